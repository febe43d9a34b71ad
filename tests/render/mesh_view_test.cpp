// Pictures of meshes from elsewhere: planets, windows, slopes, legends; and what cannot be drawn.

#include <limits>
#include <string>

#include "render/picture/stroke_text.h"
#include "small_meshes.h"

namespace render {
namespace {

using namespace testing;

TEST_F(MeshPictures, HideTheBackOfAPlanet) {
    Mesh globe = planet_mesh(7);
    const dvec3 look_from(0.3, -1, 0.4);
    const auto picture_of = [&](std::uint8_t behind, const std::vector<dvec3>& marks, const dvec3& from) {
        for (std::size_t t = 0; t < globe.triangles.size(); ++t) {
            const auto& [a, b, c] = globe.triangles[t];
            const dvec3 out = glm::cross(globe.vertices[b] - globe.vertices[a], globe.vertices[c] - globe.vertices[a]);
            globe.level[t] = glm::dot(out, look_from) > 0 ? static_cast<std::uint8_t>(t % 2) : behind;
        }
        MeshPicture picture = globe.picture(300);
        picture.planet = true;
        picture.look_from = from;
        picture.marks = marks;
        return draw_mesh_picture(picture).pixels;
    };
    const dvec3 near = 6.371e6 * glm::normalize(look_from);
    const auto front = picture_of(0, {}, look_from);
    EXPECT_EQ(front, picture_of(1, {}, look_from));
    EXPECT_EQ(front, picture_of(1, {-near}, look_from));
    EXPECT_NE(front, picture_of(1, {near}, look_from));
    EXPECT_NE(picture_of(0, {}, -look_from), picture_of(1, {}, -look_from));
}

TEST_F(MeshPictures, ShowAPlanetAsADiscWithNorthUp) {
    Mesh globe = planet_mesh(10);
    for (std::size_t t = 0; t < globe.triangles.size(); ++t) globe.level[t] = globe.middle(t).z > 0 ? 0 : 6;
    MeshPicture picture = globe.picture(300);
    picture.planet = true;
    picture.curve = false;
    const planet::Image image = draw_mesh_picture(picture);
    const Color north = pixel(image, 150, 80), south = pixel(image, 150, 220);
    EXPECT_GT(north.green, north.blue);
    EXPECT_GT(south.blue, south.green);
    EXPECT_EQ(pixel(image, 40, 40), figure_color::paper);
    EXPECT_EQ(pixel(image, 260, 260), figure_color::paper);
    for (const double z : {1.0, -1.0}) {
        picture.look_from = {0, 0, z};
        EXPECT_NE(pixel(draw_mesh_picture(picture), 150, 150), figure_color::paper);
    }
}

TEST_F(MeshPictures, ShowAWindow) {
    const Mesh mesh = Bisection::uniform(6);
    std::vector<std::uint8_t> step(mesh.triangles.size(), 0);
    for (std::size_t t = 0; t < step.size(); ++t) {
        const dvec3 m = mesh.middle(t);
        step[t] = std::max(std::abs(m.x - 48), std::abs(m.y - 48)) < 8 ? 1 : 0;
    }
    MeshPicture picture = mesh.picture(400);
    EXPECT_FALSE(merging_window(picture));
    picture.step = step;
    picture.curve = false;
    picture.window = merging_window(picture);
    ASSERT_TRUE(picture.window);
    EXPECT_EQ(dvec2(picture.window->center), dvec2(48, 48));
    EXPECT_EQ(picture.window->radius, 10);
    const planet::Image image = draw_mesh_picture(picture);
    const MeshView view = make_mesh_view(picture);
    const MeshColors colors(picture);
    EXPECT_EQ(view.place({48, 48, 0}), glm::vec3(view.middle, 0));
    const Color merged = with_alpha(colors.of(1), 1), stays = with_alpha(colors.of(0), 1);
    EXPECT_EQ(pixel(image, picture, {42, 41, 0}), merged);
    EXPECT_EQ(pixel(image, picture, {39, 48.7, 0}), stays);
    EXPECT_EQ(pixel(image, static_cast<int>(view.plot.left) - 5, 150), figure_color::paper);
    picture.width = picture.height = 100;  // framed without a legend too
    const MeshView small = make_mesh_view(picture);
    EXPECT_LT(luminance(pixel(draw_mesh_picture(picture), static_cast<int>(small.plot.left), 40)), 0.5);
}

TEST_F(MeshPictures, ShadeSlopes) {
    Mesh mesh = Bisection::uniform(8);
    for (dvec3& v : mesh.vertices) v.z = 10 - std::abs(v.x - 32);  // a roof whose ridge runs north
    MeshPicture picture = mesh.picture(256);
    picture.curve = false;
    picture.relief = true;
    const planet::Image image = draw_mesh_picture(picture);
    const double west = luminance(pixel(image, picture, {14.8, 30.5, 0}));
    const double east = luminance(pixel(image, picture, {50.8, 30.5, 0}));
    EXPECT_GT(west, 1.3 * east);
    for (dvec3& v : mesh.vertices) v.z = 7;
    picture.relief = false;
    const planet::Image flat = draw_mesh_picture(picture);
    picture.relief = true;
    EXPECT_EQ(flat.pixels, draw_mesh_picture(picture).pixels);
}

TEST_F(MeshPictures, HaveALegendThatFits) {
    const Mesh mesh = Bisection::uniform(6);
    std::vector<std::uint8_t> levels(mesh.level.size());
    for (std::size_t t = 0; t < levels.size(); ++t) levels[t] = static_cast<std::uint8_t>(t % 60);
    const std::vector<dvec3> marks = {{32, 32, 0}, {16, 16, 0}};
    for (const auto& [width, height] : {std::pair{320, 320}, {330, 1000}, {1920, 400}, {900, 900}}) {
        MeshPicture picture = mesh.picture(0);
        picture.width = width;
        picture.height = height;
        picture.level = levels;
        picture.marks = marks;
        ASSERT_TRUE(has_legend(picture));
        const MeshView view = make_mesh_view(picture);
        const Legend legend = make_legend(picture, view, MeshColors(picture), true);
        EXPECT_EQ(legend.swatches.size(), 3 * 60u);
        for (const Stroke& s : legend.strokes)
            for (const glm::vec3& p : {s.a, s.b}) {
                EXPECT_GT(p.x, 0.9f * view.plot.left);
                EXPECT_LT(p.x, static_cast<float>(width) - 0.9f * view.plot.left);
                EXPECT_GT(p.y, view.plot.bottom);
                EXPECT_LT(p.y, static_cast<float>(height) - 2);
            }
    }
    EXPECT_FALSE(has_legend(mesh.picture(200)));
}

TEST(MeshStrokes, AreTheBorderOfAPlanAndTheHorizonOfAPlanet) {
    const Mesh square = Bisection::adaptive();
    MeshPicture picture = square.picture(256);
    picture.curve = false;
    double length = 0;
    for (const Stroke& s : mesh_strokes(picture, make_mesh_view(picture)).list) length += glm::distance(s.a, s.b);
    MeshView view = make_mesh_view(picture);
    EXPECT_NEAR(length, 4 * glm::distance(view.place({0, 0, 0}), view.place({64, 0, 0})), 0.01);

    const Mesh globe = planet_mesh(11);
    picture = globe.picture(256);
    picture.planet = true;
    picture.curve = false;
    picture.look_from = {0.2, 0.5, 0.3};
    view = make_mesh_view(picture);
    const double radius = 0.5 * (view.plot.right - view.plot.left);
    length = 0;
    for (const Stroke& s : mesh_strokes(picture, view).list) {
        EXPECT_NEAR(glm::distance(glm::dvec2(s.a), view.middle), radius, 0.01 * radius);
        length += glm::distance(glm::vec2(s.a), glm::vec2(s.b));
    }
    EXPECT_GT(length, 2 * 3.14 * radius);  // it goes around; some zigzags are seen from the side
    EXPECT_LT(length, 4 * 3.14 * radius);
}

std::string message(const MeshPicture& picture) {
    try {
        draw_mesh_picture(picture);
    } catch (const planet::Error& error) {
        return error.what();
    }
    return "";
}

TEST_F(MeshPictures, RefuseWhatCannotBeDrawn) {
    const Mesh mesh = Bisection::uniform(2);
    EXPECT_NE(message(mesh.picture(63)).find("63x63 pixels; accepted: 64x64 to 16384x16384"), std::string::npos);
    EXPECT_NE(message(mesh.picture(16385)), "");
    EXPECT_NE(message(Mesh{}.picture(256)).find("no triangles"), std::string::npos);
    Mesh bad = mesh;
    bad.triangles[1][2] = 1000;
    EXPECT_NE(message(bad.picture(256)).find("vertex 1000; accepted: 0 to"), std::string::npos);
    bad = mesh;
    bad.vertices[2].z = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(message(bad.picture(256)).find("without a place"), std::string::npos);
    for (const dvec3& along : {dvec3(1, 0, 3), dvec3(0.3, 0.7, 3), dvec3(0, 0, 1), dvec3(0)}) {
        bad = mesh;
        for (dvec3& v : bad.vertices) v = (v.x + 64 * v.y) * along;
        EXPECT_NE(message(bad.picture(256)), "") << along.x;
    }
    MeshPicture picture = mesh.picture(256);
    picture.window = MeshWindow{{32, 32, 0}, 0};
    EXPECT_NE(message(picture).find("window"), std::string::npos);
    picture = mesh.picture(256);
    picture.metres_per_unit = {1, -1};
    EXPECT_NE(message(picture), "");
    picture = mesh.picture(256);
    picture.planet = true;
    picture.look_from = dvec3(0);
    EXPECT_NE(message(picture).find("direction"), std::string::npos);
}

TEST(MeshColors, AreOrderedByLightnessAndLightEnoughForLines) {
    const Mesh mesh = Bisection::uniform(2);
    std::vector<std::uint8_t> values(mesh.triangles.size(), 1);
    for (const bool steps : {false, true})
        for (int last = 2; last <= 60; ++last) {
            values.back() = static_cast<std::uint8_t>(last);
            MeshPicture picture = mesh.picture(256);
            picture.level = values;
            if (steps) picture.step = values;
            const MeshColors colors(picture);
            for (int v = 1; v < last; ++v) {
                const double a = luminance(colors.of(v)), b = luminance(colors.of(v + 1));
                EXPECT_TRUE(steps ? a < b : a > b) << steps << " " << v << " of " << last;
            }
            // WCAG's contrast ratio of graphics against what is beside it.
            const double darkest = std::min(luminance(colors.of(1)), luminance(colors.of(last)));
            EXPECT_GT((darkest + 0.05) / (luminance(figure_color::ink) + 0.05), 2.5);
        }
}

TEST(StrokeText, HasLettersDigitsAndBlanks) {
    const auto strokes = [](std::string_view text) {
        std::vector<Stroke> list;
        add_text(list, text, 10, 50, 14, figure_color::ink);
        return list;
    };
    for (const char c : std::string_view("abcdefghijklmnopqrstuvwxyz0123456789,.-")) {
        const auto list = strokes(std::string_view(&c, 1));
        EXPECT_FALSE(list.empty()) << c;
        for (const Stroke& s : list)
            for (const glm::vec3& p : {s.a, s.b}) {
                EXPECT_GE(p.x, 10 - 1.5) << c;
                EXPECT_LE(p.x, 10 + text_width(std::string_view(&c, 1), 14) + 1.5) << c;
                EXPECT_GE(p.y, 50 - 15.01) << c;
                EXPECT_LE(p.y, 50 + 5.01) << c;
            }
    }
    EXPECT_TRUE(strokes(" A\xff").empty());
    EXPECT_EQ(text_width("", 14), 0);
    EXPECT_DOUBLE_EQ(text_width("level", 28), 2 * text_width("level", 14));
}

}  // namespace
}  // namespace render
