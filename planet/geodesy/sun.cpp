#include "planet/geodesy/sun.h"

#include <array>
#include <span>

#include "planet/geodesy/earth_rotation.h"

namespace planet {
namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr double arc_second = degrees / 3600;
constexpr double astronomical_unit = 149597870700.0;  // IAU 2012, resolution B2

double into_turn(double angle) {
    const double r = std::fmod(angle, turn);
    return r < 0 ? r + turn : r;
}

/// A cos(B + C tau), tau in Julian millennia since J2000.
struct Term {
    double A, B, C;
};

// The Earth's heliocentric longitude, 1e-8 rad, referred to the mean dynamical ecliptic and equinox of date: Meeus,
// appendix III, L0 down to 1e-6 rad. The 31 terms left out add up to at most 0.0010 degree, 0.0002 rms.
constexpr std::array L0{Term{175347046, 0, 0},
                        Term{3341656, 4.6692568, 6283.0758500},
                        Term{34894, 4.62610, 12566.15170},
                        Term{3497, 2.7441, 5753.3849},
                        Term{3418, 2.8289, 3.5231},
                        Term{3136, 3.6277, 77713.7715},
                        Term{2676, 4.4181, 7860.4194},
                        Term{2343, 6.1352, 3930.2097},
                        Term{1324, 0.7425, 11506.7698},
                        Term{1273, 2.0371, 529.6910},
                        Term{1199, 1.1096, 1577.3435},
                        Term{990, 5.233, 5884.927},
                        Term{902, 2.045, 26.298},
                        Term{857, 3.508, 398.149},
                        Term{780, 1.179, 5223.694},
                        Term{753, 2.533, 5507.553},
                        Term{505, 4.583, 18849.228},
                        Term{492, 4.205, 775.523},
                        Term{357, 2.920, 0.067},
                        Term{317, 5.849, 11790.629},
                        Term{284, 1.899, 796.298},
                        Term{271, 0.315, 10977.079},
                        Term{243, 0.345, 5486.778},
                        Term{206, 4.806, 2544.314},
                        Term{205, 1.869, 5573.143},
                        Term{202, 2.458, 6069.777},
                        Term{156, 0.833, 213.299},
                        Term{132, 3.411, 2942.463},
                        Term{126, 1.083, 20.775},
                        Term{115, 0.645, 0.980},
                        Term{103, 0.636, 4694.003},
                        Term{102, 0.976, 15720.839},
                        Term{102, 4.267, 7.114}};
constexpr std::array L1{Term{628331966747, 0, 0}, Term{206059, 2.678235, 6283.075850}, Term{4303, 2.6351, 12566.1517},
                        Term{425, 1.590, 3.523}};
constexpr std::array L2{Term{52919, 0, 0}, Term{8720, 1.0721, 6283.0758}, Term{309, 0.867, 12566.152}};

double sum(std::span<const Term> terms, double tau) {
    double s = 0;
    for (const Term& t : terms) s += t.A * std::cos(t.B + t.C * tau);
    return s * 1e-8;
}

/// Astronomical units: Astronomical Almanac, section C, "low precision formulas for the Sun".
double distance_au(double days) {
    const double g = (357.529 + 0.98560028 * days) * degrees;
    return 1.00014 - 0.01671 * std::cos(g) - 0.00014 * std::cos(2 * g);
}

}  // namespace

SunPosition sun_position(UtcTime t) {
    const double T = julian_centuries(t), tau = T / 10;
    const double earth = sum(L0, tau) + tau * (sum(L1, tau) + tau * sum(L2, tau));
    const double distance = distance_au(T * 36525);
    const Nutation n = nutation(T);
    // To FK5 (Meeus 25.9), then nutation, then aberration (25.10).
    const double longitude = earth + turn / 2 + (-0.09033 - 20.4898 / distance) * arc_second + n.longitude;
    const double obliquity = mean_obliquity(T) + n.obliquity;
    const double x = std::cos(longitude), s = std::sin(longitude);
    const glm::dvec3 date{x, s * std::cos(obliquity), s * std::sin(obliquity)};
    return {into_turn(longitude), into_turn(std::atan2(date.y, date.x)), std::asin(date.z),
            distance * astronomical_unit, ecef_from_date(t) * date};
}

Geodetic subsolar_point(UtcTime t) {
    return geodetic_from_normal(sun_direction(t));
}

double equation_of_time(UtcTime t) {
    // Apparent solar time at Greenwich is the sun's hour angle there and half a turn, mean solar time is UT.
    const double hour_angle = apparent_sidereal_time(t) - sun_position(t).right_ascension;
    const double days = days_since_j2000(t);  // from noon
    return std::remainder(hour_angle - turn * (days - std::floor(days)), turn);
}

}  // namespace planet
