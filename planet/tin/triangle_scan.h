#pragma once
// The samples of a triangle of any shape, row by row, and the worst of them.
//
// A row's samples are a span from the left side to the right. Where the sides are is worked out in double, one product
// a row, and no sample is tested for being inside: |x| < 2^16 within a triangle, so that a quotient is off by less than
// 2^-35, while a side that misses a sample misses it by 2^-16 or more. A margin of 2^-20 between the two makes spans
// exact.
//
//             c
//            /|            a lowest, c highest (then leftmost); b between, right or left of a-c
//        a-c/ |b-c         rows of a and of c are left out unless a side lies in them: a vertex does not deviate
//          /__b
//         / _/ a-b
//        a-

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <utility>

#include "planet/tin/delaunay.h"
#include "planet/tin/height_grid.h"

namespace planet {

/// The longest extent of a triangle that is scanned, along either axis.
inline constexpr int max_scanned_extent = (1 << 16) - 1;

/// Corners in rising order, each with its height; `area` is twice the signed one: > 0 with b to the right of a-c.
struct SortedTriangle {
    glm::ivec2 a, b, c;
    double ha, hb, hc;  ///< metres
    std::int64_t area;

    SortedTriangle(const std::array<glm::ivec2, 3>& p, const std::array<float, 3>& h)
        : a(p[0]),
          b(p[1]),
          c(p[2]),
          ha(static_cast<double>(h[0])),
          hb(static_cast<double>(h[1])),
          hc(static_cast<double>(h[2])) {
        const auto order = [](glm::ivec2& p1, double& h1, glm::ivec2& p2, double& h2) {
            if (p2.y < p1.y || (p2.y == p1.y && p2.x < p1.x)) {
                std::swap(p1, p2);
                std::swap(h1, h2);
            }
        };
        order(a, ha, b, hb);
        order(b, hb, c, hc);
        order(a, ha, b, hb);
        area = std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
        assert(area != 0 && c.y - a.y <= max_scanned_extent);
    }
};

inline SortedTriangle sorted_triangle(const Delaunay& mesh, const HeightGrid& grid,
                                      const std::array<Delaunay::Index, 3>& vertices) {
    const std::array c{mesh.point(vertices[0]), mesh.point(vertices[1]), mesh.point(vertices[2])};
    return {c, {grid.at(c[0]), grid.at(c[1]), grid.at(c[2])}};
}
inline SortedTriangle sorted_triangle(const Delaunay& mesh, const HeightGrid& grid, Delaunay::Index triangle) {
    return sorted_triangle(mesh, grid, mesh.vertices(triangle));
}

/// Calls row(y, first, last) for the samples inside a triangle and on its sides, lowest row first; spans may be empty.
/// Ends early if it returns false. Coordinates are not negative.
template <class Row>
void for_each_span(const SortedTriangle& t, Row&& row) {
    constexpr double margin = 0x1p-20;
    const double slope_ac = static_cast<double>(t.c.x - t.a.x) / static_cast<double>(t.c.y - t.a.y);
    const double ax = static_cast<double>(t.a.x);
    const bool long_is_left = t.area > 0;
    const auto span = [&](int y, double x) {
        const double other = ax + slope_ac * static_cast<double>(y - t.a.y);
        const double left = long_is_left ? other : x, right = long_is_left ? x : other;
        return row(y, static_cast<int>(left + (1 - margin)), static_cast<int>(right + margin));
    };
    const auto rows = [&](glm::ivec2 from, glm::ivec2 to) {
        if (to.y - from.y < 2) return true;
        const double slope = static_cast<double>(to.x - from.x) / static_cast<double>(to.y - from.y);
        for (int y = from.y + 1; y < to.y; ++y)
            if (!span(y, static_cast<double>(from.x) + slope * static_cast<double>(y - from.y))) return false;
        return true;
    };
    if (rows(t.a, t.b) && span(t.b.y, static_cast<double>(t.b.x))) rows(t.b, t.c);
}

/// The plane through the corners, times the area so that whole metres stay whole numbers:
/// area * (height - ha) = per_column * (x - a.x) + per_row * (y - a.y).
struct TrianglePlane {
    double per_column, per_row;  ///< metres times samples
    explicit TrianglePlane(const SortedTriangle& t) {
        const glm::dvec2 u(t.b - t.a), v(t.c - t.a);
        const double hu = t.hb - t.ha, hv = t.hc - t.ha;
        per_column = hu * v.y - hv * u.y;
        per_row = hv * u.x - hu * v.x;
    }
};

/// The sample of a triangle that is farthest from its plane; of several, the first in rows.
template <class Real>
struct WorstSample {
    Real deviation = 0;  ///< metres; 0 if every sample lies in the plane
    glm::ivec2 sample{-1};
};

namespace scan {

inline constexpr int lanes = 8;
typedef float Floats __attribute__((vector_size(lanes * sizeof(float))));

template <class Real>
struct Lanes;
template <>
struct Lanes<float> {
    using Values = Floats;
    typedef std::int32_t Places __attribute__((vector_size(lanes * sizeof(std::int32_t))));
};
template <>
struct Lanes<double> {
    typedef double Values __attribute__((vector_size(lanes * sizeof(double))));
    typedef std::int64_t Places __attribute__((vector_size(lanes * sizeof(std::int64_t))));
};
template <class Real>
using Values = typename Lanes<Real>::Values;
template <class Real>
using Places = typename Lanes<Real>::Places;

template <class Real>
inline constexpr Values<Real> ramp{0, 1, 2, 3, 4, 5, 6, 7};
template <class Real>
inline constexpr Places<Real> count_up{0, 1, 2, 3, 4, 5, 6, 7};

/// Distances of eight samples from the plane, on from sample (x, y), times the area. Exact for heights in whole metres
/// where the products are below 2^24 (float: such are the triangles that end up in a mesh) or 2^53 (double).
template <class Real>
class ScaledDistances {
  public:
    ScaledDistances(const HeightGrid& grid, const SortedTriangle& t)
        : grid_(grid),
          a_(t.a),
          plane_(t),
          base_(static_cast<Real>(t.ha)),
          slope_(static_cast<Real>(plane_.per_column)),
          area_(static_cast<Real>(t.area)) {}
    Real area() const { return area_ < 0 ? -area_ : area_; }
    /// @param out not returned: processors without such wide registers have no one way to
    void at(int x, int y, Values<Real>& out) const {
        Floats h;
        std::memcpy(&h, grid_.row(y) + x, sizeof h);
        const auto start = static_cast<Real>(plane_.per_row * (y - a_.y) + plane_.per_column * (x - a_.x));
        out = (__builtin_convertvector(h, Values<Real>) - base_) * area_ - (start + slope_ * ramp<Real>);
        out = out < 0 ? -out : out;
    }
    /// Of one sample, not times the area: metres.
    Real one(int x, int y) const {
        Values<Real> d;
        at(x, y, d);
        return d[0] / area();
    }

  private:
    const HeightGrid& grid_;
    glm::ivec2 a_;
    TrianglePlane plane_;
    Real base_, slope_, area_;
};

template <class Real>
Real largest(const Values<Real>& values) {
    Real worst = values[0];
    for (int i = 1; i < lanes; ++i) worst = std::max(worst, values[i]);
    return worst;
}

}  // namespace scan

/// Whether distances in float say of every sample what exact ones would: is it farther than the tolerance? So it is
/// where heights and tolerance are whole metres and their products with the area whole numbers that floats hold; a
/// sample so far away that they do not is beyond the tolerance whatever the rounding.
inline bool floats_decide(const HeightGrid& grid, const SortedTriangle& t, double tolerance) {
    if (!grid.whole_metres() || tolerance != std::floor(tolerance)) return false;
    const double relief = std::max({t.ha, t.hb, t.hc}) - std::min({t.ha, t.hb, t.hc});
    return static_cast<double>(std::abs(t.area)) * (relief + tolerance + 2) < 0x1p23;
}

/// Void samples are passed over. In float, distances are off by 1e-6 of the triangle's relief at most, or not at all
/// (ScaledDistances); in double they certify.
/// @param above only deviations larger than that are of interest: the sample of a lesser one may be left out
template <class Real>
WorstSample<Real> worst_sample(const HeightGrid& grid, const SortedTriangle& t, Real above = 0) {
    using namespace scan;
    const ScaledDistances<Real> distances(grid, t);
    Values<Real> worst{};
    Places<Real> place{};
    const int left = std::min({t.a.x, t.b.x, t.c.x});
    for_each_span(t, [&](int y, int first, int last) {
        for (int x = first; x <= last; x += lanes) {
            Values<Real> d;
            distances.at(x, y, d);
            const Places<Real> better = (d > worst) & (count_up<Real> <= last - x);
            worst = better ? d : worst;
            const auto packed = static_cast<unsigned>(y - t.a.y) << 16 | static_cast<unsigned>(x - left);
            place = better ? Places<Real>{} + static_cast<int>(packed) : place;
        }
        return true;
    });
    const Real farthest = largest<Real>(worst);
    WorstSample<Real> out{farthest / distances.area(), {-1, -1}};
    if (!(out.deviation > above)) return out;
    unsigned best = 0xffffffffu;
    for (int i = 0; i < lanes; ++i)
        if (worst[i] == farthest) best = std::min(best, static_cast<unsigned>(place[i]) + static_cast<unsigned>(i));
    out.sample = {left + static_cast<int>(best & 0xffffu), t.a.y + static_cast<int>(best >> 16)};
    return out;
}

/// Whether no sample is farther from the plane than that. Void samples are passed over.
inline bool within(const HeightGrid& grid, const SortedTriangle& t, float tolerance) {
    using namespace scan;
    const ScaledDistances<float> distances(grid, t);
    const float bound = tolerance * distances.area();
    bool all = true;
    for_each_span(t, [&](int y, int first, int last) {
        Places<float> over{};
        for (int x = first; x <= last; x += lanes) {
            Values<float> d;
            distances.at(x, y, d);
            over |= (d > bound) & (count_up<float> <= last - x);
        }
        for (int i = 0; i < lanes; ++i) all = all && over[i] == 0;
        return all;
    });
    return all;
}

}  // namespace planet
