#include "planet/geodesy/earth_rotation.h"

#include <array>

#include "planet/frames.h"

namespace planet {
namespace {

constexpr double arc_second = degrees / 3600;
constexpr double turn = 2 * std::numbers::pi;

double into_turn(double angle) {
    const double r = std::fmod(angle, turn);
    return r < 0 ? r + turn : r;
}

// A rotation of the frame about an axis: what was at angle `a` from the next axis is then on it.
glm::dmat3 rotation_x(double a) {
    const double c = std::cos(a), s = std::sin(a);
    return {{1, 0, 0}, {0, c, -s}, {0, s, c}};  // columns
}
glm::dmat3 rotation_y(double a) {
    const double c = std::cos(a), s = std::sin(a);
    return {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
}
glm::dmat3 rotation_z(double a) {
    const double c = std::cos(a), s = std::sin(a);
    return {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

struct NutationTerm {
    int D, M, m, F, O;                    // multiples of the five arguments
    double longitude, longitude_century;  // 0.0001"
    double obliquity, obliquity_century;
};

// Meeus, table 22.A, by size.
constexpr std::array<NutationTerm, 13> nutation_terms{{{0, 0, 0, 0, 1, -171996, -174.2, 92025, 8.9},
                                                       {-2, 0, 0, 2, 2, -13187, -1.6, 5736, -3.1},
                                                       {0, 0, 0, 2, 2, -2274, -0.2, 977, -0.5},
                                                       {0, 0, 0, 0, 2, 2062, 0.2, -895, 0.5},
                                                       {0, 1, 0, 0, 0, 1426, -3.4, 54, -0.1},
                                                       {0, 0, 1, 0, 0, 712, 0.1, -7, 0},
                                                       {-2, 1, 0, 2, 2, -517, 1.2, 224, -0.6},
                                                       {0, 0, 0, 2, 1, -386, -0.4, 200, 0},
                                                       {0, 0, 1, 2, 2, -301, 0, 129, -0.1},
                                                       {-2, -1, 0, 2, 2, 217, -0.5, -95, 0.3},
                                                       {-2, 0, 1, 0, 0, -158, 0, 0, 0},
                                                       {-2, 0, 0, 2, 1, 129, 0.1, -70, 0},
                                                       {0, 0, -1, 2, 2, 123, 0, -53, 0}}};

}  // namespace

double delta_t(UtcTime t) {
    // 1900, 1910, ... 2020: observed (Astronomical Almanac, section K; IERS). 2030 ... 2100: estimates.
    constexpr std::array<double, 21> by_decade{-2.72, 10.46, 21.16, 24.02, 24.33, 29.15, 33.15,
                                               40.18, 50.54, 56.86, 63.83, 66.07, 69.36, 69.5,
                                               72.5,  77.0,  83.0,  90.0,  97.0,  105.0, 113.0};
    const double year = 2000 + days_since_j2000(t) / 365.25;
    const double decade = (year - 1900) / 10;
    if (decade >= 0 && decade < by_decade.size() - 1) {
        const auto i = static_cast<std::size_t>(decade);
        return by_decade[i] + (decade - static_cast<double>(i)) * (by_decade[i + 1] - by_decade[i]);
    }
    const double u = (year - 1820) / 100;
    return -20 + 32 * u * u;
}

double julian_centuries(UtcTime t) {
    return (days_since_j2000(t) + delta_t(t) / 86400) / 36525;
}

Nutation nutation(double T) {
    const double D = (297.85036 + T * (445267.111480 + T * (-0.0019142 + T / 189474))) * degrees;  // moon from sun
    const double M = (357.52772 + T * (35999.050340 + T * (-0.0001603 - T / 300000))) * degrees;   // anomaly of the sun
    const double m = (134.96298 + T * (477198.867398 + T * (0.0086972 + T / 56250))) * degrees;    // and of the moon
    const double F = (93.27191 + T * (483202.017538 + T * (-0.0036825 + T / 327270))) * degrees;   // moon from its node
    const double O = (125.04452 + T * (-1934.136261 + T * (0.0020708 + T / 450000))) * degrees;    // the node
    Nutation sum{0, 0};
    for (const NutationTerm& k : nutation_terms) {
        const double angle = k.D * D + k.M * M + k.m * m + k.F * F + k.O * O;
        sum.longitude += (k.longitude + k.longitude_century * T) * std::sin(angle);
        sum.obliquity += (k.obliquity + k.obliquity_century * T) * std::cos(angle);
    }
    return {sum.longitude * 1e-4 * arc_second, sum.obliquity * 1e-4 * arc_second};
}

double mean_obliquity(double T) {
    return (84381.406 + T * (-46.836769 + T * (-0.0001831 + T * 0.00200340))) * arc_second;
}

double mean_sidereal_time(UtcTime t) {
    const double days = days_since_j2000(t), T = days / 36525;
    // Whole turns of the days are taken off first, or they would cost four digits.
    const double whole = std::floor(days);
    const double rotation = 360 * (days - whole) + 0.98564736629 * days;
    return into_turn((280.46061837 + rotation + T * T * (0.000387933 - T / 38710000)) * degrees);
}

double apparent_sidereal_time(UtcTime t) {
    const double T = julian_centuries(t);
    const Nutation n = nutation(T);
    return into_turn(mean_sidereal_time(t) + n.longitude * std::cos(mean_obliquity(T) + n.obliquity));
}

glm::dmat3 mean_of_date_from_j2000(double T) {
    const double zeta = (2.650545 + T * (2306.083227 + T * (0.2988499 + T * 0.01801828))) * arc_second;
    const double z = (-2.650545 + T * (2306.077181 + T * (1.0927348 + T * 0.01826837))) * arc_second;
    const double theta = T * (2004.191903 + T * (-0.4294934 - T * 0.04182264)) * arc_second;
    return rotation_z(-z) * rotation_y(theta) * rotation_z(-zeta);
}

glm::dmat3 ecef_from_date(UtcTime t) {
    return rotation_z(apparent_sidereal_time(t));
}

glm::dmat3 ecef_from_j2000(UtcTime t) {
    const double T = julian_centuries(t), obliquity = mean_obliquity(T);
    const Nutation n = nutation(T);
    const glm::dmat3 date_from_mean =
        rotation_x(-obliquity - n.obliquity) * rotation_z(-n.longitude) * rotation_x(obliquity);
    return ecef_from_date(t) * date_from_mean * mean_of_date_from_j2000(T);
}

}  // namespace planet
