#include "planet/exporters/float_grid.h"

#include <cmath>
#include <string>

#include "planet/error.h"

namespace planet {
namespace {

constexpr double steps = 1 << 24;

double step_to_cover(double extent) {
    return power_of_two_above(extent / steps);
}

}  // namespace

double Bounds::largest() const {
    const glm::dvec3 m = glm::max(glm::abs(low), glm::abs(high));
    return glm::max(glm::max(m.x, m.y), m.z);
}

Bounds bounds_of(std::span<const glm::dvec3> vertices, std::string_view format) {
    Bounds b{vertices[0], vertices[0]};
    bool sound = true;
    for (const glm::dvec3& v : vertices) {
        b.low = glm::min(b.low, v);
        b.high = glm::max(b.high, v);
        for (int axis = 0; axis < 3; ++axis) sound &= std::abs(v[axis]) <= 1e30;  // false for NaN
    }
    if (!sound) throw Error(Fault::bad_data, format, "a coordinate is not finite or too large", "-1e30 to 1e30");
    return b;
}

double power_of_two_above(double x) {
    int exponent;
    const double mantissa = std::frexp(x, &exponent);
    return x > 0 ? std::ldexp(1, std::max(mantissa == 0.5 ? exponent - 1 : exponent, -100)) : std::ldexp(1, -100);
}

// Rounding moves each bound by half a step at most, so that the extent grows by one: a second one is spare.
double step_to_round(const Bounds& bounds) {
    const double step = step_to_cover(bounds.extent());
    return bounds.extent() + 2 * step <= steps * step ? step : 2 * step;
}

// The rounded bounds may need a finer step than the one they were rounded to, never a coarser one.
glm::dvec3 float_origin(const Bounds& rounded) {
    const double step = step_to_cover(rounded.extent());
    if (2 * rounded.largest() <= steps * step) return glm::dvec3(0);
    const glm::dvec3 centre = rounded.low + (rounded.high - rounded.low) * 0.5;
    return {std::rint(centre.x / step) * step, std::rint(centre.y / step) * step, std::rint(centre.z / step) * step};
}

}  // namespace planet
