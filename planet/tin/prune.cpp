#include "planet/tin/prune.h"

#include "planet/tin/triangle_scan.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class Pruning {
  public:
    Pruning(Delaunay& mesh, const HeightGrid& grid, double tolerance)
        : mesh_(mesh), grid_(grid), tolerance_(tolerance) {}

    bool remove(Index v) {
        if (!mesh_.plan_removal(v) || !own_sample_stays(v)) return false;
        for (const auto& t : mesh_.filling())
            if (!within(grid_, sorted_triangle(mesh_, grid_, t), static_cast<float>(tolerance_))) return false;
        for (const auto& t : mesh_.filling())
            if (certified_deviation(t) > tolerance_) return false;
        mesh_.remove_planned();
        return true;
    }

  private:
    double certified_deviation(const std::array<Index, 3>& t) const {
        return worst_sample<double>(grid_, sorted_triangle(mesh_, grid_, t), tolerance_).deviation;
    }

    // Most vertices fail here: they were the farthest sample once.
    bool own_sample_stays(Index v) const {
        const glm::ivec2 p = mesh_.point(v);
        for (const auto& t : mesh_.filling()) {
            const glm::ivec2 a = mesh_.point(t[0]), b = mesh_.point(t[1]), c = mesh_.point(t[2]);
            const std::int64_t in_a = orientation(b, c, p), in_b = orientation(c, a, p), in_c = orientation(a, b, p);
            if (in_a < 0 || in_b < 0 || in_c < 0) continue;
            const auto h = [this](glm::ivec2 q) { return static_cast<double>(grid_.at(q)); };
            const double scaled = static_cast<double>(in_a) * (h(a) - h(p)) +
                                  static_cast<double>(in_b) * (h(b) - h(p)) + static_cast<double>(in_c) * (h(c) - h(p));
            return std::abs(scaled) <= tolerance_ * static_cast<double>(in_a + in_b + in_c);
        }
        return true;
    }

    Delaunay& mesh_;
    const HeightGrid& grid_;
    const double tolerance_;
};

}  // namespace

std::size_t prune(Delaunay& mesh, const HeightGrid& grid, const PruneOptions& options) {
    Pruning pruning(mesh, grid, options.tolerance);
    std::size_t removed = 0;
    for (int pass = 0; pass < options.passes; ++pass) {
        const std::size_t before = removed;
        for (Index v = 0; v < mesh.vertex_slots(); ++v) {
            const bool kept = v < options.keep.size() && options.keep[v] != 0;
            if (!kept && mesh.vertex_alive(v)) removed += pruning.remove(v);
        }
        if (removed == before) break;
    }
    return removed;
}

}  // namespace planet
