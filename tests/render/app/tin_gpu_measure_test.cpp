// The gpu measure as the program asks for it.
#include "render/app/tin/tin_gpu_measure.h"

#include <gtest/gtest.h>

#include "planet/error.h"
#include "planet/tin/make_tin.h"
#include "tests/planet/tin_rasters.h"
#include "tests/render/app/scratch_folder.h"

namespace render {
namespace {

TEST(GpuMeasure, MakesATinThatKeepsItsTolerance) {
    const planet::HeightGrid grid = planet::fractional_grid(150, 110);
    std::unique_ptr<GpuMeasure> measure;
    try {
        measure = make_gpu_measure(grid);
    } catch (const planet::Error& error) {
        GTEST_SKIP() << error.what();
    }
    EXPECT_GT(measure->depth_step(), 0);
    EXPECT_LT(measure->depth_step(), 0.001);
    for (const auto quality : {planet::TinQuality::fast, planet::TinQuality::best}) {
        planet::TinOptions options;
        options.tolerance = 15;
        options.quality = quality;
        options.measure = measure.get();
        const planet::TinMesh drawn = make_tin(grid, options).mesh;
        const planet::BruteDeviation deviation = planet::brute_deviation(drawn, grid);
        EXPECT_LE(deviation.max, 15);
        EXPECT_EQ(deviation.uncovered, 0u);
        EXPECT_TRUE(planet::sound(drawn));
        options.measure = nullptr;
        options.features.points = {{0, 0}};  // not in tiles
        const double local = static_cast<double>(make_tin(grid, options).mesh.triangles.size());
        EXPECT_NEAR(static_cast<double>(drawn.triangles.size()), local, 0.05 * local);
    }
}

TEST(GpuMeasure, WithoutOpenGlSaysSoInOneLine) {
    const ScratchVariable egl("OCTAGLOBE_EGL_LIBRARY", "/nowhere/libEGL.so"),
        osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nowhere/libOSMesa.so");
    try {
        make_gpu_measure(planet::rough_grid(20, 20));
        FAIL();
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), planet::Fault::no_graphics);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("/nowhere"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace render
