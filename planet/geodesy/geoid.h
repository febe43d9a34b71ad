#pragma once
// The geoid: how far mean sea level lies above the ellipsoid. h = H + N.
//
// Read from a file in the PGM form that GeographicLib uses and documents: a 16-bit grey map whose comments give offset
// and scale, with rows from 90 N to 90 S and columns eastward from 0 E, as egm96-15.pgm.
//
// The interpolation is that of GeographicLib::Geoid (Karney, "GeographicLib: Geoid height", the 12-point cubic): in
// each grid cell a cubic polynomial in two variables, the weighted least squares fit to the stencil
//
//      weight       . 1 1 .        The cell is in the middle. In the two rows of cells at a pole the fit is held
//                   1 2 2 1        constant along the pole itself. Values agree with GeoidEval to rounding (tested);
//                   1 2 2 1        GeographicLib's own thread-safe mode takes 130 to 180 ns a point, this one a
//                   . 1 1 .        quarter of it, in any order and from any thread.

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>

#include "planet/frames.h"

namespace planet {

/// A geoid model held in memory. Immutable, safe to read from several threads; a copy shares the grid.
class Geoid {
  public:
    /// Reads the whole grid (2 MB for 15'). Throws Error(bad_data) in one line if the file is missing, not a geoid
    /// grid, truncated, or not a whole planet.
    explicit Geoid(const std::filesystem::path& pgm);

    /// Height of the geoid above WGS84. Periodic in longitude, one value at each pole, and continuous to some mm across
    /// the sides of grid cells (a least squares fit is). NaN, or a latitude outside [-pi/2, pi/2]: NaN. For EGM96 on
    /// 15' the interpolation is within 7 mm rms, 17 cm at worst, of the full spherical harmonics.
    /// @param latitude  rad, geodetic
    /// @param longitude rad, any finite value
    GeoidUndulation undulation(double latitude, double longitude) const;
    /// The same of many, in which neighbours follow each other: the same bits, faster. All spans of one length.
    void undulations(std::span<const double> latitudes, std::span<const double> longitudes,
                     std::span<GeoidUndulation> out) const;
    /// The same at a geodetic normal of any positive length.
    GeoidUndulation undulation(const glm::dvec3& normal) const;
    /// Many at once; out.size() == normals.size().
    void undulations(std::span<const glm::dvec3> normals, std::span<GeoidUndulation> out) const;

    /// "WGS84 EGM96, 15-minute grid" or what the file says of itself; "NONE" if it says nothing.
    const std::string& description() const;
    const std::filesystem::path& path() const;

  private:
    struct Grid;
    std::shared_ptr<const Grid> grid_;
};

}  // namespace planet
