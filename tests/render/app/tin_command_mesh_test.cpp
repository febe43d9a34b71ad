// `octaglobe tin` as a user runs it: its files are read back and measured the slow way (slow_deviation.h), and compared
// with what the report says. Tiles are in tin_command_tiles_test.cpp, refusals in tin_command_refusal_test.cpp.

#include <ostream>
#include <regex>

#include "planet/elevation/image_io.h"
#include "planet/elevation/raster_io.h"
#include "tests/render/app/slow_deviation.h"
#include "tests/render/app/tin_program.h"

namespace render {
namespace {

using planet::SurfaceMesh;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Written {
    const char *file, *frame, *more;
    bool rows_north = false;
};
void PrintTo(const Written& written, std::ostream* out) {
    *out << written.file << ' ' << written.frame << ' ' << written.more << (written.rows_north ? ", rows north" : "");
}

class TinFiles : public TinCommandTest, public testing::WithParamInterface<Written> {};

TEST_P(TinFiles, KeepTheBoundAndSayHowWell) {
    const auto& [file, frame, more, rows_north] = GetParam();
    Terrain terrain = hilly_terrain();
    if (rows_north) terrain.step_y = -terrain.step_y;
    terrain.write(folder_ / "dem.vrt");
    const std::string options =
        "dem.vrt --max-deviation 20 --datum ellipsoid --frame " + std::string(frame) + " " + more + " -o ";
    tin(options + "reference.ply");  // an .stl does not say where its origin is
    planet::MeshReference reference;
    read("reference.ply", &reference);
    const Json report = tin(options + file);
    const SurfaceMesh written = read(file);
    EXPECT_EQ(written.triangles.size(), report.at("triangles"));
    EXPECT_EQ(written.vertices.size(), report.at("vertices"));
    EXPECT_EQ(report.at("frame"), frame);
    EXPECT_EQ(report.at("stopped_by"), "deviation");
    expect_as_reported(written, reference, terrain, report);
    EXPECT_LE(number(report, "deviation_max_m"), 20);
    EXPECT_EQ(open_sides(written), static_cast<std::size_t>(open_sides(read("reference.ply"))));
}

INSTANTIATE_TEST_SUITE_P(Table, TinFiles,
                         testing::Values(Written{"t.ply", "source", ""}, Written{"t.obj", "source", "--quality fast"},
                                         Written{"t.ply", "source", "--quality best", true},
                                         Written{"t.glb", "enu", ""}, Written{"t.glb", "enu", "--quality fast", true},
                                         Written{"t.stl", "enu", ""}, Written{"t.ply", "enu", "--metric regional"},
                                         Written{"t.glb", "ecef", "--metric rms"},
                                         Written{"t.obj", "ecef", "--locate cells", true}));

// To the last bit, in every format and frame, in tiles and whole, whether heights are whole metres or not.
TEST_F(TinCommandTest, NoBoundIsExceededAtAll) {
    for (const auto& [unit, bound] : {std::pair(1.0, "0"), {1.0, "20"}, {1 / 3.0, "7.3"}}) {
        Terrain terrain = hilly_terrain();
        terrain.x = -105.7003;
        terrain.height_m = [unit = unit](int x, int y) { return unit * hills(x, y); };
        terrain.write(folder_ / "dem.vrt");
        for (const std::string format_frame : {"ply source", "ply utm", "ply enu", "ply ecef", "obj source", "glb utm",
                                               "glb enu", "glb ecef", "stl enu"}) {
            const std::string format = format_frame.substr(0, 3), frame = format_frame.substr(4);
            if (*bound == '0' && (format == "glb" || format == "stl")) continue;  // which round
            const std::string how = std::string("dem.vrt --max-deviation ") + bound + " --frame " + frame;
            EXPECT_LE(number(tin(how + " -o t." + format), "deviation_max_m"), std::stod(bound)) << how;
            std::filesystem::remove_all(folder_ / "out");
            EXPECT_LE(number(tin(how + " --tile 16 -o out --format " + format), "deviation_max_m"), std::stod(bound))
                << how << " in tiles";
        }
    }
}

// What a refusal says is possible is possible.
TEST_F(TinCommandTest, TheBoundThatIsOfferedHolds) {
    hilly_terrain().write(folder_ / "dem.vrt");
    for (const std::string file : {"t.glb", "t.stl"}) {
        const Outcome refused = run(folder_.path(), words("tin dem.vrt --max-deviation 0 -o " + file));
        EXPECT_EQ(refused.status, 2);
        std::smatch offer;
        ASSERT_TRUE(std::regex_search(refused.err, offer, std::regex("accepted: ([0-9.e-]+) m or more, or a .ply")))
            << refused.err;
        EXPECT_LE(number(tin("dem.vrt --max-deviation " + offer[1].str() + " -o " + file), "deviation_max_m"),
                  std::stod(offer[1]));
    }
}

TEST_F(TinCommandTest, ZeroDeviationIsKeptWhereNothingRounds) {
    for (const auto& [width, height] : {std::pair(2, 2), {2, 9}, {17, 2}, {3, 5}, {33, 33}}) {
        Terrain terrain = hilly_terrain();
        terrain.width = width;
        terrain.height = height;
        terrain.write(folder_ / "dem.vrt");
        EXPECT_EQ(tin("dem.vrt --max-deviation 0 -o t.ply").at("deviation_max_m"), 0);
        EXPECT_LT(slow_deviation_in_source(read("t.ply"), terrain).max, 1e-6);
    }
}

TEST_F(TinCommandTest, BudgetsAreMetWithinTwo) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    double last = 1e9;
    for (const int budget : {2, 50, 150, 250, 450, 750, 1050})
        for (const char* more : {"", " --quality fast --metric rms"}) {
            const Json report = tin("dem.vrt -o t.ply --max-triangles " + std::to_string(budget) + more);
            EXPECT_LE(report.at("triangles"), budget) << more;
            EXPECT_GE(report.at("triangles"), budget - 2) << more;
            EXPECT_EQ(report.at("stopped_by"), "triangles");
            EXPECT_NEAR(slow_deviation_in_source(read("t.ply"), terrain).max, number(report, "deviation_max_m"), 1e-6);
            if (*more) continue;
            EXPECT_LE(number(report, "deviation_max_m"), last);
            last = number(report, "deviation_max_m");
        }
}

TEST_F(TinCommandTest, OfBoundAndBudgetTheFirstStops) {
    hilly_terrain().write(folder_ / "dem.vrt");
    const Json budget = tin("dem.vrt --max-deviation 20 --max-triangles 100 -o t.glb");
    EXPECT_EQ(budget.at("stopped_by"), "triangles");
    EXPECT_LE(budget.at("triangles"), 100);
    EXPECT_GT(number(budget, "deviation_max_m"), 20);
    const Json bound = tin("dem.vrt --max-deviation 20 --max-triangles 5000 -o t.glb");
    EXPECT_EQ(bound.at("stopped_by"), "deviation");
    EXPECT_LE(number(bound, "deviation_max_m"), 20);
    EXPECT_NE(outcome_.out.find("stopped by the deviation"), std::string::npos) << outcome_.out;
}

// Another way to find triangles is another way to the same file.
TEST_F(TinCommandTest, LocatorsMakeTheSameMesh) {
    hilly_terrain().write(folder_ / "dem.vrt");
    for (const char* how : {"--max-triangles 300 ", "--max-triangles 301 --quality fast "}) {
        tin("dem.vrt -o auto.ply " + std::string(how) + "--locate auto");
        for (const std::string way : {"cells", "naive"}) {
            tin("dem.vrt -o t.ply " + std::string(how) + "--locate " + way);
            EXPECT_EQ(content(folder_ / "t.ply"), content(folder_ / "auto.ply")) << how << way;
        }
    }
}

// Level ground of 400 km: what there is to approximate is the planet's curvature.
TEST_F(TinCommandTest, CurvatureIsWithinTheBound) {
    Terrain terrain = hilly_terrain();
    terrain.step_x = 0.1;
    terrain.step_y = -0.1;
    terrain.height_m = [](int, int) { return 0.0; };
    terrain.write(folder_ / "dem.vrt");
    EXPECT_EQ(tin("dem.vrt --max-deviation 20 -o t.ply").at("triangles"), 2);
    for (const std::string frame : {"ecef", "enu"}) {
        const Json report = tin("dem.vrt --max-deviation 20 --datum ellipsoid -o t.ply --frame " + frame);
        EXPECT_LE(number(report, "deviation_max_m"), 20);
        EXPECT_GT(report.at("triangles"), 20);
        planet::MeshReference reference;
        const SurfaceMesh written = read("t.ply", &reference);
        EXPECT_LE(slow_deviation_in_space(written, reference, terrain).max, 20.05);
    }
}

// A cap around the pole, and a strip across the antimeridian.
TEST_F(TinCommandTest, PolesAndTheAntimeridianAreGround) {
    Terrain pole = hilly_terrain();
    pole.x = -180, pole.step_x = 9, pole.y = 90, pole.step_y = -1;
    pole.write(folder_ / "pole.vrt");
    const Json cap = tin("pole.vrt --max-deviation 300 --datum ellipsoid --frame ecef -o pole.ply");
    EXPECT_LE(number(cap, "deviation_max_m"), 300);
    EXPECT_EQ(cap.at("samples"), 41 * 33);
    Terrain pacific = hilly_terrain();
    pacific.x = 179.8;
    pacific.write(folder_ / "pacific.vrt");
    for (const char* frame : {"ecef", "enu", "utm"}) {
        const Json strip =
            tin("pacific.vrt --max-deviation 20 --datum ellipsoid -o pacific.ply --frame " + std::string(frame));
        EXPECT_LE(number(strip, "deviation_max_m"), 20) << frame;
        const SurfaceMesh mesh = read("pacific.ply");
        double longest = 0;
        for (const auto& t : mesh.triangles)
            longest = std::max(longest, glm::distance(mesh.vertices[t[0]], mesh.vertices[t[1]]));
        EXPECT_LT(longest, 60e3) << frame << ": no triangle goes around the planet";
    }
}

TEST_F(TinCommandTest, FeaturesAreExactlyThere) {
    hilly_terrain().write(folder_ / "dem.vrt");
    write_features(folder_ / "lines.geojson",
                   R"({"type":"LineString","coordinates":[[10.02,49.98],[10.32,49.83]]},
                      {"type":"LineString","coordinates":[[10.05,49.80],[10.05,49.95]]})");
    write_features(folder_ / "points.geojson",
                   R"({"type":"Point","coordinates":[10.13,49.91]},{"type":"Point","coordinates":[10.131,49.91]},
                      {"type":"Point","coordinates":[20,20]})");
    const Json report = tin("dem.vrt --max-deviation 2000 --features lines.geojson points.geojson -o t.ply");
    EXPECT_EQ(report.at("feature_points"), 1);
    EXPECT_EQ(report.at("feature_duplicates"), 1);
    EXPECT_EQ(report.at("features_outside"), 1);
    EXPECT_EQ(report.at("feature_sides"), 2);
    const SurfaceMesh mesh = read("t.ply");
    const auto sample = [&](std::uint32_t v) {
        return std::pair(std::lround((mesh.vertices[v].x - 10) * 100), std::lround((50 - mesh.vertices[v].y) * 100));
    };
    std::set<std::pair<std::pair<long, long>, std::pair<long, long>>> sides;
    std::set<std::pair<long, long>> vertices;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            sides.insert({sample(t[k]), sample(t[(k + 1) % 3])});
            vertices.insert(sample(t[k]));
        }
    EXPECT_TRUE(vertices.contains({13, 9}));
    // The first line is crossed by nothing: sides from sample to sample along it.
    long covered = 0;
    for (const auto& [a, b] : sides) {
        const auto on = [](std::pair<long, long> p) { return p.first - 2 == 2 * (p.second - 2); };
        if (on(a) && on(b) && b.first > a.first && a.first >= 2 && b.first <= 32) covered += b.first - a.first;
    }
    EXPECT_EQ(covered, 30) << "the whole line is sides";
    EXPECT_LE(tin("dem.vrt --max-deviation 20 --max-triangles 200 --features lines.geojson -o t.ply").at("triangles"),
              200);
}

TEST_F(TinCommandTest, MasksAndVoidsAreLeftOut) {
    Terrain terrain = hilly_terrain();
    terrain.height_m = [](int x, int y) { return x > 20 && x < 28 && y > 9 && y < 17 ? nan : hills(x, y); };
    terrain.write(folder_ / "dem.vrt");
    write_features(folder_ / "area.geojson",
                   R"({"type":"Polygon","coordinates":[[[10.045,49.955],[10.355,49.955],[10.355,49.705],[10.045,49.705],
                      [10.045,49.955]]]})");
    for (const char* how : {"--max-deviation 20", "--max-deviation 0", "--max-triangles 700 --metric regional"}) {
        const Json report = tin(std::string("dem.vrt --mask area.geojson -o t.ply ") + how);
        EXPECT_EQ(report.at("samples"), 31 * 25 - 49) << how;
        EXPECT_EQ(report.at("samples_uncovered"), 0) << how;
        for (const glm::dvec3& v : read("t.ply").vertices) {
            EXPECT_TRUE(v.x > 10.045 && v.x < 10.355 && v.y > 49.705 && v.y < 49.955);
            EXPECT_TRUE(std::isfinite(v.z));
        }
        Terrain masked = terrain;
        masked.height_m = [&](int x, int y) {
            return x >= 5 && x <= 35 && y >= 5 && y <= 29 ? terrain.height_m(x, y) : nan;
        };
        EXPECT_NEAR(slow_deviation_in_source(read("t.ply"), masked).max, number(report, "deviation_max_m"), 1e-6);
    }
}

TEST_F(TinCommandTest, SolidsAreClosed) {
    Terrain terrain = hilly_terrain();
    terrain.height_m = [](int x, int y) {  // holes that touch at corners, and an island in one
        if ((x == 5 && y == 5) || (x == 6 && y == 6) || (x == 12 && y == 12)) return nan;
        const int from_middle = std::max(std::abs(x - 28), std::abs(y - 16));
        return from_middle > 2 && from_middle < 6 ? nan : hills(x, y);
    };
    terrain.write(folder_ / "dem.vrt");
    for (const std::string file :
         {"t.stl", "t.glb", "t.ply", "t.obj --frame utm", "t.ply --frame ecef", "t.ply --frame enu"}) {
        const Json report = tin("dem.vrt --max-deviation 20 --base 50 -o " + file);
        const SurfaceMesh solid = read(file.substr(0, 5));
        EXPECT_LE(number(report, "deviation_max_m"), 20) << file;
        EXPECT_EQ(report.at("triangles"), solid.triangles.size());
        EXPECT_GT(sixfold_volume(solid), 0) << file;
        if (file == "t.stl") continue;  // it has no vertices, only places
        EXPECT_EQ(open_sides(solid), 0u) << file;
        if (file != "t.ply") continue;
        double lowest = 1e9, lowest_sample = 1e9;
        for (const glm::dvec3& v : solid.vertices) lowest = std::min(lowest, v.z);
        for (int y = 0; y < 33; ++y)
            for (int x = 0; x < 41; ++x) lowest_sample = std::fmin(lowest_sample, terrain.height_m(x, y));
        EXPECT_NEAR(lowest, lowest_sample - 50, 1e-9);
        double above_floor = 0;  // the prisms below all triangles that look up
        for (const auto& t : solid.triangles) {
            const glm::dvec3 &p = solid.vertices[t[0]], &q = solid.vertices[t[1]], &r = solid.vertices[t[2]];
            const double area = 0.5 * glm::cross(q - p, r - p).z;
            if (area > 1e-9) above_floor += area * ((p.z + q.z + r.z) / 3 - lowest);
        }
        EXPECT_NEAR(sixfold_volume(solid) / 6, above_floor, 1e-6) << "square degrees times metres";
    }
}

TEST_F(TinCommandTest, ExaggerationLeavesTheToleranceAlone) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    const Json plain = tin("dem.vrt --max-deviation 20 -o plain.ply"),
               tall = tin("dem.vrt --max-deviation 20 --exaggeration 3 -o tall.ply");
    EXPECT_EQ(plain.at("triangles"), tall.at("triangles"));
    EXPECT_NEAR(number(plain, "deviation_max_m"), number(tall, "deviation_max_m"), 1e-6);
    const SurfaceMesh low = read("plain.ply"), high = read("tall.ply");
    for (std::size_t i = 0; i < low.vertices.size(); ++i) EXPECT_EQ(3 * low.vertices[i].z, high.vertices[i].z);
    for (const char* e : {"0.2", "5"}) {
        const Json curved =
            tin("dem.vrt --max-deviation 20 --datum ellipsoid -o t.glb --exaggeration " + std::string(e));
        EXPECT_LE(number(curved, "deviation_max_m"), 20);
        planet::MeshReference reference;
        const SurfaceMesh mesh = read("t.glb", &reference);
        Terrain stretched = terrain;
        stretched.height_m = [&](int x, int y) { return std::stod(e) * hills(x, y); };
        EXPECT_NEAR(slow_deviation_in_space(mesh, reference, stretched).max,
                    std::stod(e) * number(curved, "deviation_max_m"), 0.05 * std::stod(e));
    }
}

TEST_F(TinCommandTest, ErrorGridHasEverySample) {
    Terrain terrain = hilly_terrain();
    terrain.height_m = [](int x, int y) { return x == 7 && y == 8 ? nan : hills(x, y); };
    terrain.write(folder_ / "dem.vrt");
    const Json report = tin("dem.vrt --max-deviation 30 --error-grid e.tif");
    const planet::Raster grid = planet::read_raster((folder_ / "e.tif").string());
    ASSERT_EQ(grid.width, 41);
    ASSERT_EQ(grid.height, 33);
    EXPECT_EQ(grid.crs, "EPSG:4326");
    EXPECT_NEAR(grid.grid.origin.x, 10, 1e-12);
    EXPECT_NEAR(grid.grid.origin.y, 50, 1e-12);
    EXPECT_NEAR(grid.grid.per_row.y, -0.01, 1e-12);
    double max = 0, squares = 0;
    for (int y = 0; y < 33; ++y)
        for (int x = 0; x < 41; ++x) {
            EXPECT_EQ(std::isnan(grid.at(x, y)), x == 7 && y == 8);
            max = std::fmax(max, grid.at(x, y));
            if (!std::isnan(grid.at(x, y))) squares += grid.at(x, y) * grid.at(x, y);
        }
    EXPECT_NEAR(max, number(report, "deviation_max_m"), 1e-4);
    EXPECT_NEAR(std::sqrt(squares / number(report, "samples")), number(report, "deviation_rms_m"), 1e-4);
}

TEST_F(TinCommandTest, SeveralFilesAreOneRaster) {
    hilly_terrain().write(folder_ / "whole.vrt");
    for (const int part : {0, 1}) {
        Terrain half = hilly_terrain();
        half.width = part == 0 ? 20 : 21;
        half.x = 10 + 0.2 * part;
        half.height_m = [=](int x, int y) { return hills(x + 20 * part, y); };
        half.write(folder_ / (part == 0 ? "part-0.vrt" : "part-1.vrt"));
    }
    tin("whole.vrt --max-deviation 20 -o whole.ply");
    for (const char* files : {"part-1.vrt part-0.vrt", "part-?.vrt"}) {
        const Json report = tin(std::string(files) + " --max-deviation 20 -o t.ply");
        EXPECT_EQ(report.at("columns"), 41);
        const SurfaceMesh one = read("whole.ply"), two = read("t.ply");
        EXPECT_EQ(one.triangles, two.triangles);
    }
}

TEST_F(TinCommandTest, HeightmapsNeedNoPlace) {
    std::ofstream(folder_ / "map.png", std::ios::binary) << planet::testing::png_bytes(30, 20, 8, [](int x, int y) {
        return static_cast<unsigned>(100 + 50 * std::sin(x * 0.4) * std::cos(y * 0.3));
    });
    for (const char* file : {"t.ply", "t.glb", "t.stl --base 5"}) {
        const Json report = tin("map.png --max-deviation 4 -o " + std::string(file));
        EXPECT_EQ(report.at("crs"), "");
        EXPECT_LE(number(report, "deviation_max_m"), 4);
    }
}

// What a viewer reads of a .glb: unit normals that look up, and the picture with its north at the north.
TEST_F(TinCommandTest, GlbIsLitAndDraped) {
    hilly_terrain().write(folder_ / "dem.vrt");
    planet::Image picture{82, 66, 3, std::vector<std::uint8_t>(82 * 66 * 3, 128)};
    planet::write_image((folder_ / "drape.png").string(), picture);
    planet::write_image((folder_ / "drape.jpg").string(), picture);
    planet::write_image((folder_ / "drape.tif").string(), picture);
    for (const std::string kind : {"png", "jpg", "tif"}) {
        tin("dem.vrt --max-deviation 20 -o t.glb --drape drape." + kind);
        const std::string file = content(folder_ / "t.glb");
        std::uint32_t length;
        std::memcpy(&length, file.data() + 12, 4);
        const Json gltf = Json::parse(file.substr(20, length));
        const std::string binary = file.substr(28 + length);
        const auto& attributes = gltf.at("meshes")[0].at("primitives")[0].at("attributes");
        const auto floats = [&](const char* name, std::size_t n) {
            const auto& accessor = gltf.at("accessors")[attributes.at(name).get<std::size_t>()];
            const auto& view = gltf.at("bufferViews")[accessor.at("bufferView").get<std::size_t>()];
            std::vector<float> values(n * accessor.at("count").get<std::size_t>());
            EXPECT_EQ(view.at("byteLength"), 4 * values.size());
            EXPECT_EQ(view.at("byteOffset").get<std::size_t>() % 4, 0u);
            std::memcpy(values.data(), binary.data() + view.at("byteOffset").get<std::size_t>(), 4 * values.size());
            return values;
        };
        const auto at = floats("POSITION", 3), normals = floats("NORMAL", 3), uv = floats("TEXCOORD_0", 2);
        ASSERT_EQ(at.size(), normals.size());
        for (std::size_t i = 0; i < at.size() / 3; ++i) {
            const glm::vec3 n(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
            EXPECT_NEAR(glm::length(n), 1, 1e-5);
            EXPECT_GT(n.y, 0.5);
            // East to the right, north to the top.
            EXPECT_NEAR(uv[2 * i], 0.5 + at[3 * i] / (0.41 * 71696), 0.02);
            EXPECT_NEAR(uv[2 * i + 1], 0.5 + at[3 * i + 2] / (0.33 * 111230), 0.02);
        }
        const auto& image = gltf.at("images")[0];
        EXPECT_EQ(image.at("mimeType"), kind == "png" ? "image/png" : "image/jpeg");
        const auto& view = gltf.at("bufferViews")[image.at("bufferView").get<std::size_t>()];
        const std::string bytes =
            binary.substr(view.at("byteOffset").get<std::size_t>(), view.at("byteLength").get<std::size_t>());
        EXPECT_TRUE(kind == "tif" || bytes == content(folder_ / ("drape." + kind).c_str())) << "as it is";
        std::ofstream(folder_ / "out.bin", std::ios::binary) << bytes;
        EXPECT_EQ(planet::read_image((folder_ / "out.bin").string()).width, 82);
    }
}

}  // namespace
}  // namespace render
