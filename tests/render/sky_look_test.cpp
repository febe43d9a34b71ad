// Surface, tone curve, dither, noise and stars.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "planet/error.h"
#include "planet/frames.h"
#include "render/sky/shading_reference.h"
#include "render/sky/stars.h"

namespace render {
namespace {

using glm::dvec3;
using glm::vec3;
using planet::degrees;
using reference::Shading;

/// A shading of an eye 100 km above the equator with the sun overhead.
struct Scene {
    AtmosphereTables tables = make_tables();
    ViewTable view = make_view_table(tables, {6378137.0 + 100e3, 0, 0}, {1, 0, 0});
    std::vector<std::uint8_t> noise = make_noise_volume(32);
    Shading shading{view.uniforms, tables, view};
    Scene() { shading.noise_table = {noise.data(), 32}; }
};
Scene& scene() {
    static Scene made;
    return made;
}

Shading::SurfaceInput ground(float latitude, float height, float slope, float footprint) {
    const vec3 normal(std::cos(latitude), 0, std::sin(latitude)), tangent(-normal.z, 0, normal.x);
    Shading::SurfaceInput s;
    s.view = -1000.0f * normal;
    s.normal = normal;
    s.terrain_normal = std::cos(slope) * normal + std::sin(slope) * tangent;
    s.imagery = vec3(0.05f, 0.06f, 0.03f);
    s.night = vec3(0);
    s.water = 0;
    s.height = height;
    s.footprint = footprint;
    return s;
}

TEST(SkySurface, CoverFollowsHeightSlopeAndLatitude) {
    Shading& s = scene().shading;
    const auto cover = [&](float latitude, float height, float slope) {
        const auto in = ground(latitude, height, slope, 1);
        return s.ground_cover(in, std::cos(slope), 0, 0);
    };
    const float alps = 46.5f * 0.0174533f;
    const vec3 forest = cover(alps, 1200, 0.1f), scree = cover(alps, 3000, 0.2f), snow = cover(alps, 3900, 0.1f);
    const vec3 cliff = cover(alps, 3900, 1.1f), tropics = cover(0.05f, 3900, 0.1f), arctic = cover(1.4f, 1600, 0.1f);
    EXPECT_GT(forest.g, forest.r);
    EXPECT_LT(s.luminance(forest), 0.06f);
    EXPECT_GT(s.luminance(scree), 2 * s.luminance(forest));
    EXPECT_GT(s.luminance(snow), 0.7f);
    EXPECT_GT(s.luminance(arctic), 0.7f);
    EXPECT_LT(s.luminance(cliff), 0.3f);    // too steep for snow
    EXPECT_LT(s.luminance(tropics), 0.3f);  // no snow yet
}

TEST(SkySurface, SnowLingersOnSlopesThatFaceThePole) {
    Shading& s = scene().shading;
    const auto light = [&](float latitude, float slope) {
        const auto in = ground(latitude, 4100, slope, 1);
        return s.luminance(s.ground_cover(in, std::cos(slope), 0, 0));
    };
    EXPECT_GT(light(0.656f, 0.5f), 0.5f);  // Colorado, 500 m above the trees; a positive slope faces north
    EXPECT_LT(light(0.656f, -0.5f), 0.25f);
    EXPECT_GT(light(-0.656f, -0.5f), 0.5f);
    EXPECT_LT(light(-0.656f, 0.5f), 0.25f);
}

TEST(SkySurface, NoiseStaysWhereItIsWhenTheEyeCrossesItsPeriod) {
    Shading a = scene().shading, b = a;
    a.sky_detail = glm::vec4(131072.0f - 64, 5, 7, 9784);  // one eye, written on either side of the period
    b.sky_detail = glm::vec4(-64, 5, 7, 9784);
    a.sky_near = glm::vec4(64, 5, 7, 0);
    b.sky_near = glm::vec4(-64, 5, 7, 0);
    for (const float size : {4.0f, 256.0f, 2048.0f, 16384.0f})
        for (float x = 0; x < 4 * size; x += 0.37f * size)
            EXPECT_NEAR(a.patch_noise(vec3(x, 0, 0), size).w, b.patch_noise(vec3(x, 0, 0), size).w, 0.02f) << size;
    for (float footprint = 0.001f; footprint < 1e5f; footprint *= 1.3f)
        for (float x = 0; x < 64 * footprint; x += 5 * footprint)
            EXPECT_NEAR(a.detail_noise(vec3(x, 0, 0), footprint, footprint).w,
                        b.detail_noise(vec3(x, 0, 0), footprint, footprint).w, 0.02f)
                << footprint;
}

// The finest noise beside an eye that moves by a millimetre a step, far from the origin of the period.
TEST(SkySurface, NoiseStandsStillUnderMillimetres) {
    Shading s = scene().shading;
    const double start = 131072 - 27.3, ground = start + 2;
    float first = 0;
    for (int step = 0; step < 40; ++step) {
        const double eye = start + 0.001 * step;
        s.sky_detail = glm::vec4(glm::dvec4(eye, 5, 7, 9784));
        s.sky_near = glm::vec4(glm::dvec4(std::fmod(eye, 128.0), 5, 7, 0));
        const vec3 view(static_cast<float>(ground - eye), 0.3f, 0);
        const float noise = s.detail_noise(view, 0.001f, 0.001f).w + s.patch_noise(view, 4).w;
        if (step == 0) first = noise;
        EXPECT_NEAR(noise, first, 0.02f) << step;
    }
}

TEST(SkySurface, ImageryFromAfarAndCoverNearWithoutASeam) {
    Shading& s = scene().shading;
    EXPECT_EQ(s.close_up(20000), 0);
    EXPECT_EQ(s.close_up(10), 1);
    float before = 1;
    for (float footprint = 1; footprint < 3e4f; footprint *= 1.05f) {
        const float near = s.close_up(footprint);
        EXPECT_LE(near, before);
        EXPECT_LT(before - near, 0.03f);
        before = near;
    }
}

TEST(SkySurface, SunNightAndGlint) {
    Shading& s = scene().shading;
    auto in = ground(0, 0, 0, 20000);
    const vec3 day = s.surface_radiance(in);
    in.night = vec3(1);
    EXPECT_LT(glm::length(s.surface_radiance(in) - day), 1e-4f);  // no lamps at noon
    in.normal = in.terrain_normal = vec3(-1, 0, 0);
    in.view = vec3(1000, 0, 0);
    EXPECT_GT(s.surface_radiance(in).r, 0.5f);
    in.night = vec3(0);
    EXPECT_LT(glm::length(s.surface_radiance(in)), 0.01f);
    auto sea = ground(0, 0, 0, 20000);
    sea.water = 1;
    const vec3 mirror = s.surface_radiance(sea);  // straight below the sun, seen from above
    sea.view = vec3(-700, 700, 0);
    const vec3 aside = s.surface_radiance(sea);
    EXPECT_GT(mirror.r, 3 * aside.r);
    auto slope = ground(0.8f, 0, 0.5f, 20000);
    const vec3 away = s.surface_radiance(slope);
    slope.terrain_normal = 2.0f * glm::dot(slope.terrain_normal, slope.normal) * slope.normal - slope.terrain_normal;
    EXPECT_GT(s.surface_radiance(slope).g, 1.5f * away.g);
}

TEST(SkyTone, MonotoneAndBounded) {
    Shading& s = scene().shading;
    float before = -1;
    for (float x = 0; x < 100; x = x * 1.02f + 1e-5f) {
        const float v = s.srgb_from_linear(s.filmic(vec3(x))).g;
        EXPECT_GE(v, before - 1e-5f);
        EXPECT_LE(v, 1.0f);
        before = v;
    }
    EXPECT_EQ(s.srgb_from_linear(s.filmic(vec3(0))), vec3(0));
    EXPECT_GT(before, 0.99f);
    for (int i = 0; i < 256; ++i) {  // the definition of sRGB
        const double v = i / 255.0, l = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(s.srgb_from_linear(vec3(static_cast<float>(l))).r, v, 0.25 / 255);
    }
}

TEST(SkyTone, DitherIsSmallAndLeavesTheMean) {
    double sum = 0;
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x) {
            const float d = scene().shading.dither({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_LE(std::abs(d), 1.0f / 255);
            sum += d;
        }
    EXPECT_LT(std::abs(sum / 65536), 0.02 / 255);
}

TEST(SkyNoise, RepeatsWithoutSeamAndIsCentred) {
    const int n = 64;
    const auto levels = make_noise_levels(n);
    const std::vector<std::uint8_t>& noise = levels[0];
    ASSERT_EQ(levels.size(), 7u);
    EXPECT_EQ(levels[6].size(), 4u);
    EXPECT_NEAR(levels[6][3], 127, 5);
    ASSERT_EQ(noise.size(), std::size_t{4} * n * n * n);
    const auto value = [&](int x, int y, int z) {
        return int{noise[static_cast<std::size_t>(((z % n) * n + y % n) * n + x % n) * 4 + 3]};
    };
    double mean = 0;
    int inside = 0, seam = 0, low = 255, high = 0;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                mean += value(x, y, z);
                low = std::min(low, value(x, y, z)), high = std::max(high, value(x, y, z));
                if (x + 1 < n) inside = std::max(inside, std::abs(value(x + 1, y, z) - value(x, y, z)));
            }
            seam = std::max(seam, std::abs(value(n, y, z) - value(n - 1, y, z)));
        }
    EXPECT_NEAR(mean / (n * n * n), 127.5, 4);
    EXPECT_GT(high - low, 150);
    EXPECT_LE(seam, inside + 8);
}

TEST(SkyStars, PlacesColorsAndBrightness) {
    const Star vega = make_star(279.2347 * degrees, 38.7837 * degrees, 0.03, 0.0);
    const Star betelgeuse = make_star(88.7929 * degrees, 7.4071 * degrees, 0.5, 1.85);
    EXPECT_NEAR(glm::length(vega.direction), 1, 1e-6);
    EXPECT_NEAR(std::asin(vega.direction.z), 38.7837 * degrees, 1e-6);
    EXPECT_GT(vega.light.b, vega.light.r);
    EXPECT_GT(betelgeuse.light.r, 1.3f * betelgeuse.light.b);
    EXPECT_NEAR(vega.light.g, 1, 0.05);
    EXPECT_GT(vega.light.g, betelgeuse.light.g);
}

class SkyStarFile : public ::testing::Test {
  protected:
    std::filesystem::path write(const std::string& text) {
        std::ofstream(file_) << text;
        return file_;
    }
    ~SkyStarFile() override {
        std::error_code gone;
        std::filesystem::remove(file_, gone);
    }
    std::filesystem::path file_ = std::filesystem::temp_directory_path() /
                                  ("sky_stars_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
                                   std::to_string(reinterpret_cast<std::uintptr_t>(this)) + ".csv");
};

TEST_F(SkyStarFile, ReadsATable) {
    const auto stars =
        read_stars(write("# stars\nra,dec,v,b_v\n279.2347, 38.7837,0.03,0.00,Vega\n\n88.79 +7.41 0.5 1.85\n"));
    ASSERT_EQ(stars.size(), 2u);
    EXPECT_EQ(stars[0].direction, make_star(279.2347 * degrees, 38.7837 * degrees, 0.03, 0).direction);
}

TEST_F(SkyStarFile, BadTablesAreNamed) {
    EXPECT_THROW(read_stars("/nonexistent/stars.csv"), planet::Error);
    EXPECT_THROW(read_stars(write("")), planet::Error);
    EXPECT_THROW(read_stars(write("ra,dec,v,b_v\n")), planet::Error);
    EXPECT_THROW(read_stars(write("1,2,3,4\n1,95,3,4\n")), planet::Error);
    EXPECT_THROW(read_stars(write("1,2,3,4\n1,2,nan,4\n")), planet::Error);
    try {
        read_stars(write("1,2,3,4\n1,2,x\n"));
        ADD_FAILURE();
    } catch (const planet::Error& e) {
        EXPECT_NE(std::string(e.what()).find(".csv:2"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace render
