// Refinement for a goal: longest side first, or largest deviation first.

#include <string>

#include "planet/bisection/bisection_state.h"
#include "planet/bisection/length_queue.h"
#include "planet/error.h"

namespace planet {

namespace {

using Index = Bisection::Index;

void check_goal(const RefineGoal& goal, std::size_t triangles) {
    const auto refuse = [](const char* where, const std::string& what, const std::string& accepted) {
        throw Error(Fault::bad_usage, where, what, accepted);
    };
    const bool sides = goal.max_side != std::numeric_limits<double>::infinity();
    const bool deviations = goal.max_deviation != std::numeric_limits<double>::infinity();
    if (!sides && !deviations && goal.max_triangles == RefineGoal::no_limit)
        refuse("the refinement", "no limit", "a longest side, a largest deviation or a number of triangles");
    if (!(goal.max_side > 0)) refuse("the longest side", std::to_string(goal.max_side), "more than 0");
    if (!(goal.max_deviation >= 0)) refuse("the largest deviation", std::to_string(goal.max_deviation), "0 or more");
    if ((deviations || goal.order == SplitOrder::deviation) && !goal.deviation)
        refuse("the deviation", "nothing to measure it by", "a surface");
    if (goal.max_triangles < triangles)
        refuse("the number of triangles", std::to_string(goal.max_triangles),
               std::to_string(triangles) + " or more, which there are already");
}

// A leaf and what it was when it was put into a heap.
struct Candidate {
    double key;
    Index leaf, name;
    LeafKind kind;
    bool operator<(const Candidate& o) const { return key != o.key ? key < o.key : leaf > o.leaf; }
};

// By any key, in any region: a heap of leaves, those that have been split meanwhile passed over.
class RefineByKey {
  public:
    RefineByKey(Bisection::State& state, const RefineGoal& goal) : state_(state), mesh_(state.mesh), goal_(goal) {}

    RefineResult run() {
        std::vector<Index> all(mesh_.size());
        for (Index t = 0; t < all.size(); ++t) all[t] = t;
        consider(all);
        while (!heap_.empty()) {
            std::pop_heap(heap_.begin(), heap_.end());
            const Candidate next = heap_.back();
            heap_.pop_back();
            if (mesh_[next.leaf].name != next.name || mesh_[next.leaf].kind != next.kind) continue;
            if (!mesh_.can_halve(mesh_[next.leaf].squared[0])) {
                result_.end = RefineEnd::finest;
                continue;
            }
            result_.splits += state_.split_leaf(next.leaf, goal_.max_triangles, [&] { consider(mesh_.changed()); });
            if (mesh_[next.leaf].name == next.name && mesh_[next.leaf].kind == next.kind) {
                result_.end = RefineEnd::budget;
                break;
            }
        }
        state_.queue_bytes = std::max(state_.queue_bytes, heap_.capacity() * sizeof(Candidate));
        for (Index t = 0; t < deviation_.size(); ++t)
            result_.deviation_max = std::max(result_.deviation_max, deviation_[t]);
        return result_;
    }

  private:
    // Measures leaves and puts those into the heap that are to be split.
    void consider(std::span<const Index> leaves) {
        places_.clear();
        in_region_.clear();
        for (const Index t : leaves) {
            const TrianglePlaces p = state_.places(t);
            if (goal_.region && !goal_.region(p)) {
                if (t < deviation_.size()) deviation_[t] = 0;
                continue;
            }
            places_.push_back(p);
            in_region_.push_back(t);
        }
        measured_.assign(places_.size(), 0);
        if (goal_.deviation) goal_.deviation(places_, measured_);
        if (goal_.deviation && deviation_.size() < mesh_.size()) deviation_.resize(mesh_.size(), 0);
        for (std::size_t i = 0; i < in_region_.size(); ++i) push(in_region_[i], measured_[i]);
    }
    void push(Index t, double deviation) {
        if (!(deviation > 0)) deviation = 0;
        if (goal_.deviation) deviation_[t] = deviation;
        const double squared = state_.longest_squared(t);
        const bool by_budget = goal_.max_side == std::numeric_limits<double>::infinity() &&
                               goal_.max_deviation == std::numeric_limits<double>::infinity();
        const bool by_deviation = goal_.order == SplitOrder::deviation;
        if (by_budget ? by_deviation && deviation == 0
                      : !(squared > goal_.max_side * goal_.max_side) && !(deviation > goal_.max_deviation))
            return;
        heap_.push_back({by_deviation ? deviation : squared, t, mesh_[t].name, mesh_[t].kind});
        std::push_heap(heap_.begin(), heap_.end());
    }

    Bisection::State& state_;
    LeafMesh& mesh_;
    const RefineGoal& goal_;
    RefineResult result_;
    std::vector<Candidate> heap_;
    std::vector<double> deviation_;  ///< by leaf, where there is a measure
    std::vector<TrianglePlaces> places_;
    std::vector<Index> in_region_;
    std::vector<double> measured_;
};

// By length alone, everywhere: no split needs another before it.
RefineResult refine_by_length(Bisection::State& state, const RefineGoal& goal) {
    LeafMesh& mesh = state.mesh;
    RefineResult result;
    double longest = 0, least = goal.max_side * goal.max_side;
    if (goal.max_side == std::numeric_limits<double>::infinity()) least = 0;
    for (Index t = 0; t < mesh.size(); ++t) longest = std::max(longest, mesh[t].squared[0]);
    const double shortest = mesh.can_halve(least) ? least : mesh.finest_squared();
    LengthQueue queue(mesh, longest, shortest);
    for (Index t = 0; t < mesh.size(); ++t) queue.push(t);
    result.end = shortest > least ? RefineEnd::finest : RefineEnd::met;
    for (Index t; (t = queue.top()) != LeafMesh::none;) {
        // Among equal lengths the leaf to be split first may be another one.
        t = mesh.terminal(t);
        if (mesh.size() + (mesh[t].beyond[0] == LeafMesh::none ? 1 : 2) > goal.max_triangles) {
            result.end = RefineEnd::budget;
            break;
        }
        mesh.split_terminal(t);
        ++result.splits;
        for (const Index changed : mesh.changed()) queue.push(changed);
    }
    state.splits += result.splits;
    state.requests += result.splits;
    state.queue_bytes = std::max(state.queue_bytes, queue.bytes());
    return result;
}

}  // namespace

RefineResult Bisection::refine(const RefineGoal& goal) {
    check_goal(goal, triangle_count());
    // Memory beyond what is used is never touched.
    if (goal.max_triangles <= std::size_t{1} << 26) state_->mesh.reserve(goal.max_triangles);
    const bool placed_in_space = state_->mesh.has_placement() && state_->mesh.options().sides == SideGeometry::space;
    if (!goal.deviation && !goal.region && !placed_in_space) return refine_by_length(*state_, goal);
    return RefineByKey(*state_, goal).run();
}

}  // namespace planet
