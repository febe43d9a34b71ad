// The check of surfaces finds what is wrong with one.

#include "planet/mesh/surface_check.h"

#include <gtest/gtest.h>

namespace planet {
namespace {

// Two triangles over a square.
SurfaceMesh square() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 5}}, {{0, 1, 2}, {2, 1, 3}}, {0, 0}, {0, 1, 2, 3}};
}

TEST(SurfaceCheck, SoundOpenSurface) {
    const SurfaceCheck c = check(square(), MeshFrame::source);
    EXPECT_TRUE(c.ok());
    EXPECT_EQ(c.summary(), "sound, 4 border sides, V - E + F = 1");
    EXPECT_EQ(c.border_sides, 4u);
    EXPECT_EQ(c.euler(), 1);
    EXPECT_FALSE(c.closed());
}

TEST(SurfaceCheck, ClosedSurface) {
    const SurfaceMesh mesh{{{1, 0, -1}, {-1, 1, -1}, {-1, -1, -1}, {0, 0, 2}},
                           {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                           {0, 0, 0, 0},
                           {0, 2, 1, strip_restart, 0, 1, 3, strip_restart, 1, 2, 3, strip_restart, 2, 0, 3}};
    EXPECT_TRUE(check(mesh, MeshFrame::ecef).closed()) << check(mesh, MeshFrame::ecef).summary();
}

TEST(SurfaceCheck, NamesEachFault) {
    const auto summary = [](auto change) {
        SurfaceMesh mesh = square();
        change(mesh);
        return check(mesh, MeshFrame::source).summary();
    };
    EXPECT_EQ(summary([](SurfaceMesh& m) { m.vertices.push_back({7, 7, 7}); }), "1 unused vertices");
    EXPECT_EQ(summary([](SurfaceMesh& m) { m.strip = {0, 1, 2}; }), "strips differ");
    EXPECT_EQ(summary([](SurfaceMesh& m) { m.strip = {0, 2, 1, 3}; }), "strips differ");
    EXPECT_NE(summary([](SurfaceMesh& m) {
                  m.triangles[1] = {1, 2, 3};
              }).find("1 wrong sides, 1 turned"),
              std::string::npos);
    EXPECT_NE(summary([](SurfaceMesh& m) { m.triangles[1] = {2, 2, 3}; }).find("degenerate"), std::string::npos);
    EXPECT_NE(summary([](SurfaceMesh& m) { m.vertices[3] = m.vertices[1]; }).find("1 doubled"), std::string::npos);
    EXPECT_NE(summary([](SurfaceMesh& m) { m.triangles.push_back({0, 1, 3}); }).find("wrong sides"), std::string::npos);
}

}  // namespace
}  // namespace planet
