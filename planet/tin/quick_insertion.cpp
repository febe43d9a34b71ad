#include "planet/tin/quick_insertion.h"

#include <limits>

#include "planet/tin/bucket_queue.h"
#include "planet/tin/triangle_scan.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class QuickInsertion {
  public:
    QuickInsertion(Delaunay& mesh, const HeightGrid& grid, const QuickInsertionOptions& options)
        : mesh_(mesh), grid_(grid), options_(options), tolerance_(static_cast<float>(options.tolerance)) {}

    void run() {
        waiting_.resize(mesh_.triangle_slots());
        for (Index t = 0; t < mesh_.triangle_slots(); ++t)
            if (mesh_.alive(t)) wait(t, std::numeric_limits<float>::max());
        do work_off_queue();
        while (!certified());
    }

  private:
    struct Waiting {
        WorstSample<float> worst;  ///< sample.x < 0: not scanned yet
        std::uint16_t bucket = BucketQueue::none;
    };

    void work_off_queue() {
        while (!queue_.empty()) {
            const std::uint16_t bucket = queue_.top_bucket();
            const Index t = queue_.pop(bucket);
            if (waiting_[t].bucket != bucket) continue;
            if (waiting_[t].worst.sample.x < 0)
                examine(t);
            else
                insert(t);
        }
    }

    void wait(Index t, float key) {
        waiting_[t].worst.sample.x = -1;
        waiting_[t].bucket = BucketQueue::bucket_of(key);
        queue_.push(t, waiting_[t].bucket);
    }

    void examine(Index t) {
        Waiting& w = waiting_[t];
        w.worst = worst_sample<float>(grid_, sorted(t), tolerance_);
        if (w.worst.deviation > tolerance_ && on_border(w.worst.sample)) w.worst = worst_inside<float>(t);
        w.bucket = BucketQueue::none;
        if (w.worst.deviation > tolerance_) queue_worst(t);
    }

    void queue_worst(Index t) {
        waiting_[t].bucket = BucketQueue::bucket_of(waiting_[t].worst.deviation);
        queue_.push(t, waiting_[t].bucket);
    }

    // Queues what rounding to float has hidden.
    bool certified() {
        bool all = true;
        for (Index t = 0; t < mesh_.triangle_slots(); ++t) {
            if (!mesh_.alive(t)) continue;
            const SortedTriangle triangle = sorted(t);
            if (floats_decide(grid_, triangle, options_.tolerance)) continue;
            WorstSample<double> worst = worst_sample<double>(grid_, triangle, options_.tolerance);
            if (worst.deviation > options_.tolerance && on_border(worst.sample)) worst = worst_inside<double>(t);
            if (!(worst.deviation > options_.tolerance)) continue;
            waiting_[t].worst = {static_cast<float>(worst.deviation), worst.sample};
            queue_worst(t);
            all = false;
        }
        return all;
    }

    SortedTriangle sorted(Index t) const { return sorted_triangle(mesh_, grid_, t); }

    bool on_border(glm::ivec2 p) const {
        return p.x == 0 || p.y == 0 || p.x == grid_.width() - 1 || p.y == grid_.height() - 1;
    }

    // A border side keeps the tolerance, but rounding can make it seem not to.
    template <class Real>
    WorstSample<Real> worst_inside(Index t) const {
        const SortedTriangle s = sorted(t);
        const scan::ScaledDistances<Real> distances(grid_, s);
        WorstSample<Real> worst;
        for_each_span(s, [&](int y, int first, int last) {
            for (int x = first; x <= last; ++x) {
                const Real d = distances.one(x, y);
                if (d > worst.deviation && !on_border({x, y})) worst = {d, {x, y}};
            }
            return true;
        });
        return worst;
    }

    void insert(Index t) {
        const WorstSample<float> worst = waiting_[t].worst;
        mesh_.insert(worst.sample, mesh_.locate_in(worst.sample, t));
        waiting_.resize(mesh_.triangle_slots());
        const float key = std::max(options_.patience * worst.deviation, tolerance_);
        for (const Index changed : mesh_.changed()) wait(changed, key);
    }

    Delaunay& mesh_;
    const HeightGrid& grid_;
    const QuickInsertionOptions options_;
    const float tolerance_;
    BucketQueue queue_;
    std::vector<Waiting> waiting_;
};

}  // namespace

void insert_to_tolerance(Delaunay& mesh, const HeightGrid& grid, const QuickInsertionOptions& options) {
    QuickInsertion(mesh, grid, options).run();
}

}  // namespace planet
