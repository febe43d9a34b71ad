#include "planet/tin/prune.h"

#include <algorithm>

#include "planet/tin/triangle_scan.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class Pruning {
  public:
    Pruning(Delaunay& mesh, const HeightGrid& grid, const PruneOptions& options)
        : mesh_(mesh), grid_(grid), tolerance_(options.tolerance), untried_(mesh.vertex_slots(), 1) {
        for (std::size_t v = 0; v < std::min(options.keep.size(), untried_.size()); ++v)
            if (options.keep[v] != 0) untried_[v] = kept;
    }

    // What failed before fails again unless its star has changed.
    std::size_t pass() {
        std::size_t removed = 0;
        for (Index v = 0; v < untried_.size(); ++v) {
            if (untried_[v] != 1 || !mesh_.vertex_alive(v)) continue;
            untried_[v] = 0;
            if (!can_go(v)) continue;
            for (const Index beside : mesh_.ring())
                if (untried_[beside] != kept) untried_[beside] = 1;
            mesh_.remove_planned();
            ++removed;
        }
        return removed;
    }

  private:
    static constexpr std::uint8_t kept = 2;

    bool can_go(Index v) {
        const glm::ivec2 p = mesh_.point(v);
        if (!mesh_.plan_removal(v, [&](const std::array<Index, 3>& t) { return own_sample_stays(p, t); })) return false;
        for (const auto& t : mesh_.filling())
            if (!within(grid_, sorted_triangle(mesh_, grid_, t), static_cast<float>(tolerance_))) return false;
        for (const auto& t : mesh_.filling())
            if (!certified(sorted_triangle(mesh_, grid_, t))) return false;
        return true;
    }

    bool certified(const SortedTriangle& t) const {
        return floats_decide(grid_, t, tolerance_) ||
               worst_sample<double>(grid_, t, tolerance_).deviation <= tolerance_;
    }

    // Most vertices fail here: they were the farthest sample once.
    bool own_sample_stays(glm::ivec2 p, const std::array<Index, 3>& t) const {
        const glm::ivec2 a = mesh_.point(t[0]), b = mesh_.point(t[1]), c = mesh_.point(t[2]);
        const std::int64_t in_a = orientation(b, c, p), in_b = orientation(c, a, p), in_c = orientation(a, b, p);
        if (in_a < 0 || in_b < 0 || in_c < 0) return true;
        const auto h = [this](glm::ivec2 q) { return static_cast<double>(grid_.at(q)); };
        const double scaled = static_cast<double>(in_a) * (h(a) - h(p)) + static_cast<double>(in_b) * (h(b) - h(p)) +
                              static_cast<double>(in_c) * (h(c) - h(p));
        return std::abs(scaled) <= tolerance_ * static_cast<double>(in_a + in_b + in_c);
    }

    Delaunay& mesh_;
    const HeightGrid& grid_;
    const double tolerance_;
    std::vector<std::uint8_t> untried_;  ///< by vertex: 1 since its star was last changed
};

}  // namespace

std::size_t prune(Delaunay& mesh, const HeightGrid& grid, const PruneOptions& options) {
    Pruning pruning(mesh, grid, options);
    std::size_t removed = 0;
    for (int pass = 0; pass < options.passes; ++pass) {
        const std::size_t now = pruning.pass();
        removed += now;
        if (now == 0) break;
    }
    return removed;
}

}  // namespace planet
