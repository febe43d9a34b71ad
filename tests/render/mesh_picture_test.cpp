// Pictures of small meshes whose every triangle, side and gate is known.
#include "render/picture/mesh_picture.h"

#include "small_meshes.h"

namespace render {
namespace {

using namespace testing;

TEST_F(MeshPictures, CoverThePlotAndNothingElse) {
    const Mesh mesh = Bisection::adaptive();
    for (const int size : {64, 256, 2100}) {  // the last takes four parts
        MeshPicture picture = mesh.picture(size);
        const planet::Image image = draw_mesh_picture(picture);
        ASSERT_EQ(image.pixels.size(), static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 3);
        picture.curve = false;  // its casing is white
        const planet::Image plain = draw_mesh_picture(picture);
        const MeshView view = make_mesh_view(picture);
        const glm::vec3 low = view.place({0, 0, 0}), high = view.place({64, 64, 0});
        const int legend = has_legend(picture) ? static_cast<int>(view.plot.bottom) + 4 : size;
        int holes = 0, strays = 0;
        for (int y = 0; y < legend; ++y)
            for (int x = 0; x < size; ++x) {
                const float inside =
                    std::min(std::min(static_cast<float>(x) + 0.5f - low.x, high.x - static_cast<float>(x) - 0.5f),
                             std::min(static_cast<float>(y) + 0.5f - high.y, low.y - static_cast<float>(y) - 0.5f));
                const bool white = pixel(plain, x, y) == figure_color::paper;
                holes += white && inside > 0;
                strays += !white && inside < -3;
            }
        EXPECT_EQ(holes, 0) << size;
        EXPECT_EQ(strays, 0) << size;
    }
}

TEST_F(MeshPictures, ShowEveryLevelInItsColour) {
    const Mesh mesh = Bisection::adaptive();
    MeshPicture picture = mesh.picture(800);
    picture.curve = false;
    const planet::Image image = draw_mesh_picture(picture);
    const MeshColors colors(picture);
    EXPECT_EQ(colors.first(), 2);
    EXPECT_EQ(colors.last(), 6);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        EXPECT_EQ(pixel(image, picture, mesh.middle(t)), colors.of(mesh.level[t])) << t;
}

TEST_F(MeshPictures, ShowSidesUnlessTrianglesAreTiny) {
    const Mesh coarse = Bisection::uniform(4), fine = Bisection::uniform(12);
    MeshPicture picture = coarse.picture(256);
    picture.curve = false;
    const planet::Image sides = draw_mesh_picture(picture);
    const Color fill = MeshColors(picture).of(4);
    for (const auto& [a, b, c] : coarse.triangles)
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {
            const dvec3 m = 0.5 * (coarse.vertices[p] + coarse.vertices[q]);
            EXPECT_LT(luminance(pixel(sides, picture, m)), 0.6 * luminance(fill)) << m.x << " " << m.y;
        }
    picture = fine.picture(128);  // legs of 1.7 pixels
    const planet::Image map = draw_mesh_picture(picture);
    const Color plain = MeshColors(picture).of(12);
    const MeshView view = make_mesh_view(picture);
    for (int y = static_cast<int>(view.plot.top) + 3; y < static_cast<int>(view.plot.bottom) - 3; ++y)
        for (int x = static_cast<int>(view.plot.left) + 3; x < static_cast<int>(view.plot.right) - 3; ++x)
            ASSERT_EQ(pixel(map, x, y), plain) << x << " " << y;
}

TEST_F(MeshPictures, RunTheCurveThroughSharedSides) {
    const Mesh mesh = Bisection::uniform(4);
    const MeshPicture picture = mesh.picture(600);
    const planet::Image image = draw_mesh_picture(picture);
    int gates = 0;
    for (std::size_t t = 0; t + 1 < mesh.triangles.size(); ++t) {
        std::vector<dvec3> shared;
        for (const std::uint32_t v : mesh.triangles[t])
            for (const std::uint32_t w : mesh.triangles[t + 1])
                if (v == w) shared.push_back(mesh.vertices[v]);
        ASSERT_EQ(shared.size(), 2u);
        const Color c = pixel(image, picture, 0.5 * (shared[0] + shared[1]));
        EXPECT_TRUE(reddish(c)) << t;
        ++gates;
    }
    EXPECT_EQ(gates, 31);
}

TEST_F(MeshPictures, BreakTheCurveWhereNoSideIsShared) {
    Mesh mesh = Bisection::uniform(4);
    // Every other triangle first: the next is never a neighbour by a side.
    Mesh apart{mesh.vertices, {}, mesh.level};
    for (std::size_t first : {0u, 1u})
        for (std::size_t t = first; t < mesh.triangles.size(); t += 2) apart.triangles.push_back(mesh.triangles[t]);
    EXPECT_GT(count(draw_mesh_picture(mesh.picture(600)), reddish), 2000);
    EXPECT_EQ(count(draw_mesh_picture(apart.picture(600)), reddish), 0);  // none in the legend either
}

TEST_F(MeshPictures, MarkRemovedVertices) {
    const Mesh mesh = Bisection::uniform(4);
    std::vector<std::uint8_t> step(mesh.triangles.size(), 0);
    step[5] = 1;
    step[6] = 2;
    const std::vector<dvec3> marks = {{32, 32, 0}, {16, 16, 0}};
    MeshPicture picture = mesh.picture(600);
    picture.step = step;
    picture.marks = marks;
    picture.curve = false;
    const planet::Image image = draw_mesh_picture(picture);
    const MeshColors colors(picture);
    EXPECT_EQ(colors.first(), 1);
    EXPECT_EQ(colors.last(), 2);
    EXPECT_EQ(pixel(image, picture, mesh.middle(5)), with_alpha(colors.of(1), 1));
    EXPECT_EQ(pixel(image, picture, mesh.middle(6)), with_alpha(colors.of(2), 1));
    EXPECT_EQ(pixel(image, picture, mesh.middle(20)), with_alpha(colors.of(0), 1));
    EXPECT_EQ(pixel(image, picture, marks[0]), figure_color::ink);
    EXPECT_EQ(pixel(image, picture, marks[1]), figure_color::paper);
    const MeshView view = make_mesh_view(picture);
    const glm::vec3 ring = view.place(marks[1]) + glm::vec3(-0.5, 3.2 * view.line_unit, 0);
    EXPECT_LT(luminance(pixel(image, static_cast<int>(ring.x), static_cast<int>(ring.y))), 0.15);
}

TEST_F(MeshPictures, KeepTheProportionOfUnits) {
    const Mesh mesh = Bisection::uniform(2);
    MeshPicture picture = mesh.picture(300);
    picture.metres_per_unit = {1, 2};
    const MeshView view = make_mesh_view(picture);
    const glm::vec3 size = view.place({64, 0, 0}) - view.place({0, 64, 0});
    EXPECT_NEAR(size.y, 2 * size.x, 1e-3);
    EXPECT_NEAR(size.y, view.plot.bottom - view.plot.top, 1e-3);
    EXPECT_LT(view.place({0, 64, 0}).y, view.place({0, 0, 0}).y) << "y is up";
    const planet::Image image = draw_mesh_picture(picture);
    EXPECT_EQ(pixel(image, 40, 150), figure_color::paper);
    EXPECT_NE(pixel(image, 151, 30), figure_color::paper);
}

TEST_F(MeshPictures, AreTheSameForLargeCoordinates) {
    const Mesh mesh = Bisection::adaptive();
    Mesh far = mesh;
    for (dvec3& v : far.vertices) v = v / 4096.0 + dvec3(499'712, 4'194'304, 1000);
    EXPECT_EQ(draw_mesh_picture(mesh.picture(400)).pixels, draw_mesh_picture(far.picture(400)).pixels);
}

TEST_F(MeshPictures, AreTheSameBytesAgain) {
    const Mesh globe = planet_mesh(8);
    MeshPicture picture = globe.picture(500);
    picture.planet = true;
    picture.relief = true;
    const planet::Image first = draw_mesh_picture(picture);
    EXPECT_EQ(first.pixels, draw_mesh_picture(picture).pixels);
    context_.emplace(Context::create());
    EXPECT_EQ(first.pixels, draw_mesh_picture(picture).pixels);
}

}  // namespace
}  // namespace render
