#pragma once
// The position part of the accuracy certificate: how far computed positions are from where they should be.
//
// Every position is computed three ways:
//   closed     ecef_from_normal() of ellipsoid.h, as every vertex is
//   library    GeographicLib::Geocentric::Forward, in double
//   exact      the textbook formula (Heiskanen and Moritz, "Physical Geodesy", 5-27) in long double, from the same
//              latitude and longitude in degrees: 64 significant bits where the processor has them, 1e-12 m
// and the worst distances are reported by bands of height, because the rounding of a double grows with the distance
// from the centre: half a unit in the last place of a coordinate is 0.5 nm on the ground and 3.7 nm at 50,000 km.

#include <cstddef>
#include <string>
#include <vector>

#include "planet/geodesy/ellipsoid.h"

namespace planet {

/// One line of a certificate.
struct CheckRow {
    std::string name;
    double value = 0;  ///< measured
    double bound = 0;  ///< the most it may be
    std::string unit;  ///< of value and bound: "m", "rad", ...
    bool passed = false;
};

/// A row that passes if value <= bound; a NaN value fails.
CheckRow check_row(std::string name, double value, double bound, std::string unit);

/// Checks positions over the whole planet from 11 km below the ellipsoid to 50,000 km above it: at `points` places
/// spread evenly, and at poles, the antimeridian, the eight faces' corners and sides and their nearest neighbours in
/// double. Deterministic. The first row only says how many positions were checked. Takes about 1 s for 2^20 points.
/// @param points at least 1
std::vector<CheckRow> check_positions(const Ellipsoid& e, std::size_t points = std::size_t{1} << 20);

}  // namespace planet
