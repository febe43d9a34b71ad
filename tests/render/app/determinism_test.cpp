// Same arguments, same bytes: twice in a row, whatever the number of threads and whichever way leads to OpenGL.

#include <gtest/gtest.h>

#include <ostream>

#include "planet/elevation/image_io.h"
#include "render/gl/context.h"
#include "tests/render/app/picture_difference.h"
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

constexpr View views[] = {
    {"globe", "--size 320x180"},
    {"mountains",
     "--size 320x180 --at 37.58,-105.49 --range 20km --heading 30 --pitch -20 --time 2026-06-21T16:00:00Z"},
    {"antimeridian",
     "--size 320x180 --at -16.5,180 --range 800km --heading 200 --pitch -40 --samples 4"
     " --show mesh,levels,curve --time 2026-06-21T23:00:00Z"},
    {"pole_at_night", "--size 180x320 --at -90,0 --height 300km --pitch -50 --time 2026-06-21T09:00:00Z"},
};

std::vector<std::string> ways_in() {
    std::vector<std::string> names;
    for (const auto& way : probe_backends())
        if (way.available) names.push_back(way.name);
    return names;
}

class Determinism : public testing::TestWithParam<View> {
  protected:
    /// The bytes of the picture, or nothing and a failure.
    std::string draw(const std::string& more) const {
        const ScratchFolder folder;
        const Outcome outcome =
            run(folder.path(), words("render -o p.png " + std::string(GetParam().arguments) + " " + more));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(folder.names(), std::vector<std::string>{"p.png"});
        return content(folder / "p.png");
    }
};

TEST_P(Determinism, SameArgumentsSameBytes) {
    const auto ways = ways_in();
    if (ways.empty()) GTEST_SKIP() << "no usable OpenGL";
    const std::string first = draw("--threads 1 --backend " + ways.front());
    ASSERT_GT(first.size(), 1000u);
    EXPECT_TRUE(draw("--threads 1 --backend " + ways.front()) == first) << "a second time";
    // Other drivers than one library's software renderer need not agree with each other.
    for (std::size_t i = 0; i < ways.size(); ++i)
        EXPECT_TRUE(draw("--threads 2 --backend " + ways[i]) == first) << ways[i] << ", 2 threads";
}

INSTANTIATE_TEST_SUITE_P(Views, Determinism, testing::ValuesIn(views),
                         [](const auto& each) { return std::string(each.param.name); });

// A picture wider than a part is drawn in two. Beside the middle the same view in one part must show the same: no line
// at the parts' border, nothing shifted. Not the same bytes: the field of view is wider, and the mesh finer for it.
TEST(Parts, ShowOnePicture) {
    if (ways_in().empty()) GTEST_SKIP() << "no usable OpenGL";
    const ScratchFolder folder;
    const std::string view =
        "--at 37.58,-105.49 --range 60km --pitch -15 --fov 2 --time 2026-06-21T16:00:00Z "
        "--max-pixel-deviation 0.1 ";
    constexpr int more = 200;  // columns, half of them on each side
    ASSERT_EQ(run(folder.path(), words("render --size 2048x60 -o one.png " + view)).status, 0);
    ASSERT_EQ(run(folder.path(), words("render --size 2248x60 -o two.png " + view)).status, 0);
    const planet::Image one = planet::read_image(folder / "one.png"), two = planet::read_image(folder / "two.png");
    ASSERT_EQ(two.width, one.width + more);
    planet::Image cut{one.width, one.height, 3, {}};
    for (int y = 0; y < one.height; ++y)
        cut.pixels.insert(cut.pixels.end(), two.pixel(more / 2, y), two.pixel(more / 2 + one.width - 1, y) + 3);
    EXPECT_LT(compare(one, cut, 3).share(), 0.005);
    // The border itself, one column on each side, is no worse than the rest.
    std::size_t beyond = 0;
    for (int y = 0; y < one.height; ++y)
        for (const int x : {2031 - more / 2, 2032 - more / 2})
            for (int channel = 0; channel < 3; ++channel)
                beyond += std::abs(one.pixel(x, y)[channel] - cut.pixel(x, y)[channel]) > 8;
    EXPECT_LE(beyond, 1u);
}

}  // namespace
}  // namespace render
