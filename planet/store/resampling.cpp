#include "planet/store/resampling.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "planet/store/surface_cursor.h"

namespace planet {

namespace {

constexpr double most_samples_at_once = 1 << 20;

// The tiles of the bake as a cursor reads them: no copies, no owners.
class BakedTiles final : public TileReader {
  public:
    explicit BakedTiles(std::span<const BakedTile> tiles) {
        for (const BakedTile& t : tiles) index_.emplace(t.tile.root.bits(), &t.tile);
    }
    std::shared_ptr<const Tile> tile(LocationCode root) const override {
        const auto found = index_.find(root.bits());
        return found == index_.end() ? nullptr : std::shared_ptr<const Tile>(std::shared_ptr<void>(), found->second);
    }

  private:
    std::unordered_map<std::uint64_t, const Tile*> index_;
};

class Certifier {
  public:
    Certifier(const ElevationField& field, const Placement& placement, double mean_radius_m, std::span<BakedTile> tiles)
        : field_(field), mean_radius_m_(mean_radius_m), baked_(tiles), cursor_(baked_, placement) {}

    void certify(BakedTile& tile) {
        const double worst = tile.inner() ? worst_beside_children(tile, 1) : worst_in(tile.tile.root);
        tile.tile.resampling =
            worst > 0 ? std::nextafter(static_cast<float>(worst), std::numeric_limits<float>::max()) : 0.0f;
    }

  private:
    enum class Children { none, some, all };
    static Children children_below(const BakedTile& tile, unsigned i) {
        const int levels = tile_levels - relative_level(i);
        std::size_t there = 0;
        for (unsigned k = i << levels; k < (i + 1) << levels; ++k) there += tile.tile.child_exists[k - tile_cells];
        return there == 0 ? Children::none : there == std::size_t{1} << levels ? Children::all : Children::some;
    }

    // Over the largest cells of an inner tile below which no tile begins.
    double worst_beside_children(const BakedTile& tile, unsigned i) {
        const Children children = children_below(tile, i);
        if (children == Children::all) return 0;
        if (children == Children::none) return worst_in(cell_code(tile.tile.root, i));
        return std::max(worst_beside_children(tile, 2 * i), worst_beside_children(tile, 2 * i + 1));
    }

    double worst_in(LocationCode cell) {
        const Cap cap = cap_of(cell);
        const double spacing = field_.spacing(cap);
        if (!std::isfinite(spacing)) return 0;
        const double side = cap.angle * mean_radius_m_;
        if (std::numbers::pi * side * side > most_samples_at_once * spacing * spacing && spacing > 0 &&
            cell.bisection_level() < max_bisection_level)
            return std::max(worst_in(cell.child(0)), worst_in(cell.child(1)));
        normals_.clear();
        heights_.clear();
        field_.samples(cap, normals_, heights_);
        return worst_of_samples(cell);
    }

    double worst_of_samples(LocationCode cell) {
        const Corners c = corners(cell);
        glm::dvec3 inward[3] = {glm::cross(c.left, c.right), glm::cross(c.right, c.apex), glm::cross(c.apex, c.left)};
        if (!is_counter_clockwise(cell))
            for (glm::dvec3& side : inward) side = -side;
        double worst = 0;
        for (std::size_t s = 0; s < normals_.size(); ++s) {
            const glm::dvec3& n = normals_[s];
            // A sample on a side is taken by both cells.
            if (glm::dot(inward[0], n) < -1e-15 || glm::dot(inward[1], n) < -1e-15 || glm::dot(inward[2], n) < -1e-15)
                continue;
            cursor_.seek(n);
            const double off = std::abs(static_cast<double>(heights_[s]) - cursor_.height(n));
            if (off > worst) worst = off;
        }
        return worst;
    }

    const ElevationField& field_;
    double mean_radius_m_;
    BakedTiles baked_;
    SurfaceCursor cursor_;
    std::vector<glm::dvec3> normals_;
    std::vector<float> heights_;
};

}  // namespace

void certify_resampling(const ElevationField& field, const Placement& placement, double mean_radius_m,
                        std::span<BakedTile> tiles, const std::function<void(double fraction)>& progress) {
    Certifier certifier(field, placement, mean_radius_m, tiles);
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        certifier.certify(tiles[t]);
        if (t % 256 == 0) progress(static_cast<double>(t) / static_cast<double>(tiles.size()));
    }
}

}  // namespace planet
