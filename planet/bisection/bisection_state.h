#pragma once
// What a Bisection holds: the leaves, and the count of splits that were asked for.

#include <algorithm>

#include "planet/bisection/leaf_mesh.h"

namespace planet {

struct Bisection::State {
    LeafMesh mesh;
    std::vector<double> base_angle;  ///< smallest angle by base triangle, radians
    std::size_t splits = 0, requests = 0, propagated_max = 0;
    std::size_t queue_bytes = 0;  ///< of the largest queue

    State(const PlainMesh& base, const BisectionOptions& options) : mesh(base, options) {}

    TrianglePlaces places(Index t) const {
        const auto& c = mesh[t].corner;
        return {mesh.place(c[0]), mesh.place(c[1]), mesh.place(c[2])};
    }
    /// Squared length of the longest side as judged or, in space, as placed.
    double longest_squared(Index t) const {
        double squared = mesh[t].squared[0];
        if (!mesh.has_placement() || mesh.options().sides == SideGeometry::plan) return squared;
        const TrianglePlaces p = places(t);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 d = p[(k + 1) % 3] - p[k];
            squared = std::max(squared, dot(d, d));
        }
        return squared;
    }
    void split_terminal(Index t) {
        mesh.split_terminal(t);
        ++splits;
    }
    void count_request(std::size_t splits_done) {
        ++requests;
        propagated_max = std::max(propagated_max, splits_done - 1);
    }
    /// Splits the longest side of a leaf, longer ones before it, as long as the mesh has at most `most` triangles after each;
    /// after each one calls done(). @return splits; the leaf is split unless the limit came first
    template <class Done>
    std::size_t split_leaf(Index t, std::size_t most, Done&& done) {
        const auto [name, kind] = std::pair(mesh[t].name, mesh[t].kind);
        std::size_t count = 0;
        while (mesh[t].name == name && mesh[t].kind == kind) {
            const Index first = mesh.terminal(t);
            if (mesh.size() + (mesh[first].beyond[0] == none ? 1 : 2) > most) return count;
            split_terminal(first);
            ++count;
            done();
        }
        count_request(count);
        return count;
    }
    std::size_t split_leaf(Index t) {
        return split_leaf(t, RefineGoal::no_limit, [] {});
    }
};

}  // namespace planet
