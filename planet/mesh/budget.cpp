#include "planet/mesh/budget.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "planet/error.h"
#include "planet/mesh/segment_builder.h"
#include "planet/parallel.h"

namespace planet {

std::size_t count_triangles(const TileSource& tiles, const SegmentView& view, std::size_t limit, int threads) {
    SegmentTree tree;
    tree.update(tiles, view);
    const CullingTest culling(view.culling);
    const auto patches = tree.in_view();
    constexpr std::size_t run = 16;
    std::atomic<std::size_t> count = 0;
    parallel_for((patches.size() + run - 1) / run, static_cast<unsigned>(std::max(threads, 1)), [&](std::size_t r) {
        SegmentBuilder builder;
        builder.begin(tiles, view, SegmentBuilder::Purpose::count);
        std::vector<BuiltSegment> segments;
        for (const auto& [i, open] : patches.subspan(r * run, std::min(run, patches.size() - r * run))) {
            if (count.load(std::memory_order_relaxed) > limit) return;
            const SegmentNode& n = tree.node(i);
            segments.clear();
            builder.build({n.tile, n.local}, n.cell, segments);
            for (const BuiltSegment& s : segments) {
                unsigned still_open = open;
                if (!culling.hidden(s.sphere.centre, s.sphere.radius, still_open))
                    count.fetch_add(s.leaves, std::memory_order_relaxed);
            }
        }
    });
    return count;
}

TriangleBudget fit_triangles(const TileSource& tiles, SegmentView view, std::size_t max_triangles, int threads) {
    constexpr int steps_per_octave = 70, most_steps = 64 * steps_per_octave;
    const double wanted = view.test.K;
    const auto K_of = [&](int step) {
        return step == most_steps ? 0 : wanted * std::exp2(-static_cast<double>(step) / steps_per_octave);
    };
    std::size_t triangles = 0;
    const auto fits = [&](int step) {
        view.test.K = K_of(step);
        const std::size_t count = count_triangles(tiles, view, max_triangles, threads);
        if (count <= max_triangles) triangles = count;
        return count <= max_triangles;
    };
    // Each limit goes through the same steps and leaves them where it fits: a larger one never ends at a coarser step.
    int too_fine = -1, fine = 0;
    for (int next = steps_per_octave; !fits(fine); next *= 2) {
        if (fine == most_steps) {
            const std::size_t least = count_triangles(tiles, view, ~std::size_t{0}, threads);
            throw Error(Fault::bad_usage, "triangle budget",
                        std::to_string(max_triangles) + " triangles are fewer than the coarsest mesh of the view has",
                        "at least " + std::to_string(least));
        }
        too_fine = fine;
        fine = std::min(next, most_steps);
    }
    while (fine - too_fine > 1) {
        const int middle = (fine + too_fine) / 2;
        (fits(middle) ? fine : too_fine) = middle;
    }
    const double K = K_of(fine);
    return {.K = K, .triangles = triangles, .coarsening = wanted == K ? 1 : wanted / K};
}

// A step changes the number of triangles by up to 2^(1/2) where the ground is rough. Back to the finer mesh only where
// that would still fit.
void BudgetSteps::after_frame(std::size_t triangles, std::size_t max_triangles) {
    if (triangles > max_triangles)
        ++step_;
    else if (step_ > 0 && 1.6 * static_cast<double>(triangles) <= static_cast<double>(max_triangles))
        --step_;
}

double BudgetSteps::factor() const {
    return std::exp2(-0.25 * step_);
}

}  // namespace planet
