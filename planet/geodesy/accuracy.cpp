#include "planet/geodesy/accuracy.h"

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "planet/geodesy/geodetic.h"

namespace planet {
namespace {

/// A position in long double, metres.
struct Exact {
    long double x, y, z;
};

struct Band {
    std::string_view name;
    double low, high;  // metres above the ellipsoid
    double bound;      // metres: for closed against exact
};

// Below 2,000 km the bound is the goal of the design. Above, coordinates of up to 56,378 km are doubles 7.5 nm apart: a
// normal rounded to 1e-16 and three roundings a coordinate leave less than four such steps.
constexpr std::array<Band, 3> bands{{{"terrain, -11 km to 9 km", -11e3, 9e3, 10e-9},
                                     {"low orbit, 9 km to 2,000 km", 9e3, 2000e3, 10e-9},
                                     {"space, 2,000 km to 50,000 km", 2000e3, 50000e3, 30e-9}}};

struct Place {
    double latitude, longitude;  // degrees
};

/// Places where something special could go wrong: E_i, poles, sides of faces, the antimeridian, and next to them.
std::vector<Place> seams() {
    const auto around = [](std::vector<double> values, double most) {
        std::vector<double> all;
        for (const double v : values) {
            const double before = std::nextafter(v, -1e3), after = std::nextafter(v, 1e3);
            for (const double near : {v, before, after, v - 1e-9, v + 1e-9})
                if (std::abs(near) <= most) all.push_back(near);
        }
        return all;
    };
    std::vector<Place> places;
    for (const double latitude : around({-90, -45, -0.0, 0, 45, 90}, 90))
        for (const double longitude : around({-180, -135, -90, -45, -0.0, 0, 45, 90, 135, 180}, 180))
            places.push_back({latitude, longitude});
    return places;
}

/// The i-th of a sequence that fills the sphere and the heights of a band evenly (Roberts' R3 sequence).
struct Sample {
    Place place;
    double fraction;  // of the band's height
};
Sample spread_evenly(std::size_t i) {
    constexpr double g = 1.2207440846057596;  // g^4 = g + 1
    const auto at = [i](double step) {
        const double v = 0.5 + static_cast<double>(i) * step;
        return v - std::floor(v);
    };
    const double z = 2 * at(1 / g) - 1;
    return {{std::asin(z) / degrees, 360 * at(1 / (g * g)) - 180}, at(1 / (g * g * g))};
}

/// Sine and cosine of degrees; exact at multiples of 90, where the vertices of the octahedron are.
struct SineCosine {
    long double sine, cosine;
};
SineCosine sine_cosine(double angle_degrees) {
    constexpr long double degree = std::numbers::pi_v<long double> / 180;
    const int quarter = static_cast<int>(std::lround(angle_degrees / 90));
    const long double rest = (static_cast<long double>(angle_degrees) - 90 * quarter) * degree;  // exact but for degree
    const long double s = std::sin(rest), c = std::cos(rest);
    switch (quarter & 3) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

/// Heiskanen and Moritz (5-27), with f and not b: b is a rounded number.
Exact exact_position(const Ellipsoid& e, const SineCosine& latitude, const SineCosine& longitude, double h) {
    const long double f = e.f, one_less_e2 = (1 - f) * (1 - f);
    const long double N = e.a / std::sqrt(1 - f * (2 - f) * latitude.sine * latitude.sine);
    const long double r = (N + h) * latitude.cosine;
    return {r * longitude.cosine, r * longitude.sine, (one_less_e2 * N + h) * latitude.sine};
}

double distance(const Exact& p, const glm::dvec3& q) {
    const long double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
    return static_cast<double>(std::sqrt(x * x + y * y + z * z));
}

/// The worst so far. Unlike std::max it keeps a NaN, so that one fails the check.
void raise(double& worst, double value) {
    if (!(value <= worst)) worst = std::isnan(worst) ? worst : value;
}

/// Worst distances in a band.
struct Worst {
    double closed_exact = 0, library_exact = 0, closed_library = 0, there_and_back = 0;
};

class Checker {
  public:
    explicit Checker(const Ellipsoid& e) : e_(e), library_(e.a, e.f) {}

    void measure(const Place& place, double h, Worst& worst) const {
        const SineCosine latitude = sine_cosine(place.latitude), longitude = sine_cosine(place.longitude);
        const Exact exact = exact_position(e_, latitude, longitude, h);
        const glm::dvec3 normal(static_cast<double>(latitude.cosine * longitude.cosine),
                                static_cast<double>(latitude.cosine * longitude.sine),
                                static_cast<double>(latitude.sine));
        const glm::dvec3 closed = ecef_from_normal(e_, normal, {h});
        glm::dvec3 library;
        library_.Forward(place.latitude, place.longitude, h, library.x, library.y, library.z);
        raise(worst.closed_exact, distance(exact, closed));
        raise(worst.library_exact, distance(exact, library));
        raise(worst.closed_library, glm::distance(closed, library));
    }

    void measure_there_and_back(const Place& place, double h, Worst& worst) const {
        const glm::dvec3 p =
            ecef_from_normal(e_, normal_from_geodetic(place.latitude * degrees, place.longitude * degrees), {h});
        const NormalPosition back = position_from_ecef(e_, p);
        raise(worst.there_and_back, glm::distance(ecef_from_normal(e_, back.normal, back.h), p));
    }

  private:
    Ellipsoid e_;
    GeographicLib::Geocentric library_;
};

void report(const Band& band, const Worst& worst, std::vector<CheckRow>& rows) {
    const std::string where = " (" + std::string(band.name) + ")";
    rows.push_back(check_row("vertex position from the exact one" + where, worst.closed_exact, band.bound, "m"));
    rows.push_back(check_row("vertex position from GeographicLib's" + where, worst.closed_library, band.bound, "m"));
    rows.push_back(
        check_row("GeographicLib's position from the exact one" + where, worst.library_exact, band.bound, "m"));
    rows.push_back(check_row("to latitude, longitude and back" + where, worst.there_and_back, 2 * band.bound, "m"));
}

}  // namespace

CheckRow check_row(std::string name, double value, double bound, std::string unit) {
    return {std::move(name), value, bound, std::move(unit), value <= bound};
}

std::vector<CheckRow> check_positions(const Ellipsoid& e, std::size_t points) {
    assert(points > 0);
    const Checker checker(e);
    const std::vector<Place> special = seams();
    std::array<Worst, bands.size()> worst{};
    for (std::size_t b = 0; b < bands.size(); ++b) {
        for (const Place& place : special)
            for (const double h : {bands[b].low, 0.5 * (bands[b].low + bands[b].high), bands[b].high}) {
                checker.measure(place, h, worst[b]);
                checker.measure_there_and_back(place, h, worst[b]);
            }
    }
    constexpr std::size_t back_step = 4;  // the way back is slow: GeographicLib solves a quartic
    for (std::size_t i = 0; i < points; ++i) {
        const std::size_t b = i % bands.size();
        const Sample sample = spread_evenly(i);
        const double h = bands[b].low + sample.fraction * (bands[b].high - bands[b].low);
        checker.measure(sample.place, h, worst[b]);
        if (i % back_step == 0) checker.measure_there_and_back(sample.place, h, worst[b]);
    }
    std::vector<CheckRow> rows;
    const auto checked = static_cast<double>(points + special.size() * 3 * bands.size());
    rows.push_back(check_row("positions checked", checked, checked, "1"));
    for (std::size_t b = 0; b < bands.size(); ++b) report(bands[b], worst[b], rows);
    return rows;
}

}  // namespace planet
