#pragma once
// A planet without data for tests and benchmarks: a height function on an ellipsoid, with per-level bounds that are
// saturated by construction, to any depth, made on demand.

#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "planet/mesh/placed_tile.h"
#include "planet/mesh/smooth_ellipsoid.h"
#include "planet/octahedron/cell_metrics.h"

namespace planet::testing {

class BallTiles final : public TileSource {
  public:
    using Height = std::function<double(const glm::dvec3&)>;

    /// @param finest_level cells of this level are never split @param roughness deviation of a cell per metre of its
    /// side
    explicit BallTiles(int finest_level, double roughness = 0, Height height = {}, double exaggeration = 1)
        : finest_(finest_level), height_(std::move(height)) {
        placement_.exaggeration = exaggeration;
        double radius = 0;
        for (int level = finest_level; level >= 0; --level) {
            const double side = cell_metrics(level).side_max * placement_.ellipsoid.a;
            radius +=
                side * 1.01 + 2 * 9000.0 * std::min(1.0, side / 1e5);  // |m - m_child| is below a side, plus relief
            radius_[level] = static_cast<float>(radius);
            deviation_[level] = static_cast<float>(side * side / (8 * placement_.ellipsoid.a) * 1.1 + roughness * side);
        }
    }

    const PlacedTile* tile(LocationCode root) const override {
        auto& slot = tiles_[root.bits()];
        if (!slot) slot = make(root);
        return slot.get();
    }

    /// The tile comes or goes, for walks: the one above says whether it is there.
    void set_there(LocationCode root, bool there) {
        PlacedTile& above = *tiles_.at(root.ancestor(root.bisection_level() - tile_levels).bits());
        above.set_child(static_cast<unsigned>(root.bits() & (tile_cells - 1)), there ? tile(root) : nullptr);
    }

    std::size_t tile_count() const { return tiles_.size(); }

    /// The bounds of levels 0 .. finest_level - 1.
    std::vector<LevelBounds> bounds() const {
        std::vector<LevelBounds> list;
        for (int level = 0; level < finest_; ++level)
            list.push_back({static_cast<double>(deviation_.at(level)), static_cast<double>(radius_.at(level))});
        return list;
    }

  private:
    std::unique_ptr<PlacedTile> make(LocationCode root) const {
        Tile t;
        t.root = root;
        t.depth = std::min(tile_levels, finest_ - root.bisection_level());
        if (const int below = root.bisection_level() + tile_levels; finest_ > below) {
            t.child_exists.set();
            t.child_deviation.assign(tile_cells, deviation_.at(below));
            t.child_radius.assign(tile_cells, radius_.at(below));
        }
        const auto normals = tile_normals(root, t.depth);
        for (const auto& n : normals) t.height.push_back(height_ ? static_cast<float>(height_(n)) : 0.0f);
        t.deviation.resize(std::size_t{1} << t.depth);
        t.radius.resize(std::size_t{1} << t.depth);
        for (std::size_t i = 1; i < t.deviation.size(); ++i) {
            const int level = root.bisection_level() + static_cast<int>(std::bit_width(i)) - 1;
            t.deviation[i] = deviation_.at(level);
            t.radius[i] = radius_.at(level);
        }
        return std::make_unique<PlacedTile>(t, placement_);
    }

    int finest_;
    Height height_;
    Placement placement_;
    std::map<int, float> radius_, deviation_;
    mutable std::map<std::uint64_t, std::unique_ptr<PlacedTile>> tiles_;
};

}  // namespace planet::testing
