// The geometry of layers: lines that follow geodesics, on the ground and through the antimeridian and the poles, and
// polygons that know what is inside.

#include <gtest/gtest.h>

#include <cmath>

#include "planet/frames.h"
#include "planet/geodesy/geodesic.h"
#include "planet/geodesy/geodetic.h"
#include "render/layers/draped_lines.h"
#include "render/layers/filled_polygons.h"
#include "render/layers/glyphs.h"
#include "render/layers/graticule.h"
#include "render/layers/placed_labels.h"

namespace render {
namespace {

using planet::degrees;
using planet::wgs84;

using Vertices = std::vector<glm::dvec3>;

glm::dvec3 normal(double longitude, double latitude) {
    return planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
}

Camera above(double longitude, double latitude, double height, int side = 800) {
    const glm::dvec3 n = normal(longitude, latitude);
    return make_camera(planet::ecef_from_normal(wgs84, n, {height}), n, 0, -90 * degrees,
                       focal_length_px(40 * degrees, side, side), side, side);
}

/// Ground of one height, of which nothing is drawn.
DrapeGround level_ground(const Camera& camera, double height = 0) {
    return {.drawn = {},
            .height = [height](const glm::dvec3&) { return height; },
            .culling = camera.culling({0, 0, camera.width, camera.height}, wgs84.b - 1e4)};
}

std::vector<ScreenPiece> draped(const Vertices& line, const Camera& camera, double height = 0) {
    GeodesicLines lines;
    lines.add(line);
    DrapeGround ground = level_ground(camera, height);
    std::vector<ScreenPiece> pieces;
    drape(lines, camera, ground, pieces);
    return pieces;
}

double length_px(const std::vector<ScreenPiece>& pieces) {
    double sum = 0;
    for (const ScreenPiece& p : pieces) sum += static_cast<double>(glm::distance(glm::vec2(p.a), glm::vec2(p.b)));
    return sum;
}

TEST(GeodesicSide, MiddleIsOnTheGeodesic) {
    const planet::Geodesics geodesics(wgs84);
    const double ends[][4] = {{-73.8, 40.6, 103.8, 1.35}, {179, 10, -178, -5}, {0, 80, 180, 85}, {5, 45, 5.1, 45.05}};
    for (const auto& [x0, y0, x1, y1] : ends) {
        const planet::Geodetic m = planet::geodetic_from_normal(middle_of_side(normal(x0, y0), normal(x1, y1)));
        const planet::Geodetic a{y0 * degrees, x0 * degrees, {}}, b{y1 * degrees, x1 * degrees, {}};
        const double whole = geodesics.distance(a, b), first = geodesics.distance(a, m),
                     last = geodesics.distance(m, b);
        EXPECT_NEAR(first, last, 1);
        EXPECT_NEAR(first + last, whole, 1e-3) << x0;
    }
}

TEST(GeodesicLines, BallsHoldTheirRuns) {
    GeodesicLines lines;
    Vertices line;
    for (int i = 0; i < 500; ++i) line.push_back({-170.0 - 0.2 * i, 60 * std::sin(0.05 * i), 0});
    lines.add(line);
    lines.add(Vertices{{-120, 0, 0}, {60, 1, 0}});
    std::size_t vertices = 0;
    for (const GeodesicLines::Run& run : lines.runs()) {
        const auto normals = lines.vertices(run);
        vertices += normals.size() - (run.begins ? 0 : 1);
        for (std::size_t i = 0; i < normals.size(); ++i) {
            EXPECT_LE(glm::distance(planet::ecef_from_normal(wgs84, normals[i]), run.centre), run.radius + 1e-6);
            if (i == 0) continue;
            const glm::dvec3 middle = planet::ecef_from_normal(wgs84, middle_of_side(normals[i - 1], normals[i]));
            EXPECT_LE(glm::distance(middle, run.centre), run.radius + 1e-6);
        }
    }
    EXPECT_EQ(vertices, 502u);
    EXPECT_EQ(lines.vertex_count(), 502u);
}

TEST(Drape, PiecesFollowOneAnotherAndTheGeodesic) {
    const Camera camera = above(-150, 40, 8e6);
    const auto pieces = draped({{-170, 30, 0}, {-120, 45, 0}}, camera);
    ASSERT_GT(pieces.size(), 30u);
    const planet::Geodesics geodesics(wgs84);
    for (const ScreenPiece& p : pieces) EXPECT_LE(glm::distance(glm::vec2(p.a), glm::vec2(p.b)), 3.001f);
    for (std::size_t i = 1; i < pieces.size(); ++i) EXPECT_EQ(pieces[i].a, pieces[i - 1].b);
    const auto along =
        geodesics.points_along({30 * degrees, -170 * degrees, {}}, {45 * degrees, -120 * degrees, {}}, 9);
    for (const planet::GeodesicPoint& p : along) {
        const auto at = screen_from_ecef(
            camera, planet::ecef_from_normal(wgs84, planet::normal_from_geodetic(p.latitude, p.longitude)));
        ASSERT_TRUE(at);
        float nearest = 1e9f;
        for (const ScreenPiece& piece : pieces)
            nearest = std::min(nearest, glm::distance(glm::vec2(piece.a), glm::vec2(*at)));
        EXPECT_LT(nearest, 3.0f);
    }
}

TEST(Drape, CrossesTheAntimeridianTheShortWay) {
    const auto pieces = draped({{170, 0, 0}, {-170, 0, 0}}, above(180, 0, 8e6));
    const auto plain = draped({{-10, 0, 0}, {10, 0, 0}}, above(0, 0, 8e6));
    EXPECT_GT(length_px(plain), 100);
    EXPECT_NEAR(length_px(pieces), length_px(plain), 0.1);
    // Longitudes beyond +-180 are the same places.
    EXPECT_NEAR(length_px(draped({{170, 0, 0}, {190, 0, 0}}, above(180, 0, 8e6))), length_px(plain), 0.1);
}

TEST(Drape, LiesAtTheHeightOfTheGround) {
    const Camera camera = above(20, 10, 10e3);
    const auto low = draped({{20, 10, 0}, {20.01, 10, 0}}, camera),
               high = draped({{20, 10, 0}, {20.01, 10, 0}}, camera, 5e3);
    ASSERT_FALSE(low.empty());
    EXPECT_NEAR(length_px(high) / length_px(low), 2, 0.01);
    EXPECT_NEAR(static_cast<double>(high.front().a.z), camera.near_m / 5e3, 1e-8);
}

TEST(Drape, LeavesOutTheFarSideAndWhatIsBehindTheEye) {
    EXPECT_TRUE(draped({{-160, 0, 0}, {-150, 5, 0}}, above(20, 0, 2e7)).empty());
    const glm::dvec3 n = normal(20, 0);
    const Camera level = make_camera(planet::ecef_from_normal(wgs84, n, {100}), n, 0, 0, 800, 800, 800);
    EXPECT_TRUE(draped({{20, -0.01, 0}, {20, -0.02, 0}}, level).empty());
    EXPECT_FALSE(draped({{20, -0.01, 0}, {20, 0.02, 0}}, level).empty());
}

TEST(Drape, ACrowdOfPointsIsThinned) {
    const Camera camera = above(0, 0, 1e7);
    GeodesicLines points;
    for (int i = 0; i < 10'000; ++i) points.add(Vertices{{1e-5 * i, 0, 0}});
    DrapeGround ground = level_ground(camera);
    std::vector<ScreenPiece> pieces;
    drape(points, camera, ground, pieces);
    EXPECT_GE(pieces.size(), 1u);
    EXPECT_LE(pieces.size(), 3u);
}

planet::Polygon polygon_of(Vertices ring) {
    ring.push_back(ring.front());
    return {std::move(ring), {}};
}

int around(const planet::Polygon& polygon, double longitude, double latitude) {
    FilledPolygons polygons;
    polygons.add(polygon);
    return polygons.walls(above(longitude, latitude, 3e6), 9000).around_eye;
}

// Whichever way they turn, polygons are their smaller side, across the antimeridian and about the poles.
TEST(FilledPolygons, KnowWhatIsInside) {
    const planet::Polygon date_line = polygon_of({{170, -10, 0}, {-170, -10, 0}, {-170, 10, 0}, {170, 10, 0}});
    planet::Polygon turned = date_line;
    std::reverse(turned.outer.begin(), turned.outer.end());
    for (const planet::Polygon& p : {date_line, turned}) {
        EXPECT_EQ(around(p, 180, 1), 1);
        EXPECT_EQ(around(p, -172, -5), 1);
        EXPECT_EQ(around(p, 165, 0), 0);
        EXPECT_EQ(around(p, 60, 0), 0);
    }
    const planet::Polygon pole = polygon_of({{0, 70, 0}, {90, 70, 0}, {180, 70, 0}, {-90, 70, 0}});
    EXPECT_EQ(around(pole, 0, 90), 1);
    EXPECT_EQ(around(pole, 135, 80), 1);
    EXPECT_EQ(around(pole, 0, 60), 0);
    // As Antarctica is in many files: to the pole and back along the antimeridian.
    const planet::Polygon cut = polygon_of(
        {{-180, -90, 0}, {-180, -70, 0}, {-90, -65, 0}, {0, -70, 0}, {90, -66, 0}, {180, -70, 0}, {180, -90, 0}});
    EXPECT_EQ(around(cut, 45, -80), 1);
    EXPECT_EQ(around(cut, 179, -85), 1);
    EXPECT_EQ(around(cut, -179, -85), 1);
    EXPECT_EQ(around(cut, 0, -50), 0);
}

TEST(FilledPolygons, HolesAreOutside) {
    planet::Polygon ring = polygon_of({{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}});
    ring.holes.push_back(polygon_of({{8, 8, 0}, {12, 8, 0}, {12, 12, 0}, {8, 12, 0}}).outer);
    EXPECT_EQ(around(ring, 10, 10), 0);
    EXPECT_EQ(around(ring, 4, 10), 1);
}

constexpr auto beside_mark = LayerName::Place::beside_mark;

TEST(Labels, DoNotTouchAndThoseOfHigherLayersComeFirst) {
    const Camera camera = above(0, 0, 1e5);
    Layer low, high;
    for (int i = 0; i < 40; ++i)
        low.names.push_back({"low " + std::to_string(i), normal(0.01 * i - 0.2, 0), beside_mark});
    high.names = {{"high", normal(0, 0), beside_mark}, {"hidden", normal(170, 0), beside_mark}};
    const Layer* layers[] = {&low, &high};
    const auto width_of = [](const std::string& text) { return 8.0 * static_cast<double>(text.size()); };
    const auto labels = place_labels(layers, camera, level_ground(camera), 15, width_of);
    ASSERT_GT(labels.size(), 3u);
    EXPECT_EQ(*labels.front().text, "high");
    for (std::size_t i = 0; i < labels.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const auto &a = labels[i], &b = labels[j];
            EXPECT_TRUE(a.at.x > b.at.x + b.width || b.at.x > a.at.x + a.width || std::abs(a.at.y - b.at.y) > 15);
        }
}

TEST(Labels, AMountainHidesThem) {
    const glm::dvec3 n = normal(0, 0);
    const Camera level = make_camera(planet::ecef_from_normal(wgs84, n, {500}), n, 0, -3 * degrees, 800, 800, 800);
    Layer layer;
    layer.names = {{"far", normal(0, 0.1), beside_mark}};
    const Layer* layers[] = {&layer};
    const auto width_of = [](const std::string&) { return 20.0; };
    DrapeGround ground = level_ground(level);
    EXPECT_EQ(place_labels(layers, level, ground, 15, width_of).size(), 1u);
    ground.height = [](const glm::dvec3& at) {
        const double latitude = std::asin(at.z) / degrees;
        return latitude > 0.04 && latitude < 0.06 ? 1000.0 : 0.0;
    };
    EXPECT_TRUE(place_labels(layers, level, ground, 15, width_of).empty());
}

std::vector<std::string> texts_of(const std::vector<LayerName>& names) {
    std::vector<std::string> texts;
    for (const LayerName& name : names) texts.push_back(name.text);
    return texts;
}

TEST(Graticule, LinesAreNamedFromTheMiddleOn) {
    const auto texts = texts_of(graticule_names(above(9, 41, 1e6), 5 * degrees));
    ASSERT_GT(texts.size(), 6u);
    EXPECT_EQ(
        (std::vector<std::string>(texts.begin(), texts.begin() + 6)),
        (std::vector<std::string>{"40\u00b0 N", "10\u00b0 E", "45\u00b0 N", "15\u00b0 E", "35\u00b0 N", "5\u00b0 E"}));
    const auto minutes = texts_of(graticule_names(above(-7.49, 0.01, 1e5), 0.5 * degrees));
    EXPECT_EQ((std::vector<std::string>(minutes.begin(), minutes.begin() + 6)),
              (std::vector<std::string>{"Equator", "7\u00b0 30\u2032 W", "0\u00b0 30\u2032 N", "7\u00b0 W",
                                        "0\u00b0 30\u2032 S", "8\u00b0 W"}));
}

// Halfway towards the next parallel, on the side of the picture's middle.
TEST(Graticule, TheMiddleMeridianHasItsName) {
    const auto at = [](double longitude, double latitude) {
        return graticule_names(above(longitude, latitude, 1e6), 5 * degrees).at(1);
    };
    EXPECT_EQ(at(1, 41).text, "Prime Meridian");
    EXPECT_NEAR(glm::distance(at(1, 41).normal, normal(0, 42.5)), 0, 1e-12);
    EXPECT_NEAR(glm::distance(at(-1, -41).normal, normal(0, -42.5)), 0, 1e-12);
    EXPECT_EQ(at(179, 10.5).text, "180\u00b0");
    EXPECT_EQ(at(-178, 9.5).text, "180\u00b0");
    EXPECT_NEAR(glm::distance(at(-178, 9.5).normal, normal(180, 7.5)), 0, 1e-12);
    EXPECT_EQ(at(174, 0).text, "175\u00b0 E");
}

// No parallel beyond 90 degrees, no meridian twice, no name where only sky is in the middle.
TEST(Graticule, KnowsPolesTheAntimeridianAndTheSky) {
    for (const auto& [longitude, latitude] : {std::pair(0.0, 90.0), {180.0, 0.0}, {-180.0, -70.0}}) {
        const auto names = graticule_names(above(longitude, latitude, 2e7), 30 * degrees);
        const auto texts = texts_of(names);
        for (const std::string& text : texts) {
            EXPECT_EQ(std::count(texts.begin(), texts.end(), text), 1) << text;
            EXPECT_LE(std::atoi(text.c_str()), text.ends_with("N") || text.ends_with("S") ? 89 : 180) << text;
        }
    }
    EXPECT_FALSE(graticule_names(above(180, 0, 2e7), 30 * degrees).empty());
    const glm::dvec3 n = normal(0, 0);
    const Camera up = make_camera(planet::ecef_from_normal(wgs84, n, {500}), n, 0, 20 * degrees, 800, 800, 800);
    EXPECT_TRUE(graticule_names(up, degrees).empty());
}

TEST(Graticule, APictureThatIsShownLargerHasTheSameLines) {
    Camera camera = above(0, 0, 3e5), quarter = camera;
    quarter.focal_px *= 0.25;
    EXPECT_EQ(graticule_step(camera, 1), graticule_step(quarter, 0.25));
    EXPECT_LT(graticule_step(camera, 1), graticule_step(quarter, 1));
}

// Twice the size: twice as far from their places, and from each other.
TEST(Labels, GrowWithTheirGaps) {
    const Camera camera = above(10, 20, 1e6, 800), large = above(10, 20, 1e6, 1600);
    Layer layer;
    const glm::dvec3 places[] = {normal(10, 20), normal(10.53, 20)};
    for (const glm::dvec3& place : places) layer.names.push_back({"x", place, LayerName::Place::beside_mark});
    const Layer* const layers[] = {&layer};
    const auto placed = [&](const Camera& c, double scale, double width) {
        const double size = scale * label_size_px;
        return place_labels(layers, c, level_ground(c), size, [&](const std::string&) { return scale * width; });
    };
    for (const double width : {50.0, 57.0, 80.0}) {
        const auto once = placed(camera, 1, width), twice = placed(large, 2, width);
        ASSERT_EQ(once.size(), twice.size()) << width;
        EXPECT_EQ(once.size(), width > 55 ? 1u : 2u);
        EXPECT_NEAR(static_cast<double>(twice[0].at.x), 2 * static_cast<double>(once[0].at.x), 1);
    }
}

TEST(Labels, StandBesideTheirMarksHoweverLarge) {
    const Camera camera = above(10, 20, 1e6);
    const auto left = [&](double width) {
        Layer layer;
        layer.style.width = width;
        layer.names.push_back({"x", normal(10, 20), LayerName::Place::beside_mark});
        const Layer* const layers[] = {&layer};
        const auto labels =
            place_labels(layers, camera, level_ground(camera), label_size_px, [](const std::string&) { return 20.0; });
        return static_cast<double>(labels.at(0).at.x) - 400;
    };
    EXPECT_NEAR(left(2), 9, 0.51);
    EXPECT_NEAR(left(8) - left(2), 6 * point_radius_widths, 1);
}

TEST(Labels, CharactersOfAnyBytes) {
    EXPECT_EQ(characters_of("a\xc3\xa9\xe2\x82\xac\xf0\x9f\x97\xbb"), U"a\u00e9\u20ac\U0001F5FB");
    EXPECT_EQ(characters_of("\xff x\xe2\x82"), U"\ufffd x\ufffd");
    EXPECT_EQ(characters_of(""), U"");
}

}  // namespace
}  // namespace render
