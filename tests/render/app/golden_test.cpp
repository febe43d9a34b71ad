// Golden pictures: what the program draws is what it drew when somebody last looked at it.
//
//     OCTAGLOBE_RENEW_GOLDEN=1 ctest --test-dir BUILD -R Golden      draws them anew: look at them before you commit
//
// Another processor or driver may round differently: 3/255 on 0.5 % of the pixels is allowed. When a test fails, the
// picture that was drawn and the difference (eight times as bright) are written to files, whose names are in its
// message.

#include <gtest/gtest.h>

#include <ostream>

#include "planet/elevation/image_io.h"
#include "render/gl/context.h"
#include "tests/render/app/picture_difference.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

namespace fs = std::filesystem;

constexpr int tolerance = 3;
constexpr double tolerated_share = 0.005;

struct GoldenPicture {
    const char* name;
    const char* arguments;
};
void PrintTo(const GoldenPicture& picture, std::ostream* out) {
    *out << picture.arguments;
}

constexpr GoldenPicture golden_pictures[] = {
    {"globe_day", ""},
    {"globe_terminator", "--at 25,45 --range 18000km --time 2026-03-20T15:00:00Z"},
    {"blanca_60km", "--at 37.58,-105.49 --range 60km --heading 30 --pitch -25 --time 2026-06-21T16:00:00Z"},
    {"blanca_5km", "--at 37.58,-105.49 --range 5km --heading 60 --pitch -12 --time 2026-06-21T16:00:00Z"},
    {"pole", "--at 90,0 --range 3000km --time 2026-06-21T09:00:00Z"},
    {"dusk", "--at 37.58,-105.49 --range 30km --heading 290 --pitch -6 --time 2026-06-22T02:10:00Z"},
    {"mesh",
     "--at 37.58,-105.49 --range 30km --pitch -40 --exaggeration 2 --show mesh,levels --max-pixel-deviation 4"
     " --time 2026-06-21T16:00:00Z"},
    {"layers",
     "--at 37.56,-105.47 --range 12km --heading 20 --pitch -22 --time 2026-06-21T15:00:00Z "
     "--layer " OCTAGLOBE_SOURCE_DIR "/tests/golden/layers.geojson,width=3"},
    {"relief", "--at 40,60 --range 9000km --time 2026-06-21T08:00:00Z --show relief,coastlines,borders"},
};

bool renewing() {
    const char* wanted = std::getenv("OCTAGLOBE_RENEW_GOLDEN");
    return wanted && std::string_view(wanted) == "1";
}

bool graphics() {
    for (const auto& way : probe_backends())
        if (way.available) return true;
    return false;
}

class Golden : public testing::TestWithParam<GoldenPicture> {};

TEST_P(Golden, LooksAsItDid) {
    if (!graphics()) GTEST_SKIP() << "no usable OpenGL";
    const fs::path golden = fs::path(OCTAGLOBE_SOURCE_DIR "/tests/golden") / (GetParam().name + std::string(".png"));
    const ScratchFolder folder;
    const fs::path drawn = folder / "drawn.png";
    const Outcome outcome =
        run(folder.path(), words("render --size 480x270 -o drawn.png " + std::string(GetParam().arguments)));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    if (renewing()) {
        fs::create_directories(golden.parent_path());
        fs::copy_file(drawn, golden, fs::copy_options::overwrite_existing);
        return;
    }
    ASSERT_TRUE(fs::exists(golden)) << golden << " is missing: OCTAGLOBE_RENEW_GOLDEN=1 makes it";
    const PictureDifference d = compare(planet::read_image(drawn), planet::read_image(golden), tolerance);
    if (d.share() <= tolerated_share) return;

    const fs::path failed = OCTAGLOBE_FAILED_PICTURES, name = GetParam().name;
    fs::create_directories(failed);
    const fs::path kept = failed / (name.native() + ".png"), difference = failed / (name.native() + "_difference.png");
    fs::copy_file(drawn, kept, fs::copy_options::overwrite_existing);
    if (d.pixels > 0) planet::write_image(difference, d.image);
    ADD_FAILURE() << 100 * d.share() << " % of the pixels differ by more than " << tolerance << "/255, the worst by "
                  << d.worst << "\n  golden      " << golden.native() << "\n  drawn       " << kept.native()
                  << "\n  difference  " << difference.native();
}

INSTANTIATE_TEST_SUITE_P(Pictures, Golden, testing::ValuesIn(golden_pictures),
                         [](const auto& each) { return std::string(each.param.name); });

// The measure itself: it must see what golden pictures are there to catch, and let pass what they are to tolerate.
TEST(PictureDifference, CountsPixelsBeyondTheTolerance) {
    const planet::Image flat{200, 100, 3, std::vector<std::uint8_t>(60000, 100)};
    planet::Image other = flat;
    EXPECT_EQ(compare(flat, other, tolerance).share(), 0);
    for (std::size_t i = 0; i < other.pixels.size(); i += 3) other.pixels[i] = 103;
    EXPECT_EQ(compare(flat, other, tolerance).share(), 0);
    for (std::size_t pixel = 0; pixel < 101; ++pixel) other.pixels[pixel * 3 + pixel % 3] = 96;
    const PictureDifference d = compare(flat, other, tolerance);
    EXPECT_EQ(d.beyond, 101u);
    EXPECT_EQ(d.worst, 4);
    EXPECT_GT(d.share(), tolerated_share);
    EXPECT_EQ(d.image.pixel(0, 0)[0], 32);
    EXPECT_EQ(compare(flat, {100, 200, 3, flat.pixels}, tolerance).share(), 1);
}

}  // namespace
}  // namespace render
