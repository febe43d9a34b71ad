// Verification of a whole store: everything that reading relies on.

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/mesh/deviation.h"
#include "planet/store/baked_tile.h"
#include "planet/store/store_tables.h"
#include "planet/store/tile_cache.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

using TilePointer = std::shared_ptr<const Tile>;

class Checker {
  public:
    explicit Checker(const ElevationStore& store)
        : store_(store), cache_(store), scale_(tile_scale(store.metadata())) {}

    StoreCheck run(const std::function<void(double)>& progress) {
        std::vector<LocationCode> codes;
        try {
            codes = store_.tiles();
        } catch (const Error& error) {
            problem(error.what());
            return found_;
        }
        for (std::size_t t = 0; t < codes.size(); ++t) {
            if (progress && t % 64 == 0) progress(static_cast<double>(t) / static_cast<double>(codes.size()));
            check(codes[t], codes);
        }
        const bool complete = store_.metadata().complete;
        for (int face = 0; complete && face < face_count; ++face) require(LocationCode::face_root(face), codes);
        if (complete && codes.size() != store_.metadata().tiles)
            problem(store_.where() + ": " + std::to_string(codes.size()) + " tiles, but the metadata says " +
                    std::to_string(store_.metadata().tiles));
        return found_;
    }

  private:
    void problem(std::string line) {
        ++found_.problems;
        if (found_.first_problems.size() < 20) found_.first_problems.push_back(std::move(line));
    }
    void problem(LocationCode root, const std::string& what) {
        problem(store_.where() + ": tile " + to_string(root) + ": " + what);
    }

    static bool contains(const std::vector<LocationCode>& codes, LocationCode root) {
        return std::binary_search(codes.begin(), codes.end(), root);
    }
    void require(LocationCode root, const std::vector<LocationCode>& codes) {
        if (!contains(codes, root)) problem(root, "is missing");
    }

    // nullptr if there is none or it is damaged; its own check reports damage.
    TilePointer sound(LocationCode root) const {
        TilePointer tile = cache_.tile(root);
        return tile && !tile->damaged ? tile : nullptr;
    }

    void check(LocationCode root, const std::vector<LocationCode>& codes) {
        ++found_.tiles;
        const std::size_t known_damage = cache_.damage().size();
        const TilePointer tile = cache_.tile(root);
        if (!tile || tile->damaged) {
            const auto damage = cache_.damage();
            problem(damage.size() > known_damage ? damage.back()
                                                 : store_.where() + ": tile " + to_string(root) + " is damaged");
            return;
        }
        found_.vertices += tile->height.size();
        for (std::size_t k = 0; store_.metadata().complete && k < std::size_t{1} << tile->depth; ++k)
            if (tile->child_exists[k]) require(scale_.layers.below(root, k), codes);
        check_nested(*tile);
        check_sides(*tile);
        if (root.bisection_level() > 0) check_above(*tile);
        if (tile->child_exists.any()) check_bounds(*tile);
    }

    // A record must be at least those of the child diamonds, in this tile and in the tiles below it.
    void check_nested(const Tile& tile) {
        lattice_.set_normals(corners(tile.root), tile.depth);
        lattice_.set_positions(scale_.placement, tile.height, tile.undulation, {});
        const TileLayout& layout = tile_layout();
        for (unsigned i = 1; i < 1u << tile.depth; ++i) {
            const glm::vec3& m = lattice_.rounded()[layout.split_vertex[i]];
            for (unsigned child = 2 * i; child < 2 * i + 2; ++child) {
                if (child < 1u << tile.depth) {
                    check_below(tile, i, m, tile, child, lattice_.rounded()[layout.split_vertex[child]]);
                } else if (tile.child_exists[child - (1u << tile.depth)]) {
                    if (const TilePointer below = sound(cell_code(tile.root, child)))
                        check_below(tile, i, m, *below, 1, split_position(*below));
                }
            }
        }
    }

    glm::vec3 split_position(const Tile& tile) const {
        const GeoidUndulation N = tile.undulation.empty() ? GeoidUndulation{} : tile.undulation[3];
        return glm::vec3(
            scale_.placement.ecef(split_vertex(corners(tile.root)), static_cast<double>(tile.height[3]), N));
    }

    void check_below(const Tile& tile, unsigned i, const glm::vec3& m, const Tile& below, unsigned child,
                     const glm::vec3& m_child) {
        const float deviation = below.deviation[child];
        if (deviation == 0) return;
        if (!(tile.deviation[i] >= deviation) ||
            !(static_cast<double>(tile.radius[i]) >= radius_over(m, m_child, below.radius[child])))
            problem(tile.root, "record " + std::to_string(i) + " does not enclose those below it");
    }

    static bool same_origin(const Tile& a, std::size_t v, const Tile& b, std::size_t w) {
        return a.origins.known() == b.origins.known() && (!a.origins.known() || a.origins[v] == b.origins[w]);
    }

    void check_sides(const Tile& tile) {
        const TileLayout& layout = tile_layout();
        TilePointer beside[3];
        for (const Side side : {Side::split, Side::left_leg, Side::right_leg})
            beside[static_cast<std::size_t>(side)] = sound(neighbor(tile.root, side));
        for (const SideCell& s : side_cells(tile.depth)) {
            const Tile* other = beside[static_cast<std::size_t>(s.side)].get();
            const unsigned j = local_across(s.cell);
            const bool shared = other && j < 1u << other->depth;
            const float deviation = tile.deviation[s.cell];
            if (!shared) {
                if (deviation != 0 && store_.metadata().complete && cache_.damage().empty())
                    problem(tile.root, "record " + std::to_string(s.cell) + " has no tile beside it");
                continue;
            }
            ++found_.side_records;
            const std::size_t v = layout.split_vertex[s.cell], w = layout.split_vertex[j];
            if (deviation != other->deviation[j] || tile.radius[s.cell] != other->radius[j] ||
                tile.height[v] != other->height[w] || !same_origin(tile, v, *other, w) ||
                (!tile.undulation.empty() && tile.undulation[v].m != other->undulation[w].m))
                problem(tile.root,
                        "record " + std::to_string(s.cell) + " differs from that of tile " + to_string(other->root));
        }
    }

    void check_above(const Tile& tile) {
        const LocationCode root = tile.root;
        const TilePointer above = sound(scale_.layers.above(root));
        if (!above) return;
        const std::size_t position = scale_.layers.position(root);
        if (!above->child_exists[position])
            problem(root, "is not listed by the tile above it");
        else if (above->child_deviation[position] != tile.deviation[1] ||
                 (tile.deviation[1] > 0 && above->child_radius[position] != tile.radius[1]))
            problem(root, "is not what the tile above it says of its root");
        const auto& corner = tile_layout().corners[scale_.layers.local_above(root)];
        for (std::size_t v = 0; v < 3; ++v)
            if (tile.height[v] != above->height[corner[v]] || !same_origin(tile, v, *above, corner[v]) ||
                (!tile.undulation.empty() && tile.undulation[v].m != above->undulation[corner[v]].m))
                problem(root, "corner " + std::to_string(v) + " differs from the tile above it");
    }

    // Leaf deviations are computed as they are read; those of inner tiles are stored.
    void check_bounds(const Tile& tile) {
        std::vector<std::uint8_t> exists(tile.deviation.size());
        for (std::size_t i = 1; i < exists.size(); ++i) exists[i] = tile.deviation[i] > 0;
        lattice_.set_positions(scale_.placement, tile.height, tile.undulation, exists);
        std::vector<float> own(tile.deviation.size());
        own_deviation(lattice_, own);
        for (std::size_t i = 1; i < own.size(); ++i)
            if (exists[i] && tile.deviation[i] < own[i])
                problem(tile.root, "deviation " + std::to_string(i) + " is not a bound");
    }

    const ElevationStore& store_;
    TileCache cache_;
    TileScale scale_;
    TileLattice lattice_;
    StoreCheck found_;
};

}  // namespace

StoreCheck ElevationStore::verify(const std::function<void(double)>& progress) const {
    return Checker(*this).run(progress);
}

}  // namespace planet
