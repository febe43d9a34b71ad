#include "planet/geodesy/geodesic.h"

#include <gtest/gtest.h>

#include <GeographicLib/GeodesicExact.hpp>
#include <array>
#include <limits>
#include <random>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Geodetic at(double latitude_deg, double longitude_deg) {
    return {latitude_deg * degrees, longitude_deg * degrees, {}};
}

Geodetic position(const GeodesicPoint& p) {
    return {p.latitude, p.longitude, {}};
}

double apart(const Ellipsoid& e, const Geodetic& p, const Geodetic& q) {
    return glm::distance(ecef_from_geodetic(e, p), ecef_from_geodetic(e, q));
}

class RandomPairs {
  public:
    Geodetic next() {
        // Evenly by latitude, so that poles are well covered.
        return at(latitude_(random_), longitude_(random_));
    }
    /// A pair of which a fifth is nearly antipodal, and a fifth is close together.
    std::array<Geodetic, 2> next_pair() {
        const Geodetic p = next();
        Geodetic q = next();
        const int kind = count_++ % 5;
        const double d = small_(random_);
        if (kind == 0) q = at(-p.latitude / degrees + d, p.longitude / degrees + 180 + small_(random_));
        if (kind == 1) q = at(p.latitude / degrees + d, p.longitude / degrees + small_(random_));
        if (std::abs(q.latitude) > 90 * degrees) q.latitude = p.latitude;
        return {p, q};
    }

  private:
    std::mt19937_64 random_{11};
    std::uniform_real_distribution<double> latitude_{-90, 90}, longitude_{-180, 180}, small_{-0.5, 0.5};
    int count_ = 0;
};

// Karney (2013), the worked examples of sections 2 and 3: tables 2 and 3.
TEST(Geodesic, KarneysExamples) {
    const Geodesics lines;
    const GeodesicPoint p = lines.direct(at(40, 0), 30 * degrees, 10e6);
    EXPECT_NEAR(p.latitude / degrees, 41.79331020506, 1e-11);
    EXPECT_NEAR(p.longitude / degrees, 137.84490004377, 1e-11);
    EXPECT_NEAR(p.azimuth / degrees, 149.09016931807, 1e-11);
    const GeodesicInverse g = lines.inverse(at(-30, 0), at(29.9, 179.8));
    EXPECT_NEAR(g.start_azimuth / degrees, 161.89052473633, 1e-10);
    EXPECT_NEAR(g.end_azimuth / degrees, 18.09073724574, 1e-10);
    EXPECT_NEAR(g.distance, 19989832.827610, 1e-6);
}

TEST(Geodesic, AgreesWithTheEllipticIntegrals) {
    for (const Ellipsoid& e : {wgs84, mars}) {
        const Geodesics lines(e);
        const GeographicLib::GeodesicExact exact(e.a, e.f);
        RandomPairs pairs;
        for (int i = 0; i < 3000; ++i) {
            const auto [p, q] = pairs.next_pair();
            double distance = 0;
            exact.Inverse(p.latitude / degrees, p.longitude / degrees, q.latitude / degrees, q.longitude / degrees,
                          distance);
            ASSERT_NEAR(lines.distance(p, q), distance, 2e-8);
        }
    }
}

TEST(Geodesic, DirectLeadsWhereInverseSays) {
    for (const Ellipsoid& e : {wgs84, mars, moon, sphere()}) {
        const Geodesics lines(e);
        RandomPairs pairs;
        for (int i = 0; i < 3000; ++i) {
            const auto [p, q] = pairs.next_pair();
            const GeodesicInverse g = lines.inverse(p, q);
            ASSERT_GE(g.distance, 0);
            ASSERT_LE(g.distance, std::numbers::pi * e.a);
            ASSERT_LT(apart(e, position(lines.direct(p, g.start_azimuth, g.distance)), q), 3e-8) << i;
        }
    }
}

TEST(Geodesic, DistanceIsSymmetricAndAddsUp) {
    const Geodesics lines;
    RandomPairs pairs;
    for (int i = 0; i < 3000; ++i) {
        const auto [p, q] = pairs.next_pair();
        const double whole = lines.distance(p, q);
        ASSERT_NEAR(lines.distance(q, p), whole, 1e-8);
        const Geodetic r = pairs.next();
        ASSERT_LE(whole, lines.distance(p, r) + lines.distance(r, q) + 1e-8);
        const GeodesicInverse g = lines.inverse(p, q);
        const Geodetic middle = position(lines.direct(p, g.start_azimuth, whole / 3));
        ASSERT_NEAR(lines.distance(p, middle) + lines.distance(middle, q), whole, 3e-8);
    }
}

TEST(Geodesic, Antipodes) {
    const Geodesics lines;
    // Over a pole: half a meridian, 20003931.4586 m (Karney 2013, table 1: quarter meridian 10001965.729).
    EXPECT_NEAR(lines.distance(at(90, 0), at(-90, 77)), 20003931.4586254, 1e-6);
    EXPECT_NEAR(lines.distance(at(0, 0), at(0, 180)), 20003931.4586254, 1e-6);
    EXPECT_NEAR(lines.distance(at(40, -20), at(-40, 160)), 20003931.4586254, 1e-6);
    // The pair on which Vincenty's method fails: GeographicLib's documentation, "Geodesics on an ellipsoid".
    EXPECT_NEAR(lines.distance(at(0, 0), at(0.5, 179.5)), 19936288.578965, 1e-5);
    EXPECT_NEAR(Geodesics(sphere()).distance(at(12, 0), at(-12, 180)), std::numbers::pi * sphere().a, 1e-7);
}

TEST(Geodesic, PolesAndAntimeridian) {
    const Geodesics lines;
    EXPECT_NEAR(lines.distance(at(90, 0), at(90, 135)), 0, 1e-8);
    EXPECT_NEAR(lines.distance(at(10, 180), at(10, -180)), 0, 1e-8);
    EXPECT_NEAR(lines.distance(at(0, 179.5), at(0, -179.5)), wgs84.a * degrees, 1e-8);
    EXPECT_NEAR(lines.inverse(at(90, 0), at(0, 30)).start_azimuth, 150 * degrees, 1e-15);
    EXPECT_EQ(lines.distance(at(-0.0, -0.0), at(0.0, 0.0)), 0);
    EXPECT_NEAR(position(lines.direct(at(89, 10), 0, 300e3)).longitude, -170 * degrees, 1e-14);
}

TEST(Geodesic, PointsAlongALine) {
    const Geodesics lines;
    const Geodetic from = at(50.1, 8.6), to = at(-33.9, 151.2);
    const auto points = lines.points_along(from, to, 1001);
    ASSERT_EQ(points.size(), 1001u);
    const double step = lines.distance(from, to) / 1000;
    EXPECT_LT(apart(wgs84, position(points.front()), from), 1e-8);
    EXPECT_LT(apart(wgs84, position(points.back()), to), 3e-8);
    for (std::size_t i = 1; i < points.size(); ++i)
        ASSERT_NEAR(lines.distance(position(points[i - 1]), position(points[i])), step, 1e-7);
}

TEST(Geodesic, AreasOfPolygons) {
    const Geodesics lines;
    // An octant of the ellipsoid; WGS84 has 510065621724089 m^2 in all (Karney, Planimeter).
    const std::array octant{at(0, 0), at(0, 90), at(90, 0)};
    EXPECT_NEAR(lines.polygon(octant).area, 510065621724088.44 / 8, 1);
    const std::array reversed{octant[2], octant[1], octant[0]};
    EXPECT_NEAR(lines.polygon(reversed).area, -510065621724088.44 / 8, 1);
    // Around the pole, and across the antimeridian.
    const std::array cap{at(89, 0), at(89, 120), at(89, 240)};
    EXPECT_GT(lines.polygon(cap).area, 1e10);
    const std::array square{at(0, 179.5), at(0, -179.5), at(1, -179.5), at(1, 179.5)};
    EXPECT_NEAR(lines.polygon(square).area, 1.2309e10, 1e7);
    const GeodesicInverse side = lines.inverse(at(0, 179.5), at(0, -179.5));
    EXPECT_GT(lines.polygon(square).perimeter, 3.9 * side.distance);
    EXPECT_EQ(lines.polygon(std::array{at(1, 1), at(2, 2)}).area, 0);
    EXPECT_NEAR(lines.polygon(std::array{at(1, 1), at(2, 2)}).perimeter, 2 * lines.distance(at(1, 1), at(2, 2)), 1e-7);
    EXPECT_EQ(lines.polygon({}).area, 0);
}

TEST(Geodesic, EightFacesCoverThePlanet) {
    const Geodesics lines(mars);
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        sum += lines.polygon(std::array{at(0, 90 * i), at(0, 90 * i + 90), at(90, 0)}).area;
        sum += lines.polygon(std::array{at(0, 90 * i + 90), at(0, 90 * i), at(-90, 0)}).area;
    }
    const double e = std::sqrt(mars.e2());
    const double area = 2 * std::numbers::pi * mars.a * mars.a * (1 + (1 - mars.e2()) / e * std::atanh(e));
    EXPECT_NEAR(sum / area, 1, 1e-13);
}

TEST(Geodesic, NoAnswerIsNaN) {
    const Geodesics lines;
    EXPECT_TRUE(std::isnan(lines.distance(at(91, 0), at(0, 0))));
    EXPECT_TRUE(std::isnan(lines.distance(at(0, nan), at(0, 0))));
    EXPECT_TRUE(std::isnan(lines.direct(at(0, 0), nan, 1).latitude));
    EXPECT_TRUE(std::isnan(lines.direct(at(0, 0), 0, std::numeric_limits<double>::infinity()).latitude));
    EXPECT_TRUE(std::isnan(lines.points_along(at(0, 0), at(95, 0), 3)[1].latitude));
    EXPECT_TRUE(std::isnan(lines.polygon(std::array{at(0, 0), at(95, 0), at(0, 9)}).area));
    EXPECT_THROW(Geodesics(ellipsoid("pancake", 1, 0.5)), Error);
}

}  // namespace
}  // namespace planet
