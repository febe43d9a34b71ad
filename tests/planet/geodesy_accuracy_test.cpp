#include "planet/geodesy/accuracy.h"

#include <gtest/gtest.h>

#include <limits>

namespace planet {
namespace {

TEST(Accuracy, PositionsHoldTheirBoundsOnEveryPlanet) {
    for (const Ellipsoid& e : {wgs84, sphere(), moon, mars}) {
        const auto rows = check_positions(e, 1 << 18);
        ASSERT_EQ(rows.size(), 13u);
        EXPECT_GE(rows[0].value, 1 << 18);
        for (std::size_t i = 1; i < rows.size(); ++i) {
            EXPECT_TRUE(rows[i].passed) << e.name << " " << rows[i].name << " " << rows[i].value;
            EXPECT_LE(rows[i].value, rows[i].bound);
            // Doubles near 6,000 km are 0.9 nm apart: a check that finds less has not looked.
            EXPECT_GT(rows[i].value, 1e-10) << rows[i].name;
            EXPECT_EQ(rows[i].unit, "m");
        }
    }
}

TEST(Accuracy, MillionPointsOnTheEarthWithinTenNanometres) {
    const auto rows = check_positions(wgs84);
    EXPECT_GE(rows[0].value, 1e6);
    for (const CheckRow& row : rows)
        if (row.name.find("terrain") != std::string::npos && row.name.find("vertex") == 0) {
            EXPECT_LT(row.value, 10e-9) << row.name;
        }
}

// A wrong surface must fail: the flattening is off by one part in 10^7, 2 mm at the poles.
TEST(Accuracy, FailsOnAWrongEllipsoid) {
    Ellipsoid wrong = wgs84;
    wrong.b -= wrong.a * wrong.f * 1e-7;
    const auto rows = check_positions(wrong, 1000);
    for (const CheckRow& row : rows)
        if (row.name.find("vertex") == 0) {
            EXPECT_FALSE(row.passed) << row.name;
            EXPECT_GT(row.value, 0.0020);
            EXPECT_LT(row.value, 0.0026);  // at 45 degrees the foot moves by 1.16 times as much as b
        }
}

TEST(Accuracy, NaNFails) {
    EXPECT_FALSE(check_row("x", std::numeric_limits<double>::quiet_NaN(), 1, "m").passed);
    EXPECT_TRUE(check_row("x", 1, 1, "m").passed);
    Ellipsoid broken = wgs84;
    broken.b = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(check_positions(broken, 10)[1].passed);
}

}  // namespace
}  // namespace planet
