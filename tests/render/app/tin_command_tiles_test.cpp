// `octaglobe tin --tile`: what its files are put together, at every sample, and what of them is seen when it fails.

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <ostream>

#include "planet/elevation/raster_io.h"
#include "planet/mesh/surface_check.h"
#include "tests/render/app/slow_deviation.h"
#include "tests/render/app/tin_program.h"

namespace render {
namespace {

using planet::SurfaceMesh;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class TinTiles : public TinCommandTest {
  protected:
    std::vector<SurfaceMesh> read_tiles(const std::string& folder) const {
        std::vector<std::filesystem::path> paths;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / folder))
            paths.push_back(entry.path());
        std::sort(paths.begin(), paths.end());
        std::vector<SurfaceMesh> tiles;
        for (const auto& path : paths) tiles.push_back(planet::read_mesh(path.string()));
        return tiles;
    }
};

/// Of wide_terrain() in its own coordinates.
glm::ivec2 sample_at(const glm::dvec3& p) {
    return {std::lround((p.x - 10) * 100), std::lround((50 - p.y) * 100)};
}

bool has_vertex(const SurfaceMesh& mesh, glm::ivec2 sample) {
    return std::ranges::any_of(mesh.vertices, [&](const glm::dvec3& v) { return sample_at(v) == sample; });
}

/// How much of the straight line between two samples is sides, in columns or rows, whichever are more.
int steps_along(const SurfaceMesh& mesh, glm::ivec2 from, glm::ivec2 to) {
    const glm::ivec2 way = to - from;
    const auto place = [&](std::uint32_t v) {  // along the line; -1 off it
        const glm::ivec2 d = sample_at(mesh.vertices[v]) - from;
        const bool beyond =
            glm::dot(glm::dvec2(d), glm::dvec2(way)) < 0 || glm::length(glm::dvec2(d)) > glm::length(glm::dvec2(way));
        return d.x * way.y != d.y * way.x || beyond ? -1 : std::max(std::abs(d.x), std::abs(d.y));
    };
    std::set<std::pair<int, int>> sides;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax({place(t[k]), place(t[(k + 1) % 3])});
            if (low >= 0) sides.insert({low, high});
        }
    int steps = 0;
    for (const auto& [low, high] : sides) steps += high - low;
    return steps;
}

/// Four by four tiles of 20 samples.
Terrain wide_terrain() {
    Terrain terrain = hilly_terrain();
    terrain.width = terrain.height = 81;
    return terrain;
}

struct Written {
    const char *format, *frame;
    bool voids = false;
};
void PrintTo(const Written& written, std::ostream* out) {
    *out << written.format << ' ' << written.frame << (written.voids ? " with voids" : "");
}

class TinTilesOf : public TinTiles, public testing::WithParamInterface<Written> {};

TEST_P(TinTilesOf, FitBitForBit) {
    const auto& [format, frame, voids] = GetParam();
    Terrain terrain = wide_terrain();
    if (voids)
        terrain.height_m = [](int x, int y) {
            const bool lake = x > 30 && x < 52 && y > 15 && y < 45, speck = x == 20 && y == 20, side = x > 58 && y < 22,
                       below = y == 61 && x > 3 && x < 33;
            return lake || speck || side || below ? nan : hills(x, y);
        };
    terrain.write(folder_ / "dem.vrt");
    const Json report = tin(std::string("dem.vrt --max-deviation 15 --datum ellipsoid --tile 20 -o out/ --frame ") +
                            frame + " --format " + format + " --error-grid e.tif");
    EXPECT_EQ(report.at("tiles"), voids ? 15 : 16);
    const std::vector<SurfaceMesh> tiles = read_tiles("out");
    ASSERT_EQ(tiles.size(), voids ? 15u : 16u);
    std::size_t triangles = 0;
    for (const SurfaceMesh& tile : tiles) triangles += tile.triangles.size();
    EXPECT_EQ(triangles, report.at("triangles"));

    SurfaceMesh whole = put_together(tiles);
    std::size_t open = 0;
    {
        // What is open is the border of the raster and of its voids, as it is of one mesh of all.
        const Json one = tin(std::string("dem.vrt --max-deviation 0 -o one.ply"));
        open = open_sides(whole);
        if (!voids) {
            const planet::SurfaceCheck check = planet::check(whole, planet::MeshFrame::source);
            EXPECT_EQ(check.wrong_sides, 0u);
            EXPECT_EQ(check.degenerate, 0u);
            EXPECT_EQ(check.euler(), 1) << "a disc";
        }
        EXPECT_EQ(report.at("samples"), one.at("samples"));
        EXPECT_EQ(report.at("samples_uncovered"), one.at("samples_uncovered"));
        EXPECT_EQ(report.at("samples_void"), one.at("samples_void"));
    }
    EXPECT_LT(open, voids ? 600u : 4u * 80u);
    EXPECT_LE(number(report, "deviation_max_m"), 15);
    if (frame == std::string("source")) {
        const SlowDeviation slow = slow_deviation_in_source(whole, terrain);
        EXPECT_EQ(slow.uncovered, report.at("samples_uncovered"));
        EXPECT_NEAR(slow.max, number(report, "deviation_max_m"), 1e-6);
        EXPECT_NEAR(slow.rms, number(report, "deviation_rms_m"), 1e-6);
    }
    const planet::Raster errors = planet::read_raster((folder_ / "e.tif").string());
    double max = 0;
    std::size_t known = 0;
    for (int y = 0; y < 81; ++y)
        for (int x = 0; x < 81; ++x) {
            max = std::fmax(max, errors.at(x, y));
            known += !std::isnan(errors.at(x, y));
        }
    EXPECT_NEAR(max, number(report, "deviation_max_m"), 1e-3);
    EXPECT_EQ(known, report.at("samples"));
}

INSTANTIATE_TEST_SUITE_P(Table, TinTilesOf,
                         testing::Values(Written{"ply", "source"}, Written{"ply", "source", true},
                                         Written{"glb", "enu"}, Written{"glb", "enu", true}, Written{"stl", "enu"},
                                         Written{"glb", "ecef"}, Written{"obj", "ecef", true}, Written{"glb", "utm"}));

// Tiles of 2000 km: the chords of borders sag along verticals that lean, and what has to go in there goes into both tiles.
TEST_F(TinTiles, CurvedBordersAreMendedOnBothSides) {
    Terrain terrain = wide_terrain();
    terrain.step_x = 0.9, terrain.step_y = -0.9, terrain.x = 0;
    terrain.write(folder_ / "dem.vrt");
    const Json report =
        tin("dem.vrt --max-deviation 1500 --datum ellipsoid --tile 20 -o out --format ply --frame ecef");
    EXPECT_GT(number(report, "tiles_remade"), 0) << "or this tests nothing";
    EXPECT_LE(number(report, "deviation_max_m"), 1500);
    const SurfaceMesh whole = put_together(read_tiles("out"));
    const planet::SurfaceCheck check = planet::check(whole, planet::MeshFrame::ecef);
    EXPECT_EQ(check.wrong_sides, 0u);
    EXPECT_EQ(check.euler(), 1);
    EXPECT_LT(open_sides(whole), 4u * 80u);
}

TEST_F(TinTiles, TheSameBytesWhateverIsDoneFirst) {
    wide_terrain().write(folder_ / "dem.vrt");
    tin("dem.vrt --max-deviation 15 --tile 20 -o a");
    tin("dem.vrt --max-deviation 15 --tile 20 -o b");
    EXPECT_EQ(content(folder_ / "a/row1_column2.glb"), content(folder_ / "b/row1_column2.glb"));
    EXPECT_NE(content(folder_ / "a/row1_column2.glb"), "");
}

TEST_F(TinTiles, MaskedTilesAreLeftOut) {
    wide_terrain().write(folder_ / "dem.vrt");
    write_features(folder_ / "area.geojson",
                   R"({"type":"Polygon","coordinates":[[[10.045,49.955],[10.355,49.955],[10.355,49.405],[10.045,49.405],
                      [10.045,49.955]]]})");
    const Json report = tin("dem.vrt --max-deviation 15 --tile 20 --mask area.geojson -o out --format ply");
    EXPECT_EQ(report.at("tiles"), 6);
    EXPECT_EQ(report.at("tiles_void"), 10);
    EXPECT_EQ(report.at("samples"), 31 * 55);
    const SurfaceMesh whole = put_together(read_tiles("out"));
    EXPECT_EQ(planet::check(whole, planet::MeshFrame::source).euler(), 1);
}

// Lines that cross borders and each other, run along them and end at them, points on borders and at corners, in a terrain
// with a hole on one.
TEST_F(TinTiles, FeaturesAreInThem) {
    for (const bool holes : {false, true}) {
        Terrain terrain = wide_terrain();
        if (holes)
            terrain.height_m = [](int x, int y) { return x > 33 && x < 48 && y > 34 && y < 43 ? nan : hills(x, y); };
        terrain.write(folder_ / "dem.vrt");
        write_features(folder_ / "f.geojson",
                       R"({"type":"LineString","coordinates":[[10.03,49.97],[10.75,49.26],[10.07,49.41]]},
                          {"type":"LineString","coordinates":[[10.02,49.28],[10.77,49.93]]},
                          {"type":"LineString","coordinates":[[10.4,49.94],[10.4,49.22]]},
                          {"type":"LineString","coordinates":[[10.33,49.6],[10.61,49.6],[10.69,49.79]]},
                          {"type":"Point","coordinates":[10.2,49.6]},{"type":"Point","coordinates":[10.6,49.73]},
                          {"type":"Point","coordinates":[10.41,49.51]}, {"type":"Point","coordinates":[12,49]})");
        for (const std::string how : {"--format ply", "--frame ecef --format glb", "--quality best --format ply"}) {
            std::filesystem::remove_all(folder_ / "out");
            const Json report = tin("dem.vrt --max-deviation 60 --tile 20 -o out --features f.geojson " + how);
            EXPECT_EQ(number(report, "feature_points") + number(report, "feature_duplicates") +
                          number(report, "features_over_voids"),
                      3)
                << "each once";
            EXPECT_EQ(report.at("features_outside"), 1);
            EXPECT_EQ(report.at("features_dropped"), 0);
            EXPECT_GE(report.at("feature_crossings"), 1) << "in tiles: others are vertices of borders";
            EXPECT_LE(number(report, "deviation_max_m"), 60);
            const SurfaceMesh whole = put_together(read_tiles("out"));
            const planet::SurfaceCheck check = planet::check(
                whole, how == "--frame ecef --format glb" ? planet::MeshFrame::ecef : planet::MeshFrame::source);
            EXPECT_EQ(check.wrong_sides, 0u);
            EXPECT_EQ(check.doubled_vertices, 0u);
            EXPECT_EQ(check.euler(), holes ? 0 : 1) << how << ": a disc, or one with a hole";
            EXPECT_EQ(report.at("samples_uncovered"), 0);
            if (how == "--frame ecef --format glb") continue;
            EXPECT_NEAR(slow_deviation_in_source(whole, terrain).max, number(report, "deviation_max_m"), 1e-6);
            if (holes)
                EXPECT_EQ(steps_along(whole, {40, 44}, {40, 78}), 34) << "a border, beyond the hole";
            else
                EXPECT_EQ(steps_along(whole, {40, 6}, {40, 78}), 72) << "a border";
            EXPECT_EQ(steps_along(whole, {3, 3}, {20, 20}), 17) << "up to the first border";
            EXPECT_TRUE(has_vertex(whole, {20, 40}) && has_vertex(whole, {60, 27}));
            EXPECT_EQ(has_vertex(whole, {41, 49}), true);
        }
    }
}

TEST_F(TinTiles, ABudgetIsSharedOut) {
    const Terrain terrain = wide_terrain();
    terrain.write(folder_ / "dem.vrt");
    for (const auto& [budget, format] : {std::pair(40, "ply"), {1000, "ply"}, {1000, "glb"}, {20000, "ply"}}) {
        std::filesystem::remove_all(folder_ / "out");
        const Json report =
            tin("dem.vrt --max-triangles " + std::to_string(budget) + " --tile 20 -o out --format " + format);
        EXPECT_LE(report.at("triangles"), budget);
        EXPECT_GE(report.at("triangles"), std::min(0.95 * budget, 12000.0)) << "as many as are of use";
        EXPECT_EQ(report.at("stopped_by"), "triangles");
        EXPECT_LE(report.at("search_trials"), 12);
        const SurfaceMesh whole = put_together(read_tiles("out"));
        EXPECT_EQ(planet::check(whole, planet::MeshFrame::source).euler(), 1);
        if (format == std::string("glb")) continue;
        EXPECT_NEAR(slow_deviation_in_source(whole, terrain).max, number(report, "deviation_max_m"), 1e-6);
    }
    std::filesystem::remove_all(folder_ / "out");
    const Json bound = tin("dem.vrt --max-triangles 5000 --max-deviation 100 --tile 20 -o out");
    EXPECT_EQ(bound.at("stopped_by"), "deviation");
    EXPECT_LE(number(bound, "deviation_max_m"), 100);
    std::filesystem::remove_all(folder_ / "out");
    const Json budget = tin("dem.vrt --max-triangles 500 --max-deviation 1 --tile 20 -o out");
    EXPECT_EQ(budget.at("stopped_by"), "triangles");
    EXPECT_GT(number(budget, "deviation_max_m"), 1);
}

/// Foothills of the Sangre de Cristo: 193 x 193 samples.
Terrain real_terrain() {
    Terrain terrain;
    terrain.width = terrain.height = 193;
    const auto dem =
        std::make_shared<planet::Raster>(planet::read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif"));
    terrain.height_m = [dem](int x, int y) { return dem->at(1600 + x, 700 + y); };
    return terrain;
}

// What a metric adds up is less with it than without, within the same budget; borders fit.
TEST_F(TinTiles, ABudgetGoesWhereAMetricWantsIt) {
    const Terrain terrain = real_terrain();
    terrain.write(folder_ / "dem.vrt");
    std::map<std::string, double> rms;
    for (const std::string metric : {"local", "regional", "rms"}) {
        std::filesystem::remove_all(folder_ / "out");
        const Json report = tin("dem.vrt --max-triangles 2000 --tile 48 --format ply -o out --metric " + metric);
        EXPECT_LE(report.at("triangles"), 2000);
        EXPECT_GE(report.at("triangles"), 1900);
        EXPECT_EQ(report.at("stopped_by"), "triangles");
        const SurfaceMesh whole = put_together(read_tiles("out"));
        const planet::SurfaceCheck check = planet::check(whole, planet::MeshFrame::source);
        EXPECT_EQ(check.wrong_sides, 0u);
        EXPECT_EQ(check.euler(), 1) << "a disc";
        const SlowDeviation slow = slow_deviation_in_source(whole, terrain);
        EXPECT_NEAR(slow.max, number(report, "deviation_max_m"), 1e-6);
        EXPECT_NEAR(slow.rms, number(report, "deviation_rms_m"), 1e-6);
        rms[metric] = slow.rms;
    }
    EXPECT_LT(rms["rms"], 0.9 * rms["local"]);
    EXPECT_LT(rms["rms"], rms["regional"]);
}

// Without a budget the metric is but an order in which the tolerance is reached.
TEST_F(TinTiles, KeepTheBoundByAnyMetric) {
    Terrain terrain = wide_terrain();
    terrain.height_m = [](int x, int y) { return x > 33 && x < 50 && y > 10 && y < 44 ? nan : hills(x, y); };
    terrain.write(folder_ / "dem.vrt");
    for (const std::string how : {"regional --format ply --frame source", "rms --format glb",
                                  "rms --format stl --base 50", "rms --max-triangles 20000 --format glb --frame utm"}) {
        std::filesystem::remove_all(folder_ / "out");
        const Json report = tin("dem.vrt --max-deviation 15 --datum ellipsoid --tile 20 -o out --metric " + how);
        EXPECT_LE(number(report, "deviation_max_m"), 15);
        EXPECT_EQ(report.at("stopped_by"), "deviation");
    }
    std::filesystem::remove_all(folder_ / "out");
    const Json budget = tin("dem.vrt --max-triangles 700 --max-deviation 1 --metric rms --tile 20 -o out");
    EXPECT_EQ(budget.at("stopped_by"), "triangles");
    EXPECT_GT(number(budget, "deviation_max_m"), 1);
    EXPECT_LE(budget.at("triangles"), 700);
}

// Their floors are level with each other, and their walls the same.
TEST_F(TinTiles, EachIsASolid) {
    Terrain terrain = wide_terrain();
    terrain.height_m = [](int x, int y) { return x > 30 && x < 52 && y > 15 && y < 45 ? nan : hills(x, y) + 9 * x; };
    terrain.write(folder_ / "dem.vrt");
    for (const std::string how : {"--format ply", "--format glb", "--format glb --frame ecef", "--format stl"}) {
        std::filesystem::remove_all(folder_ / "out");
        const Json report = tin("dem.vrt --max-deviation 20 --tile 20 --base 50 -o out " + how);
        EXPECT_EQ(report.at("closed"), true);
        EXPECT_EQ(report.at("base_m"), 50);
        EXPECT_LE(number(report, "deviation_max_m"), 20);
        std::set<double> floors;
        for (const SurfaceMesh& tile : read_tiles("out")) {
            EXPECT_EQ(open_sides(tile), 0u) << how;
            EXPECT_GT(sixfold_volume(tile), 0) << how;
            floors.insert(std::ranges::min(tile.vertices, {}, &glm::dvec3::z).z);
        }
        EXPECT_TRUE(floors.size() == 1 || how == "--format glb --frame ecef") << how;
    }
}

TEST_F(TinTiles, DrapesAreCut) {
    wide_terrain().write(folder_ / "dem.vrt");
    std::ofstream(folder_ / "drape.png", std::ios::binary)
        << planet::testing::png_bytes(162, 162, 8, [](int x, int y) { return static_cast<unsigned>(x + y) % 256; });
    tin("dem.vrt --max-deviation 15 --tile 40 --drape drape.png -o out");
    for (const char* name : {"out/row0_column0.glb", "out/row1_column1.glb"}) {
        const std::string file = content(folder_ / name);
        EXPECT_NE(file.find("image/png"), std::string::npos);
        EXPECT_NE(file.find("\x89PNG"), std::string::npos);
    }
}

// A limit of the size of files stands for a full disk.
TEST_F(TinTiles, NothingOfThemIsLeftByAFullDisk) {
    wide_terrain().write(folder_ / "dem.vrt");
    const auto before = folder_.names();
    for (const char* arguments :
         {"tin dem.vrt --max-deviation 0.1 --tile 40 -o out --format ply", "tin dem.vrt --max-deviation 0.1 -o t.glb",
          "tin dem.vrt --max-deviation 0.1 -o t.ply --error-grid e.tif --json r.json"}) {
        const Outcome outcome = render::run(folder_.path(), words(arguments), [] {
            const rlimit size{9000, 9000};
            ::setrlimit(RLIMIT_FSIZE, &size);
            std::signal(SIGXFSZ, SIG_IGN);
        });
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_NE(outcome.err.find("cannot be written"), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find(".part"), std::string::npos) << "what nobody has named: " << outcome.err;
        EXPECT_EQ(folder_.names(), before) << arguments;
    }
}

TEST_F(TinTiles, AFolderThatIsThereStays) {
    wide_terrain().write(folder_ / "dem.vrt");
    std::filesystem::create_directory(folder_ / "full");
    std::filesystem::create_directory(folder_ / "empty");
    std::ofstream(folder_ / "full/precious") << "kept";
    const Outcome outcome = render::run(folder_.path(), words("tin dem.vrt --max-deviation 15 --tile 20 -o full"));
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("is there, and not empty"), std::string::npos) << outcome.err;
    EXPECT_EQ(content(folder_ / "full/precious"), "kept");
    tin("dem.vrt --max-deviation 15 --tile 40 -o empty");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "empty/row1_column1.glb"));
}

}  // namespace
}  // namespace render
