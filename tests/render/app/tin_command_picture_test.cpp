// octaglobe tin --metric gpu, --picture and --stages.

#include <nlohmann/json.hpp>

#include "planet/elevation/image_io.h"
#include "render/app/tin/tin_written.h"
#include "tests/render/app/tin_program.h"

namespace render {
namespace {

class TinPictureCommand : public TinCommandTest {
  protected:
    void SetUp() override { hilly_terrain().write(folder_ / "dem.vrt"); }
};

TEST_F(TinPictureCommand, DrawsStepsOfAnyMetric) {
    for (const char* metric : {"local", "rms"}) {
        const Json report =
            tin("dem.vrt --max-triangles 200 --metric " + std::string(metric) + " --picture steps.png --stages 20,100");
        EXPECT_EQ(report.at("picture"), "steps.png");
        const planet::Image image = planet::read_image((folder_ / "steps.png").string());
        EXPECT_GT(image.width, 500);
        EXPECT_GT(image.height, 300);
    }
}

TEST_F(TinPictureCommand, TheGpuMeasureKeepsTheBoundAndSaysItsStep) {
    const Outcome there =
        run(folder_.path(), words("tin dem.vrt --max-deviation 20 --metric gpu -o drawn.ply --json g.json"));
    if (there.status == 4) GTEST_SKIP() << there.err;
    ASSERT_EQ(there.status, 0) << there.err;
    const Json drawn = Json::parse(content(folder_ / "g.json"));
    EXPECT_LE(number(drawn, "deviation_max_m"), 20);
    EXPECT_GT(number(drawn, "depth_step_m"), 0);
    const Json local = tin("dem.vrt --max-deviation 20 --metric local --locate cells -o local.ply");
    EXPECT_NEAR(number(drawn, "triangles"), number(local, "triangles"), 0.05 * number(local, "triangles"));
}

TEST_F(TinPictureCommand, WithoutOpenGlTheGpuMeasureIsRefusedAndNothingElse) {
    const ScratchVariable egl("OCTAGLOBE_EGL_LIBRARY", "/nowhere/libEGL.so"),
        osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nowhere/libOSMesa.so");
    const Outcome refused = run(folder_.path(), words("tin dem.vrt --max-deviation 20 --metric gpu -o drawn.ply"));
    EXPECT_EQ(refused.status, 4);
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "drawn.ply"));
    tin("dem.vrt --max-deviation 20 --picture steps.png --stages 20");
}

TEST_F(TinPictureCommand, RefusesWhatItCannotDraw) {
    for (const char* arguments :
         {"--picture steps.gif", "--picture steps.png --stages 2", "--picture steps.png --stages 50,",
          "--picture steps.png --stages fifty", "--stages 50", "--picture steps.png --tile 16 -o tiles",
          "--picture steps.png --stages 4000000", "--picture missing/steps.png"}) {
        const Outcome refused = run(folder_.path(), words("tin dem.vrt --max-deviation 20 " + std::string(arguments)));
        EXPECT_EQ(refused.status, 2) << arguments;
        EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "steps.png")) << arguments;
    }
}

}  // namespace
}  // namespace render
