#include "planet/tin/tiled_features.h"

#include <algorithm>
#include <cmath>

namespace planet {

namespace {

class FeatureCutter {
  public:
    explicit FeatureCutter(const TinTiling& tiling) : tiling_(tiling) {}

    void point(glm::ivec2 p) {
        share(p);
        needs_[tiling_.tiles_at(p).front()].features.points.push_back(p);
    }

    void segment(glm::ivec2 a, glm::ivec2 b) {
        std::vector<Cut> cuts{{0, a}, {1, b}};
        for (int axis = 0; axis < 2; ++axis) add_crossings(a, b, axis, cuts);
        std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& c, const Cut& d) { return c.way < d.way; });
        for (const Cut& cut : cuts) share(cut.sample);
        for (std::size_t i = 1; i < cuts.size(); ++i) {
            const glm::ivec2 from = cuts[i - 1].sample, to = cuts[i].sample;
            if (from != to) needs_[tile_of(from, to)].features.lines.push_back({from, to});
        }
    }

    std::unordered_map<std::size_t, TinTileNeeds> take() { return std::move(needs_); }

  private:
    struct Cut {
        double way;  ///< from 0 at one end of the segment to 1 at the other
        glm::ivec2 sample;
    };

    // With borders of constant x (axis 0) or y.
    void add_crossings(glm::ivec2 a, glm::ivec2 b, int axis, std::vector<Cut>& cuts) const {
        const auto [first, last] = std::minmax(a[axis], b[axis]);
        const int step = tiling_.step(), end = (axis == 0 ? tiling_.width() : tiling_.height()) - 1;
        for (int border = (first / step + 1) * step; border < std::min(last, end); border += step) {
            const double way = double{1} * (border - a[axis]) / (b[axis] - a[axis]);
            glm::ivec2 at(glm::round(glm::dvec2(a) + way * glm::dvec2(b - a)));
            at[axis] = border;
            cuts.push_back({way, at});
        }
    }

    void share(glm::ivec2 p) {
        const std::vector<std::size_t> tiles = tiling_.tiles_at(p);
        if (tiles.size() < 2) return;
        for (const std::size_t tile : tiles) needs_[tile].border.push_back(p);
    }

    // The first that has both.
    std::size_t tile_of(glm::ivec2 p, glm::ivec2 q) const {
        const std::vector<std::size_t> at_p = tiling_.tiles_at(p), at_q = tiling_.tiles_at(q);
        return *std::ranges::find_first_of(at_p, at_q);
    }

    const TinTiling& tiling_;
    std::unordered_map<std::size_t, TinTileNeeds> needs_;
};

}  // namespace

std::unordered_map<std::size_t, TinTileNeeds> cut_into_tiles(const TinFeatures& features, const TinTiling& tiling) {
    FeatureCutter cutter(tiling);
    for (const glm::ivec2 p : features.points) cutter.point(p);
    for (const auto& line : features.lines)
        for (std::size_t i = 1; i < line.size(); ++i) cutter.segment(line[i - 1], line[i]);
    return cutter.take();
}

}  // namespace planet
