// Pictures of small meshes whose every triangle, side and gate is known.
#include "render/picture/mesh_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "planet/error.h"
#include "planet/mesh/smooth_ellipsoid.h"
#include "render/gl/context.h"
#include "render/picture/mesh_figure.h"
#include "render/picture/stroke_text.h"

namespace render {
namespace {

using glm::dvec2;
using glm::dvec3;

struct Mesh {
    std::vector<dvec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint8_t> level;

    MeshPicture picture(int size) const {
        MeshPicture p{.vertices = vertices, .triangles = triangles, .level = level};
        p.width = p.height = size;
        return p;
    }
    dvec3 middle(std::size_t t) const {
        const auto& [a, b, c] = triangles[t];
        return (vertices[a] + vertices[b] + vertices[c]) / 3.0;
    }
};

/// The square 0..64 by 0..64 bisected in the order of the Sierpinski curve. `split` is asked with the split vertex.
class Bisection {
  public:
    using Split = std::function<bool(const glm::ivec2&, int level)>;

    static Mesh of(const Split& split) {
        Bisection b(split);
        b.cell({64, 0}, {0, 0}, {64, 64}, 0);
        b.cell({0, 64}, {64, 64}, {0, 0}, 0);
        return b.mesh_;
    }
    static Mesh uniform(int finest) {
        return of([=](const glm::ivec2&, int level) { return level < finest; });
    }
    /// Level 2 to 6, the higher the nearer to (0, 0). The radii shrink by more than a child's vertex is away from its
    /// parent's, so the test is nested and the mesh conforming.
    static Mesh adaptive() {
        return of([](const glm::ivec2& m, int level) {
            const double split_side = 64 * std::sqrt(2.0) / std::pow(2, 0.5 * level);
            return level < 6 && std::hypot(m.x, m.y) <= 1.3 * split_side;
        });
    }

  private:
    explicit Bisection(const Split& split) : split_(split) {}

    void cell(const glm::ivec2& apex, const glm::ivec2& left, const glm::ivec2& right, int level) {
        const glm::ivec2 m = (left + right) / 2;
        if (split_(m, level)) {
            cell(m, left, apex, level + 1);
            cell(m, apex, right, level + 1);
            return;
        }
        mesh_.triangles.push_back({vertex(apex), vertex(left), vertex(right)});
        mesh_.level.push_back(static_cast<std::uint8_t>(level));
    }
    std::uint32_t vertex(const glm::ivec2& p) {
        const auto [place, is_new] =
            numbers_.try_emplace({p.x, p.y}, static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (is_new) mesh_.vertices.emplace_back(p, 0);
        return place->second;
    }

    const Split& split_;
    Mesh mesh_;
    std::map<std::pair<int, int>, std::uint32_t> numbers_;
};

Mesh planet_mesh(int level) {
    planet::SmoothEllipsoid source(planet::wgs84);
    source.refine_to_level(level);
    Mesh mesh;
    for (const planet::GridPosition& v : source.vertices()) mesh.vertices.push_back(planet::ecef_from_grid(v));
    const auto strip = source.strip();
    for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
        const std::uint32_t a = strip[i], b = strip[i + 1], c = strip[i + 2];
        if (a != b && b != c && a != c) mesh.triangles.push_back({a, i & 1 ? c : b, i & 1 ? b : c});
    }
    mesh.level.assign(mesh.triangles.size(), static_cast<std::uint8_t>(level));
    return mesh;
}

Color pixel(const planet::Image& image, int x, int y) {
    const std::uint8_t* p = image.pixel(x, y);
    return {p[0], p[1], p[2]};
}
Color pixel(const planet::Image& image, const MeshPicture& picture, const dvec3& place) {
    const glm::vec3 p = make_mesh_view(picture).place(place);
    return pixel(image, static_cast<int>(p.x), static_cast<int>(p.y));
}
/// Relative luminance of sRGB, 0..1.
double luminance(Color c) {
    const auto linear = [](std::uint8_t v) { return std::pow(v / 255.0, 2.2); };
    return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}
bool reddish(Color c) {
    return c.red > c.green + 90 && c.red > c.blue + 60;
}
int count(const planet::Image& image, const std::function<bool(Color)>& test) {
    int n = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) n += test(pixel(image, x, y));
    return n;
}

class MeshPictures : public testing::Test {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create());
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
    void TearDown() override {
        if (!context_) return;
        EXPECT_EQ(take_gl_errors(), "");
    }
    std::optional<Context> context_;
};

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
