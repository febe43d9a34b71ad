// octaglobe refine STREAM.oprog: prefixes, views, frames.

#include <algorithm>

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

TEST_F(RefineStreamTest, TakesFewBytesASplit) {
    EXPECT_LT(number(made_, "progressive_bytes_per_split"), 10);
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
    refine("hills.oprog --morph 2 -o frames");  // in degrees: .ply
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
