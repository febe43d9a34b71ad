// Writing mesh files: every format against its definition, and round trips. Foreign and damaged files: mesh_reading_test.cpp.

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "planet/error.h"
#include "planet/exporters/mesh_file.h"
#include "planet/frames.h"
#include "surface_meshes.h"

namespace planet {
namespace {

using testing::bytes_of_mesh;
using testing::enu_reference;
using testing::Glb;
using testing::mesh_from_bytes;
using testing::number_at;
using testing::reference_of;
using testing::TemporaryFolder;
using testing::wavy_mesh;
using testing::write_bytes;

constexpr MeshFormat all_formats[]{MeshFormat::glb, MeshFormat::ply, MeshFormat::obj, MeshFormat::stl};

template <class Act>
std::string refusal(Fault fault, const Act& act) {
    try {
        act();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), fault) << e.what();
        return e.what();
    }
    return "";
}

bool contains(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

// As Glb::vertex() sees them: without the reader.
void expect_exact(const SurfaceMesh& rounded, const Glb& glb) {
    for (std::size_t i = 0; i < rounded.vertices.size(); ++i)
        ASSERT_EQ(glb.vertex(i), rounded.vertices[i]) << "vertex " << i;
}

TEST(MeshFile, FormatIsThatOfTheEndingInAnyCase) {
    EXPECT_EQ(mesh_format("a.glb"), MeshFormat::glb);
    EXPECT_EQ(mesh_format("a.b/c.PLY"), MeshFormat::ply);
    EXPECT_EQ(mesh_format("a.Obj"), MeshFormat::obj);
    EXPECT_EQ(mesh_format("/x/y.stl"), MeshFormat::stl);
    for (const char* path : {"", "glb", "a.gltf", "a.glb/x", "a.glb.png"}) {
        const std::string line = refusal(Fault::bad_usage, [&] { mesh_format(path); });
        EXPECT_TRUE(contains(line, ".glb, .ply, .obj or .stl")) << line;
    }
}

TEST(MeshFile, FramesThatAFormatCannotHoldAreRefused) {
    MeshReference degrees_of_source = reference_of(MeshFrame::source);
    degrees_of_source.geographic = true;
    SurfaceMesh mesh = wavy_mesh(2, 1);
    const auto refuses = [&](const MeshReference& r, MeshFormat format) {
        const std::string line = refusal(Fault::bad_usage, [&] { check_frame(r, format); });
        EXPECT_EQ(refusal(Fault::bad_usage, [&] { bytes_of_mesh(mesh, r, format); }), line);
        EXPECT_EQ(refusal(Fault::bad_usage, [&] { round_to_format(mesh, r, format); }), line);
        EXPECT_EQ(refusal(Fault::bad_usage, [&] { rounding_bound({}, {}, r, format); }), line);
        return line;
    };
    EXPECT_TRUE(contains(refuses(degrees_of_source, MeshFormat::glb), "accepted: frame enu, utm or ecef"));
    for (const MeshFrame frame : {MeshFrame::source, MeshFrame::utm, MeshFrame::ecef})
        EXPECT_TRUE(contains(refuses(reference_of(frame), MeshFormat::stl), "accepted: frame enu"));
    EXPECT_EQ(refuses(degrees_of_source, MeshFormat::ply), "");
    EXPECT_EQ(refuses(degrees_of_source, MeshFormat::obj), "");
    EXPECT_EQ(refuses(reference_of(MeshFrame::source), MeshFormat::glb), "");
    EXPECT_EQ(refuses(enu_reference(), MeshFormat::stl), "");
}

TEST(MeshFile, MeshesThatAreNoneAreRefused) {
    for (const MeshFormat format : all_formats) {
        SurfaceMesh empty, points = wavy_mesh(2, 1);
        points.triangles.clear();
        for (SurfaceMesh* mesh : {&empty, &points}) {
            EXPECT_NE(refusal(Fault::bad_data, [&] { bytes_of_mesh(*mesh, enu_reference(), format); }), "");
            EXPECT_NE(refusal(Fault::bad_data, [&] { round_to_format(*mesh, enu_reference(), format); }), "");
        }
    }
    for (const MeshFormat format : {MeshFormat::glb, MeshFormat::stl})
        for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1e31}) {
            SurfaceMesh mesh = wavy_mesh(2, 1);
            mesh.vertices[4].y = bad;
            EXPECT_NE(refusal(Fault::bad_data, [&] { bytes_of_mesh(mesh, enu_reference(), format); }), "");
            EXPECT_NE(refusal(Fault::bad_data, [&] { round_to_format(mesh, enu_reference(), format); }), "");
        }
}

TEST(MeshFile, WhatTheSinkThrowsPasses) {
    struct Full {};
    const SurfaceMesh mesh = wavy_mesh(3, 1);
    for (const MeshFormat format : all_formats)
        EXPECT_THROW(write_mesh([](std::string_view) { throw Full(); }, mesh, enu_reference(), format), Full);
}

TEST(MeshFile, DoublesKeepTheirBits) {
    SurfaceMesh mesh = wavy_mesh(5, 1 / 3.0, {-105.4858, 37.5767, 0});
    mesh.vertices[0] = {-0.0, 5e-324, 1e300};
    mesh.vertices[1] = {std::numeric_limits<double>::max(), -1e-310, 0.1};
    for (const MeshFormat format : {MeshFormat::ply, MeshFormat::obj}) {
        SurfaceMesh rounded = mesh;
        const MeshRounding rounding = round_to_format(rounded, reference_of(MeshFrame::source), format);
        EXPECT_EQ(rounding.xy, 0);
        EXPECT_EQ(rounding.z, 0);
        const auto read = mesh_from_bytes(bytes_of_mesh(rounded, reference_of(MeshFrame::source), format),
                                          format == MeshFormat::ply ? ".ply" : ".obj");
        EXPECT_EQ(read.triangles, mesh.triangles);
        ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
        EXPECT_EQ(std::memcmp(read.vertices.data(), mesh.vertices.data(), 24 * mesh.vertices.size()), 0);
    }
}

TEST(MeshFile, ReferenceComesBack) {
    const SurfaceMesh mesh = wavy_mesh(2, 1);
    MeshReference lines = enu_reference(), source = reference_of(MeshFrame::source);
    lines.crs = "PROJCS[\"a\",\n    UNIT[\"metre\", 1]]";
    source.geographic = true;
    source.vertical_datum = "Normaal Amsterdams Peil";
    for (const std::string ending : {".ply", ".obj", ".glb"})
        for (const MeshReference& reference :
             {lines, source, reference_of(MeshFrame::utm), reference_of(MeshFrame::ecef)}) {
            if (ending == ".glb" && reference.geographic) continue;
            MeshReference read = enu_reference();
            mesh_from_bytes(bytes_of_mesh(mesh, reference, mesh_format("x" + ending)), ending, &read);
            EXPECT_EQ(read.frame, reference.frame) << ending;
            EXPECT_EQ(read.crs, ending == ".glb" || reference.crs.empty() ? reference.crs
                                                                          : "PROJCS[\"a\",     UNIT[\"metre\", 1]]");
            EXPECT_EQ(read.vertical_datum, reference.vertical_datum);
            EXPECT_EQ(read.geographic, reference.geographic);
            EXPECT_EQ(read.origin, reference.origin);
            EXPECT_EQ(read.ecef_from_enu, reference.ecef_from_enu);
        }
}

TEST(MeshFile, PlyIsItsHeaderAndPackedRecords) {
    const SurfaceMesh mesh = wavy_mesh(7, 1000);
    const std::string file = bytes_of_mesh(mesh, enu_reference(), MeshFormat::ply);
    const std::size_t body = file.find("end_header\n") + 11;
    EXPECT_TRUE(file.starts_with("ply\nformat binary_little_endian 1.0\ncomment "));
    for (const char* line : {"comment generator Octaglobe\n", "comment frame enu\n", "comment crs EPSG:4979\n",
                             "comment vertical_datum EGM96\n", "element vertex 64\nproperty double x\n",
                             "element face 98\nproperty list uchar int vertex_indices\nend_header\n"})
        EXPECT_TRUE(contains(file.substr(0, body), line)) << line;
    ASSERT_EQ(file.size(), body + 24 * 64 + 13 * 98);
    EXPECT_EQ(number_at<glm::dvec3>(file, body + 24 * 5), mesh.vertices[5]);
    EXPECT_EQ(file[body + 24 * 64 + 13], 3);
    EXPECT_EQ((number_at<std::array<std::uint32_t, 3>>(file, body + 24 * 64 + 14)), mesh.triangles[1]);
}

TEST(MeshFile, StlHasFiftyBytesATriangle) {
    SurfaceMesh mesh = wavy_mesh(6, 5000);
    mesh.triangles.push_back({0, 0, 1});  // without area, so without a normal
    const MeshRounding bound = rounding_bound({0, 0, 200.1}, {5000, 5000, 800.1}, enu_reference(), MeshFormat::stl);
    const SurfaceMesh before = mesh;
    const MeshRounding rounding = round_to_format(mesh, enu_reference(), MeshFormat::stl);
    EXPECT_GT(rounding.xy, 0);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const volatile float nearest = static_cast<float>(before.vertices[i][axis]);
            EXPECT_EQ(mesh.vertices[i][axis], static_cast<double>(nearest));
        }
    EXPECT_LE(rounding.xy, bound.xy);
    EXPECT_LE(rounding.z, bound.z);
    EXPECT_LE(bound.xy, 1 / 4096.0);
    const std::string file = bytes_of_mesh(mesh, enu_reference(), MeshFormat::stl);
    ASSERT_EQ(file.size(), 84 + 50 * mesh.triangles.size());
    EXPECT_EQ(number_at<std::uint32_t>(file, 80), mesh.triangles.size());
    EXPECT_FALSE(file.starts_with("solid"));
    EXPECT_TRUE(contains(file.substr(0, 80), "frame enu")) << file.substr(0, 80);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& t = mesh.triangles[i];
        const auto normal = glm::dvec3(number_at<glm::vec3>(file, 84 + 50 * i));
        const glm::dvec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
        EXPECT_EQ(glm::dvec3(number_at<glm::vec3>(file, 84 + 50 * i + 12)), a);
        EXPECT_EQ(glm::dvec3(number_at<glm::vec3>(file, 84 + 50 * i + 36)), c);
        if (t[0] == t[1]) {
            EXPECT_EQ(normal, glm::dvec3(0));
        } else {
            EXPECT_GT(normal.z, 0);
            EXPECT_NEAR(glm::length(normal), 1, 1e-6);
            EXPECT_NEAR(glm::dot(normal, glm::normalize(b - a)), 0, 1e-6);
        }
        EXPECT_EQ(number_at<std::uint16_t>(file, 84 + 50 * i + 48), 0);
    }
    const SurfaceMesh read = mesh_from_bytes(file, ".stl");
    ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(read.vertices.size(), mesh.vertices.size()) << "corners at one place are one vertex";
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(read.vertices[read.triangles[i][k]], mesh.vertices[mesh.triangles[i][k]]);
}

TEST(MeshFile, GlbChunksAreAlignedAndPadded) {
    for (std::size_t triangles = 1; triangles <= 4; ++triangles) {  // an odd number of 16 bit indices needs padding
        SurfaceMesh mesh = wavy_mesh(2, 10);
        mesh.triangles.resize(triangles);
        for (const std::string crs : {"", "a", "ab", "abc"}) {
            MeshReference reference = enu_reference();
            reference.crs = crs;
            const std::string file = bytes_of_mesh(mesh, reference, MeshFormat::glb);
            EXPECT_TRUE(file.starts_with(std::string_view("glTF\2\0\0\0", 8)));
            EXPECT_EQ(number_at<std::uint32_t>(file, 8), file.size());
            const auto json = number_at<std::uint32_t>(file, 12);
            EXPECT_EQ(json % 4, 0u);
            EXPECT_EQ(file.substr(16, 4), "JSON");
            EXPECT_EQ(file[20 + file.substr(20, json).find_last_not_of(' ')], '}');
            const auto binary = number_at<std::uint32_t>(file, 20 + json);
            EXPECT_EQ(file.substr(24 + json, 4), std::string_view("BIN\0", 4));
            const std::size_t arrays = 12 * mesh.vertices.size() + 6 * triangles;
            EXPECT_EQ(binary, (arrays + 3) / 4 * 4);
            EXPECT_EQ(file.size(), 28 + json + binary);
            EXPECT_EQ(file.find_first_not_of('\0', 28 + json + arrays), std::string::npos);
            EXPECT_TRUE(contains(file, "\"buffers\":[{\"byteLength\":" + std::to_string(arrays) + "}]"));
        }
    }
}

TEST(MeshFile, GlbIndicesAre16BitUpTo65535Vertices) {
    // The index 65535 would restart a primitive.
    for (const std::size_t count : {65534, 65535, 65536}) {
        SurfaceMesh mesh = wavy_mesh(255, 1000);
        ASSERT_EQ(mesh.vertices.size(), 65536u);
        mesh.vertices.resize(count);
        std::erase_if(mesh.triangles, [&](const auto& t) { return t[0] >= count || t[1] >= count || t[2] >= count; });
        round_to_format(mesh, enu_reference(), MeshFormat::glb);
        const std::string file = bytes_of_mesh(mesh, enu_reference(), MeshFormat::glb);
        const std::size_t size = count == 65536 ? 4 : 2;
        EXPECT_TRUE(contains(file, size == 4 ? "\"componentType\":5125" : "\"componentType\":5123"));
        EXPECT_EQ(Glb(file).binary.size(), (12 * count + 3 * size * mesh.triangles.size() + 3) / 4 * 4);
        const SurfaceMesh read = mesh_from_bytes(file, ".glb");
        EXPECT_EQ(read.triangles, mesh.triangles);
        EXPECT_EQ(read.vertices, mesh.vertices);
    }
}

TEST(MeshFile, GlbSaysTheBoundsOfItsPositions) {
    SurfaceMesh mesh = wavy_mesh(9, 777, {431234.567, 4161234.5, 0});
    round_to_format(mesh, reference_of(MeshFrame::utm), MeshFormat::glb);
    const Glb glb(bytes_of_mesh(mesh, reference_of(MeshFrame::utm), MeshFormat::glb));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double low = 1e30, high = -1e30;
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            const auto p = static_cast<double>(number_at<std::array<float, 3>>(glb.binary, 12 * i)[axis]);
            low = std::min(low, p);
            high = std::max(high, p);
        }
        EXPECT_EQ(glb.list("min").at(axis), low);
        EXPECT_EQ(glb.list("max").at(axis), high);
    }
}

TEST(MeshFile, GlbIsYUp) {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 4}, {0, 0, -4}};  // centre, east, north, up, down
    mesh.triangles = {{0, 1, 2}, {3, 1, 4}};
    const Glb glb(bytes_of_mesh(mesh, enu_reference(), MeshFormat::glb));
    using Floats = std::array<float, 3>;
    EXPECT_EQ(number_at<Floats>(glb.binary, 12), (Floats{1, 0, 0}));
    EXPECT_EQ(number_at<Floats>(glb.binary, 24), (Floats{0, 0, -2}));
    EXPECT_EQ(number_at<Floats>(glb.binary, 36), (Floats{0, 4, 0}));
    EXPECT_FALSE(contains(glb.json, "translation"));
    EXPECT_FALSE(contains(glb.json, "-0.0"));
}

TEST(MeshFile, GlbTellsItsFrameOriginAndRounding) {
    SurfaceMesh mesh = wavy_mesh(8, 95000, {-47500, -47500, 0});
    MeshRounding rounding = round_to_format(mesh, enu_reference(), MeshFormat::glb);
    const Glb enu(bytes_of_mesh(mesh, enu_reference(), MeshFormat::glb, rounding));
    for (const char* part : {"\"frame\":\"enu\"", "\"crs\":\"EPSG:4979\"", "\"vertical_datum\":\"EGM96\"",
                             "\"step\":0.0078125}", "\"latitude\":37.58", "\"longitude\":-105.49"})
        EXPECT_TRUE(contains(enu.json, part)) << part << " in " << enu.json;
    const glm::dvec3 origin = enu_reference().origin;
    EXPECT_EQ(enu.list("ecef"), (std::vector<double>{origin.x, origin.y, origin.z}));

    mesh = wavy_mesh(8, 1000, origin);
    rounding = round_to_format(mesh, reference_of(MeshFrame::ecef), MeshFormat::glb);
    const Glb ecef(bytes_of_mesh(mesh, reference_of(MeshFrame::ecef), MeshFormat::glb, rounding));
    const auto root = ecef.list("translation"), said = ecef.list("ecef");
    ASSERT_EQ(root.size(), 3u);
    EXPECT_EQ(said, (std::vector<double>{root[0], -root[2], root[1]}));
    MeshReference broken = enu_reference();
    broken.crs = "\"\xff\n\x01";
    EXPECT_NO_THROW(mesh_from_bytes(bytes_of_mesh(mesh, broken, MeshFormat::glb), ".glb")) << "still JSON";
}

TEST(MeshRounding, GridStepsArePowersOfTwoThatFit24Bits) {
    const auto step = [](double extent) {
        return rounding_bound({0, 0, 0}, {extent, 1, 1}, reference_of(MeshFrame::utm), MeshFormat::glb).step;
    };
    EXPECT_EQ(step(95000), 1 / 128.0);
    EXPECT_EQ(step(131071), 1 / 128.0);
    EXPECT_EQ(step(131072), 1 / 64.0) << "the bounds may be rounded outwards";
    EXPECT_EQ(step(12756274), 1);
    EXPECT_EQ(rounding_bound({0, 0, 0}, {95000, 1, 1}, reference_of(MeshFrame::utm), MeshFormat::glb).z, 1 / 256.0);
    EXPECT_EQ(rounding_bound({5, 5, 5}, {5, 5, 5}, reference_of(MeshFrame::utm), MeshFormat::glb).step,
              std::ldexp(1, -100));
}

TEST(MeshRounding, OriginPlusOffsetIsTheRoundedVertex) {
    for (const glm::dvec3& low : {glm::dvec3(0), glm::dvec3(-47500, -47500, 3000), glm::dvec3(431234.567, 4161234.5, 1),
                                  glm::dvec3(-1703145.7, -4878231.9, 3728123.1), glm::dvec3(1e9, -1e9, 7)})
        for (const double side : {0.37, 997.123, 1000.3, 94997.3, 131072.0 - 1 / 128.0, 131071.99, 131072.0, 12.7e6}) {
            const MeshReference reference = reference_of(MeshFrame::ecef);
            const SurfaceMesh exact = wavy_mesh(9, side, low);
            SurfaceMesh mesh = exact;
            const MeshRounding rounding = round_to_format(mesh, reference, MeshFormat::glb);
            double xy = 0, z = 0;
            for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
                const glm::dvec3 moved = glm::abs(mesh.vertices[i] - exact.vertices[i]);
                xy = std::max({xy, moved.x, moved.y});
                z = std::max(z, moved.z);
                EXPECT_EQ(std::remainder(mesh.vertices[i].x, rounding.step), 0);
            }
            EXPECT_EQ(rounding.xy, xy);
            EXPECT_EQ(rounding.z, z);
            EXPECT_LE(std::max(xy, z), rounding.step / 2);
            const Glb glb(bytes_of_mesh(mesh, reference, MeshFormat::glb, rounding));
            expect_exact(mesh, glb);
            // Where rounding doubled the step to be safe, the writer need not.
            const double grid = side > 131071 && side < 131073 ? rounding.step / 2 : rounding.step;
            for (const double t : glb.list("translation")) EXPECT_EQ(std::remainder(t, grid), 0);
            const SurfaceMesh read = mesh_from_bytes(bytes_of_mesh(mesh, reference, MeshFormat::glb), ".glb");
            EXPECT_EQ(read.vertices, mesh.vertices);
            EXPECT_EQ(read.triangles, mesh.triangles);
            SurfaceMesh again = mesh;
            const MeshRounding none = round_to_format(again, reference, MeshFormat::glb);
            EXPECT_EQ(again.vertices, mesh.vertices) << "side " << side;
            EXPECT_EQ(none.xy, 0);
        }
}

TEST(MeshRounding, APlanetHasItsOriginAtTheCentre) {
    SurfaceMesh ball;
    for (int i = 0; i <= 20; ++i)
        for (int k = 0; k < 40; ++k)
            ball.vertices.push_back((6378137 + 100.3 * i) *
                                    normal_from_geodetic((9 * i - 90) * degrees, 9.1 * k * degrees));
    for (std::uint32_t i = 0; i + 41 < ball.vertices.size(); ++i) ball.triangles.push_back({i, i + 1, i + 41});
    const MeshRounding rounding = round_to_format(ball, reference_of(MeshFrame::ecef), MeshFormat::glb);
    EXPECT_EQ(rounding.step, 1);
    const Glb glb(bytes_of_mesh(ball, reference_of(MeshFrame::ecef), MeshFormat::glb, rounding));
    EXPECT_TRUE(glb.list("translation").empty());
    EXPECT_EQ(glb.list("ecef"), (std::vector<double>{0, 0, 0}));
    expect_exact(ball, glb);
}

// Two tiles side by side: the eastern side of one is the western side of the other.
void expect_equal_borders(const SurfaceMesh& west, const SurfaceMesh& east, std::uint32_t west_n,
                          std::uint32_t east_n) {
    const MeshReference reference = reference_of(MeshFrame::utm);
    const Glb a(bytes_of_mesh(west, reference, MeshFormat::glb)), b(bytes_of_mesh(east, reference, MeshFormat::glb));
    EXPECT_NE(a.list("translation"), b.list("translation"));
    for (std::uint32_t y = 0; y <= west_n; ++y) {
        const std::size_t at = y * (west_n + 1) + west_n, beside = y * (east_n + 1);
        EXPECT_EQ(a.vertex(at), b.vertex(beside));
        EXPECT_EQ(west.vertices[at], east.vertices[beside]);
    }
}

TEST(MeshFile, HoldsAMeshToTheBit) {
    const TemporaryFolder folder;
    for (const MeshFormat format : all_formats) {
        SurfaceMesh mesh = wavy_mesh(9, 100);
        round_to_format(mesh, enu_reference(), format);
        const std::string bytes = bytes_of_mesh(mesh, enu_reference(), format), path = folder / "mesh";
        const auto holds = [&](const SurfaceMesh& expected) { return file_holds(path, format, expected); };
        write_bytes(path, bytes);
        EXPECT_TRUE(holds(mesh));
        SurfaceMesh moved = mesh, fewer = mesh, turned = mesh;
        moved.vertices.back().z = std::nextafter(moved.vertices.back().z, 1e9);
        fewer.triangles.pop_back();
        std::swap(turned.triangles[3][0], turned.triangles[3][1]);
        EXPECT_FALSE(holds(moved));
        EXPECT_FALSE(holds(fewer));
        EXPECT_FALSE(holds(turned));
        if (format != MeshFormat::stl && format != MeshFormat::obj) continue;
        const std::string more = format == MeshFormat::obj ? "f 1 2 3\n" : "x";
        for (const std::string& damaged : {bytes.substr(0, bytes.size() - 9), bytes + more, std::string()}) {
            write_bytes(path, damaged);
            EXPECT_FALSE(holds(mesh));
        }
    }
}

TEST(MeshRounding, NeighbouringTilesShareTheBitsOfTheirBorder) {
    const std::uint32_t n = 16;
    const MeshReference reference = reference_of(MeshFrame::utm);
    const auto tile = [&](double side, double west, std::uint32_t columns) {
        SurfaceMesh mesh = wavy_mesh(n, side, {west, 4161234.5671, 0});
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {  // heights by row, so that borders agree
            const double row = static_cast<double>(i / (n + 1)), column = static_cast<double>(i % (n + 1));
            mesh.vertices[i] = {west + side * column / columns, 4161234.5671 + 95000 * row / n, 1e3 * std::sin(row)};
        }
        return mesh;
    };
    const double border = 431234.5678;
    SurfaceMesh west = tile(95000, border - 95000, n), east = tile(95000, border, n);
    for (std::uint32_t y = 0; y <= n; ++y) west.vertices[y * (n + 1) + n].x = border;
    SurfaceMesh far = tile(190000, border, n);
    SurfaceMesh west_again = west;
    round_to_format(west, reference, MeshFormat::glb);
    round_to_format(east, reference, MeshFormat::glb);
    expect_equal_borders(west, east, n, n);

    const double step = round_to_format(far, reference, MeshFormat::glb).step;
    EXPECT_EQ(step, 1 / 64.0);
    EXPECT_EQ(round_to_format(west_again, reference, MeshFormat::glb, step).step, step);
    expect_equal_borders(west_again, far, n, n);
}

}  // namespace
}  // namespace planet
