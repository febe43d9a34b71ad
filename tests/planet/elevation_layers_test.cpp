#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "planet/elevation/constant_field.h"
#include "planet/elevation/fractal_field.h"
#include "planet/elevation/layered_field.h"
#include "planet/elevation/surface_field.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Raster make_raster(int width, int height, glm::dvec2 origin, double step, const std::function<double(int, int)>& at) {
    Raster r;
    r.width = width;
    r.height = height;
    r.grid = {origin, {step, 0}, {0, -step}};
    std::vector<float> s;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) s.push_back(static_cast<float>(at(column, row)));
    r.samples = std::move(s);
    r.crs = "EPSG:4326";
    return r;
}

std::shared_ptr<const RasterField> field_of(Raster raster, VerticalDatum datum = VerticalDatum::egm96) {
    return std::make_shared<RasterField>(std::make_shared<const Raster>(std::move(raster)), datum);
}

glm::dvec3 at_degrees(double latitude, double longitude) {
    return normal_from_geodetic(latitude * degrees, longitude * degrees);
}

// One degree over the whole planet.
std::shared_ptr<const RasterField> coarse_world() {
    return field_of(
        make_raster(360, 180, {-179.5, 89.5}, 1, [](int c, int r) { return 300 * std::sin(c * 0.2) + 2.0 * r; }));
}
// 0.05 degrees, latitude 8..12, longitude 8..12, with a hole of 0.5 degrees, 500 m above anything else.
double fine_height(int c, int r) {
    const bool hole = std::abs(c - 40) < 5 && std::abs(r - 40) < 5;
    return hole ? nan : 800 + 40 * std::sin(c * 0.7) * std::cos(r * 0.5);
}
std::shared_ptr<const RasterField> fine_patch(VerticalDatum datum = VerticalDatum::egm96) {
    return field_of(make_raster(80, 80, {8.025, 11.975}, 0.05, fine_height), datum);
}

TEST(LayeredField, TheFinerOneIsNeverAltered) {
    const auto fine = fine_patch();
    const LayeredField both({coarse_world(), fine}, VerticalDatum::egm96);
    for (double lat = 8.01; lat < 12; lat += 0.043)
        for (double lon = 8.01; lon < 12; lon += 0.047) {
            const float h = fine->height(at_degrees(lat, lon));
            if (!std::isnan(h)) {
                ASSERT_EQ(both.height(at_degrees(lat, lon)), h);
            }
        }
}

TEST(LayeredField, TheCoarserOneIsLedUpToItsBorderOverTwoSamples) {
    const auto world = coarse_world(), fine = fine_patch();
    const LayeredField both({world, fine}, VerticalDatum::egm96);
    // Across every side of the patch and of its hole: no step. (The finer one changes by up to 2 m over 0.002 degrees.)
    for (double along = 8.03; along < 11.97; along += 0.0173) {
        for (const double border : {8.0, 12.0}) {
            const double outward = border < 10 ? -1 : 1;
            const glm::dvec3 in = at_degrees(along, border - outward * 0.001),
                             out = at_degrees(along, border + outward * 0.001);
            ASSERT_NEAR(both.height(in), both.height(out), 8) << along;
            ASSERT_GT(std::abs(both.height(in) - world->height(in)), 100);
            const glm::dvec3 in2 = at_degrees(border - outward * 0.001, along),
                             out2 = at_degrees(border + outward * 0.001, along);
            ASSERT_NEAR(both.height(in2), both.height(out2), 8) << along;
        }
    }
    // Beyond two samples nothing is changed; within, the correction falls steadily from the border.
    for (double lon = 0; lon < 20; lon += 0.37)
        ASSERT_EQ(both.height(at_degrees(14.1, lon)), world->height(at_degrees(14.1, lon)));
    double before = 1e9;
    for (double lon = 12.01; lon < 14.3; lon += 0.01) {
        const glm::dvec3 n = at_degrees(10, lon);
        const double correction = static_cast<double>(both.height(n) - world->height(n));
        EXPECT_LT(correction, before + 2) << lon;  // the border itself is uneven by 40 m
        EXPECT_GE(correction, 0);
        before = correction;
    }
    // The hole is filled from around it, without a jump anywhere.
    for (double lat = 9.7; lat < 10.3; lat += 0.02) {
        double last = nan;
        for (double lon = 9.6; lon < 10.4; lon += 0.001) {
            const double h = static_cast<double>(both.height(at_degrees(lat, lon)));
            ASSERT_TRUE(h > 720 && h < 880) << lat << " " << lon << " " << h;
            if (!std::isnan(last)) {
                ASSERT_NEAR(h, last, 8) << lat << " " << lon;
            }
            last = h;
        }
    }
}

TEST(LayeredField, WithoutAnySourceTheHeightIsZero) {
    const LayeredField alone({fine_patch()}, VerticalDatum::egm96);
    EXPECT_EQ(alone.height(at_degrees(50, 50)), 0);
    EXPECT_EQ(alone.height({0, 0, -1}), 0);
    EXPECT_NEAR(alone.height(at_degrees(10.2, 7.999)), alone.height(at_degrees(10.2, 8.001)), 8);
    EXPECT_EQ(alone.height(at_degrees(10.2, 7.87)), 0);  // two of its samples away
    EXPECT_TRUE(std::isnan(alone.height({nan, nan, nan})));
    EXPECT_TRUE(std::isinf(alone.spacing({{0, 0, -1}, 0.1})));
    EXPECT_THROW(LayeredField({}, VerticalDatum::egm96), Error);
}

TEST(LayeredField, DatumsMeetThroughTheGeoid) {
    const auto geoid = [](std::span<const glm::dvec3> n, std::span<GeoidUndulation> out) {
        for (std::size_t i = 0; i < n.size(); ++i) out[i].m = 50 * n[i].x;
    };
    const auto world = coarse_world();
    const auto fine = fine_patch(VerticalDatum::ellipsoid);
    EXPECT_THROW(LayeredField({world, fine}, VerticalDatum::egm96), Error);
    const LayeredField above_geoid({world, fine}, VerticalDatum::egm96, geoid);
    const LayeredField above_ellipsoid({world, fine}, VerticalDatum::ellipsoid, geoid);
    const glm::dvec3 in = at_degrees(9, 9), out = at_degrees(-30, 40);
    EXPECT_NEAR(above_geoid.height(in), static_cast<double>(fine->height(in)) - 50 * in.x, 1e-3);
    EXPECT_EQ(above_ellipsoid.height(in), fine->height(in));
    EXPECT_EQ(above_geoid.height(out), world->height(out));
    EXPECT_NEAR(above_ellipsoid.height(out), static_cast<double>(world->height(out)) + 50 * out.x, 1e-3);
    EXPECT_EQ(above_geoid.sources().size(), 2u);
}

TEST(LayeredField, SamplesAreThoseThatShow) {
    const auto world = coarse_world(), fine = fine_patch();
    const LayeredField both({world, fine}, VerticalDatum::egm96);
    std::vector<glm::dvec3> n, of_fine;
    std::vector<float> h, unused;
    const Cap cap{at_degrees(10, 10), 4 * degrees};
    both.samples(cap, n, h);
    fine->samples(cap, of_fine, unused);
    ASSERT_EQ(n.size(), h.size());
    EXPECT_GT(n.size(), of_fine.size() + 20);
    std::size_t below = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        ASSERT_NEAR(both.height(n[i]), h[i], 1e-2);
        below += std::isnan(fine->height(n[i])) ? 1 : 0;
    }
    EXPECT_EQ(n.size(), of_fine.size() + below);
    EXPECT_NEAR(both.spacing({at_degrees(10, 10), 0}), 0.05 * degrees * 6378137, 100);
    EXPECT_NEAR(both.spacing({at_degrees(-10, 10), 0}), degrees * 6378137, 6000);
}

// 33,000 voids in a rugged DEM, alone and in clumps, over a coarse one that is 400 m off.
struct HoledDem {
    static constexpr int size = 1100;
    static constexpr double step = 0.001;
    std::vector<bool> holes = std::vector<bool>(size * size);
    std::vector<std::pair<int, int>> hole_list;

    static double relief(int c, int r) {
        return 1500 + 300 * std::sin(c * 0.05) * std::cos(r * 0.04) + 20 * std::sin(c * 0.9 + r);
    }

    explicit HoledDem(std::size_t count, unsigned clumps) {
        std::mt19937 random(3);
        const auto punch = [&](int c, int r) {
            if (c < 0 || r < 0 || c >= size || r >= size || holes[static_cast<std::size_t>(r * size + c)]) return;
            holes[static_cast<std::size_t>(r * size + c)] = true;
            hole_list.emplace_back(c, r);
        };
        while (hole_list.size() < count) {
            const int c = static_cast<int>(random() % size), r = static_cast<int>(random() % size);
            const int reach = random() % clumps == 0 ? 3 : 0;
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i) punch(c + i, r + j);
        }
    }
    std::shared_ptr<const RasterField> field() const {
        return field_of(make_raster(size, size, {10, 47}, step, [this](int c, int r) {
            return holes[static_cast<std::size_t>(r * size + c)] ? nan : relief(c, r);
        }));
    }
    static glm::dvec3 place(double c, double r) { return at_degrees(47 - step * r, 10 + step * c); }
};

TEST(LayeredField, ThirtyThreeThousandVoidsGiveNoSpike) {
    const HoledDem dem(33000, 40);
    const auto fine = dem.field();
    const auto world =
        field_of(make_raster(40, 40, {8, 48.5}, 0.1, [](int c, int r) { return 1900 + 3.0 * c - 2.0 * r; }));
    const LayeredField both({world, fine}, VerticalDatum::egm96);
    std::vector<glm::dvec3> n;
    std::vector<double> low, high;
    for (const auto& [c, r] : dem.hole_list) {
        double least = 1e9, most = -1e9;
        for (int j = std::max(r - 4, 0); j <= std::min(r + 4, HoledDem::size - 1); ++j)
            for (int i = std::max(c - 4, 0); i <= std::min(c + 4, HoledDem::size - 1); ++i) {
                least = std::min(least, HoledDem::relief(i, j));
                most = std::max(most, HoledDem::relief(i, j));
            }
        for (const double off : {-0.45, 0.0, 0.4}) {
            n.push_back(HoledDem::place(c + off, r - off));
            low.push_back(least);
            high.push_back(most);
        }
    }
    std::vector<float> h(n.size());
    both.heights(n, h);
    double worst = 0, sum = 0;
    for (std::size_t i = 0; i < n.size(); ++i) {
        ASSERT_TRUE(std::isfinite(h[i]));
        const double above = std::max({static_cast<double>(h[i]) - high[i], low[i] - static_cast<double>(h[i]), 0.0});
        worst = std::max(worst, above);
        sum += above;
    }
    // Beyond what is around by no more than the pull of borders elsewhere; unblended it would be 400 m and more.
    EXPECT_LT(worst, 60);
    EXPECT_LT(sum / static_cast<double>(n.size()), 2);
}

TEST(LayeredField, ABlendInRegionsIsTheWholeBlend) {
    HoledDem dem(75000, 4000);
    std::sort(dem.hole_list.begin(), dem.hole_list.end());
    const auto fine = dem.field();
    ASSERT_GT(fine->border_size(), 1u << 19);
    const auto world =
        field_of(make_raster(200, 200, {9, 48}, 0.02, [](int c, int r) { return 1900 + 3.0 * c - 2.0 * r; }));
    const LayeredField both({world, fine}, VerticalDatum::egm96);
    std::vector<glm::dvec3> border;
    fine->border({{0, 0, 1}, 4}, 1, border);
    std::vector<BorderBlend::Point> points;
    const double reach = 2 * world->spacing({HoledDem::place(0, 0), 0}) / 6378137;
    for (const glm::dvec3& p : border)
        points.push_back({p, static_cast<double>(fine->height(p)) - static_cast<double>(world->height(p)), reach});
    const BorderBlend whole(points, 0.36 * fine->spacing({border[0], 1e-6}) / 6378137);
    double worst = 0;
    for (std::size_t i = 0; i < dem.hole_list.size() / 8; i += 5) {
        const glm::dvec3 p = HoledDem::place(dem.hole_list[i].first, dem.hole_list[i].second);
        const double expected = static_cast<double>(world->height(p)) + whole(p);
        worst = std::max(worst, std::abs(static_cast<double>(both.height(p)) - expected));
    }
    for (double along = -50; along < 600; along += 3.7) {  // outside, through the regions around the DEM
        const glm::dvec3 p = HoledDem::place(along, -20 - 0.1 * along);
        const double expected = static_cast<double>(world->height(p)) + whole(p);
        if (std::isnan(fine->height(p)))
            worst = std::max(worst, std::abs(static_cast<double>(both.height(p)) - expected));
    }
    EXPECT_LT(worst, 3);  // clusters of points count as one, and are not the same ones
}

// Steep coasts: an island of 3000 m cliffs, land below sea level, a lagoon.
TEST(SurfaceField, WaterIsFlatAndNothingSinksBelowIt) {
    const auto land = [](int c, int r) {
        return (c - 20) * (c - 20) + (r - 15) * (r - 15) < 90 && !(c == 20 && r == 15);
    };
    std::mt19937 random(7);
    std::uniform_real_distribution<double> relief(1, 3000), depth(-4000, -1);
    Raster heights =
        make_raster(40, 30, {0, 30}, 1, [&](int c, int r) { return land(c, r) ? relief(random) : depth(random); });
    const Raster mask = make_raster(40, 30, {0, 30}, 1, [&](int c, int r) { return land(c, r) ? 1 : 0; });
    const auto plain = field_of(heights);
    const auto surface = make_surface_field(heights, mask, VerticalDatum::egm96);
    int flat = 0, rough = 0;
    for (double y = 0; y <= 29; y += 0.0921)
        for (double x = 0; x <= 39; x += 0.0931) {
            const float h = surface->height(at_degrees(30 - y, x));
            const int c = static_cast<int>(x), r = static_cast<int>(y);
            const int wet = !land(c, r) + !land(c + 1, r) + !land(c, r + 1) + !land(c + 1, r + 1);
            if (wet == 4) {
                ASSERT_EQ(h, 0) << x << " " << y;
                ++flat;
            } else if (wet > 0) {
                ASSERT_GE(h, -1e-3f) << x << " " << y;
                ++rough;
            }
        }
    EXPECT_GT(flat, 1000);
    EXPECT_GT(rough, 1000);
    for (int r = 10; r < 20; ++r)
        for (int c = 13; c < 27; ++c)
            EXPECT_NEAR(surface->height(at_degrees(30 - r, c)), land(c, r) ? plain->height(at_degrees(30 - r, c)) : 0,
                        1e-2);
    // No steps: both sides of every side between patches.
    for (double y = 8.03; y < 22; y += 0.1)
        for (int x = 10; x < 30; ++x)
            ASSERT_NEAR(surface->height(at_degrees(30 - y, x - 1e-6)), surface->height(at_degrees(30 - y, x + 1e-6)),
                        0.1);
}

TEST(SurfaceField, SixteenBitAndRefusals) {
    const auto shorts = [](Raster r, const std::function<std::int16_t(int)>& v) {
        std::vector<std::int16_t> s(r.count());
        for (std::size_t i = 0; i < s.size(); ++i) s[i] = v(static_cast<int>(i));
        r.samples = std::move(s);
        return r;
    };
    const Raster grid = make_raster(8, 8, {0, 10}, 1, [](int, int) { return 0; });
    const Raster heights = shorts(grid, [](int i) { return static_cast<std::int16_t>(i % 8 < 4 ? -3000 : 1000); });
    const Raster mask = shorts(grid, [](int i) { return static_cast<std::int16_t>(i % 8 < 4 ? 0 : 1); });
    const auto surface = make_surface_field(heights, mask, VerticalDatum::egm96);
    EXPECT_EQ(surface->height(at_degrees(6, 2)), 0);
    EXPECT_EQ(surface->height(at_degrees(6, 6)), 1000);
    EXPECT_EQ(surface->height(at_degrees(6.5, 2.5)), 0);
    EXPECT_NEAR(surface->height(at_degrees(6.5, 3.5)), 500, 100);
    std::vector<glm::dvec3> n;
    std::vector<float> h;
    surface->samples({{0, 0, 1}, 4}, n, h);
    EXPECT_EQ(*std::min_element(h.begin(), h.end()), 0);
    EXPECT_THROW(make_surface_field(heights, shorts(grid, [](int) { return std::int16_t{2}; }), VerticalDatum::egm96),
                 Error);
    const Raster elsewhere = make_raster(8, 8, {1, 10}, 1, [](int, int) { return 1; });
    EXPECT_THROW(make_surface_field(heights, elsewhere, VerticalDatum::egm96), Error);
    const Raster other_size = make_raster(8, 7, {0, 10}, 1, [](int, int) { return 1; });
    EXPECT_THROW(make_surface_field(heights, other_size, VerticalDatum::egm96), Error);
}

TEST(ConstantField, IsConstant) {
    const ConstantField field(123.5, VerticalDatum::ellipsoid);
    EXPECT_EQ(field.height({0, 0, 1}), 123.5f);
    EXPECT_TRUE(std::isnan(field.height({nan, 0, 1})));
    EXPECT_EQ(field.datum(), VerticalDatum::ellipsoid);
    EXPECT_EQ(field.sources().at(0).checksum.size(), 64u);
}

struct Moments {
    double mean = 0, rms = 0, greatest_step = 0;
};

Moments moments_of(const FractalField& field, double step) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    Moments m;
    constexpr int count = 100000;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        const double h = static_cast<double>(field.height(n));
        m.mean += h / count;
        m.rms += h * h / count;
        const double there = static_cast<double>(field.height(glm::normalize(n + step * glm::dvec3(n.y, n.z, n.x))));
        m.greatest_step = std::max(m.greatest_step, std::abs(there - h));
    }
    m.rms = std::sqrt(m.rms);
    return m;
}

TEST(FractalField, HasTheStatedAmplitudeAndBand) {
    FractalParameters p;
    p.amplitude_m = 1000;
    p.longest_m = p.shortest_m = 100e3;
    const Moments one = moments_of(FractalField(p), 1e-4);
    EXPECT_NEAR(one.rms, 1000, 30);
    EXPECT_NEAR(one.mean, 0, 30);
    EXPECT_LT(one.greatest_step, 1000);  // 637 m along, of a wave of 100 km
    p.shortest_m = 100e3 / 8;
    p.hurst = 1;
    const Moments four = moments_of(FractalField(p), 1e-4);
    EXPECT_NEAR(four.rms, 1000 * std::sqrt(1 + 0.25 + 0.0625 + 1.0 / 64), 35);  // octaves are independent
    EXPECT_DOUBLE_EQ(FractalField(p).spacing({}), 100e3 / 32);
    p.ridged = true;
    EXPECT_NEAR(moments_of(FractalField(p), 1e-4).mean, 0, 60);
}

TEST(FractalField, SeedsDifferAndBitsDoNot) {
    FractalParameters p;
    const FractalField a(p), b(p);
    p.seed = 2;
    const FractalField other(p);
    std::vector<glm::dvec3> n;
    for (int i = 0; i < 1000; ++i) n.push_back(at_degrees(i * 0.17 - 85, i * 0.3));
    std::vector<float> x(n.size()), y(n.size()), z(n.size());
    a.heights(n, x);
    b.heights(n, y);
    other.heights(n, z);
    EXPECT_EQ(x, y);
    double difference = 0;
    for (std::size_t i = 0; i < n.size(); ++i) difference += std::abs(static_cast<double>(x[i] - z[i])) / 1000;
    EXPECT_GT(difference, 500);
    EXPECT_NE(a.sources()[0].checksum, other.sources()[0].checksum);
    p.shortest_m = p.longest_m * 2;
    EXPECT_THROW(FractalField{p}, Error);
    p.shortest_m = nan;
    EXPECT_THROW(FractalField{p}, Error);
}

}  // namespace
}  // namespace planet
