// Every geodesic of geodesic_set.txt (made by make_geodesic_set.cpp): both problems, areas, and identities.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "planet/geodesy/geodesic.h"

namespace planet {
namespace {

struct Line {
    Geodetic from, to;
    double start, end, length, area;
};

const std::vector<Line>& geodesic_set() {
    static const std::vector<Line> all = [] {
        std::vector<Line> lines;
        std::ifstream in(OCTAGLOBE_SOURCE_DIR "/tests/planet/geodesic_set.txt");
        for (std::string text; std::getline(in, text);) {
            if (text.starts_with("#")) continue;
            std::istringstream words(text);
            double v[8];
            for (double& x : v) words >> x;
            EXPECT_TRUE(words) << text;
            lines.push_back({{v[0] * degrees, v[1] * degrees, {}},
                             {v[3] * degrees, v[4] * degrees, {}},
                             v[2] * degrees,
                             v[5] * degrees,
                             v[6],
                             v[7]});
        }
        return lines;
    }();
    return all;
}

// Radians of 180 degrees are good to 1.5 nm on the ground, twice at each end.
constexpr double tolerance_m = 3e-8;

TEST(GeodesicSet, Inverse) {
    const Geodesics lines;
    ASSERT_EQ(geodesic_set().size(), 430u);
    for (const Line& line : geodesic_set()) {
        const GeodesicInverse found = lines.inverse(line.from, line.to);
        ASSERT_NEAR(found.distance, line.length, tolerance_m);
        // The azimuth of a short line is as good as its ends, that of a nearly antipodal one as the place it misses.
        const GeodesicPoint end = lines.direct(line.from, found.start_azimuth, found.distance);
        ASSERT_LT(lines.distance({end.latitude, end.longitude, {}}, line.to), tolerance_m);
    }
}

TEST(GeodesicSet, Direct) {
    const Geodesics lines;
    for (const Line& line : geodesic_set()) {
        const GeodesicPoint end = lines.direct(line.from, line.start, line.length);
        ASSERT_LT(lines.distance({end.latitude, end.longitude, {}}, line.to), 5e-8);
    }
}

TEST(GeodesicSet, ThereAndBack) {
    const Geodesics lines;
    for (const Line& line : geodesic_set()) {
        const double there = lines.distance(line.from, line.to), back = lines.distance(line.to, line.from);
        ASSERT_NEAR(there, back, tolerance_m);
        if (!lines.is_unique(line.from, line.to)) continue;
        const GeodesicInverse returned = lines.inverse(line.to, line.from);
        const GeodesicPoint start = lines.direct(line.to, returned.start_azimuth, back);
        ASSERT_LT(lines.distance({start.latitude, start.longitude, {}}, line.from), tolerance_m);
    }
}

TEST(GeodesicSet, HalvesAddUp) {
    const Geodesics lines;
    for (const Line& line : geodesic_set()) {
        const auto points = lines.points_along(line.from, line.to, 3);
        const Geodetic middle{points[1].latitude, points[1].longitude, {}};
        ASSERT_NEAR(lines.distance(line.from, middle), line.length / 2, tolerance_m);
        ASSERT_NEAR(lines.distance(line.from, middle) + lines.distance(middle, line.to), line.length, 2 * tolerance_m);
    }
}

// The quadrilateral between a line and the equator.
TEST(GeodesicSet, AreasToTheEquator) {
    const Geodesics lines;
    int compared = 0;
    for (const Line& line : geodesic_set()) {
        const double turn = std::remainder(line.to.longitude - line.from.longitude, 360 * degrees);
        // Beyond that the equator is not the shortest line between its ends; at a pole the longitude is a matter of taste.
        if (std::abs(turn) > 179 * degrees || std::abs(line.from.latitude) > 89.9 * degrees) continue;
        // A line that crosses the equator has a part on each side, which polygon() does not tell apart from a figure 8.
        const Geodetic corners[] = {line.from, {0, line.from.longitude, {}}, {0, line.to.longitude, {}}, line.to};
        ASSERT_NEAR(lines.polygon(corners).area, line.area, 3.0) << line.length;
        ++compared;
    }
    EXPECT_GT(compared, 250);
}

TEST(GeodesicSet, OnlyMirroredAntipodesAreAmbiguous) {
    const Geodesics lines;
    const auto at = [](double latitude, double longitude) {
        return Geodetic{latitude * degrees, longitude * degrees, {}};
    };
    for (const Line& line : geodesic_set()) EXPECT_TRUE(lines.is_unique(line.from, line.to)) << line.length;
    EXPECT_FALSE(lines.is_unique(at(0, 0), at(0, 180)));
    EXPECT_FALSE(lines.is_unique(at(0, 0), at(0, 179.7)));
    EXPECT_FALSE(lines.is_unique(at(40, 10), at(-40, -170)));
    EXPECT_FALSE(lines.is_unique(at(90, 0), at(-90, 0)));
    EXPECT_FALSE(lines.is_unique(at(30, 0), at(-30, 179.9)));
    EXPECT_TRUE(lines.is_unique(at(0, 0), at(0, 179)));
    EXPECT_TRUE(lines.is_unique(at(40, 10), at(-39, -170)));
    EXPECT_TRUE(lines.is_unique(at(1, 2), at(1, 2)));
    EXPECT_TRUE(lines.is_unique(at(95, 2), at(1, 2)));
}

}  // namespace
}  // namespace planet
