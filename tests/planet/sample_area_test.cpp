#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "planet/elevation/raster_field.h"

namespace planet {
namespace {

// Steps of a degree a sample, from longitude 20 and this latitude on.
RasterField field_at(double latitude, double step, int width, int height) {
    Raster r;
    r.width = width;
    r.height = height;
    r.grid = {{20, latitude}, {step, 0}, {0, -step}};
    r.crs = "EPSG:4326";
    std::vector<std::int16_t> samples(r.count());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int16_t>(i % 1000);
    r.samples = std::move(samples);
    return RasterField(std::make_shared<const Raster>(std::move(r)), VerticalDatum::egm96);
}

using Sample = std::array<double, 3>;

std::vector<Sample> visited(const RasterField& field, const SampleArea& area) {
    std::vector<Sample> all;
    field.sample_rows(area, [&](std::span<const glm::dvec3> normals, std::span<const float> heights) {
        EXPECT_EQ(normals.size(), heights.size());
        for (const glm::dvec3& n : normals) all.push_back({n.x, n.y, n.z});
    });
    std::sort(all.begin(), all.end());
    return all;
}

// Every sample of the raster that is in the area by its definition.
std::vector<Sample> inside(const RasterField& field, const SampleArea& area) {
    std::vector<Sample> all;
    for (const Sample& s : visited(field, Cap{{0, 0, 1}, 4})) {
        const glm::dvec3 n(s[0], s[1], s[2]);
        const auto holds = [&](const glm::dvec3& side) { return glm::dot(side, n) >= -1e-15; };
        if (std::all_of(area.sides.begin(), area.sides.end(), holds)) all.push_back(s);
    }
    return all;
}

void expect_samples_of_cells(const RasterField& field, const glm::dvec3& middle, int first_level, int last_level) {
    std::size_t in_all = 0, visits = 0;
    for (int level = first_level; level <= last_level; ++level) {
        const LocationCode cell = cell_at(middle, level);
        for (const LocationCode c : {cell, neighbor(cell), neighbor(cell, Side::left_leg)}) {
            const SampleArea area(corners(c));
            const std::vector<Sample> wanted = inside(field, area), found = visited(field, area);
            EXPECT_TRUE(std::includes(found.begin(), found.end(), wanted.begin(), wanted.end())) << to_string(c);
            EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "twice";
            in_all += wanted.size();
            visits += found.size();
        }
    }
    EXPECT_GT(in_all, 1000u);
    EXPECT_LT(static_cast<double>(visits), 1.1 * static_cast<double>(in_all));
}

TEST(SampleArea, ACellsSamplesAndFewOthersAreVisitedOnce) {
    expect_samples_of_cells(field_at(46, 0.01, 300, 200), normal_from_geodetic(45 * degrees, 21.5 * degrees), 8, 17);
    expect_samples_of_cells(field_at(-1, 0.01, 300, 200), normal_from_geodetic(-2 * degrees, 21.5 * degrees), 8, 17);
}

TEST(SampleArea, NearAPoleParallelsBendAsMuchAsSides) {
    const RasterField field = field_at(89.95, 0.5, 719, 20);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> around(-180, 180), down(80, 90);
    for (int k = 0; k < 60; ++k) {
        const LocationCode cell =
            cell_at(normal_from_geodetic(down(random) * degrees, around(random) * degrees), 1 + k % 12);
        const SampleArea area(corners(cell));
        const std::vector<Sample> wanted = inside(field, area), found = visited(field, area);
        EXPECT_TRUE(std::includes(found.begin(), found.end(), wanted.begin(), wanted.end())) << to_string(cell);
    }
}

TEST(SampleArea, HasTheCellOnItsInnerSide) {
    for (const char* name : {"N0", "N3", "S1.0110", "S2.1"}) {
        const Corners c = corners(parse_code(name).value());
        const SampleArea area(c);
        EXPECT_TRUE(area.is_cell());
        for (const glm::dvec3& side : area.sides) EXPECT_GT(glm::dot(side, c.left + c.right + c.apex), 0);
    }
    EXPECT_FALSE(SampleArea(Cap{{1, 0, 0}, 0.1}).is_cell());
}

// Places that are interpolated together get the bits they get alone.
void expect_same_heights(const RasterField& field) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> longitude(19.9, 20.5), latitude(45.4, 46.1), near(-0.01, 0.01);
    std::vector<glm::dvec3> normals;
    for (int k = 0; k < 1500; ++k) {
        const double x = longitude(random), y = latitude(random);
        for (int i = 0; i < 7; ++i)
            normals.push_back(normal_from_geodetic((y + near(random)) * degrees, (x + near(random)) * degrees));
    }
    normals[100] = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    std::vector<float> together(normals.size());
    field.heights(normals, together);
    std::size_t voids = 0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const float alone = field.height(normals[i]);
        voids += std::isnan(alone) ? 1 : 0;
        ASSERT_EQ(std::bit_cast<std::uint32_t>(alone), std::bit_cast<std::uint32_t>(together[i])) << i;
    }
    EXPECT_GT(voids, 500u);
    EXPECT_LT(voids, normals.size() / 2);
}

TEST(RasterHeights, TogetherOrAloneAreTheSameBits) {
    Raster shorts;
    shorts.width = 60;
    shorts.height = 70;
    shorts.grid = {{20, 46}, {0.01, 0}, {0, -0.01}};
    shorts.crs = "EPSG:4326";
    std::mt19937 random(3);
    std::vector<std::int16_t> samples(shorts.count());
    for (std::int16_t& s : samples) {
        const auto any = random();
        s = any % 29 == 0 ? void_sample : any % 31 == 0 ? water_sample : static_cast<std::int16_t>(any % 5000 - 400);
    }
    Raster floats = shorts;
    std::vector<float> numbers;
    for (const std::int16_t s : samples)
        numbers.push_back(s == void_sample    ? std::numeric_limits<float>::quiet_NaN()
                          : s == water_sample ? -std::numeric_limits<float>::infinity()
                                              : 0.37f * s);
    shorts.samples = std::move(samples);
    floats.samples = std::move(numbers);
    expect_same_heights(RasterField(std::make_shared<const Raster>(std::move(shorts)), VerticalDatum::egm96));
    expect_same_heights(RasterField(std::make_shared<const Raster>(std::move(floats)), VerticalDatum::egm96));
}

}  // namespace
}  // namespace planet
