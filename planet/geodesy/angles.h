#pragma once

#include <glm/glm.hpp>
#include <span>

namespace planet {

/// Longitude and latitude of normals of any length > 0, in radians: atan2(y, x) and atan2(z, hypot(x, y)) within 4e-16,
/// signs of zeros included, made to run on vector units. NaN gives NaN. All spans have the same size.
void angles_from_normals(std::span<const glm::dvec3> normals, std::span<double> longitude, std::span<double> latitude);

}  // namespace planet
