// Sheets of steps towards a TIN.
#include "render/app/tin/tin_picture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "planet/error.h"
#include "tests/planet/tin_rasters.h"
#include "tests/render/app/scratch_folder.h"

namespace render {
namespace {

using planet::HeightGrid;

constexpr glm::dvec2 square{30, 30};

/// Level but for one sample.
HeightGrid peak(int width, int height, glm::ivec2 at) {
    HeightGrid grid(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) grid.set({x, y}, glm::ivec2(x, y) == at ? 100.0f : 0.0f);
    return {grid, {0, 0}, {width - 1, height - 1}};
}

template <class Is>
std::vector<glm::ivec2> pixels_that(const planet::Image& image, Is is) {
    std::vector<glm::ivec2> out;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t* p = image.pixel(x, y);
            if (is(p[0], p[1], p[2])) out.emplace_back(x, y);
        }
    return out;
}

TEST(TinPicture, TheNewVertexSitsInARingOnTheBrightestSpot) {
    const planet::Image image = draw_tin_steps(peak(61, 41, {40, 15}), square, {}, {4});
    // Pale yellow, the end of the scale; the scale itself is below the panels.
    auto brightest = pixels_that(image, [](int r, int g, int b) { return r > 245 && g > 225 && b < 215; });
    std::erase_if(brightest, [&](glm::ivec2 p) { return p.y > image.height - 160; });
    ASSERT_GT(brightest.size(), 20u);
    glm::dvec2 middle(0);
    for (const glm::ivec2 p : brightest) middle += glm::dvec2(p) / static_cast<double>(brightest.size());
    const auto white = pixels_that(image, [](int r, int g, int b) { return r == 255 && g == 255 && b == 255; });
    const auto in_ring = std::ranges::count_if(
        white, [&](glm::ivec2 p) { return std::abs(glm::length(glm::dvec2(p) - middle) - 11) < 2; });
    EXPECT_GT(in_ring, 100);
    for (const glm::ivec2 p : brightest) EXPECT_LT(glm::length(glm::dvec2(p) - middle), 11);
}

TEST(TinPicture, HasAPanelForEveryStageOnTheWay) {
    const HeightGrid grid = planet::rough_grid(90, 60);
    const auto area_of_sheet = [&](std::vector<std::size_t> stages) {
        const planet::Image image = draw_tin_steps(grid, square, {}, std::move(stages));
        EXPECT_EQ(image.pixels.size(), image.row_size() * static_cast<std::size_t>(image.height));
        return static_cast<double>(image.width) * image.height;
    };
    const double two = area_of_sheet({50}), eight = area_of_sheet({1050, 50, 150, 250, 250, 450, 600, 750});
    EXPECT_NEAR(eight / two, 4, 0.8);
    planet::TinOptions options;
    options.tolerance = 150;  // kept long before there are so many
    const planet::Image image = draw_tin_steps(grid, square, options, {20, 100000});
    EXPECT_NEAR(static_cast<double>(image.width) * image.height, two, 1);
}

TEST(TinPicture, IsTheSameEveryTime) {
    const HeightGrid grid = planet::rough_grid(90, 60);
    EXPECT_EQ(draw_tin_steps(grid, square, {}, {50, 150}).pixels, draw_tin_steps(grid, square, {}, {150, 50}).pixels);
}

TEST(TinPicture, LeavesVoidsGrey) {
    HeightGrid grid = planet::rough_grid(90, 60);
    const auto grey = [](int r, int g, int b) { return r == 226 && g == 229 && b == 235; };
    const std::size_t none = pixels_that(draw_tin_steps(grid, square, {}, {100}), grey).size();
    for (int y = 20; y < 40; ++y)
        for (int x = 30; x < 60; ++x) grid.set({x, y}, std::numeric_limits<float>::quiet_NaN());
    const planet::Image image = draw_tin_steps(grid, square, {}, {400});
    const double panels = 2 * 760.0 * 480, part = 20.0 * 30 / (90 * 60);
    EXPECT_NEAR(static_cast<double>(pixels_that(image, grey).size() - none), part * panels, 0.1 * part * panels);
}

TEST(TinPicture, OfSteepProportionsIsStillASheet) {
    for (const glm::ivec2 size : {glm::ivec2(2, 300), glm::ivec2(300, 2), glm::ivec2(3, 3)}) {
        const planet::Image image = draw_tin_steps(planet::rough_grid(size.x, size.y), square, {}, {4, 6});
        EXPECT_LT(std::max(image.width, image.height), 6000);
    }
}

TEST(TinPicture, RefusesStagesThatAreNone) {
    const HeightGrid grid = planet::rough_grid(40, 30);
    for (const std::vector<std::size_t>& stages :
         {std::vector<std::size_t>{}, {2}, {0, 50}, std::vector<std::size_t>(36, 50)}) {
        try {
            auto distinct = stages;
            for (std::size_t i = 0; distinct.size() > 3 && i < distinct.size(); ++i) distinct[i] += i;
            draw_tin_steps(grid, square, {}, distinct);
            FAIL() << stages.size();
        } catch (const planet::Error& error) {
            EXPECT_EQ(error.fault(), planet::Fault::bad_usage);
            EXPECT_EQ(std::string(error.what()).rfind("--stages: ", 0), 0u) << error.what();
        }
    }
    EXPECT_THROW(draw_tin_steps(peak(9, 9, {4, 4}), square, {}, {200}), planet::Error) << "the peak is done with 8";
}

TEST(TinPicture, GoesToAFile) {
    const ScratchFolder folder;
    const std::string path = folder / "steps.png";
    write_tin_steps(planet::rough_grid(90, 60), square, {}, paper_stages, path);
    EXPECT_GT(std::filesystem::file_size(path), 10000u);
    EXPECT_THROW(write_tin_steps(planet::rough_grid(9, 6), square, {}, {8}, folder / "steps.txt"), planet::Error);
}

}  // namespace
}  // namespace render
