#pragma once
// Segments of baked places, and what they are compared with: the same made anew.

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "pedestrian_planet.h"
#include "planet/frames.h"
#include "planet/mesh/segments.h"
#include "planet/streaming/store_tiles.h"

namespace planet::testing {

using pedestrian::places;

/// A baked place, walked without the whole machinery of a program.
struct Ground {
    explicit Ground(std::size_t place, double exaggeration = 1)
        : store(std::make_shared<const ElevationStore>(pedestrian::bake_place(places[place]))),
          cache(*store),
          tiles(cache, {places[place].ellipsoid, exaggeration}),
          centre(glm::normalize(places[place].direction)) {}

    std::shared_ptr<const ElevationStore> store;
    TileCache cache;
    StoreTiles tiles;
    glm::dvec3 centre;
};

struct Pose {
    glm::dvec3 eye, ahead;
};

inline void look(SegmentView& view, const Pose& pose, double occluder_radius) {
    view.test.eye = view.culling.eye = pose.eye;
    const glm::dvec3 ahead = glm::normalize(pose.ahead);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0.3, 0.5, 0.8123))),
                     up = glm::cross(right, ahead);
    const double c = std::cos(0.5), s = std::sin(0.5);
    view.culling.inward = {c * right + s * ahead, -c * right + s * ahead, c * up + s * ahead, -c * up + s * ahead};
    view.culling.occluder_radius = occluder_radius;
}

/// Every part of all segments, in full.
inline ::testing::AssertionResult equal(const Segments& a, const Segments& b) {
    const auto fail = [](std::size_t k, const char* what) {
        return ::testing::AssertionFailure() << "segment " << k << ": " << what;
    };
    if (a.segments().size() != b.segments().size()) return ::testing::AssertionFailure() << "number of segments";
    for (std::size_t k = 0; k < a.segments().size(); ++k) {
        const Segment &s = a.segments()[k], &t = b.segments()[k];
        if (s.root != t.root || s.patch != t.patch || s.detailed != t.detailed) return fail(k, "cells");
        if (s.leaves != t.leaves || s.vertex_count != t.vertex_count || s.index_count != t.index_count)
            return fail(k, "counts");
        if (std::memcmp(&a.vertices()[s.first_vertex], &b.vertices()[t.first_vertex],
                        s.vertex_count * sizeof(SegmentVertex)) != 0)
            return fail(k, "vertices");
        if (!std::equal(&a.indices()[s.first_index], &a.indices()[s.first_index] + s.index_count,
                        &b.indices()[t.first_index]))
            return fail(k, "strip");
        if (!std::equal(&a.leaf_levels()[s.first_leaf], &a.leaf_levels()[s.first_leaf] + s.leaves,
                        &b.leaf_levels()[t.first_leaf]))
            return fail(k, "levels");
    }
    return ::testing::AssertionSuccess();
}

/// Follows updates with segments made anew.
class Witness {
  public:
    void expect_equal(const Segments& updated, const TileSource& tiles, const SegmentView& view, int threads = 1) {
        anew_.build(tiles, view, threads);
        ASSERT_EQ(updated.hash(), anew_.hash()) << "frame " << frame_;
        ASSERT_EQ(updated.leaf_count(), anew_.leaf_count());
        ASSERT_GE(updated.ratio_max(), anew_.ratio_max());
        ASSERT_EQ(updated.deviation_max_m(), anew_.deviation_max_m());
        if (frame_ % 16 == 0) {
            ASSERT_TRUE(equal(updated, anew_)) << "frame " << frame_;
        }
        ++frame_;
        seen_ += anew_.segments().size();
        built_ += updated.built();
    }
    /// The share of segments in view that were built.
    double built() const { return static_cast<double>(built_) / static_cast<double>(seen_); }
    std::size_t seen() const { return seen_; }

  private:
    Segments anew_;
    int frame_ = 0;
    std::size_t seen_ = 0, built_ = 0;
};

inline glm::dvec3 beside(const glm::dvec3& n) {
    return glm::normalize(glm::cross(n, glm::dvec3(0.1, 0.7, -0.4)));
}

}  // namespace planet::testing
