#include "planet/store/resampling.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "planet/store/surface_cursor.h"

namespace planet {

namespace {

// A field may look at far more samples than lie in a small cap, so few large ones are asked for.
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
    Certifier(const ElevationField& field, const Placement& placement, std::span<BakedTile> tiles,
              const std::function<void(double)>& progress)
        : field_(field),
          mean_radius_m_(placement.ellipsoid.mean_radius()),
          tiles_(tiles),
          progress_(progress),
          baked_(tiles),
          cursor_(baked_, placement) {
        for (std::size_t t = 0; t < tiles.size(); ++t) index_.emplace(&tiles[t].tile, t);
    }

    void certify(LocationCode cell) {
        const Cap cap = cap_of(cell);
        const double spacing = field_.spacing(cap);
        if (!std::isfinite(spacing)) return;
        const double across = cap.angle * mean_radius_m_;
        const bool too_many =
            spacing > 0 && std::numbers::pi * across * across > most_samples_at_once * spacing * spacing;
        if (too_many && cell.bisection_level() < max_bisection_level) {
            certify(cell.child(0));
            certify(cell.child(1));
            return;
        }
        normals_.clear();
        heights_.clear();
        field_.samples(cap, normals_, heights_);
        certify_samples(cell);
        const std::uint64_t before = cell.bits() + 1 - (std::uint64_t{8} << cell.bisection_level());
        progress_(std::ldexp(static_cast<double>(before), -cell.bisection_level() - 3));
    }

  private:
    void certify_samples(LocationCode cell) {
        const Corners c = corners(cell);
        glm::dvec3 inward[3] = {glm::cross(c.left, c.right), glm::cross(c.right, c.apex), glm::cross(c.apex, c.left)};
        if (!is_counter_clockwise(cell))
            for (glm::dvec3& side : inward) side = -side;
        for (std::size_t s = 0; s < normals_.size(); ++s) {
            const glm::dvec3& n = normals_[s];
            // A sample on a side is taken from both cells.
            if (glm::dot(inward[0], n) < -1e-15 || glm::dot(inward[1], n) < -1e-15 || glm::dot(inward[2], n) < -1e-15)
                continue;
            cursor_.seek(n);
            const double off = std::abs(static_cast<double>(heights_[s]) - cursor_.height(n));
            if (off > static_cast<double>(cursor_.tile().resampling))
                tiles_[index_.at(&cursor_.tile())].tile.resampling =
                    std::nextafter(static_cast<float>(off), std::numeric_limits<float>::max());
        }
    }

    const ElevationField& field_;
    double mean_radius_m_;
    std::span<BakedTile> tiles_;
    const std::function<void(double)>& progress_;
    std::unordered_map<const Tile*, std::size_t> index_;
    BakedTiles baked_;
    SurfaceCursor cursor_;
    std::vector<glm::dvec3> normals_;
    std::vector<float> heights_;
};

}  // namespace

void certify_resampling(const ElevationField& field, const Placement& placement, std::span<BakedTile> tiles,
                        const std::function<void(double fraction)>& progress) {
    Certifier certifier(field, placement, tiles, progress);
    for (int face = 0; face < face_count; ++face) certifier.certify(LocationCode::face_root(face));
}

}  // namespace planet
