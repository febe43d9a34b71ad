#pragma once
// What the benchmarks of baking work on: the tiles of the shipped DEM, measured and settled.

#include <algorithm>
#include <memory>
#include <vector>

#include "planet/elevation/raster_field.h"
#include "planet/mesh/deviation.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/store/baked_tile.h"
#include "planet/store/coverage.h"
#include "planet/store/tile_codec.h"

namespace planet::bench {

/// The DEM of the Sangre de Cristo alone, above the ellipsoid, in quanta of 0.25 m: about 2.5 million vertices.
struct BakeScene {
    std::shared_ptr<const RasterField> field =
        open_raster_field(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif", VerticalDatum::ellipsoid);
    TileScale scale;
    std::vector<BakedTile> tiles;
    std::vector<const BakedTile*> leaves;  ///< whole leaf tiles of the depth that most of them have
    std::size_t leaf_vertices = 0;

    BakeScene() {
        tiles = tie_tiles(coverage(*field, {}));
        for (BakedTile& tile : tiles) measure(tile);
        settle(tiles);
        choose_leaves();
    }

    /// Heights as a bake samples them, but corners of roots are sampled too.
    void measure(BakedTile& baked) {
        TileLattice lattice;
        Tile& tile = baked.tile;
        lattice.set_normals(corners(tile.root), tile.depth);
        std::vector<glm::dvec3> normals(lattice.size());
        for (std::size_t v = 0; v < normals.size(); ++v) normals[v] = lattice.normal(v);
        tile.height.resize(normals.size());
        field->heights(normals, tile.height);
        for (float& h : tile.height) h = std::isnan(h) ? 0.0f : std::nearbyint(4 * h) / 4;
        lattice.set_positions(scale.placement, tile.height, {}, baked.exists);
        baked.rounded.assign(lattice.rounded().begin(), lattice.rounded().end());
        tile.deviation.resize(baked.exists.size());
        tile.radius.resize(baked.exists.size());
        own_deviation(lattice, tile.deviation);
        corner_radii(lattice, baked.exists, baked.inner(), std::vector<std::uint8_t>(tile_cells / 2, 1), tile.radius);
        own_height_range(tile, baked.exists);
    }

    void choose_leaves() {
        for (const BakedTile& t : tiles)
            if (!t.inner() && t.tile.min_height > 0 && std::ranges::count(t.exists, 0) == 1) leaves.push_back(&t);
        for (const BakedTile* t : leaves) leaf_vertices += t->tile.height.size();
    }
};

inline const BakeScene& bake_scene() {
    static const BakeScene scene;
    return scene;
}

}  // namespace planet::bench
