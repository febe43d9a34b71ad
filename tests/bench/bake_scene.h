#pragma once
// What the benchmarks of baking work on: the tiles of the shipped DEM, measured and settled.

#include <algorithm>
#include <memory>
#include <vector>

#include "planet/bake/bake.h"
#include "planet/elevation/raster_field.h"
#include "planet/mesh/saturation.h"
#include "planet/store/baked_tile.h"
#include "planet/store/ladder.h"
#include "planet/store/tile_codec.h"
#include "planet/store/tile_sides.h"

namespace planet::bench {

/// The DEM of the Sangre de Cristo alone, above the ellipsoid, in quanta of 0.25 m: five million vertices.
struct BakeScene {
    std::shared_ptr<const RasterField> field =
        open_raster_field(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif", VerticalDatum::ellipsoid);
    TileScale scale;
    std::vector<BakedTile> tiles;
    std::vector<const BakedTile*> leaves;  ///< whole leaf tiles amid the DEM
    std::size_t leaf_vertices = 0;

    BakeScene() {
        BakeOptions options;
        options.first_tile_level = scale.layers.first;
        const ElevationStore store = bake_in_memory(*field, options);
        for (const LocationCode root : store.tiles()) tiles.push_back(as_baked(*store.read(root)));
        for (const BakedTile& t : tiles)
            if (!t.inner() && t.tile.min_height > 0 && std::count(t.exists.begin(), t.exists.end(), 0) == 1)
                leaves.push_back(&t);
        for (const BakedTile* t : leaves) leaf_vertices += t->tile.height.size();
    }

    /// What a bake encodes: with how far the records of the sides lie above what the tile itself arrives at.
    BakedTile as_baked(const Tile& tile) const {
        BakedTile baked;
        baked.tile = tile;
        baked.has_tiles_below = tile.child_exists.any();
        for (const float d : tile.deviation) baked.exists.push_back(d > 0);
        if (!baked.inner()) find_gains(baked);
        return baked;
    }

    void find_gains(BakedTile& baked) const {
        const Tile& tile = baked.tile;
        TileLattice lattice;
        lattice.set_normals(corners(tile.root), tile.depth);
        lattice.set_positions(scale.placement, tile.height, {}, baked.exists);
        std::vector<float> deviation(baked.exists.size()), radius(baked.exists.size());
        measure_leaf(lattice, baked.exists, deviation, radius);
        TileSaturation saturation;
        saturation.start(tile.depth, lattice.rounded());
        const auto sides = side_cells(tile.depth);
        baked.gain.resize(sides.size());
        for (int level = tile.depth - 1; level >= 0; --level) {
            saturation.level(level, baked.exists, deviation, radius);
            for (std::size_t k = 0; k < sides.size(); ++k) {
                const unsigned i = sides[k].cell;
                if (relative_level(i) != level || !baked.exists[i]) continue;
                const auto gain = [](unsigned settled, unsigned own) {
                    return static_cast<std::uint16_t>(settled - own);
                };
                baked.gain[k] = {gain(deviation_code(tile.deviation[i]), deviation_code(deviation[i])),
                                 gain(radius_code(tile.radius[i]), radius_code(radius[i]))};
                deviation[i] = tile.deviation[i];
                radius[i] = tile.radius[i];
            }
        }
    }
};

inline const BakeScene& bake_scene() {
    static const BakeScene scene;
    return scene;
}

}  // namespace planet::bench
