#pragma once
// What the benchmarks of baking work on: the tiles of the shipped DEM, measured and settled.

#include <algorithm>
#include <memory>
#include <vector>

#include "planet/elevation/raster_field.h"
#include "planet/mesh/deviation.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/store/bake.h"
#include "planet/store/bake_settling.h"
#include "planet/store/ladder.h"
#include "planet/store/tile_codec.h"

namespace planet::bench {

/// The DEM of the Sangre de Cristo alone, above the ellipsoid, in quanta of 0.25 m: about 2.5 million vertices.
struct BakeScene {
    std::shared_ptr<const RasterField> field =
        open_raster_field(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif", VerticalDatum::ellipsoid);
    TileScale scale;
    std::vector<BakedTile> tiles;          ///< leaf tiles, as they were encoded
    std::vector<const BakedTile*> leaves;  ///< whole leaf tiles of the depth that most of them have
    std::size_t leaf_vertices = 0;

    BakeScene() {
        const ElevationStore store = bake_in_memory(*field, {});
        for (const LocationCode root : store.tiles()) {
            std::optional<Tile> tile = store.read(root);
            if (tile->child_exists.none()) tiles.push_back(baked(std::move(*tile)));
        }
        choose_leaves();
    }

    /// What the tile's sides have above what the tile itself arrives at: as in the bake.
    BakedTile baked(Tile tile) const {
        BakedTile baked;
        for (const float deviation : tile.deviation) baked.exists.push_back(deviation > 0);
        TileLattice lattice;
        lattice.set_normals(corners(tile.root), tile.depth);
        lattice.set_positions(scale.placement, tile.height, {}, baked.exists);
        std::vector<float> deviation(baked.exists.size()), radius(baked.exists.size());
        measure_leaf(lattice, baked.exists, deviation, radius);
        TileRecords records;
        records.depth = tile.depth;
        std::ranges::copy(lattice.rounded(), records.position.begin());
        records.set_own(deviation, radius, baked.exists);
        const auto sides = side_cells(tile.depth);
        std::vector<SideSteps> settled, mine(sides.size());
        for (const SideCell& s : sides)
            settled.push_back({static_cast<std::uint16_t>(deviation_code(tile.deviation[s.cell])),
                               static_cast<std::uint16_t>(radius_code(tile.radius[s.cell]))});
        records.settle(settled, mine);
        for (std::size_t k = 0; k < sides.size(); ++k)
            baked.gain.push_back({static_cast<std::uint16_t>(settled[k].deviation - mine[k].deviation),
                                  static_cast<std::uint16_t>(settled[k].radius - mine[k].radius)});
        baked.tile = std::move(tile);
        return baked;
    }

    void choose_leaves() {
        for (const BakedTile& t : tiles)
            if (t.tile.min_height > 0 && std::ranges::count(t.exists, 0) == 1) leaves.push_back(&t);
        for (const BakedTile* t : leaves) leaf_vertices += t->tile.height.size();
    }
};

inline const BakeScene& bake_scene() {
    static const BakeScene scene;
    return scene;
}

}  // namespace planet::bench
