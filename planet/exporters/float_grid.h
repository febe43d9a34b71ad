#pragma once
// The grid of a power of two on which float offsets from an origin are exact (mesh_file.h).

#include <glm/glm.hpp>
#include <span>
#include <string_view>

namespace planet {

struct Bounds {
    glm::dvec3 low, high;

    double extent() const { return glm::max(glm::max(high.x - low.x, high.y - low.y), high.z - low.z); }
    /// Of any coordinate.
    double largest() const;
};

/// Of at least one vertex. Throws Error(bad_data) naming the format if a coordinate is not finite or beyond 1e30.
Bounds bounds_of(std::span<const glm::dvec3> vertices, std::string_view format);

/// The least power of two that is at least x >= 0, and at least 2^-100: offsets on such a grid are no denormal floats.
double power_of_two_above(double x);

/// The least power of two of which 2^24 steps cover the bounds after rounding to it as well.
double step_to_round(const Bounds& bounds);

/// An origin for vertices that were rounded to step_to_round() of their bounds or to a coarser power of two: on that grid
/// too, so that origin + offset = vertex exactly in double, and each offset is exact as a float. It is 0 if offsets from
/// there fit as well, as those of a planet do; else the centre of the bounds.
glm::dvec3 float_origin(const Bounds& rounded);

}  // namespace planet
