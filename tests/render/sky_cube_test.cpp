// Cube maps of pictures and of relief.
#include <gtest/gtest.h>

#include <cmath>

#include "planet/error.h"
#include "planet/frames.h"
#include "render/sky/cube_map.h"

namespace render {
namespace {

using glm::dvec3;
constexpr double pi = std::numbers::pi;

/// A colour that is smooth over the sphere, 20..235.
glm::ivec3 smooth_color(const dvec3& n) {
    return glm::ivec3(glm::round(127.5 + 107.0 * n * dvec3(1, 0.9, -1)));
}

std::vector<std::uint8_t> smooth_picture(int width, int height) {
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::ivec3 c = smooth_color(
                planet::normal_from_geodetic(pi * (0.5 - (y + 0.5) / height), 2 * pi * ((x + 0.5) / width - 0.5)));
            for (int k = 0; k < 3; ++k) bytes.push_back(static_cast<std::uint8_t>(c[k]));
        }
    return bytes;
}

TEST(SkyCube, KeepsASmoothPictureEverywhereAtEveryScale) {
    const auto bytes = smooth_picture(512, 256);
    for (const int side : {64, 256}) {  // coarser and finer than the picture
        const CubeMap cube = cube_from_equirectangular({512, 256, 3, bytes}, side, Encoding::linear);
        ASSERT_EQ(cube.levels.back().side, 1);
        for (std::size_t level = 0; cube.levels[level].side >= 32; ++level) {
            const CubeLevel& l = cube.levels[level];
            int worst = 0;
            for (int row = 0; row < 6 * l.side; ++row)
                for (int x = 0; x < l.side; ++x) {
                    const dvec3 n = cube_normal(row / l.side, (x + 0.5) / l.side, (row % l.side + 0.5) / l.side);
                    const auto* t = &l.texels[static_cast<std::size_t>(row * l.side + x) * 4];
                    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(t[c] - smooth_color(n)[c]));
                    ASSERT_EQ(t[3], 255);
                }
            EXPECT_LE(worst, 3) << side << " level " << level;
        }
    }
}

TEST(SkyCube, AveragesLightAndNotBytes) {
    std::vector<std::uint8_t> stripes;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) stripes.push_back(x % 2 ? 255 : 0);
    const CubeMap srgb = cube_from_equirectangular({256, 128, 1, stripes}, 1, Encoding::srgb);
    const CubeMap linear = cube_from_equirectangular({256, 128, 1, stripes}, 1, Encoding::linear);
    EXPECT_NEAR(srgb.levels[0].texels[0], 188, 2);
    EXPECT_NEAR(linear.levels[0].texels[0], 128, 2);
}

TEST(SkyCube, AlphaThreadsAndOddSizes) {
    const std::vector<std::uint8_t> white{255, 255, 255};
    const std::vector<std::uint8_t> grey{10, 20, 30, 40, 50, 60}, one{77, 78, 79};
    const CubeMap a = cube_from_equirectangular({3, 2, 1, grey}, 16, Encoding::srgb, 1);
    const CubeMap b = cube_from_equirectangular({3, 2, 1, grey}, 16, Encoding::srgb, 5);
    for (std::size_t k = 0; k < a.levels.size(); ++k) EXPECT_EQ(a.levels[k].texels, b.levels[k].texels);
    CubeMap single = cube_from_equirectangular({1, 1, 3, one}, 16, Encoding::srgb);
    EXPECT_EQ(single.levels[2].texels[1], 78);
    set_alpha(single, a);
    EXPECT_EQ(single.levels[0].texels[3], a.levels[0].texels[0]);
    EXPECT_EQ(single.levels[0].texels[0], 77);
    set_night_alpha(single, cube_from_equirectangular({1, 1, 3, white}, 16, Encoding::linear));
    EXPECT_EQ(single.levels[0].texels[3], 127);
    EXPECT_THROW(cube_from_equirectangular({3, 2, 3, grey}, 16, Encoding::srgb), planet::Error);
    EXPECT_THROW(cube_from_equirectangular({0, 0, 1, {}}, 16, Encoding::srgb), planet::Error);
    EXPECT_THROW(cube_from_equirectangular({3, 2, 1, grey}, 17, Encoding::srgb), planet::Error);
}

TEST(SkyCube, LightsWithoutMoonshine) {
    const std::vector<std::uint8_t> picture{18, 60, 84, 121, 119, 127, 0, 0, 0};  // the Sahara, Paris, nothing
    const auto lights = lights_from_night_picture(picture);
    EXPECT_EQ(lights[0], 0);
    EXPECT_GT(lights[3], 120);
    EXPECT_GT(lights[3], lights[5]);
    EXPECT_EQ(lights[8], 0);
}

/// Heights that are a plane wave through space: the slope is known everywhere, poles included.
class Wave : public planet::ElevationField {
  public:
    static constexpr double amplitude = 2e5, radius = 6.371e6;
    static inline const dvec3 along = glm::normalize(dvec3(1, 2, 3));
    planet::VerticalDatum datum() const override { return planet::VerticalDatum::ellipsoid; }
    void heights(std::span<const dvec3> normals, std::span<float> out) const override {
        for (std::size_t i = 0; i < normals.size(); ++i)
            out[i] = normals[i].x > 0.9 ? std::nanf("") : static_cast<float>(amplitude * glm::dot(normals[i], along));
    }
    double spacing(const planet::Cap&) const override { return 0; }
    void samples(const planet::Cap&, std::vector<dvec3>&, std::vector<float>&) const override {}
    std::vector<planet::SourceInfo> sources() const override { return {}; }
};

TEST(SkyCube, ReliefIsTheSlopeOfTheField) {
    const CubeMap cube = relief_cube(Wave(), 64, Wave::radius, true);
    const CubeMap sea = relief_cube(Wave(), 64, Wave::radius, false);
    double worst = 0;
    for (int row = 0; row < 6 * 64; ++row)
        for (int x = 0; x < 64; ++x) {
            const dvec3 n = cube_normal(row / 64, (x + 0.5) / 64, (row % 64 + 0.5) / 64);
            const auto at = [&](const CubeMap& c) {
                const auto* t = &c.levels[0].texels[static_cast<std::size_t>(row * 64 + x) * 4];
                return dvec3(static_cast<std::int8_t>(t[0]), static_cast<std::int8_t>(t[1]),
                             static_cast<std::int8_t>(t[2])) /
                       254.0;
            };
            const dvec3 slope = (Wave::along - glm::dot(Wave::along, n) * n) * (Wave::amplitude / Wave::radius);
            if (n.x > 0.95) {
                EXPECT_EQ(at(cube), dvec3(0));
            }
            if (n.x < 0.85) worst = std::max(worst, glm::length(at(cube) - (glm::normalize(n - slope) - n)));
            if (glm::dot(n, Wave::along) < -0.1 && n.x < 0.85) {
                EXPECT_EQ(at(sea), dvec3(0));
            }
        }
    EXPECT_LT(worst, 0.005);
}

}  // namespace
}  // namespace render
