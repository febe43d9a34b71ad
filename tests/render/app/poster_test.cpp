// Pictures larger than what is drawn at once: any part of one drawn alone has the pixels of the whole.

#include <gtest/gtest.h>

#include <ostream>

#include "planet/elevation/image_io.h"
#include "tests/render/app/can_draw.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

struct View {
    const char* name;
    const char* arguments;
};
void PrintTo(const View& view, std::ostream* out) {
    *out << view.arguments;
}

// Four parts each: their borders are at 2032.
constexpr View views[] = {
    {"globe", "--show graticule --samples 1"},
    {"horizon", "--at 37.58,-105.49 --range 60km --heading 30 --pitch -8 --show graticule,mesh --samples 1"},
    {"ground", "--at 37.58,-105.49 --height 3 --heading 250 --show graticule --samples 4 --time 2026-06-21T13:00:00Z"},
    {"stars", "--at -90,0 --height 300km --pitch -10 --time 2026-06-21T09:00:00Z"},
};

class Poster : public testing::TestWithParam<View> {
  protected:
    planet::Image draw(const std::string& more) const {
        const Outcome outcome = run(folder_.path(), words("render --size 2080x2064 -o p.png " +
                                                          std::string(GetParam().arguments) + " " + more));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return planet::read_image(folder_ / "p.png");
    }
    ScratchFolder folder_;
};

TEST_P(Poster, ACropHasThePixelsOfTheWhole) {
    if (!can_draw()) GTEST_SKIP() << "no usable OpenGL";
    const planet::Image whole = draw("");
    ASSERT_EQ(whole.width, 2080);
    const struct { int x, y, width, height; } crops[] = {{1960, 1980, 120, 84}, {700, 900, 300, 33}};
    for (const auto& c : crops) {
        const std::string text = std::to_string(c.x) + "," + std::to_string(c.y) + "," + std::to_string(c.width) + "x" +
                                 std::to_string(c.height);
        const planet::Image crop = draw("--crop " + text);
        ASSERT_EQ(crop.width, c.width);
        ASSERT_EQ(crop.height, c.height);
        int different = 0;
        for (int y = 0; y < c.height; ++y)
            different += !std::equal(crop.pixel(0, y), crop.pixel(0, y) + 3 * c.width, whole.pixel(c.x, c.y + y));
        EXPECT_EQ(different, 0) << "rows of " << text;
    }
}

INSTANTIATE_TEST_SUITE_P(Views, Poster, testing::ValuesIn(views),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(Crop, OfASmallPictureToo) {
    if (!can_draw()) GTEST_SKIP() << "no usable OpenGL";
    const ScratchFolder folder;
    ASSERT_EQ(run(folder.path(), words("render --size 200x100 -o a.png")).status, 0);
    ASSERT_EQ(run(folder.path(), words("render --size 200x100 --crop 90,40,20x30 -o b.png")).status, 0);
    const planet::Image whole = planet::read_image(folder / "a.png"), crop = planet::read_image(folder / "b.png");
    ASSERT_EQ(crop.height, 30);
    for (int y = 0; y < 30; ++y)
        EXPECT_TRUE(std::equal(crop.pixel(0, y), crop.pixel(0, y) + 60, whole.pixel(90, 40 + y))) << y;
}

TEST(Crop, RefusesWhatIsNotInThePicture) {
    const ScratchFolder folder;
    for (const char* crop :
         {"90,40,20x61", "200,0,1x1", "-1,0,5x5", "1,2", "1,2,3", "1,2,0x5", "x,2,3x4", "1,2,3x4,5"}) {
        const Outcome outcome = run(folder.path(), words(std::string("render --size 200x100 -o b.png --crop ") + crop));
        EXPECT_EQ(outcome.status, 2) << crop;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace render
