#include "planet/tin/greedy_tin.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/tin/indexed_heap.h"
#include "planet/tin/triangle_scan.h"
#include "planet/tin/void_border.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class GreedyInsertion {
  public:
    GreedyInsertion(Delaunay& mesh, const HeightGrid& grid, const GreedyOptions& options)
        : mesh_(mesh),
          start_(mesh),
          grid_(grid),
          options_(options),
          stages_(options.stages),
          local_(make_measure(TinMetric::local, grid)) {
        measure_ = options.measure ? options.measure : local_.get();
    }

    GreedyReport run() {
        report_.triangles = start_triangles_ = triangles_over_samples(mesh_, grid_).triangles.size();
        if (report_.triangles > options_.max_triangles)
            throw Error(Fault::bad_usage, "the budget of triangles",
                        std::to_string(options_.max_triangles) + " are fewer than corners, features and voids need",
                        std::to_string(report_.triangles) + " or more");
        insert_while_due();
        if (!measure_->exact()) {  // what it has missed
            if (past_best()) return_to_best();
            measure_ = local_.get();
            report_.end = GreedyEnd::tolerance;
            insert_while_due();
        }
        if (past_best()) {
            return_to_best();
            fill_up();
        }
        report_.deviation_max = certified_deviation();
        return report_;
    }

  private:
    void insert_while_due() {
        measure_all();
        best_vertices_ = 0;
        remember_if_best();
        while (!priority_.empty()) {
            if (!insert_next()) {
                report_.end = GreedyEnd::budget;
                return;
            }
            remember_if_best();
        }
    }

    void measure_all() {
        std::vector<Index> all;
        for (Index t = 0; t < mesh_.triangle_slots(); ++t)
            if (mesh_.alive(t)) all.push_back(t);
        priority_.clear();
        added_up_ = 0;
        share_.assign(mesh_.triangle_slots(), 0);
        measure(all);
    }

    // Triangles within a bound do not wait.
    void measure(std::span<const Index> triangles) {
        measured_.resize(triangles.size());
        measure_->measure(mesh_, triangles, measured_);
        if (measure_->adds_up()) share_.resize(mesh_.triangle_slots(), 0);
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const Measured& m = measured_[i];
            if (m.sample.x >= 0 && m.deviation > options_.tolerance && m.priority > options_.least_priority)
                priority_.set(triangles[i], {m.priority, m.sample});
            else
                priority_.remove(triangles[i]);
            if (!measure_->adds_up()) continue;
            added_up_ += m.priority - share_[triangles[i]];
            share_[triangles[i]] = m.priority;
        }
    }

    // What a state is judged by: the less, the better.
    double judged() const {
        if (measure_->adds_up()) return added_up_;
        return priority_.empty() ? 0 : priority_.top_key().priority;
    }

    bool past_best() const { return report_.end == GreedyEnd::budget && judged() > best_; }

    double certified_deviation() const {
        double largest = 0;
        for (Index t = 0; t < mesh_.triangle_slots(); ++t)
            if (mesh_.alive(t))
                largest = std::max(largest, worst_sample<double>(grid_, sorted_triangle(mesh_, grid_, t)).deviation);
        return largest;
    }

    // @return false if that would be too many triangles
    bool insert_next() {
        const Index t = priority_.top();
        const glm::ivec2 sample = priority_.top_key().sample;
        mesh_.plan_insertion(sample, mesh_.locate_in(sample, t));
        const std::size_t after = triangles_after_plan();
        if (after > options_.max_triangles) return false;
        const auto stage =
            std::find_if(stages_.begin(), stages_.end(), [&](std::size_t s) { return s >= after && s < after + 2; });
        if (stage != stages_.end() && options_.at_stage) {
            const std::size_t asked = *stage;
            stages_.erase(stage);
            insert_with_picture(asked, sample);
        } else {
            insert_planned();
        }
        ++report_.insertions;
        return true;
    }

    std::size_t triangles_after_plan() const {
        const std::size_t fan = mesh_.ring().size() - (mesh_.open_ring() ? 1 : 0);
        return report_.triangles + fan - mesh_.cavity().size();
    }

    void insert_planned() {
        report_.triangles = triangles_after_plan();
        mesh_.insert_planned();
        measure(mesh_.changed());
    }

    void insert_with_picture(std::size_t asked, glm::ivec2 sample) {
        TinStage stage{asked, {}, deviation_grid(mesh_, grid_), sample, certified_deviation()};
        insert_planned();
        stage.mesh = triangles_over_samples(mesh_, grid_);
        options_.at_stage(std::move(stage));
    }

    void remember_if_best() {
        const double now = judged();
        if (best_vertices_ != 0 && now >= best_) return;
        best_ = now;
        best_vertices_ = mesh_.vertex_slots();
    }

    // Insertions have the order of the vertices: the first of them are made again.
    void return_to_best() {
        std::vector<glm::ivec2> again;
        for (std::size_t v = start_.vertex_slots(); v < best_vertices_; ++v)
            again.push_back(mesh_.point(static_cast<Index>(v)));
        report_.taken_back += mesh_.vertex_slots() - best_vertices_;
        mesh_ = start_;
        report_.triangles = start_triangles_;
        for (const glm::ivec2 p : again) {
            mesh_.plan_insertion(p, mesh_.locate(p));
            report_.triangles = triangles_after_plan();
            mesh_.insert_planned();
        }
        measure_all();
    }

    // A triangle whose sample would make something worse than the best state waits no longer, until it changes.
    void fill_up() {
        while (!priority_.empty()) {
            const Index t = priority_.top();
            const glm::ivec2 sample = priority_.top_key().sample;
            mesh_.plan_insertion(sample, mesh_.locate_in(sample, t));
            if (triangles_after_plan() > options_.max_triangles || makes_worse(sample)) {
                priority_.remove(t);
                continue;
            }
            insert_planned();
            ++report_.filled_up;
        }
    }

    bool makes_worse(glm::ivec2 p) const {
        const auto ring = mesh_.ring();
        double largest = 0, sum = 0, before = 0;
        for (std::size_t i = 0; i + (mesh_.open_ring() ? 1 : 0) < ring.size(); ++i) {
            const glm::ivec2 a = mesh_.point(ring[i]), b = mesh_.point(ring[(i + 1) % ring.size()]);
            const SortedTriangle s({a, b, p}, {grid_.at(a), grid_.at(b), grid_.at(p)});
            if (measure_->adds_up())
                sum += measure_->priority(s);
            else
                largest = std::max(largest, worst_sample<double>(grid_, s).deviation);
        }
        if (!measure_->adds_up()) return largest > best_;
        for (const Index t : mesh_.cavity()) before += share_[t];
        return sum >= before;
    }

    Delaunay& mesh_;
    const Delaunay start_;
    const HeightGrid& grid_;
    const GreedyOptions& options_;
    std::vector<std::size_t> stages_;  ///< still to come
    std::unique_ptr<TinMeasure> local_;
    TinMeasure* measure_;
    GreedyReport report_;
    std::size_t start_triangles_ = 0, best_vertices_ = 0;
    double best_ = 0;
    IndexedHeap priority_;
    double added_up_ = 0;        ///< of a measure that adds up
    std::vector<double> share_;  ///< in it, by triangle
    std::vector<Measured> measured_;
};

}  // namespace

GreedyReport insert_greedily(Delaunay& mesh, const HeightGrid& grid, const GreedyOptions& options) {
    if (!(options.tolerance >= 0))
        throw Error(Fault::bad_usage, "the tolerance", std::to_string(options.tolerance) + " m", "0 or more");
    return GreedyInsertion(mesh, grid, options).run();
}

Delaunay coarsest_tin(const HeightGrid& grid) {
    constexpr int longest = 1 << 15;
    const auto places = [](int samples) {
        std::vector<int> out;
        for (int i = 0; i < samples - 1; i += longest) out.push_back(i);
        out.push_back(samples - 1);
        return out;
    };
    Delaunay mesh(places(grid.width()), places(grid.height()));
    for (const glm::ivec2 p : void_border(grid, {0, 0}, {grid.width() - 1, grid.height() - 1})) mesh.insert(p);
    return mesh;
}

std::vector<float> deviation_grid(const Delaunay& mesh, const HeightGrid& grid) {
    std::vector<float> out(grid.count(), std::numeric_limits<float>::quiet_NaN());
    const auto at = [&](glm::ivec2 p) -> float& {
        return out[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(grid.width()) +
                   static_cast<std::size_t>(p.x)];
    };
    for (Index t = 0; t < mesh.triangle_slots(); ++t) {
        if (!mesh.alive(t)) continue;
        const SortedTriangle s = sorted_triangle(mesh, grid, t);
        const scan::ScaledDistances<double> distances(grid, s);
        for_each_span(s, [&](int y, int first, int last) {
            for (int x = first; x <= last; ++x) at({x, y}) = static_cast<float>(distances.one(x, y));
            return true;
        });
        for (const glm::ivec2 corner : mesh.corners(t))
            if (grid.valid(corner)) at(corner) = 0;
    }
    return out;
}

}  // namespace planet
