// `octaglobe mesh` as a user runs it: its files are read back and measured the slow way (slow_deviation.h), and compared
// with what the report says. What it refuses is in mesh_refusal_test.cpp.

#include <ostream>
#include <regex>
#include <set>

#include "planet/elevation/image_io.h"
#include "tests/render/app/command_report.h"
#include "tests/render/app/slow_deviation.h"

namespace render {
namespace {

using planet::SurfaceMesh;

class MeshCommand : public CommandTest {
  protected:
    /// octaglobe mesh ARGUMENTS; its report.
    Json mesh(const std::string& arguments) { return report_of("mesh " + arguments); }
};

/// Of triangles that turn the wrong way, seen from above: from +z, or in ecef from outside.
std::size_t turned_down(const SurfaceMesh& mesh, bool ecef) {
    return static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, [&](const auto& t) {
        const glm::dvec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        return glm::dot(glm::cross(b - a, c - a), ecef ? a + b + c : glm::dvec3(0, 0, 1)) < 0;
    }));
}

/// Every side of two triangles, once each way, and Euler's number that of a sphere.
void expect_closed(const SurfaceMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_TRUE(sides.insert({t[k], t[(k + 1) % 3]}).second) << "a side twice the same way";
    for (const auto& [a, b] : sides) ASSERT_TRUE(sides.contains({b, a})) << "an open side";
    EXPECT_EQ(mesh.vertices.size() - sides.size() / 2 + mesh.triangles.size(), 2u);
}

void expect_counts(const SurfaceMesh& mesh, const Json& report) {
    EXPECT_EQ(mesh.triangles.size(), report.at("triangles"));
    EXPECT_EQ(mesh.vertices.size(), report.at("vertices"));
}

double plan_area(const SurfaceMesh& mesh) {
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const glm::dvec3 u = mesh.vertices[t[1]] - mesh.vertices[t[0]], v = mesh.vertices[t[2]] - mesh.vertices[t[0]];
        area += 0.5 * (u.x * v.y - u.y * v.x);
    }
    return area;
}

// Every format in every frame that it holds.
struct Written {
    const char *file, *frame;
    bool rows_north = false;
};
void PrintTo(const Written& written, std::ostream* out) {
    *out << written.file << ' ' << written.frame << (written.rows_north ? ", rows run north" : "");
}

class MeshFiles : public MeshCommand, public testing::WithParamInterface<Written> {};

TEST_P(MeshFiles, KeepTheBoundAndSayHowWell) {
    const auto& [file, frame, rows_north] = GetParam();
    Terrain terrain = hilly_terrain();
    if (rows_north) terrain.step_y = -terrain.step_y;
    terrain.write(folder_ / "dem.vrt");
    const std::string options = "dem.vrt --max-deviation 20 --datum ellipsoid --frame " + std::string(frame) + " -o ";
    // An .stl does not say where its origin is; the .ply of the same frame does.
    mesh(options + "reference.ply");
    planet::MeshReference reference;
    read("reference.ply", &reference);
    const Json report = mesh(options + file);
    const SurfaceMesh written = read(file);
    expect_counts(written, report);
    EXPECT_EQ(report.at("frame"), frame);
    expect_as_reported(written, reference, terrain, report);
    EXPECT_LE(number(report, "deviation_max_m"), 20 + 1e-6);
    EXPECT_EQ(turned_down(written, frame == std::string("ecef")), 0u);
}

INSTANTIATE_TEST_SUITE_P(Table, MeshFiles,
                         testing::Values(Written{"t.ply", "source"}, Written{"t.obj", "source"},
                                         Written{"t.ply", "source", true}, Written{"t.glb", "enu"},
                                         Written{"t.glb", "enu", true}, Written{"t.stl", "enu"},
                                         Written{"t.ply", "enu"}, Written{"t.glb", "ecef"},
                                         Written{"t.obj", "ecef", true}));

TEST_F(MeshCommand, FormatsChooseTheirFrame) {
    hilly_terrain().write(folder_ / "dem.vrt");
    for (const auto& [file, frame] :
         {std::pair("t.glb", "enu"), {"t.stl", "enu"}, {"t.ply", "source"}, {"t.obj", "source"}})
        EXPECT_EQ(mesh("dem.vrt --max-deviation 50 -o " + std::string(file)).at("frame"), frame) << file;
}

TEST_F(MeshCommand, ZeroDeviationIsKeptWhereNothingRounds) {
    for (const auto& [width, height] : {std::pair(2, 2), {2, 9}, {17, 2}, {3, 5}, {40, 7}, {33, 33}}) {
        Terrain terrain = hilly_terrain();
        terrain.width = width;
        terrain.height = height;
        terrain.write(folder_ / "dem.vrt");
        const Json report = mesh("dem.vrt --max-deviation 0 -o t.ply");
        const SurfaceMesh written = read("t.ply");
        EXPECT_LT(number(report, "deviation_max_m"), 1e-9);
        EXPECT_LT(slow_deviation_in_source(written, terrain).max, 1e-6);
        EXPECT_NEAR(plan_area(written), (width - 1) * (height - 1) * 1e-4, 1e-12) << width << 'x' << height;
        EXPECT_NE(outcome_.out.find("deviation at most 0 m"), std::string::npos) << outcome_.out;
    }
}

// What a refusal says is possible is possible.
TEST_F(MeshCommand, TheBoundThatIsOfferedHolds) {
    hilly_terrain().write(folder_ / "dem.vrt");
    for (const std::string file : {"t.glb", "t.stl"}) {
        const Outcome refused = run(folder_.path(), words("mesh dem.vrt --max-deviation 0 -o " + file));
        EXPECT_EQ(refused.status, 2);
        std::smatch offer;
        ASSERT_TRUE(std::regex_search(refused.err, offer, std::regex("accepted: ([0-9.e-]+) m or more, or a .ply")))
            << refused.err;
        const Json report = mesh("dem.vrt --max-deviation " + offer[1].str() + " -o " + file);
        EXPECT_LE(number(report, "deviation_max_m"), std::stod(offer[1]) + 1e-6);
    }
}

TEST_F(MeshCommand, BudgetIsSpentAndNeverExceeded) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    double last = 1e9;
    for (const std::size_t budget : {5u, 100u, 1000u, 2000u}) {
        const Json report = mesh("dem.vrt --max-triangles " + std::to_string(budget) + " -o t.ply");
        const SurfaceMesh written = read("t.ply");
        expect_counts(written, report);
        EXPECT_LE(written.triangles.size(), budget);
        EXPECT_GT(10 * written.triangles.size(), 9 * budget);
        EXPECT_NEAR(slow_deviation_in_source(written, terrain).max, number(report, "deviation_max_m"), 1e-6);
        EXPECT_LT(number(report, "deviation_max_m"), last);
        last = number(report, "deviation_max_m");
    }
}

TEST_F(MeshCommand, BudgetGoesBeforeTheBound) {
    hilly_terrain().write(folder_ / "dem.vrt");
    const Json tight = mesh("dem.vrt --max-deviation 20 --max-triangles 100 -o t.glb");
    EXPECT_LE(tight.at("triangles"), 100);
    EXPECT_GT(number(tight, "deviation_max_m"), 20);
    const Json ample = mesh("dem.vrt --max-deviation 20 --max-triangles 5000 -o t.glb");
    EXPECT_LE(number(ample, "deviation_max_m"), 20 + 1e-6);  // after rounding, too
    EXPECT_EQ(ample.at("triangles"), mesh("dem.vrt --max-deviation 20 -o t.glb").at("triangles"));
}

// Level ground of 400 km: what there is to approximate is the planet's curvature.
TEST_F(MeshCommand, BudgetIsSpentOnCurvatureToo) {
    Terrain terrain = hilly_terrain();
    terrain.step_x = 0.1;
    terrain.step_y = -0.1;
    terrain.height_m = [](int, int) { return 0.0; };
    terrain.write(folder_ / "dem.vrt");
    const Json bound = mesh("dem.vrt --max-deviation 20 --datum ellipsoid --frame ecef -o t.ply");
    const Json budget =
        mesh("dem.vrt --max-triangles " + bound.at("triangles").dump() + " --datum ellipsoid --frame ecef -o t.ply");
    EXPECT_GT(number(budget, "triangles"), 0.5 * number(bound, "triangles"));
    EXPECT_LT(number(budget, "deviation_max_m"), 40);
    EXPECT_EQ(mesh("dem.vrt --max-triangles 1000 --frame source -o t.ply").at("triangles"), 5);
}

TEST_F(MeshCommand, LevelsAreUniform) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    const Json middle = mesh("dem.vrt --level 8 -o t.ply");
    const SurfaceMesh written = read("t.ply");
    expect_counts(written, middle);
    EXPECT_NEAR(slow_deviation_in_source(written, terrain).max, number(middle, "deviation_max_m"), 1e-6);
    for (const auto& t : written.triangles) {  // two samples a leg
        const auto twice = std::abs(plan_area({written.vertices, {t}, {}, {}}));
        EXPECT_NEAR(twice, 2e-4, 1e-12);
    }
    EXPECT_EQ(written.triangles.size(), 2u * 20 * 16);
    const Json finest = mesh("dem.vrt --level 10 -o t.ply");
    EXPECT_EQ(finest.at("triangles"), 2 * 40 * 32);
    EXPECT_LT(number(finest, "deviation_max_m"), 1e-9);
}

TEST_F(MeshCommand, FeaturesStay) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    write_features(folder_ / "f.geojson",
                   R"({"type":"Point","coordinates":[10.13,49.91]},{"type":"Point","coordinates":[20,20]},
                      {"type":"LineString","coordinates":[[10,50],[10.2,49.8]]},
                      {"type":"LineString","coordinates":[[10.37,49.8],[11,49.8]]},
                      {"type":"Polygon","coordinates":[[[10.25,49.95],[10.31,49.95],[10.31,49.92],[10.25,49.95]]]})");
    const Json report = mesh("dem.vrt --max-deviation 200 --keep f.geojson -o t.ply");
    std::set<std::pair<int, int>> vertices;
    for (const glm::dvec3& v : read("t.ply").vertices)
        vertices.insert(
            {static_cast<int>(std::lround((v.x - 10) * 100)), static_cast<int>(std::lround((50 - v.y) * 100))});
    std::set<std::pair<int, int>> expected{{13, 9}};
    for (int i = 0; i <= 20; ++i) expected.insert({i, i});
    for (int i = 37; i <= 40; ++i) expected.insert({i, 20});
    for (int i = 25; i <= 31; ++i) expected.insert({i, 5});
    for (int i = 5; i <= 8; ++i) expected.insert({31, i});
    for (const auto& sample : expected) EXPECT_TRUE(vertices.contains(sample)) << sample.first << ',' << sample.second;
    EXPECT_GE(report.at("kept_samples"), expected.size());
    EXPECT_LE(report.at("kept_samples"), expected.size() + 6);  // the slanting side of the polygon
    EXPECT_EQ(report.at("kept_outside"), 2);                    // a point, and a line that leaves the raster
    EXPECT_LT(mesh("dem.vrt --max-deviation 200 -o t.ply").at("triangles"), report.at("triangles"));
    EXPECT_LE(mesh("dem.vrt --max-deviation 20 --max-triangles 400 --keep f.geojson -o t.ply").at("triangles"), 400);
}

TEST_F(MeshCommand, WhatIsNoHeightIsLeftOut) {
    Terrain terrain = hilly_terrain();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    terrain.height_m = [](int x, int y) {
        if (x == 4 && y == 5) return nan;
        if (x == 12 && y == 3) return -inf;
        if (x > 20 && x < 28 && y > 9 && y < 17) return inf;
        return hills(x, y);
    };
    terrain.write(folder_ / "dem.vrt");
    for (const char* how : {"--max-deviation 20", "--max-deviation 0", "--max-triangles 700", "--level 6"}) {
        const Json report = mesh(std::string("dem.vrt -o t.ply ") + how);
        const SurfaceMesh written = read("t.ply");
        const SlowDeviation slow = slow_deviation_in_source(written, terrain);
        EXPECT_EQ(report.at("samples_void"), 2 + 49) << how;
        EXPECT_EQ(report.at("samples_uncovered"), slow.uncovered) << how;
        EXPECT_NEAR(slow.max, number(report, "deviation_max_m"), 1e-6) << how;
        for (const glm::dvec3& v : written.vertices) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
    }
}

TEST_F(MeshCommand, DrapesLieWhereTheySay) {
    hilly_terrain().write(folder_ / "dem.vrt");
    planet::write_image((folder_ / "photo.png").string(), {200, 100, 3, std::vector<std::uint8_t>(60'000, 90)});
    std::ofstream(folder_ / "photo.png.aux.xml")
        << "<PAMDataset><SRS>EPSG:32632</SRS><GeoTransform>560000,400,0,5560000,0,-600</GeoTransform></PAMDataset>";
    mesh("dem.vrt --max-deviation 20 --frame utm -o t.glb --drape photo.png");
    planet::MeshLooks looks;
    const SurfaceMesh mesh = planet::read_mesh((folder_ / "t.glb").string(), nullptr, &looks);
    EXPECT_EQ(looks.picture, content(folder_ / "photo.png"));
    EXPECT_EQ(looks.normals.size(), mesh.vertices.size());
    ASSERT_EQ(looks.uv.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < looks.uv.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(looks.uv[i].x), (mesh.vertices[i].x - 560000) / 80000, 1e-5);
        EXPECT_NEAR(static_cast<double>(looks.uv[i].y), (5560000 - mesh.vertices[i].y) / 60000, 1e-5);
    }
}

TEST_F(MeshCommand, HeightmapsNeedNoPlace) {
    const auto grey = [](int x, int y) {
        return static_cast<unsigned>(100 + 50 * std::sin(0.4 * x) * std::cos(0.3 * y));
    };
    std::ofstream(folder_ / "map.png", std::ios::binary) << planet::testing::png_bytes(33, 21, 8, grey);
    Terrain same{.width = 33, .height = 21, .x = 0, .y = 0, .step_x = 1, .step_y = -1};
    same.height_m = [&](int x, int y) { return static_cast<double>(grey(x, y)); };
    for (const char* file : {"t.ply", "t.stl", "t.glb"}) {
        const Json report = mesh(std::string("map.png --max-deviation 2 -o ") + file);
        const SurfaceMesh written = read(file);
        EXPECT_EQ(report.at("crs"), "");
        EXPECT_NEAR(slow_deviation_in_source(written, same).max, number(report, "deviation_max_m"), 1e-4) << file;
        EXPECT_LE(number(report, "deviation_max_m"), 2 + 1e-6);
        EXPECT_EQ(turned_down(written, false), 0u);
    }
}

TEST_F(MeshCommand, ProjectedRastersGoEverywhere) {
    Terrain terrain = hilly_terrain();
    terrain.crs = "EPSG:32613";
    terrain.x = 400000;
    terrain.y = 4100000;
    terrain.step_x = 30;
    terrain.step_y = -30;
    terrain.write(folder_ / "dem.vrt");
    for (const char* frame : {"source", "utm"}) {
        const Json report = mesh("dem.vrt --max-deviation 20 -o t.ply --frame " + std::string(frame));
        EXPECT_EQ(report.at("crs"), "EPSG:32613");
        EXPECT_NEAR(slow_deviation_in_source(read("t.ply"), terrain).max, number(report, "deviation_max_m"), 1e-3);
    }
    for (const char* frame : {"enu", "ecef"}) {
        const Json report = mesh("dem.vrt --max-deviation 20 -o t.ply --frame " + std::string(frame));
        EXPECT_LE(number(report, "deviation_max_m"), 20 + 1e-6);
        const SurfaceMesh written = read("t.ply");
        EXPECT_EQ(turned_down(written, frame == std::string("ecef")), 0u);
        for (const glm::dvec3& v : written.vertices)
            if (frame == std::string("enu")) {
                EXPECT_LT(glm::length(glm::dvec2(v)), 30 * 30);  // metres from the middle
            }
    }
    Terrain geographic = hilly_terrain();
    geographic.write(folder_ / "dem.vrt");
    const Json utm = mesh("dem.vrt --max-deviation 20 -o t.ply --frame utm");
    EXPECT_EQ(utm.at("crs"), "EPSG:32632");
    EXPECT_EQ(turned_down(read("t.ply"), false), 0u);
    EXPECT_LE(number(utm, "deviation_max_m"), 20 + 1e-6);
}

struct Corner {
    const char* name;
    double x, y, step;
};
void PrintTo(const Corner& corner, std::ostream* out) {
    *out << corner.name;
}
class CornersOfThePlanet : public MeshCommand, public testing::WithParamInterface<Corner> {};

TEST_P(CornersOfThePlanet, AreLikeAnyPlace) {
    const auto& [name, x, y, step] = GetParam();
    Terrain terrain{.width = 41, .height = 21, .x = x, .y = y, .step_x = step, .step_y = -step};
    const int level_row = y < 0 ? terrain.height - 1 : 0;  // a pole has one height
    terrain.height_m = [=](int column, int row) { return 500 + 15.0 * (row - level_row) * std::sin(column); };
    terrain.write(folder_ / "dem.vrt");
    for (const std::string frame : {"enu", "ecef"}) {
        for (const std::string how : {"--max-deviation 30", "--max-triangles 1000"}) {
            const Json report = mesh("dem.vrt -o t.ply --datum ellipsoid --frame " + frame + " " + how);
            planet::MeshReference reference;
            const SurfaceMesh written = read("t.ply", &reference);
            const SlowDeviation slow = slow_deviation_in_space(written, reference, terrain);
            EXPECT_EQ(slow.uncovered, 0u) << frame << how;
            // Over a side that is curved in the lattice a sample may lie on its neighbour.
            EXPECT_NEAR(slow.max, number(report, "deviation_max_m"), 0.01 * slow.max + 1e-6) << frame << how;
            EXPECT_TRUE(how == "--max-triangles 1000" || number(report, "deviation_max_m") <= 30 + 1e-6);
            EXPECT_TRUE(how != "--max-triangles 1000" || report.at("triangles") <= 1000);
            EXPECT_EQ(report.at("samples"), 41 * 21);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Table, CornersOfThePlanet,
                         testing::Values(Corner{"antimeridian", 179, 50, 0.05}, Corner{"north pole", 10, 90, 0.5},
                                         Corner{"south pole", 10, -80, 0.5}, Corner{"past 180", 350, 10, 0.5}));

// The undulation near 49.8 N, 10.2 E is about 48 m.
TEST_F(MeshCommand, HeightsAboveTheGeoidAreRaisedToTheEllipsoid) {
    hilly_terrain().write(folder_ / "dem.vrt");
    mesh("dem.vrt --level 8 --frame ecef -o geoid.ply");
    mesh("dem.vrt --level 8 --frame ecef --datum ellipsoid -o ellipsoid.ply");
    const SurfaceMesh geoid = read("geoid.ply"), ellipsoid = read("ellipsoid.ply");
    ASSERT_EQ(geoid.vertices.size(), ellipsoid.vertices.size());
    for (std::size_t i = 0; i < geoid.vertices.size(); ++i) {
        const double raised = glm::length(geoid.vertices[i]) - glm::length(ellipsoid.vertices[i]);
        ASSERT_GT(raised, 45);
        ASSERT_LT(raised, 51);
    }
}

TEST_F(MeshCommand, AnotherPlanetKeepsItsOwnCoordinates) {
    Terrain terrain = hilly_terrain();
    terrain.crs = "+proj=longlat +R=1737400 +no_defs";
    terrain.write(folder_ / "moon.vrt");
    const Json report = mesh("moon.vrt --max-deviation 20 -o t.ply");
    EXPECT_EQ(report.at("frame"), "source");
    EXPECT_EQ(report.at("vertical_datum"), "");
    EXPECT_NEAR(slow_deviation_in_source(read("t.ply"), terrain).max, number(report, "deviation_max_m"), 1e-6);
}

TEST_F(MeshCommand, HelpNamesEveryOption) {
    const Outcome outcome = run(folder_.path(), words("mesh --help"));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("Example:\n  octaglobe mesh "), std::string::npos);
    for (const char* option :
         {"dem FILE", "--planet", "--store", "--patches", "--patch-level", "--max-deviation", "--max-triangles",
          "--level", "--keep", "--remove", "--output", "--frame", "--datum", "--picture", "--size", "--json"})
        EXPECT_NE(outcome.out.find(option), std::string::npos) << option;
}

TEST_F(MeshCommand, SaysFewDigits) {
    hilly_terrain().write(folder_ / "dem.vrt");
    const Json report = mesh("dem.vrt --max-triangles 333 -o t.glb");
    std::smatch said;
    ASSERT_TRUE(
        std::regex_search(outcome_.out, said, std::regex("deviation at most ([0-9.]+) m, rms ([0-9.]+) m over")))
        << outcome_.out;
    for (std::size_t i = 1; i <= 2; ++i) {
        const std::string text = said[i];
        EXPECT_LE(std::ranges::count_if(text, [](char c) { return c != '.'; }), 4) << text;
        const double exact = number(report, i == 1 ? "deviation_max_m" : "deviation_rms_m");
        EXPECT_GE(std::stod(text), exact - 1e-6);
        EXPECT_NEAR(std::stod(text), exact, 2e-3 * exact);
    }
}

TEST_F(MeshCommand, PicturesHaveTheProportionsOfTheRaster) {
    const auto size = [&](int width, int height, const std::string& options) {
        Terrain terrain = hilly_terrain();
        terrain.crs = "EPSG:32613";
        terrain.width = width;
        terrain.height = height;
        terrain.step_x = 30;
        terrain.step_y = -30;
        terrain.write(folder_ / "dem.vrt");
        mesh("dem.vrt --max-triangles 400 --picture p.png " + options);
        const planet::Image image = planet::read_image((folder_ / "p.png").string());
        return std::pair(image.width, image.height);
    };
    const auto [width, height] = size(65, 33, "");
    EXPECT_EQ(width, 1600);
    EXPECT_GT(height, 800);
    EXPECT_LT(height, 1000);
    const auto [same, higher] = size(33, 33, "");
    EXPECT_EQ(same, 1600);
    EXPECT_GT(higher, 1600);
    EXPECT_LT(higher, 1800);
    EXPECT_EQ(size(65, 3, ""), std::pair(1600, 400));
    EXPECT_EQ(size(5, 65, ""), std::pair(1600, 3200));
    EXPECT_EQ(size(65, 33, "--size 300x200"), std::pair(300, 200));
    for (const char* file : {"p.jpg", "p.tif"}) {
        mesh("dem.vrt --max-triangles 400 --size 300x200 --picture " + std::string(file));
        EXPECT_EQ(planet::read_image((folder_ / file).string()).width, 300);
    }
}

TEST_F(MeshCommand, PlanetOfOneLevelIsClosed) {
    const Json report = mesh("--planet --level 8 -o uniform.ply");
    planet::MeshReference reference;
    const SurfaceMesh written = read("uniform.ply", &reference);
    expect_counts(written, report);
    EXPECT_EQ(written.triangles.size(), 8u << 8);
    EXPECT_EQ(reference.frame, planet::MeshFrame::ecef);
    expect_closed(written);
    EXPECT_EQ(turned_down(written, true), 0u);
    // What triangles of this size are off is the planet's curvature; the relief is within 11 km of that.
    double depth = 0;
    for (const auto& t : written.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p = 0.5 * (written.vertices[t[k]] + written.vertices[(t[(k + 1) % 3])]);
            depth = std::max(depth, 6378137 - glm::length(p / glm::dvec3(1, 1, 1 - 1 / 298.257223563)));
        }
    EXPECT_NEAR(number(report, "deviation_max_m"), depth, 11e3);
}

TEST_F(MeshCommand, PlanetWithinABoundIsClosed) {
    const Json report = mesh("--planet --max-deviation 2000 -o earth.glb");
    const SurfaceMesh written = read("earth.glb");
    expect_counts(written, report);
    expect_closed(written);
    EXPECT_EQ(turned_down(written, true), 0u);
    EXPECT_LE(number(report, "deviation_max_m"), 2000);
    EXPECT_GT(number(report, "deviation_max_m"), 1900);
}

TEST_F(MeshCommand, PlanetWithinABudgetKeepsFeatures) {
    write_features(folder_ / "f.geojson", R"({"type":"Point","coordinates":[-105.4858,37.5767]})");
    const Json report = mesh("--planet --max-triangles 5000 --keep f.geojson -o earth.ply");
    const SurfaceMesh written = read("earth.ply");
    expect_counts(written, report);
    EXPECT_LE(written.triangles.size(), 5000u);
    EXPECT_GT(written.triangles.size(), 4900u);
    expect_closed(written);
    // The store's finest vertices are some 100 m apart where its finest source is.
    const auto [foot, up] = foot_and_normal(-105.4858, 37.5767);
    double nearest = 1e9;
    for (const glm::dvec3& v : written.vertices) nearest = std::min(nearest, glm::length(glm::cross(v - foot, up)));
    EXPECT_LT(nearest, 200);
}

// Balmelli, Kovacevic and Vetterli: the merging domain of a vertex of the coarsest grid.
TEST_F(MeshCommand, RemovesAVertexOfPatches) {
    const Json report = mesh("--patches 3x3 --patch-level 4 --remove 24,24 --picture domain.png -o domain.ply");
    EXPECT_EQ(report.at("vertex_label"), 1);
    EXPECT_EQ(report.at("vertex_grid"), "cartesian");
    EXPECT_EQ(report.at("spreading_steps"), 8);
    EXPECT_EQ(report.at("merged_triangles"), 238);
    EXPECT_EQ(report.at("cells_visited"), 238);
    EXPECT_EQ(report.at("merged_by_step"), Json({2, 4, 8, 16, 24, 40, 56, 88}));
    const SurfaceMesh written = read("domain.ply");
    expect_counts(written, report);
    EXPECT_EQ(written.vertices.size() + report.at("removed_vertices").get<std::size_t>(), 49u * 49);
    EXPECT_NEAR(plan_area(written), 48 * 48, 1e-9);
    EXPECT_EQ(turned_down(written, false), 0u);
    for (const glm::dvec3& v : written.vertices) EXPECT_FALSE(v.x == 24 && v.y == 24);
    EXPECT_EQ(planet::read_image((folder_ / "domain.png").string()).width, 1600);
    // One of the finest vertices drags nothing along.
    EXPECT_EQ(mesh("--patches 3x3 --patch-level 4 --remove 23,24").at("removed_vertices"), 1);
}

TEST_F(MeshCommand, RemovesAVertexOfThePlanet) {
    const Json report = mesh("--planet --level 10 --remove 45,45 --picture d.png -o d.ply");
    EXPECT_EQ(report.at("merged_triangles"), 238);
    EXPECT_EQ(report.at("merged_by_step"), Json({2, 4, 8, 16, 24, 40, 56, 88}));
    const SurfaceMesh written = read("d.ply");
    expect_counts(written, report);
    expect_closed(written);
    EXPECT_EQ(turned_down(written, true), 0u);
    EXPECT_EQ(written.triangles.size() + 2 * report.at("removed_vertices").get<std::size_t>(), 8u << 10);
    EXPECT_EQ(planet::read_image((folder_ / "d.png").string()).height, 1600);
}

}  // namespace
}  // namespace render
