// octaglobe refine STREAM.oprog: prefixes, views, frames.

#include <algorithm>

#include "planet/geodesy/geodetic.h"
#include "tests/render/app/refine_program.h"

namespace render {
namespace {

using planet::SurfaceMesh;

class RefineStreamTest : public RefineCommandTest {
  protected:
    void SetUp() override {
        write_mesh_file(folder_ / "mesh.obj", uneven_mesh());
        made_ = refine("mesh.obj --max-triangles 2000 --progressive out.oprog -o whole.ply");
    }
    Json made_;
};

TEST_F(RefineStreamTest, EveryPrefixIsAConformingMesh) {
    std::size_t before = 0;
    for (const char* share : {"0", "0.01", "0.35", "0.5", "0.999", "1"}) {
        const Json report = refine("out.oprog --at " + std::string(share) + " -o part.ply");
        const SurfaceMesh part = read("part.ply");
        EXPECT_EQ(report["triangles"], part.triangles.size());
        EXPECT_GE(part.triangles.size(), before);
        before = part.triangles.size();
    }
    EXPECT_EQ(before, read("whole.ply").triangles.size());
    refine("out.oprog --at 0 -o base.ply");
    EXPECT_EQ(read("base.ply").vertices, uneven_mesh().vertices);
    refine("out.oprog -o all.ply");
    EXPECT_EQ(read("all.ply").vertices, read("whole.ply").vertices);
}

// Places too: heights are multiples of a step from midpoints, and so are the whole mesh's.
TEST_F(RefineStreamTest, TakesFewBytesASplit) {
    EXPECT_LT(number(made_, "progressive_bytes_per_split"), 7);
    hilly_terrain().write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    const Json hills = refine("flat.ply --elevation dem.vrt --max-deviation 5 --progressive hills.oprog -o hills.ply");
    EXPECT_LT(number(hills, "progressive_bytes_per_split"), 9);
    EXPECT_LE(number(hills, "deviation_max_m"), 5 + 1e-6);
    refine("hills.oprog -o again.ply");
    EXPECT_EQ(read("again.ply").vertices, read("hills.ply").vertices);
    refine("flat.ply --elevation dem.vrt --frame ecef --steps 8 --progressive ecef.oprog -o ecef.ply");
    refine("ecef.oprog -o again.ply");
    EXPECT_EQ(read("again.ply").vertices, read("ecef.ply").vertices);
}

TEST_F(RefineStreamTest, FramesGoFromTheBaseMeshToTheWhole) {
    const Json report = refine("out.oprog --morph 5 --format ply -o frames/");
    EXPECT_EQ(report["frames"], 5);
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "frames"))
        names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    ASSERT_EQ(names, (std::vector<std::string>{"frame_00000.ply", "frame_00001.ply", "frame_00002.ply",
                                               "frame_00003.ply", "frame_00004.ply"}));
    EXPECT_EQ(read("frames/frame_00004.ply").vertices, read("whole.ply").vertices);
    for (const std::string& name : names)
        EXPECT_EQ(read("frames/" + name).triangles, read("frames/frame_00000.ply").triangles);
}

TEST_F(RefineStreamTest, FramesMoveFromFlatToTerrain) {
    hilly_terrain().write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    refine("flat.ply --elevation dem.vrt --max-deviation 50 --progressive hills.oprog");
    refine("hills.oprog --morph 2 --format ply -o frames");
    const SurfaceMesh flat = read("frames/frame_00000.ply"), hilly = read("frames/frame_00001.ply");
    // Halfway between the corners there is no relief yet.
    const auto of_corners = [&](const SurfaceMesh& mesh) {
        double low = 1e9, high = -1e9;
        for (std::size_t i = 0; i < 4; ++i) {
            low = std::min(low, mesh.vertices[i].z);
            high = std::max(high, mesh.vertices[i].z);
        }
        return std::pair(low, high);
    };
    const auto [low, high] = of_corners(flat);
    for (const glm::dvec3& v : flat.vertices) {
        EXPECT_GE(v.z, low - 1e-6);
        EXPECT_LE(v.z, high + 1e-6);
    }
    EXPECT_TRUE(
        std::ranges::any_of(hilly.vertices, [&](const glm::dvec3& v) { return v.z < low - 50 || v.z > high + 50; }));
}

/// The longest way of a vertex from one frame to the next, metres.
double longest_step(const std::vector<SurfaceMesh>& frames) {
    double longest = 0;
    for (std::size_t i = 1; i < frames.size(); ++i)
        for (std::size_t v = 0; v < frames[i].vertices.size(); ++v)
            longest = std::max(longest, std::abs(frames[i].vertices[v].z - frames[i - 1].vertices[v].z));
    return longest;
}

// The triangles are those of the last frame in all, whatever flips on the way there, so the surface moves as its vertices
// do; and the more frames, the less.
TEST_F(RefineStreamTest, NothingJumpsFromFrameToFrame) {
    hilly_terrain().write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    const Json made = refine("flat.ply --elevation dem.vrt --max-deviation 50 --progressive hills.oprog");
    const auto frames = [&](int count) {
        refine("hills.oprog --morph " + std::to_string(count) + " --format ply -o frames" + std::to_string(count));
        std::vector<SurfaceMesh> out;
        for (int i = 0; i < count; ++i) {
            char name[40];
            std::snprintf(name, sizeof name, "frames%d/frame_%05d.ply", count, i);
            out.push_back(read(name));
            EXPECT_EQ(out.back().triangles, out.front().triangles);
        }
        return out;
    };
    const double coarse = longest_step(frames(9)), fine = longest_step(frames(65));
    EXPECT_GT(coarse, 20);
    EXPECT_LT(4 * fine, coarse);
    EXPECT_GT(made["pending_triangles"], 0) << "there are triangles that became four, and some did";
}

TEST_F(RefineStreamTest, KeepsItsRuleAndIsPutIntoFrames) {
    EXPECT_EQ(refine("out.oprog --rule modified -o all.ply")["rule"], "modified");
    planet::MeshReference degrees = degrees_reference();
    degrees.vertical_datum = "ellipsoid";
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees);
    refine("flat.ply --steps 4 --progressive flat.oprog");
    EXPECT_EQ(refine("flat.oprog --at 0.5 -o half.glb")["frame"], "enu");
    EXPECT_EQ(refine("flat.oprog --at 0.5 -o half.ply")["frame"], "source");
    EXPECT_EQ(refine("flat.oprog --at 0.5 --frame ecef -o ecef.ply")["frame"], "ecef");
    const SurfaceMesh flat = read("half.ply"), ecef = read("ecef.ply");
    ASSERT_EQ(flat.vertices.size(), ecef.vertices.size());
    for (std::size_t v = 0; v < flat.vertices.size(); ++v) {
        const glm::dvec3 p = flat.vertices[v];
        const planet::Geodetic g{p.y * planet::degrees, p.x * planet::degrees, {p.z}};
        EXPECT_LT(glm::distance(planet::ecef_from_geodetic(planet::wgs84, g), ecef.vertices[v]), 1e-6);
    }
    EXPECT_EQ(refine("flat.oprog --morph 3 -o frames")["frame"], "enu");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "frames/frame_00002.glb"));
}

TEST_F(RefineStreamTest, AViewIsFineNearThePlaceOnly) {
    hilly_terrain().write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    refine("flat.ply --elevation dem.vrt --max-side 200 --progressive hills.oprog");
    const Json near = refine("hills.oprog --view 49.7,10.05,2km -o near.ply");
    const Json far = refine("hills.oprog --view 49.7,10.05,200km -o far.ply");
    const Json whole = refine("hills.oprog -o whole.ply");
    EXPECT_LT(far["triangles"], near["triangles"]);
    EXPECT_LT(near["triangles"], whole["triangles"]);
    const SurfaceMesh mesh = read("near.ply");
    const auto beside = [&](double longitude, double latitude) {
        return std::ranges::count_if(mesh.vertices, [&](const glm::dvec3& v) {
            return std::abs(v.x - longitude) < 0.05 && std::abs(v.y - latitude) < 0.05;
        });
    };
    EXPECT_GT(beside(10.05, 49.73), 2 * beside(10.35, 49.95));
}

TEST_F(RefineStreamTest, KeepsAttributes) {
    const SurfaceMesh mesh = uneven_mesh();
    planet::MeshLooks looks, found;
    for (const glm::dvec3& v : mesh.vertices) looks.uv.emplace_back(v.x / 512, v.y / 512);
    write_mesh_file(folder_ / "looks.ply", mesh, {}, looks);
    refine("looks.ply --max-side 40 --progressive looks.oprog");
    refine("looks.oprog --at 0.5 -o half.ply");
    const SurfaceMesh half = read("half.ply", &found);
    ASSERT_EQ(found.uv.size(), half.vertices.size());
    for (std::size_t i = 0; i < half.vertices.size(); ++i) EXPECT_NEAR(found.uv[i].x, half.vertices[i].x / 512, 1e-5);
}

// Cut short anywhere, or with any byte changed: refused in one line, or some mesh; never a crash.
TEST_F(RefineStreamTest, DamagedStreamsAreRefused) {
    const std::string whole = content(folder_ / "out.oprog");
    for (std::size_t i = 0; i < 24; ++i) {
        std::string damaged = whole;
        if (i % 2 == 0)
            damaged.resize(whole.size() * i / 24);
        else
            damaged[whole.size() * i / 24] = static_cast<char>(damaged[whole.size() * i / 24] ^ 0x55);
        std::ofstream(folder_ / "damaged.oprog", std::ios::binary) << damaged;
        const Outcome outcome = run(folder_.path(), words("refine damaged.oprog -o part.ply"));
        EXPECT_EQ(outcome.status, 3) << i;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("octaglobe: damaged.oprog: ")) << outcome.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "part.ply"));
}

}  // namespace
}  // namespace render
