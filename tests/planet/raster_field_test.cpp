#include "planet/elevation/raster_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planet/error.h"
#include "planet/geodesy/angles.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::RasterFile;
using testing::TemporaryFolder;
using testing::write_raster;

using HeightAt = std::function<double(int, int)>;

Raster make_raster(int width, int height, glm::dvec2 origin, glm::dvec2 step, const HeightAt& height_at) {
    Raster r;
    r.width = width;
    r.height = height;
    r.grid = {origin, {step.x, 0}, {0, step.y}};
    std::vector<float> s;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) s.push_back(static_cast<float>(height_at(column, row)));
    r.samples = std::move(s);
    r.crs = "EPSG:4326";
    return r;
}

RasterField field_of(Raster raster) {
    return RasterField(std::make_shared<const Raster>(std::move(raster)), VerticalDatum::egm96);
}

float at_degrees(const ElevationField& field, double latitude, double longitude) {
    return field.height(normal_from_geodetic(latitude * degrees, longitude * degrees));
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(RasterField, AnglesAreThoseOfTheStandardLibrary) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<glm::dvec3> n;
    for (int i = 0; i < 200000; ++i)
        n.push_back(glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))));
    for (const double x : {-1.0, -0.0, 0.0, 1.0})
        for (const double y : {-1.0, -0.0, 0.0, 1.0})
            for (const double z : {-1.0, -0.0, 0.0, 1.0}) n.emplace_back(x, y, z);
    std::vector<double> lon(n.size()), lat(n.size());
    angles_from_normals(n, lon, lat);
    for (std::size_t i = 0; i < n.size(); ++i) {
        ASSERT_NEAR(lon[i], std::atan2(n[i].y, n[i].x), 5e-16) << i;
        ASSERT_NEAR(lat[i], std::atan2(n[i].z, std::hypot(n[i].x, n[i].y)), 5e-16) << i;
        ASSERT_EQ(std::signbit(lon[i]), std::signbit(n[i].y));
    }
    const glm::dvec3 odd[] = {{nan, 0, 1}, {0, nan, 1}, {1, 0, nan}};
    for (const glm::dvec3& p : odd) {
        double a = 0, b = 0;
        angles_from_normals({&p, 1}, {&a, 1}, {&b, 1});
        EXPECT_TRUE(std::isnan(a + b));
    }
}

TEST(RasterField, ExactOnQuadraticsAndAsKeysSaysOnCubics) {
    const auto quadratic = [](double x, double y) {
        return 100 + 3 * x - 2 * y + 0.5 * x * x - 0.25 * x * y + 0.125 * y * y;
    };
    const RasterField field = field_of(make_raster(40, 30, {10, 50}, {0.1, -0.1}, quadratic));
    const RasterField cubic =
        field_of(make_raster(40, 30, {10, 50}, {0.1, -0.1}, [](double x, double) { return x * x * x; }));
    for (double y = 1; y <= 27.99; y += 0.37)
        for (double x = 1; x <= 37.99; x += 0.41) {
            ASSERT_NEAR(at_degrees(field, 50 - 0.1 * y, 10 + 0.1 * x), quadratic(x, y), 2e-3) << x << " " << y;
            const double t = x - std::floor(x);
            ASSERT_NEAR(at_degrees(cubic, 50 - 0.1 * y, 10 + 0.1 * x), x * x * x + t * (1 - t) * (1 - 2 * t), 2e-2)
                << x;
        }
}

TEST(RasterField, ExactOnPlanesUpToThePixelsEdgesAndNoFarther) {
    const auto plane = [](double x, double y) { return 100 + 3 * x - 2 * y; };
    for (const bool south_up : {false, true}) {
        const double step = south_up ? 0.1 : -0.1;
        const RasterField field = field_of(make_raster(7, 5, {10, 50}, {0.1, step}, plane));
        for (double y = -0.499; y < 4.5; y += 0.1)
            for (double x = -0.499; x < 6.5; x += 0.1)
                ASSERT_NEAR(at_degrees(field, 50 + step * y, 10 + 0.1 * x), plane(x, y), 1e-4) << x << " " << y;
        EXPECT_TRUE(std::isnan(at_degrees(field, 50 - step * 0.51, 10)));
        EXPECT_TRUE(std::isnan(at_degrees(field, 50, 10 - 0.051)));
        EXPECT_TRUE(std::isnan(at_degrees(field, 50, 10 + 0.651)));
        EXPECT_TRUE(std::isnan(at_degrees(field, -50, -170)));
        EXPECT_TRUE(std::isnan(field.height({nan, nan, nan})));
    }
}

TEST(RasterField, OneSampleAndOneRow) {
    const RasterField one = field_of(make_raster(1, 1, {10, 50}, {0.1, -0.1}, [](int, int) { return 7; }));
    EXPECT_EQ(at_degrees(one, 50.04, 10.04), 7);
    EXPECT_TRUE(std::isnan(at_degrees(one, 50.06, 10)));
    EXPECT_TRUE(std::isfinite(one.spacing({normal_from_geodetic(50 * degrees, 10 * degrees), 0.01})));
    const RasterField row = field_of(make_raster(9, 1, {10, 50}, {0.1, -0.1}, [](int c, int) { return 2 * c; }));
    EXPECT_NEAR(at_degrees(row, 50.03, 10.25), 5, 1e-5);
    const RasterField column = field_of(make_raster(1, 9, {10, 50}, {0.1, -0.1}, [](int, int r) { return 2 * r; }));
    EXPECT_NEAR(at_degrees(column, 49.75, 10.02), 5, 1e-5);
}

TEST(RasterField, AVoidIsItsPixelAndLeavesTheRestSmooth) {
    const auto hill = [](int c, int r) {
        return c == 10 && r == 10 ? nan : 10 * std::sin(0.7 * c) + 8 * std::cos(0.9 * r);
    };
    const RasterField field = field_of(make_raster(21, 21, {0, 0}, {0.1, 0.1}, hill));
    const auto at = [&](double x, double y) { return at_degrees(field, 0.1 * y, 0.1 * x); };
    EXPECT_TRUE(std::isnan(at(10, 10)));
    EXPECT_TRUE(std::isnan(at(10.49, 9.51)));
    EXPECT_TRUE(std::isfinite(at(10.51, 10)));
    EXPECT_NEAR(at(11, 10), hill(11, 10), 1e-4);
    // No jump across the sides of the patches around the void where they are whole: approached from both sides.
    for (double y = 7.01; y < 13; y += 0.05)
        for (const double x : {7.0, 8.0, 9.0, 11.0, 12.0, 13.0}) {
            if (x > 8.9 && x < 11.1 && y > 9 && y < 11) continue;  // a side of a patch with a void corner
            ASSERT_NEAR(at(x - 1e-5, y), at(x + 1e-5, y), 2e-3) << x << " " << y;
            ASSERT_NEAR(at(y, x - 1e-5), at(y, x + 1e-5), 2e-3) << x << " " << y;
        }
    std::vector<glm::dvec3> border;
    field.border({{0, 0, 1}, 4}, 1, border);
    EXPECT_EQ(border.size(), 2u * (4 * 21 + 4));
    for (const glm::dvec3& n : border) EXPECT_TRUE(std::isfinite(field.height(n)));
}

TEST(RasterField, CrossesTheAntimeridian) {
    const auto ramp = [](int c, int) { return 5 * c; };
    for (const double west : {178.0, -182.0}) {
        const RasterField field = field_of(make_raster(41, 21, {west, -1}, {0.1, 0.1}, ramp));
        EXPECT_NEAR(at_degrees(field, 0, 179), 50, 1e-3);
        EXPECT_NEAR(at_degrees(field, 0, 180), 100, 1e-3);
        EXPECT_NEAR(at_degrees(field, 0, -180), 100, 1e-3);
        EXPECT_NEAR(at_degrees(field, 0, -179), 150, 1e-3);
        EXPECT_TRUE(std::isnan(at_degrees(field, 0, 0)));
        EXPECT_TRUE(std::isnan(at_degrees(field, 0, 177)));
    }
}

// A smooth function of the direction, so the same at the antimeridian and the poles whichever way one comes.
double smooth(const glm::dvec3& n) {
    return 1000 * n.x + 500 * n.y * n.z - 700 * n.z + 300 * n.x * n.y;
}

TEST(RasterField, AGlobalRasterIsSmoothAcrossTheAntimeridianAndThePoles) {
    struct Layout {
        int width, height;
        glm::dvec2 origin, step;
    };
    const Layout layouts[] = {
        {360, 180, {-179.5, 89.5}, {1, -1}},  // pixels, north up
        {360, 180, {0.5, -89.5}, {1, 1}},     // pixels from Greenwich, south up
        {360, 181, {0, 90}, {1, -1}},         // nodes, poles as rows
        {361, 181, {-180, 90}, {1, -1}},      // nodes, the last column repeats the first
        {361, 181, {180, 90}, {-1, -1}},      // columns westward
    };
    for (const Layout& l : layouts) {
        const RasterField field = field_of(make_raster(l.width, l.height, l.origin, l.step, [&](int c, int r) {
            return smooth(
                normal_from_geodetic((l.origin.y + r * l.step.y) * degrees, (l.origin.x + c * l.step.x) * degrees));
        }));
        EXPECT_EQ(columns_around(field.raster()), 360);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> turn(-180, 180), cosine(-1, 1);
        for (int i = 0; i < 20000; ++i) {
            const double latitude = std::asin(cosine(random)) / degrees, longitude = turn(random);
            const glm::dvec3 n = normal_from_geodetic(latitude * degrees, longitude * degrees);
            const double tolerance = std::abs(latitude) > 89 ? 6 : 0.05;  // the last row is led to one value
            ASSERT_NEAR(field.height(n), smooth(n), tolerance) << latitude << " " << longitude << " " << l.width;
        }
        for (const double pole : {-1.0, 1.0}) {
            const float h = field.height({0, 0, pole});
            EXPECT_NEAR(h, smooth({0, 0, pole}), 0.5);
            for (double longitude = -180; longitude < 180; longitude += 7)
                ASSERT_NEAR(at_degrees(field, pole * (90 - 1e-6), longitude), h, 1e-3) << longitude;
        }
        for (double latitude = -89.9; latitude < 90; latitude += 3.3)
            ASSERT_NEAR(at_degrees(field, latitude, 180 - 1e-7), at_degrees(field, latitude, -180 + 1e-7), 1e-3);
        std::vector<glm::dvec3> border;
        field.border({{0, 0, 1}, 4}, 1, border);
        EXPECT_TRUE(border.empty());
    }
}

TEST(RasterField, BatchAndSingleHaveTheSameBits) {
    const RasterField field =
        field_of(make_raster(50, 50, {0, 0}, {0.1, 0.1}, [](int c, int r) { return 10 * std::sin(c + 3.0 * r); }));
    std::vector<glm::dvec3> n;
    for (int i = 0; i < 1000; ++i) n.push_back(normal_from_geodetic((i % 37) * 0.1 * degrees, i * 0.004 * degrees));
    std::vector<float> h(n.size());
    field.heights(n, h);
    for (std::size_t i = 0; i < n.size(); ++i) ASSERT_EQ(h[i], field.height(n[i])) << i;
}

TEST(RasterField, ProjectedRastersWithinTheirBound) {
    // EPSG code, lower left corner in metres. UTM across its zone's edge, polar stereographic over the pole, Web
    // Mercator, British National Grid (another datum), UTM at the antimeridian.
    struct Case {
        const char* crs;
        double x, y, step;
    };
    const Case cases[] = {{"EPSG:32633", 450000, 5200000, 90},  {"EPSG:3995", -300000, -300000, 6000},
                          {"EPSG:3857", 1000000, 5800000, 500}, {"EPSG:27700", 300000, 500000, 100},
                          {"EPSG:32701", 180000, 8200000, 300}, {"EPSG:3857", -20037508, -5000000, 400000}};
    const TemporaryFolder folder;
    for (const Case& c : cases) {
        SCOPED_TRACE(c.crs);
        const RasterFile file{100, 90, c.crs, {c.x, c.step, 0, c.y + 90 * c.step, 0, -c.step}, ""};
        write_raster<float>(folder / "a", file, [](int x, int y) { return static_cast<float>(10 * x + 1000 * y); });
        const auto raster = std::make_shared<const Raster>(read_raster(folder / "a"));
        const RasterField field(raster, VerticalDatum::egm96);
        ASSERT_FALSE(raster->geographic());
        std::mt19937 random(5);
        std::uniform_real_distribution<double> unit(0, 1);
        int missing = 0;
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec2 s(99 * unit(random), 89 * unit(random));
            glm::dvec2 p = raster->grid.crs_from_sample(s);
            raster->transform->geodetic_from_crs({&p, 1});
            const float h = at_degrees(field, p.y, p.x);
            if (std::isnan(h)) {
                ++missing;
                continue;
            }
            ASSERT_NEAR(h, 10 * s.x + 1000 * s.y, 1010 / 256.0 + 0.05) << s.x << " " << s.y;
        }
        EXPECT_EQ(missing, 0);
        std::vector<glm::dvec3> n;
        std::vector<float> h;
        field.samples({{0, 0, 1}, 4}, n, h);
        ASSERT_EQ(n.size(), 9000u);
        for (std::size_t i = 0; i < n.size(); ++i) ASSERT_NEAR(field.height(n[i]), h[i], 1010 / 128.0 + 0.05);
    }
}

TEST(RasterField, SpacingAndSamplesOfACap) {
    const RasterField field = field_of(make_raster(
        200, 200, {0.05, 49.95}, {0.1, -0.1}, [](int c, int r) { return c >= 100 && r < 100 ? nan : c + 1000.0 * r; }));
    const double metres = 6378137 * 0.1 * degrees;
    const auto cap = [](double latitude, double longitude, double angle) {
        return Cap{normal_from_geodetic(latitude * degrees, longitude * degrees), angle * degrees};
    };
    EXPECT_NEAR(field.spacing(cap(45, 5, 0.1)), metres * std::sqrt(std::cos(46.8 * degrees)), 0.05 * metres);
    EXPECT_LE(field.spacing(cap(45, 5, 0.1)), metres * std::sqrt(std::cos(45 * degrees)));
    EXPECT_TRUE(std::isinf(field.spacing(cap(-45, 5, 10))));
    EXPECT_TRUE(std::isinf(field.spacing(cap(48, 18, 0.1))));  // all void there
    std::vector<glm::dvec3> n;
    std::vector<float> h;
    const Cap c = cap(40, 10, 1);  // over the corner of the void
    field.samples(c, n, h);
    std::size_t expected = 0;
    for (int row = 0; row < 200; ++row)
        for (int column = 0; column < 200; ++column) {
            const glm::dvec3 p = normal_from_geodetic((49.95 - 0.1 * row) * degrees, (0.05 + 0.1 * column) * degrees);
            if (!(column >= 100 && row < 100) && glm::dot(p, c.centre) >= std::cos(c.angle)) ++expected;
        }
    EXPECT_EQ(n.size(), expected);
    EXPECT_GT(expected, 250u);
    for (std::size_t i = 0; i < n.size(); ++i) ASSERT_NEAR(field.height(n[i]), h[i], 0.02);
    const SourceInfo info = field.sources().at(0);
    EXPECT_NEAR(info.spacing_m, metres * std::sqrt(std::cos(40 * degrees)), 1);
}

}  // namespace
}  // namespace planet
