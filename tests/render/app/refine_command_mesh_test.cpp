// octaglobe refine MESH: what it writes is a conforming mesh that keeps what was asked for, and says so.

#include <algorithm>
#include <set>

#include "tests/render/app/refine_program.h"

namespace render {
namespace {

using planet::MeshLooks;
using planet::SurfaceMesh;

std::vector<std::array<double, 3>> sorted_places(const SurfaceMesh& mesh) {
    std::vector<std::array<double, 3>> places;
    for (const glm::dvec3& v : mesh.vertices) places.push_back({v.x, v.y, v.z});
    std::sort(places.begin(), places.end());
    return places;
}

TEST_F(RefineCommandTest, NoSideIsLongerInAnyFormat) {
    write_mesh_file(folder_ / "mesh.ply", uneven_mesh());
    for (const char* ending : {".ply", ".obj", ".glb", ".stl"}) {
        SCOPED_TRACE(ending);
        const Json report = refine("mesh.ply --max-side 30 -o finer" + std::string(ending));
        const SurfaceMesh mesh = read("finer" + std::string(ending));
        EXPECT_LE(longest_side(mesh), 30.001);
        EXPECT_GT(longest_side(mesh), 15);
        EXPECT_EQ(report["triangles"], mesh.triangles.size());
        EXPECT_EQ(report["stopped_by"], "length");
        EXPECT_GE(number(report, "angle_ratio_min"), 0.6734);
        EXPECT_EQ(report["propagation_max"], 0) << "longest first never propagates";
    }
}

TEST_F(RefineCommandTest, ReadsEveryFormat) {
    for (const char* ending : {".ply", ".obj", ".glb", ".stl"}) {
        SCOPED_TRACE(ending);
        planet::MeshReference reference;
        if (ending == std::string(".stl")) reference.frame = planet::MeshFrame::enu;
        write_mesh_file(folder_.path() / ("mesh" + std::string(ending)), uneven_mesh(), reference);
        refine("mesh" + std::string(ending) + " --steps 1 -o finer.ply");
        EXPECT_GE(read("finer.ply").triangles.size(), 2 * uneven_mesh().triangles.size());
    }
}

TEST_F(RefineCommandTest, BothRulesHaveTheSameVerticesAfterTwoSteps) {
    write_mesh_file(folder_ / "mesh.ply", uneven_mesh());
    const Json modified = refine("mesh.ply --steps 2 --rule modified -o modified.ply");
    const Json plain = refine("mesh.ply --steps 2 --rule plain -o plain.ply");
    EXPECT_EQ(sorted_places(read("modified.ply")), sorted_places(read("plain.ply")));
    EXPECT_LE(modified["triangles"], plain["triangles"]);
    EXPECT_GE(number(plain, "angle_ratio_min"), 0.5);
    EXPECT_EQ(plain["pending_triangles"], 0);
}

TEST_F(RefineCommandTest, ABudgetIsNeverExceeded) {
    write_mesh_file(folder_ / "mesh.ply", uneven_mesh());
    for (const int budget : {32, 33, 100, 1001}) {
        const Json report = refine("mesh.ply --max-triangles " + std::to_string(budget) + " -o finer.ply");
        EXPECT_LE(report["triangles"].get<int>(), budget);
        EXPECT_GE(report["triangles"].get<int>(), budget - 2);
        EXPECT_EQ(report["stopped_by"], "triangles");
        EXPECT_EQ(read("finer.ply").triangles.size(), report["triangles"].get<std::size_t>());
    }
}

// The second-longest side: three triangles, and the shortest side is left alone.
TEST_F(RefineCommandTest, SplitsTheSideAtAPoint) {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {7, 5, 0}};  // sides 10, 5.83 and 8.6
    mesh.triangles = {{0, 1, 2}};
    write_mesh_file(folder_ / "mesh.ply", mesh);
    refine("mesh.ply --split 3.5,2.45 -o split.ply");
    const SurfaceMesh split = read("split.ply");
    EXPECT_EQ(split.triangles.size(), 3u);
    const auto places = sorted_places(split);
    EXPECT_TRUE(std::ranges::binary_search(places, std::array{3.5, 2.5, 0.0}));
    EXPECT_FALSE(std::ranges::binary_search(places, std::array{8.5, 2.5, 0.0}));
}

TEST_F(RefineCommandTest, RefinesWithinARegionOnly) {
    write_mesh_file(folder_ / "mesh.ply", uneven_mesh(8));
    write_features(folder_ / "area.geojson",
                   R"({"type":"Polygon","coordinates":[[[50,50],[200,50],[50,200],[50,50]]]})");
    const Json whole = refine("mesh.ply --max-side 20 -o whole.ply");
    const Json part = refine("mesh.ply --max-side 20 --region area.geojson -o part.ply");
    EXPECT_LT(4 * part["triangles"].get<int>(), whole["triangles"].get<int>());
    const SurfaceMesh mesh = read("part.ply");
    for (const auto& t : mesh.triangles) {
        const glm::dvec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
        if (middle.x < 60 || middle.y < 60 || middle.x + middle.y > 240) continue;
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_LE(glm::distance(mesh.vertices[t[k]], mesh.vertices[t[(k + 1) % 3]]), 20);
    }
    const Json steps = refine("mesh.ply --steps 2 --region area.geojson -o steps.ply");
    read("steps.ply");
    EXPECT_LT(steps["triangles"].get<int>(), 2 * 128);
}

// Vertices between others have the mean of what these carry; normals are unit vectors.
TEST_F(RefineCommandTest, AttributesAreInterpolated) {
    const SurfaceMesh mesh = uneven_mesh();
    MeshLooks looks;
    for (const glm::dvec3& v : mesh.vertices) {
        looks.uv.emplace_back(v.x / 512, v.y / 512);
        looks.colors.emplace_back(v.x / 512 + 0.05, v.y / 512 + 0.05, 0.25, 1);
        looks.normals.push_back(glm::normalize(glm::vec3(v.x / 400 - 0.5, 0.1, 1)));
    }
    for (const char* ending : {".glb", ".ply", ".obj"}) {
        SCOPED_TRACE(ending);
        write_mesh_file(folder_.path() / ("mesh" + std::string(ending)), mesh, {}, looks);
        refine("mesh" + std::string(ending) + " --max-side 40 -o finer" + ending);
        MeshLooks found;
        const SurfaceMesh finer = read("finer" + std::string(ending), &found);
        ASSERT_EQ(found.uv.size(), finer.vertices.size());
        ASSERT_EQ(found.colors.size(), finer.vertices.size());
        ASSERT_EQ(found.normals.size(), finer.vertices.size());
        for (std::size_t i = 0; i < finer.vertices.size(); ++i) {
            const glm::dvec3& v = finer.vertices[i];
            EXPECT_NEAR(found.uv[i].x, v.x / 512, 1e-4);
            EXPECT_NEAR(found.uv[i].y, v.y / 512, 1e-4);
            EXPECT_NEAR(found.colors[i].r, v.x / 512 + 0.05, 0.01);
            EXPECT_NEAR(found.colors[i].b, 0.25, 0.01);
            EXPECT_NEAR(glm::length(found.normals[i]), 1, 1e-6);
        }
    }
}

TEST_F(RefineCommandTest, LooseTrianglesAreWelded) {
    const SurfaceMesh whole = uneven_mesh();
    SurfaceMesh loose;
    for (const auto& t : whole.triangles) {
        const auto first = static_cast<std::uint32_t>(loose.vertices.size());
        for (const std::uint32_t v : t) loose.vertices.push_back(whole.vertices[v]);
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    write_mesh_file(folder_ / "loose.ply", loose);
    EXPECT_EQ(run(folder_.path(), words("refine loose.ply --steps 1 -o fine.ply")).status, 3);
    const Json report = refine("loose.ply --weld --steps 1 -o fine.ply");
    EXPECT_EQ(report["base_vertices"], whole.vertices.size());
    EXPECT_EQ(report["welded_vertices"], loose.vertices.size() - whole.vertices.size());
}

TEST_F(RefineCommandTest, DrawsAPicture) {
    write_mesh_file(folder_ / "mesh.ply", uneven_mesh());
    refine("mesh.ply --max-side 40 --picture refine.png --size 640x480");
    EXPECT_TRUE(content(folder_ / "refine.png").starts_with("\x89PNG"));
}

// ---- over terrain ----

/// The largest distance along z of a sample from the triangle that holds it, in degrees and metres.
double largest_deviation(const SurfaceMesh& mesh, const Terrain& terrain) {
    double largest = 0;
    for (int row = 0; row < terrain.height; ++row)
        for (int column = 0; column < terrain.width; ++column) {
            const glm::dvec2 p(terrain.x + column * terrain.step_x, terrain.y + row * terrain.step_y);
            double least = std::numeric_limits<double>::infinity();
            for (const auto& t : mesh.triangles) {
                const glm::dvec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
                const glm::dvec2 u(b - a), v(c - a), w = p - glm::dvec2(a);
                const double area = u.x * v.y - u.y * v.x;
                const double beta = (w.x * v.y - w.y * v.x) / area, gamma = (u.x * w.y - u.y * w.x) / area;
                if (beta < -1e-9 || gamma < -1e-9 || beta + gamma > 1 + 1e-9) continue;
                const double z = a.z + beta * (b.z - a.z) + gamma * (c.z - a.z);
                least = std::min(least, std::abs(z - terrain.height_m(column, row)));
            }
            largest = std::max(largest, least);
        }
    return largest;
}

TEST_F(RefineCommandTest, TheBoundHoldsAtEverySampleOfTheFile) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    for (const double bound : {100.0, 10.0}) {
        const Json report =
            refine("flat.ply --elevation dem.vrt --max-deviation " + std::to_string(bound) + " -o fine.ply");
        EXPECT_LE(number(report, "deviation_max_m"), bound + 1e-6);
        EXPECT_EQ(report["samples"], terrain.width * terrain.height);
        EXPECT_EQ(report["samples_uncovered"], 0);
        EXPECT_EQ(report["sides"], "plan");
        EXPECT_EQ(report["stopped_by"], "deviation");
        EXPECT_GE(number(report, "angle_ratio_min"), 0.6734);
        EXPECT_LE(largest_deviation(read("fine.ply"), terrain), bound + 1e-6);
    }
}

TEST_F(RefineCommandTest, TheBoundHoldsInALocalFrameThatRounds) {
    hilly_terrain().write(folder_ / "dem.vrt");
    ASSERT_EQ(run(folder_.path(), words("tin dem.vrt --max-deviation 150 -o tin.glb")).status, 0);
    const Json report = refine("tin.glb --elevation dem.vrt --max-deviation 20 -o fine.glb");
    EXPECT_LE(number(report, "deviation_max_m"), 20 + 1e-6);
    EXPECT_LE(report["samples_uncovered"].get<int>(), 2 * (41 + 33)) << "those on the border, whose sides are chords";
    EXPECT_LT(number(report, "lifted_max_m"), 1) << "the TIN was made of these samples";
    read("fine.glb");
}

// What is in the region is so before the file rounds it, too.
TEST_F(RefineCommandTest, TheBoundHoldsInARegionOfAMeshThatIsRounded) {
    hilly_terrain().write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    // Along a line on which vertices of the mesh lie.
    write_features(folder_ / "half.geojson",
                   R"({"type":"Polygon","coordinates":[[[10.2,49],[11,49],[11,51],[10.2,51],[10.2,49]]]})");
    const Json report = refine("flat.ply --elevation dem.vrt --max-deviation 20 --region half.geojson -o half.glb");
    EXPECT_LE(number(report, "deviation_max_in_region_m"), 20 + 1e-6);
    EXPECT_GT(number(report, "deviation_max_m"), 50);
}

// Beside a void, and where the mesh goes on beyond the raster, refinement ends.
TEST_F(RefineCommandTest, VoidsAndBordersEnd) {
    Terrain terrain = hilly_terrain();
    terrain.height_m = [](int x, int y) {
        return (x > 10 && x < 20 && y > 8 && y < 22) ? std::numeric_limits<double>::quiet_NaN() : hills(x, y);
    };
    terrain.write(folder_ / "dem.vrt");
    SurfaceMesh larger = terrain_rectangle();
    for (glm::dvec3& v : larger.vertices) v.x = 10.2 + 2 * (v.x - 10.2), v.y = 49.84 + 2 * (v.y - 49.84);
    write_mesh_file(folder_ / "flat.ply", larger, degrees_reference());
    const Json report = refine("flat.ply --elevation dem.vrt --max-deviation 20 -o fine.ply");
    EXPECT_LE(number(report, "deviation_max_m"), 20 + 1e-6);
    EXPECT_LT(report["triangles"].get<int>(), 20'000);
}

}  // namespace
}  // namespace render
