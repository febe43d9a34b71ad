// Strokes painted in memory.
#include "render/picture/stroke_coverage.h"

#include <gtest/gtest.h>

namespace render {
namespace {

planet::Image black(int width, int height) {
    return {width, height, 3, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height) * 3, 0)};
}

TEST(StrokeCoverage, FillsItsWidthAndLeavesTheRest) {
    planet::Image image = black(40, 20);
    StrokeCoverage strokes(40, 20);
    strokes.add({{10, 10, 0}, {30, 10, 0}, 4, {}});
    strokes.paint(image, {200, 100, 50});
    for (int x = 10; x < 30; ++x) {
        EXPECT_EQ(image.pixel(x, 9)[0], 200);
        EXPECT_EQ(image.pixel(x, 10)[1], 100);
        EXPECT_EQ(image.pixel(x, 6)[0], 0);
        EXPECT_EQ(image.pixel(x, 13)[0], 0);
    }
    EXPECT_EQ(image.pixel(34, 10)[0], 0);
    EXPECT_GT(image.pixel(31, 9)[0], 0) << "ends are round";
}

TEST(StrokeCoverage, OfOneColourOverlapAsOne) {
    planet::Image once = black(30, 30), twice = black(30, 30);
    const Stroke s{{3.3f, 4.1f, 0}, {25.2f, 22.7f, 0}, 1.3f, {}};
    StrokeCoverage strokes(30, 30);
    strokes.add(s);
    strokes.paint(once, {255, 255, 255, 120});
    strokes.add(s);
    strokes.add({s.b, s.a, s.width, {}});
    strokes.paint(twice, {255, 255, 255, 120});
    EXPECT_EQ(once.pixels, twice.pixels);
    strokes.paint(twice, {255, 0, 0});
    EXPECT_EQ(once.pixels, twice.pixels) << "painted is done with";
}

TEST(StrokeCoverage, ThinLinesAreFaintNotBroken) {
    planet::Image image = black(30, 8);
    StrokeCoverage strokes(30, 8);
    strokes.add({{2, 4.5f, 0}, {28, 4.5f, 0}, 0.4f, {}});
    strokes.paint(image, {255, 255, 255});
    for (int x = 4; x < 26; ++x) EXPECT_NEAR(image.pixel(x, 4)[0], 0.7 * 0.4 * 255, 2) << x;
}

TEST(StrokeCoverage, StaysWithinItsClipAndThePicture) {
    planet::Image image = black(20, 20);
    StrokeCoverage strokes(20, 20);
    strokes.clip({5, 5, 10, 10});
    strokes.add({{-100, -100, 0}, {100, 100, 0}, 300, {}});
    strokes.add({{50, 50, 0}, {60, 60, 0}, 3, {}});
    strokes.paint(image, {255, 255, 255});
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x)
            EXPECT_EQ(image.pixel(x, y)[0], x >= 5 && x < 10 && y >= 5 && y < 10 ? 255 : 0) << x << "," << y;
}

}  // namespace
}  // namespace render
