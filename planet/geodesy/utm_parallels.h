#pragma once
// UTM coordinates along parallels: of the samples of a graticule, at a fraction of what the projection takes.

#include <optional>
#include <span>
#include <vector>

#include "planet/geodesy/utm.h"

namespace planet {

/// Columns are meridians at equal distances, rows parallels. Along a parallel easting and northing are smooth functions of
/// the longitude: polynomials through the projection of Chebyshev's nodes, one pair a row. (Trefethen, "Approximation theory
/// and approximation practice", chapters 2 to 4 and 19.)
class UtmParallels {
  public:
    struct Columns {
        double first = 0, step = 0;  ///< longitude of the first column and from one to the next, rad
        int count = 0;
    };
    struct Place {
        double easting = 0, northing = 0;  ///< metres
    };

    /// How far places may be from those of utm_from_geodetic(), metres: ten times what is measured, between the nodes of rows
    /// all over the graticule, before one is made.
    static constexpr double accuracy = 1e-6;

    /// @param zone, north whose coordinates run on across the equator @param latitudes of the rows, rad
    /// @return none where a polynomial of low degree does not keep the accuracy, the projection does not reach, or there are
    /// so few columns that nothing is gained
    static std::optional<UtmParallels> make(int zone, bool north, const Columns& columns,
                                            std::span<const double> latitudes);

    Place at(int column, int row) const;

  private:
    UtmParallels(std::size_t terms, int columns) : terms_(terms), columns_(columns) {}
    void add_row(std::span<const Place> at_nodes);
    bool fits(int zone, bool north, const Columns& columns, std::span<const double> latitudes) const;
    Place sum(double t, std::size_t row) const;

    std::size_t terms_;
    int columns_;
    std::vector<Place> coefficients_;  ///< of Chebyshev's polynomials, row by row
};

/// In the zone and hemisphere given, whose northings run on across the equator. NaN where the zone does not reach.
UtmParallels::Place utm_place(double latitude, double longitude, int zone, bool north);

}  // namespace planet
