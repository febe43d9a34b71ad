#include "planet/geodesy/utm_parallels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/error.h"

namespace planet {

namespace {

using Place = UtmParallels::Place;

// Chebyshev's nodes, from 1 to -1; between two of them, for k + 1/2.
double node(double k, std::size_t terms) {
    return std::cos(std::numbers::pi * (k + 0.5) / static_cast<double>(terms));
}

// Of a place on a parallel from -1, its first column, to 1, its last.
double longitude(const UtmParallels::Columns& columns, double t) {
    return columns.first + columns.step * 0.5 * (t + 1) * (columns.count - 1);
}

}  // namespace

Place utm_place(double latitude, double longitude, int zone, bool north) try {
    const Utm utm = utm_from_geodetic({latitude, longitude, {}}, zone);
    const double other = utm.north == north ? 0 : north ? -1e7 : 1e7;
    return {utm.easting, utm.northing + other};
} catch (const Error&) {
    const double nowhere = std::numeric_limits<double>::quiet_NaN();
    return {nowhere, nowhere};
}

std::optional<UtmParallels> UtmParallels::make(int zone, bool north, const Columns& columns,
                                               std::span<const double> latitudes) {
    for (const std::size_t terms : {6u, 8u, 10u, 12u, 16u, 20u}) {
        if (columns.count < 4 * static_cast<int>(terms)) break;
        UtmParallels found(terms, columns.count);
        if (!found.fits(zone, north, columns, latitudes)) continue;
        found.coefficients_.reserve(terms * latitudes.size());
        std::vector<Place> at_nodes(terms);
        for (const double latitude : latitudes) {
            for (std::size_t k = 0; k < terms; ++k)
                at_nodes[k] = utm_place(latitude, longitude(columns, node(static_cast<double>(k), terms)), zone, north);
            found.add_row(at_nodes);
        }
        return found;
    }
    return std::nullopt;
}

// The places are smooth in the latitude, too: rows between those that are tried are no worse.
bool UtmParallels::fits(int zone, bool north, const Columns& columns, std::span<const double> latitudes) const {
    constexpr std::size_t rows = 16;  // and the last
    UtmParallels trial(terms_, columns_);
    std::vector<Place> at_nodes(terms_);
    for (std::size_t i = 0; i <= rows; ++i) {
        const double latitude = latitudes[i * (latitudes.size() - 1) / rows];
        const auto place = [&](double t) { return utm_place(latitude, longitude(columns, t), zone, north); };
        for (std::size_t k = 0; k < terms_; ++k) at_nodes[k] = place(node(static_cast<double>(k), terms_));
        trial.add_row(at_nodes);
        for (std::size_t k = 0; k <= terms_; ++k) {  // the ends, and between nodes
            const double t = k == 0 ? 1 : k == terms_ ? -1 : node(static_cast<double>(k) - 0.5, terms_);
            const Place exact = place(t), sum = trial.sum(t, i);
            if (!(std::hypot(sum.easting - exact.easting, sum.northing - exact.northing) <= 0.1 * accuracy))
                return false;
        }
    }
    return true;
}

void UtmParallels::add_row(std::span<const Place> at_nodes) {
    const auto n = static_cast<double>(terms_);
    for (std::size_t j = 0; j < terms_; ++j) {
        Place sum;
        for (std::size_t k = 0; k < terms_; ++k) {
            const double weight =
                std::cos(std::numbers::pi * static_cast<double>(j) * (static_cast<double>(k) + 0.5) / n);
            sum.easting += weight * at_nodes[k].easting;
            sum.northing += weight * at_nodes[k].northing;
        }
        const double scale = (j == 0 ? 1 : 2) / n;
        coefficients_.push_back({scale * sum.easting, scale * sum.northing});
    }
}

// Clenshaw's recurrence.
Place UtmParallels::sum(double t, std::size_t row) const {
    const Place* c = coefficients_.data() + row * terms_;
    Place one, two;
    for (std::size_t j = terms_ - 1; j > 0; --j) {
        const Place next{c[j].easting + 2 * t * one.easting - two.easting,
                         c[j].northing + 2 * t * one.northing - two.northing};
        two = one;
        one = next;
    }
    return {c[0].easting + t * one.easting - two.easting, c[0].northing + t * one.northing - two.northing};
}

Place UtmParallels::at(int column, int row) const {
    return sum(2.0 * column / (columns_ - 1) - 1, static_cast<std::size_t>(row));
}

}  // namespace planet
