// What keeps triangles from being a conforming mesh is found and named; welding joins what lies at the same place.

#include "planet/exporters/conforming.h"

#include <gtest/gtest.h>

#include <random>

#include "surface_meshes.h"

namespace planet {
namespace {

/// Two triangles over a square: the diagonal from 0 to 2.
SurfaceMesh square() {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

void expect_fault(const SurfaceMesh& mesh, std::string_view text) {
    const auto fault = conforming_fault(mesh);
    ASSERT_TRUE(fault) << text;
    EXPECT_EQ(*fault, text);
}

TEST(Conforming, MeshesThatAre) {
    EXPECT_EQ(conforming_fault(square()), std::nullopt);
    EXPECT_EQ(conforming_fault(testing::wavy_mesh(20, 1000)), std::nullopt);
    SurfaceMesh tetrahedron;
    tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    EXPECT_EQ(conforming_fault(tetrahedron), std::nullopt);
}

TEST(Conforming, TrianglesWithoutAreaAreNamed) {
    SurfaceMesh mesh = square();
    mesh.triangles[1] = {0, 2, 2};
    expect_fault(mesh, "triangle 1 has two corners at vertex 2 (1, 1, 0.5)");
    mesh = square();
    mesh.vertices[3] = {2, 2, 1};  // on the line through 0 and 2
    expect_fault(mesh, "triangle 1 has no area: vertex 0 (0, 0, 0), vertex 2 (1, 1, 0.5), vertex 3 (2, 2, 1)");
}

TEST(Conforming, SidesSharedWronglyAreNamed) {
    SurfaceMesh mesh = square();
    mesh.triangles[1] = {3, 2, 0};  // clockwise
    expect_fault(mesh,
                 "the side from vertex 0 (0, 0, 0) to vertex 2 (1, 1, 0.5) has two triangles that turn unlike each "
                 "other");
    mesh = square();
    mesh.vertices.emplace_back(0, 0, 1);
    mesh.triangles.push_back({2, 0, 4});
    expect_fault(mesh, "the side from vertex 0 (0, 0, 0) to vertex 2 (1, 1, 0.5) has 3 triangles");
}

TEST(Conforming, TJunctionsAreNamed) {
    SurfaceMesh mesh = square();
    mesh.vertices.emplace_back(0.5, -1, 0);
    mesh.vertices.emplace_back(0.5, 0, 0);
    mesh.triangles.push_back({0, 4, 5});
    mesh.triangles.push_back({4, 1, 5});
    expect_fault(mesh,
                 "the side from vertex 0 (0, 0, 0) to vertex 1 (1, 0, 0) has vertex 5 (0.5, 0, 0) within it: a "
                 "T-junction");
    mesh.vertices[5].y = -0.01;  // a hole is none
    EXPECT_EQ(conforming_fault(mesh), std::nullopt);
}

TEST(Conforming, SeamsAreNamedAndWelded) {
    SurfaceMesh mesh = square();
    mesh.vertices.push_back(mesh.vertices[0]);
    mesh.vertices.push_back(mesh.vertices[2]);
    mesh.triangles[1] = {4, 5, 3};
    const auto fault = conforming_fault(mesh);
    ASSERT_TRUE(fault);
    EXPECT_NE(fault->find("lie at the same place"), std::string::npos) << *fault;
    MeshLooks looks;
    looks.uv = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}};
    EXPECT_EQ(weld(mesh, looks), 2u);
    EXPECT_EQ(mesh.vertices, square().vertices);
    EXPECT_EQ(mesh.triangles, square().triangles);
    EXPECT_EQ(looks.uv, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
    EXPECT_EQ(conforming_fault(mesh), std::nullopt);
    EXPECT_EQ(weld(mesh, looks), 0u);
}

// -0 and 0 are one place.
TEST(Conforming, WeldingTakesZerosAsOne) {
    SurfaceMesh mesh = square();
    mesh.vertices.push_back({-0.0, -0.0, -0.0});
    mesh.triangles[1][0] = 4;
    MeshLooks looks;
    EXPECT_EQ(weld(mesh, looks), 1u);
    EXPECT_EQ(mesh.triangles, square().triangles);
}

// Every vertex of a mesh whose triangles share nothing is on the border: all of them welded make up the mesh again.
TEST(Conforming, LooseTrianglesAreWelded) {
    const SurfaceMesh whole = testing::wavy_mesh(40, 1000);
    SurfaceMesh loose;
    for (const auto& t : whole.triangles) {
        const auto first = static_cast<std::uint32_t>(loose.vertices.size());
        for (const std::uint32_t v : t) loose.vertices.push_back(whole.vertices[v]);
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_TRUE(conforming_fault(loose));
    MeshLooks looks;
    EXPECT_EQ(weld(loose, looks), 3 * whole.triangles.size() - whole.vertices.size());
    EXPECT_EQ(conforming_fault(loose), std::nullopt);
    EXPECT_EQ(loose.triangles.size(), whole.triangles.size());
}

// Of every triangle of a mesh one after the other: moved by a T-junction's worth, found wherever it is.
TEST(Conforming, TJunctionsAreFoundAnywhere) {
    std::mt19937 random(7);
    for (int i = 0; i < 50; ++i) {
        SurfaceMesh mesh = testing::wavy_mesh(12, 1000, {5e5, 4e6, 0});
        // One of two triangles at a diagonal is split at its middle, the other is not.
        const std::size_t t = 2 * (random() % (mesh.triangles.size() / 2));
        const auto [a, b, c] = mesh.triangles[t];
        const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back((mesh.vertices[b] + mesh.vertices[c]) * 0.5);
        mesh.triangles[t] = {a, b, middle};
        mesh.triangles.push_back({a, middle, c});
        const auto fault = conforming_fault(mesh);
        ASSERT_TRUE(fault);
        EXPECT_NE(fault->find("vertex " + std::to_string(middle) + " "), std::string::npos) << *fault;
        EXPECT_NE(fault->find("T-junction"), std::string::npos) << *fault;
    }
}

}  // namespace
}  // namespace planet
