// Colours, normals and texture coordinates of vertices: written and read in every format that has them.

#include <gtest/gtest.h>

#include "planet/error.h"
#include "planet/exporters/mesh_file.h"
#include "surface_meshes.h"

namespace planet {
namespace {

using testing::TemporaryFolder;
using testing::write_bytes;

/// Numbers that 8 bits hold.
MeshLooks looks_for(const SurfaceMesh& mesh) {
    MeshLooks looks;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto x = static_cast<float>(i % 7), y = static_cast<float>(i % 5);
        looks.normals.push_back(glm::normalize(glm::vec3(x - 3, y - 2, 4)));
        looks.uv.emplace_back(x / 8, y / 4);
        looks.colors.emplace_back(x / 255, 1 - y / 255, 0.2f, 1);
    }
    return looks;
}

MeshLooks through_file(const SurfaceMesh& mesh, const MeshLooks& looks, const std::string& ending) {
    const TemporaryFolder folder;
    std::string bytes;
    write_mesh([&](std::string_view block) { bytes += block; }, mesh, testing::enu_reference(),
               mesh_format("mesh" + ending), std::nullopt, looks);
    write_bytes(folder / ("mesh" + ending), bytes);
    MeshLooks found;
    const SurfaceMesh read = read_mesh(folder / ("mesh" + ending), nullptr, &found);
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size());  // an .stl numbers vertices in its own order
    return found;
}

MeshLooks looks_of_bytes(const std::string& bytes, const std::string& ending) {
    const TemporaryFolder folder;
    write_bytes(folder / ("mesh" + ending), bytes);
    MeshLooks found;
    read_mesh(folder / ("mesh" + ending), nullptr, &found);
    return found;
}

template <class Vector>
void expect_near(const std::vector<Vector>& found, const std::vector<Vector>& expected, float tolerance) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int k = 0; k < Vector::length(); ++k) EXPECT_NEAR(found[i][k], expected[i][k], tolerance) << i;
}

TEST(MeshAttributes, ComeBackFromEveryFormatThatHasThem) {
    const SurfaceMesh mesh = testing::wavy_mesh(9, 1000);
    const MeshLooks looks = looks_for(mesh);
    for (const char* ending : {".glb", ".ply", ".obj"}) {
        SCOPED_TRACE(ending);
        const MeshLooks found = through_file(mesh, looks, ending);
        expect_near(found.normals, looks.normals, 1e-7f);
        expect_near(found.uv, looks.uv, 0);  // 1 - (1 - v) is exact for these
        expect_near(found.colors, looks.colors, 2e-7f);
    }
    const MeshLooks none = through_file(mesh, looks, ".stl");
    EXPECT_TRUE(none.normals.empty() && none.uv.empty() && none.colors.empty());
}

TEST(MeshAttributes, EachAlone) {
    const SurfaceMesh mesh = testing::wavy_mesh(4, 1000);
    const MeshLooks all = looks_for(mesh);
    for (const char* ending : {".glb", ".ply", ".obj"})
        for (int which = 0; which < 3; ++which) {
            SCOPED_TRACE(ending + std::to_string(which));
            MeshLooks one;
            if (which == 0) one.normals = all.normals;
            if (which == 1) one.uv = all.uv;
            if (which == 2) one.colors = all.colors;
            const MeshLooks found = through_file(mesh, one, ending);
            EXPECT_EQ(found.normals.size(), one.normals.size());
            EXPECT_EQ(found.uv.size(), one.uv.size());
            EXPECT_EQ(found.colors.size(), one.colors.size());
        }
}

TEST(MeshAttributes, PictureOfAGlb) {
    const SurfaceMesh mesh = testing::wavy_mesh(4, 1000);
    MeshLooks looks = looks_for(mesh);
    looks.picture = testing::png_bytes(3, 2, 8, [](int x, int y) { return static_cast<unsigned>(x + y); });
    EXPECT_EQ(through_file(mesh, looks, ".glb").picture, looks.picture);
    EXPECT_EQ(through_file(mesh, looks, ".ply").picture, "");
    EXPECT_EQ(through_file(mesh, looks, ".glb").base_color, glm::vec4(1));
    EXPECT_EQ(through_file(mesh, {}, ".glb").base_color, glm::vec4(glm::vec3(0.6f), 1));
}

// The first corner's; and none at all where a vertex has none.
TEST(MeshAttributes, ObjOfOthers) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0.5\nvt 1 1 0\nvn 0 0 1\nvn 0 1 0\n";
    const MeshLooks all = looks_of_bytes(vertices + "f 1/1/1 2/2/1 3/3/1\nf 1/3/2 3/3/2 4/-2/-1\n", ".obj");
    EXPECT_EQ(all.uv, (std::vector<glm::vec2>{{0, 1}, {0.5, 1}, {1, 0}, {0.5, 1}}));
    EXPECT_EQ(all.normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
    const MeshLooks some = looks_of_bytes(vertices + "f 1/1/1 2/2/1 3/3/1\nf 1//2 3//2 4//2\n", ".obj");
    EXPECT_TRUE(some.uv.empty());
    EXPECT_EQ(some.normals.size(), 4u);
    for (const char* faces : {"f 1/9 2/1 3/1\nf 1/1 3/1 4/1\n", "f 1/-9 2/1 3/1\nf 1/0 3/x 4/\n", "f 1 2 3\n"})
        EXPECT_TRUE(looks_of_bytes(vertices + faces, ".obj").uv.empty()) << faces;
}

TEST(MeshAttributes, PlyOfOthers) {
    const std::string
        head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
        faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const MeshLooks colors =
        looks_of_bytes(head + "property ushort red\nproperty ushort green\nproperty ushort blue\n" + faces +
                           "0 0 0 0 65535 0\n1 0 0 0 0 0\n0 1 0 65535 0 0\n3 0 1 2\n",
                       ".ply");
    EXPECT_EQ(colors.colors, (std::vector<glm::vec4>{{0, 1, 0, 1}, {0, 0, 0, 1}, {1, 0, 0, 1}}));
    const MeshLooks half = looks_of_bytes(
        head + "property float nx\nproperty float ny\n" + faces + "0 0 0 1 0\n1 0 0 1 0\n0 1 0 1 0\n3 0 1 2\n", ".ply");
    EXPECT_TRUE(half.normals.empty());
    EXPECT_THROW(looks_of_bytes(head + "property float s\nproperty float t\n" + faces +
                                    "0 0 0 nan 0\n1 0 0 1 0\n0 1 0 1 0\n3 0 1 2\n",
                                ".ply"),
                 Error);
}

}  // namespace
}  // namespace planet
