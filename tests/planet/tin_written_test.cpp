// TINs as they are written: places, winding, deviations in every frame.

#include "planet/tin/written_tin.h"

#include <gtest/gtest.h>

#include "planet/elevation/raster_io.h"
#include "planet/mesh/surface_check.h"
#include "planet/patches/patch_mesh.h"
#include "planet/tin/make_tin.h"
#include "planet/tin/tin_mending.h"
#include "tin_rasters.h"

namespace planet {
namespace {

// 3 arc-seconds, rows southwards, at 37 degrees north.
std::shared_ptr<const Raster> geographic_raster(int width, int height) {
    auto raster = std::make_shared<Raster>();
    raster->name = "dem.tif";
    raster->width = width;
    raster->height = height;
    raster->crs = "EPSG:4326";
    raster->grid = {{-106, 37.5}, {1.0 / 1200, 0}, {0, -1.0 / 1200}};
    const HeightGrid heights = rough_grid(width, height);
    std::vector<float> samples;
    for (int y = 0; y < height; ++y) samples.insert(samples.end(), heights.row(y), heights.row(y) + width);
    raster->samples = samples;
    return raster;
}

RasterFrame frame_of(std::shared_ptr<const Raster> raster, MeshFrame frame) {
    return {std::move(raster), frame, VerticalDatum::ellipsoid, nullptr};
}

TEST(TinWritten, IsASurfaceInEveryFrame) {
    const auto raster = geographic_raster(120, 90);
    const HeightGrid grid(*raster);
    const TinMesh mesh = make_tin(grid, {.tolerance = 20}).mesh;
    for (const MeshFrame kind : {MeshFrame::source, MeshFrame::utm, MeshFrame::enu, MeshFrame::ecef}) {
        const RasterFrame frame = frame_of(raster, kind);
        SurfaceMesh surface = surface_from_tin(mesh, grid, frame);
        append_strips(surface.triangles, surface.strip);
        const SurfaceCheck c = check(surface, kind);
        EXPECT_TRUE(c.ok()) << c.summary();
        EXPECT_EQ(c.euler(), 1);
    }
}

TEST(TinWritten, DeviationsAreThoseOfTheLatticeInTheSource) {
    const auto raster = geographic_raster(120, 90);
    const HeightGrid grid(*raster);
    const RasterFrame frame = frame_of(raster, MeshFrame::source);
    for (const double tolerance : {0.0, 5.0, 40.0, 1e5}) {
        const TinMesh mesh = make_tin(grid, {.tolerance = tolerance}).mesh;
        const SurfaceMesh surface = surface_from_tin(mesh, grid, frame);
        const WrittenDeviation d = measure_written(mesh, surface.vertices, grid, frame, {.above = -1});
        EXPECT_NEAR(d.max, brute_deviation(mesh, grid).max, 1e-6);
        EXPECT_EQ(d.samples, grid.count()) << "each counts once";
        EXPECT_EQ(d.uncovered, 0u);
        ASSERT_EQ(d.too_far.size(), mesh.triangles.size());
        EXPECT_EQ(std::ranges::max(d.too_far, {}, &FarTriangle::deviation).deviation, d.max);
        EXPECT_GT(d.angle_min, 0);
        EXPECT_LT(d.angle_min, 61 * degrees);
        EXPECT_EQ(measure_written(mesh, surface.vertices, grid, frame, {.threads = 1}).rms, d.rms)
            << "whatever the threads";
        double squares = 0;
        for (int y = 0; y < 90; ++y)
            for (int x = 0; x < 120; ++x) {  // by the first triangle that holds it
                for (const auto& t : mesh.triangles) {
                    const glm::ivec2 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]], p(x, y);
                    const auto u = static_cast<double>(orientation(b, c, p)),
                               v = static_cast<double>(orientation(c, a, p)),
                               w = static_cast<double>(orientation(a, b, p));
                    if (u < 0 || v < 0 || w < 0) continue;
                    const auto h = [&](glm::ivec2 q) { return static_cast<double>(grid.at(q)); };
                    const double off = (u * h(a) + v * h(b) + w * h(c)) / (u + v + w) - h(p);
                    squares += off * off;
                    break;
                }
            }
        EXPECT_NEAR(d.rms, std::sqrt(squares / static_cast<double>(grid.count())), 1e-6);
    }
}

TEST(TinWritten, CountsWhatVoidsLeave) {
    const auto raster = geographic_raster(60, 50);
    HeightGrid grid(*raster);
    for (int y = 10; y < 30; ++y)
        for (int x = 20; x < 33 + y % 4; ++x) grid.set({x, y}, std::nanf(""));
    const TinMesh mesh = make_tin(grid, {.tolerance = 10}).mesh;
    const RasterFrame frame = frame_of(raster, MeshFrame::source);
    const WrittenDeviation d = measure_written(mesh, surface_from_tin(mesh, grid, frame).vertices, grid, frame);
    EXPECT_EQ(d.samples + d.uncovered, grid.valid_samples());
    EXPECT_EQ(d.uncovered, brute_deviation(mesh, grid).uncovered);
    EXPECT_LE(d.max, 10 + 1e-9);
}

TEST(TinWritten, NoticesWhatRoundingDoes) {
    const auto raster = geographic_raster(60, 50);
    const HeightGrid grid(*raster);
    const RasterFrame frame = frame_of(raster, MeshFrame::source);
    const TinMesh mesh = make_tin(grid, {.tolerance = 10}).mesh;
    SurfaceMesh surface = surface_from_tin(mesh, grid, frame);
    surface.vertices[surface.vertices.size() / 2].z += 25;
    const WrittenDeviation d = measure_written(mesh, surface.vertices, grid, frame);
    EXPECT_GE(d.max, 25 - 1e-9) << "at the vertex itself, at least";
    EXPECT_LE(d.max, 35 + 1e-9);
}

// A sea of 200 x 200 km: flat in its CRS, 3 m or more above its chord.
TEST(TinWritten, CurvedFramesAreMetByHeightsAboveThePlane) {
    auto flat = std::make_shared<Raster>();
    flat->name = "sea.tif";
    flat->width = flat->height = 160;
    flat->crs = "EPSG:4326";
    flat->grid = {{5, 1}, {1.0 / 80, 0}, {0, -1.0 / 80}};
    flat->samples = std::vector<float>(160 * 160, 0.0f);
    const HeightGrid grid(*flat);
    const RasterFrame enu = frame_of(flat, MeshFrame::enu), ecef = frame_of(flat, MeshFrame::ecef);
    const TinMesh flat_mesh = make_tin(grid, {.tolerance = 3}).mesh;
    EXPECT_GT(measure_written(flat_mesh, surface_from_tin(flat_mesh, grid, ecef).vertices, grid, ecef).max, 100);
    const TinMesh mesh = make_tin(heights_above_tangent_plane(grid, enu), {.tolerance = 3}).mesh;
    for (const RasterFrame* frame : {&enu, &ecef}) {
        SurfaceMesh surface = surface_from_tin(mesh, grid, *frame);
        append_strips(surface.triangles, surface.strip);
        const WrittenDeviation d = measure_written(mesh, surface.vertices, grid, *frame);
        EXPECT_LE(d.max, 3.1);
        EXPECT_EQ(d.samples, grid.count());
        EXPECT_TRUE(check(surface, frame->reference().frame).ok());
    }
}

// Measured again where it has changed: what measuring all of it says, to the bit.
TEST(TinWritten, IsMeasuredAgainWhereItHasChanged) {
    const auto raster = geographic_raster(300, 280);
    const HeightGrid whole(*raster);
    HeightGrid pierced(whole);
    for (int y = 100; y < 130; ++y)
        for (int x = 90; x < 120 + y % 5; ++x) pierced.set({x, y}, std::nanf(""));
    const RasterFrame frame = frame_of(raster, MeshFrame::enu);
    for (const HeightGrid* const grid : {&whole, &std::as_const(pierced)}) {
        TinMesh mesh = make_tin(*grid, {.tolerance = 6}).mesh;
        ASSERT_GT(mesh.triangles.size(), 3 * 4096u) << "several pieces";
        WrittenMeasure measure(*grid, frame, {.above = 5, .by_sample = true});
        measure.measure(mesh, surface_from_tin(mesh, *grid, frame).vertices);
        const std::vector<FarTriangle> due = measure.found().too_far;
        ASSERT_GT(due.size(), 10u);
        std::vector<FarTriangle> some;
        std::ranges::copy_if(due, std::back_inserter(some),
                             [](const FarTriangle& far) { return far.triangle % 7 == 0; });
        const MendedTin mended = mend(mesh, *grid, some);
        const SurfaceMesh surface = surface_from_tin(mesh, *grid, frame);
        measure.measure_again(mesh, surface.vertices, mended.changed);
        const WrittenDeviation all = measure_written(mesh, surface.vertices, *grid, frame, {.above = 5}),
                               again = measure.take();
        EXPECT_EQ(again.max, all.max);
        EXPECT_EQ(again.rms, all.rms);
        EXPECT_EQ(again.samples, all.samples);
        EXPECT_EQ(again.uncovered, all.uncovered);
        EXPECT_EQ(again.angle_min, all.angle_min);
        ASSERT_EQ(again.too_far.size(), all.too_far.size());
        EXPECT_LT(again.too_far.size(), due.size());
        for (std::size_t i = 0; i < all.too_far.size(); ++i) {
            EXPECT_EQ(again.too_far[i].triangle, all.too_far[i].triangle);
            EXPECT_EQ(again.too_far[i].sample, all.too_far[i].sample);
        }
    }
}

TEST(TinWritten, TellsOfEverySample) {
    const auto raster = geographic_raster(60, 50);
    HeightGrid grid(*raster);
    for (int x = 20; x < 33; ++x) grid.set({x, 17}, std::nanf(""));
    const TinMesh mesh = make_tin(grid, {.tolerance = 10}).mesh;
    const RasterFrame frame = frame_of(raster, MeshFrame::source);
    const WrittenDeviation d =
        measure_written(mesh, surface_from_tin(mesh, grid, frame).vertices, grid, frame, {.by_sample = true});
    ASSERT_EQ(d.by_sample.size(), grid.count());
    float most = 0;
    std::size_t known = 0;
    for (const float off : d.by_sample) {
        if (std::isnan(off)) continue;
        ++known;
        most = std::max(most, off);
    }
    EXPECT_EQ(known, d.samples);
    EXPECT_NEAR(static_cast<double>(most), d.max, 1e-6);
    EXPECT_TRUE(measure_written(mesh, surface_from_tin(mesh, grid, frame).vertices, grid, frame).by_sample.empty());
}

// The frame of a window: the same places, to the bit.
TEST(TinWritten, WindowsLieWhereTheyWere) {
    const auto raster = geographic_raster(60, 50);
    const HeightGrid grid(*raster), part(grid, {13, 7}, {40, 33});
    const TinMesh mesh = make_tin(part, {.tolerance = 10}).mesh;
    TinMesh moved = mesh;
    for (glm::ivec2& p : moved.vertices) p += glm::ivec2(13, 7);
    for (const MeshFrame kind : {MeshFrame::source, MeshFrame::utm, MeshFrame::enu, MeshFrame::ecef}) {
        const RasterFrame frame = frame_of(raster, kind), window = frame.window({13, 7});
        const SurfaceMesh here = surface_from_tin(mesh, part, window), there = surface_from_tin(moved, grid, frame);
        EXPECT_EQ(here.vertices, there.vertices);
        const WrittenDeviation d = measure_written(mesh, here.vertices, part, window),
                               e = measure_written(moved, there.vertices, grid, frame);
        EXPECT_NEAR(d.max, e.max, 1e-6);
        EXPECT_LE(d.max, 10.01);
    }
}

TEST(TinWritten, ExaggeratedDeviationsAreMetresOfHeight) {
    const auto raster = geographic_raster(60, 50);
    const HeightGrid grid(*raster);
    const TinMesh mesh = make_tin(grid, {.tolerance = 10}).mesh;
    for (const MeshFrame kind : {MeshFrame::source, MeshFrame::utm}) {
        const RasterFrame plain = frame_of(raster, kind), tall(raster, kind, VerticalDatum::ellipsoid, nullptr, 4);
        const SurfaceMesh low = surface_from_tin(mesh, grid, plain), high = surface_from_tin(mesh, grid, tall);
        EXPECT_EQ(4 * low.vertices[9].z, high.vertices[9].z);
        EXPECT_NEAR(measure_written(mesh, low.vertices, grid, plain).max,
                    measure_written(mesh, high.vertices, grid, tall).max, 1e-6);
    }
}

}  // namespace
}  // namespace planet
