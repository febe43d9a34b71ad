// Reading mesh files that others wrote, and files that are damaged or hostile.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "planet/error.h"
#include "planet/exporters/mesh_file.h"
#include "surface_meshes.h"

namespace planet {
namespace {

using testing::bytes_of_mesh;
using testing::enu_reference;
using testing::mesh_from_bytes;
using testing::TemporaryFolder;
using testing::wavy_mesh;
using testing::write_bytes;

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Vertices = std::vector<glm::dvec3>;

std::string refusal(const std::string& path) {
    try {
        read_mesh(path);
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data) << e.what();
        EXPECT_TRUE(std::string(e.what()).starts_with(path)) << e.what();
        EXPECT_TRUE(
            std::all_of(e.what(), e.what() + std::strlen(e.what()), [](char c) { return c >= ' ' && c <= '~'; }));
        return e.what();
    }
    return "";
}

std::string refusal_of_bytes(const std::string& bytes, const std::string& ending) {
    const TemporaryFolder folder;
    write_bytes(folder / ("mesh" + ending), bytes);
    return refusal(folder / ("mesh" + ending));
}

bool contains(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

template <class T>
std::string bytes_of_numbers(std::initializer_list<T> numbers, bool big_endian = false) {
    std::string bytes;
    for (const T number : numbers) {
        auto b = std::bit_cast<std::array<char, sizeof(T)>>(number);
        if (big_endian) std::reverse(b.begin(), b.end());
        bytes.append(b.data(), b.size());
    }
    return bytes;
}

// A .glb of this JSON, in which # stands for the size of the binary chunk.
std::string glb_of(std::string json, std::string binary) {
    while (binary.size() % 4 != 0) binary += '\0';
    if (const std::size_t hash = json.find('#'); hash != std::string::npos)
        json.replace(hash, 1, std::to_string(binary.size()));
    while (json.size() % 4 != 0) json += ' ';
    const auto u32 = [](std::size_t v) { return bytes_of_numbers({static_cast<std::uint32_t>(v)}); };
    return "glTF" + u32(2) + u32(28 + json.size() + binary.size()) + u32(json.size()) + "JSON" + json +
           u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

TEST(MeshReading, AsciiPlyWithPolygonsAndMore) {
    MeshReference reference;
    const SurfaceMesh mesh = mesh_from_bytes(
        "ply\r\nformat ascii 1.0\r\ncomment frame utm\r\nobj_info scanned\r\nelement camera 2\r\nproperty list uchar "
        "float "
        "view\r\nelement nothing 4000000000\r\nelement vertex 5\r\nproperty float32 x\r\nproperty uchar "
        "red\r\nproperty "
        "float y\r\nproperty list int int neighbours\r\nproperty float z\r\nelement face 3\r\nproperty uchar "
        "flags\r\nproperty list uchar int vertex_index\r\nend_header\r\n"
        "2 0.5 0.25 0\r\n"
        "0 255 0 0 0\r\n1 255 0 2 7 8 0\r\n1 255 +1 0 1e0\r\n0 255 1 0 0.5\r\n-1 0 0.5 0 0\r\n"
        "9 5 0 1 2 3 4\r\n9 2 0 1\r\n9 3 0 1 2",
        ".ply", &reference);
    EXPECT_EQ(mesh.vertices, (Vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0.5}, {-1, 0.5, 0}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 1, 2}})) << "a fan, no side, a triangle";
    EXPECT_EQ(reference.frame, MeshFrame::utm);
}

TEST(MeshReading, BinaryPlyOfEitherEndianness) {
    for (const bool big : {false, true}) {
        const std::string header = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                                   "_endian 1.0\nelement vertex 3\nproperty short x\nproperty float y\nproperty double "
                                   "z\nelement face 1\nproperty list ushort uint vertex_indices\nend_header\n";
        std::string body;
        for (const float v : {0.0f, 1.0f, 2.0f})
            body += bytes_of_numbers({static_cast<std::int16_t>(-300 * v)}, big) + bytes_of_numbers({v + 0.5f}, big) +
                    bytes_of_numbers({static_cast<double>(v) * 0.1}, big);
        body += bytes_of_numbers<std::uint16_t>({3}, big) + bytes_of_numbers<std::uint32_t>({2, 0, 1}, big);
        const SurfaceMesh mesh = mesh_from_bytes(header + body, ".ply");
        EXPECT_EQ(mesh.vertices, (Vertices{{0, 0.5, 0}, {-300, 1.5, 0.1}, {-600, 2.5, 0.2}}));
        EXPECT_EQ(mesh.triangles, (Triangles{{2, 0, 1}}));
    }
}

TEST(MeshReading, ObjOfOthers) {
    const SurfaceMesh mesh = mesh_from_bytes(
        "# by hand\nmtllib x.mtl\no square\nv 0 0 0 1.0\nv +1 0 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\n  v 1\t1 0\r\nv 0 1 "
        "0\n"
        "usemtl y\nf 1/1/1 2//1 3/1 4\nf -4 -2 -1\nl 1 2",
        ".obj");
    EXPECT_EQ(mesh.vertices, (Vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 2, 3}}));
    for (const char* bad :
         {"v 0 0\n", "v a b c\n", "v 0 0 0\nf 0 1 1\n", "v 0 0 0\nf -2 1 1\n", "v 0 0 0\nf 1 1 2\n",
          "v 0 0 0\nf 1 1 x\n", "v 0 0 0\nf 1 1 99999999999999999999\n", "v 0 0 0\nf 1 1 4294967296\n",
          "v 0 0 nan\nf 1 1 1\n", "v 0 0 1e999\nf 1 1 1\n", "v 0 0 0\nf 1 1\n", "\x1b[31m"})
        EXPECT_NE(refusal_of_bytes(bad, ".obj"), "") << bad;
}

TEST(MeshReading, StlJoinsCornersAtOnePlace) {
    const SurfaceMesh ascii = mesh_from_bytes(
        "solid square\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n "
        "endloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex -0.0 0 0\nvertex 1.0 1e0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid\n",
        ".stl");
    EXPECT_EQ(ascii.vertices, (Vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(ascii.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));

    MeshReference reference;
    std::string binary = bytes_of_mesh(ascii, enu_reference(), MeshFormat::stl);
    EXPECT_EQ(mesh_from_bytes(binary, ".stl", &reference).vertices, ascii.vertices);
    EXPECT_EQ(reference.frame, MeshFrame::enu);
    binary.replace(0, 5, "solid");  // as some programs begin binary files too
    EXPECT_EQ(mesh_from_bytes(binary, ".stl").triangles, ascii.triangles);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(&binary[84 + 12], &nan, 4);
    EXPECT_TRUE(contains(refusal_of_bytes(binary, ".stl"), "not finite"));
    for (const char* bad : {"solid x", "solid x\nvertex 0 0", "solid x\nvertex 0 0 0 vertex 0 0 0", "soli"})
        EXPECT_NE(refusal_of_bytes(bad, ".stl"), "") << bad;
}

const char* const foreign_json =
    R"({"asset":{"version":"2.0","extras":{"frame":7,"crs":["x"]}},"extensionsRequired":["KHR_materials_unlit"],"scene":1,
"scenes":[{"nodes":[5]},{"nodes":[0,2]}],
"nodes":[{"translation":[10,0,0],"children":[1]},{"scale":[2,2,2],"mesh":0},
{"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1],"mesh":1},{},{},{"mesh":1}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":5},{"attributes":{"POSITION":0},"mode":0}]},
{"primitives":[{"attributes":{"POSITION":0},"mode":6},{"attributes":{"POSITION":0},"indices":2}]}],
"accessors":[{"bufferView":0,"byteOffset":4,"componentType":5126,"count":4,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},
{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":64,"byteStride":16},{"buffer":0,"byteOffset":64,"byteLength":6},
{"buffer":0,"byteOffset":70,"byteLength":6}],
"buffers":[{"byteLength":#}]})";

std::string foreign_binary() {
    return bytes_of_numbers<float>({9, 0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9, 1, 1, 0}) +
           bytes_of_numbers<std::uint8_t>({0, 1, 2, 2, 3, 1}) + bytes_of_numbers<std::uint16_t>({3, 2, 1});
}

TEST(MeshReading, GlbOfNodesStripsFansAndStrides) {
    const SurfaceMesh mesh = mesh_from_bytes(glb_of(foreign_json, foreign_binary()), ".glb");
    const Vertices strip{{10, 0, 0}, {12, 0, 0}, {10, 0, 2}, {12, 0, 2}};  // scaled, moved, turned z-up
    const Vertices mirrored{{0, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {-1, 0, 1}};
    Vertices all = strip;
    all.insert(all.end(), mirrored.begin(), mirrored.end());
    all.insert(all.end(), mirrored.begin(), mirrored.end());
    EXPECT_EQ(mesh.vertices, all);
    // The strip 0 1 2 2 3 1 has its turns left out; what a mirror turns over is turned back.
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}, {4, 6, 5}, {4, 7, 6}, {11, 9, 10}}));
}

// Of its strip, and of the two parts that a mirror shows.
TEST(MeshReading, GlbOfMaterials) {
    const auto looks_of = [](const std::string& first, const std::string& second) {
        std::string json = foreign_json;
        const auto put = [&](const std::string& before, const std::string& text) {
            const std::size_t at = json.find(before);
            EXPECT_NE(at, json.npos);
            json.insert(at, text);
        };
        put(R"("mode":5)", R"("material":0,)");
        put(R"("indices":2)", R"("material":1,)");
        put(R"("meshes":)", R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":)" + first +
                                R"(}},{"pbrMetallicRoughness":{"baseColorFactor":)" + second + "}}],");
        const TemporaryFolder folder;
        write_bytes(folder / "m.glb", glb_of(json, foreign_binary()));
        MeshLooks looks;
        read_mesh(folder / "m.glb", nullptr, &looks);
        return looks;
    };
    const glm::vec4 red(1, 0, 0.25f, 1), white(1), blue(0, 0, 1, 0.5f);
    const MeshLooks two = looks_of("[1,0,0.25,1]", "[0,0,1,0.5]");
    EXPECT_EQ(two.base_color, white);
    ASSERT_EQ(two.colors.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(two.colors[i], i < 4 ? red : i < 8 ? white : blue) << i;
    const MeshLooks plain = looks_of("[1,1,1,1]", "[1,1,1]");  // one that is none
    EXPECT_EQ(plain.base_color, white);
    EXPECT_TRUE(plain.colors.empty());
}

TEST(MeshReading, GlbThatIsNotReadSaysWhy) {
    const auto with = [](std::string_view part, std::string_view instead) {
        std::string json = foreign_json;
        const std::size_t at = json.find(part);
        EXPECT_NE(at, std::string::npos) << part;
        json.replace(at, part.size(), instead);
        return refusal_of_bytes(glb_of(json, foreign_binary()), ".glb");
    };
    EXPECT_TRUE(contains(with("KHR_materials_unlit", "KHR_draco_mesh_compression"), "KHR_draco_mesh_compression"));
    EXPECT_TRUE(contains(with("\"mesh\":0}", "\"mesh\":0,\"children\":[0]}"), "trees"));
    EXPECT_TRUE(contains(with("\"byteLength\":#", "\"byteLength\":#,\"uri\":\"x.bin\""), "another file"));
    EXPECT_TRUE(contains(with("\"count\":4", "\"count\":5"), "beyond its end"));
    EXPECT_TRUE(contains(with("\"count\":4", "\"count\":-1"), "whole number"));
    EXPECT_TRUE(contains(with("\"count\":4", "\"count\":1e300"), "whole number"));
    EXPECT_TRUE(contains(with("\"count\":4", "\"count\":18446744073709551615"), "beyond its end"));
    EXPECT_TRUE(contains(with("\"count\":4", "\"count\":3"), "no vertex"));
    EXPECT_TRUE(contains(with("\"byteOffset\":4", "\"byteOffset\":18446744073709551615"), "beyond its end"));
    EXPECT_TRUE(contains(with("\"byteOffset\":64", "\"byteOffset\":18446744073709551615"), "beyond its end"));
    EXPECT_TRUE(contains(with("\"byteStride\":16", "\"byteStride\":0"), "beyond its end"));
    EXPECT_TRUE(contains(with("\"type\":\"VEC3\"", "\"type\":\"VEC3\",\"sparse\":{}"), "sparse"));
    EXPECT_TRUE(contains(with("\"translation\":[10,0,0]", "\"translation\":[1e300,1e400,0]"), "JSON"));
    EXPECT_TRUE(contains(with("\"translation\":[10,0,0]", "\"translation\":[10,0]"), "JSON"));
    EXPECT_TRUE(contains(with("\"scale\":[2,2,2]", "\"scale\":[1e308,1e308,1e308],\"rotation\":[9,9,9,9]"), "finite"));
    EXPECT_TRUE(contains(with("\"scene\":1", "\"scene\":9"), "JSON"));
    EXPECT_TRUE(contains(with("\"nodes\":[0,2]", "\"nodes\":[3,4]"), "no triangles"));
    EXPECT_TRUE(contains(with("\"asset\"", "asset"), "JSON"));
    EXPECT_NE(refusal_of_bytes("glTF", ".glb"), "");
    EXPECT_TRUE(contains(refusal_of_bytes(std::string(100, 'x'), ".glb"), "not a binary glTF"));
    EXPECT_NE(refusal_of_bytes(glb_of(std::string(100000, '['), ""), ".glb"), "");
    EXPECT_NE(refusal_of_bytes(glb_of("[]", ""), ".glb"), "");
    EXPECT_NE(refusal_of_bytes(glb_of("7", ""), ".glb"), "");
}

// Small files that ask for much: refused from the file's size, in no time.
TEST(MeshReading, CountsBeyondTheFileAllocateNothing) {
    const std::string face = "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* encoding : {"ascii", "binary_little_endian"}) {
        const std::string head = std::string("ply\nformat ") + encoding + " 1.0\nelement vertex ";
        EXPECT_TRUE(contains(refusal_of_bytes(head +
                                                  "99999999999\nproperty char x\nproperty char y\nproperty char "
                                                  "z\nelement face 1" +
                                                  face + std::string(99, '1'),
                                              ".ply"),
                             "no room"));
        EXPECT_TRUE(contains(refusal_of_bytes(head +
                                                  "0\nproperty char x\nproperty char y\nproperty char z\nelement face "
                                                  "18446744073709551615" +
                                                  face,
                                              ".ply"),
                             "no room"));
        EXPECT_NE(refusal_of_bytes(head + "18446744073709551616" + face, ".ply"), "");
        EXPECT_NE(
            refusal_of_bytes(head + "18446744073709551615\nelement face 18446744073709551615\nend_header\n", ".ply"),
            "");
    }
    std::string stl(84, ' ');
    stl.replace(80, 4, "\xff\xff\xff\xff");
    EXPECT_TRUE(contains(refusal_of_bytes(stl, ".stl"), "ends early"));

    // Ten thousand nodes draw one strip of ten thousand turns, or a mesh of ten thousand primitives of points.
    std::string nodes, roots, points;
    for (int i = 0; i < 10000; ++i) {
        nodes += std::string(i ? "," : "") + R"({"mesh":0})";
        roots += std::string(i ? "," : "") + std::to_string(i);
        points += R"({"mode":0},)";
    }
    for (const std::string& first : {std::string(), points}) {
        const std::string json = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" +
                                 nodes + R"(],"meshes":[{"primitives":[)" + first +
                                 R"({"attributes":{"POSITION":0},"indices":1,"mode":5}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
            {"bufferView":1,"componentType":5121,"count":10000,"type":"SCALAR"}],
            "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":10000}],
            "buffers":[{"byteLength":#}]})";
        EXPECT_TRUE(contains(refusal_of_bytes(glb_of(json, std::string(10036, '\0')), ".glb"), "repeats"));
    }
}

TEST(MeshReading, WhatIsNoFileIsRefused) {
    const TemporaryFolder folder;
    EXPECT_TRUE(contains(refusal(folder / "none.glb"), "no such file"));
    std::filesystem::create_directory(folder / "folder.ply");
    EXPECT_TRUE(contains(refusal(folder / "folder.ply"), "not a file"));
    EXPECT_THROW(read_mesh(folder / "mesh.png"), Error);
    for (const char* ending : {".glb", ".ply", ".obj", ".stl"}) EXPECT_NE(refusal_of_bytes("", ending), "");
}

// A damaged file gives a mesh or an Error that names it; the sanitizers see to the rest.
class DamagedMesh : public ::testing::TestWithParam<const char*> {
  protected:
    DamagedMesh() : path_(folder_ / (std::string("mesh") + GetParam())) {
        file_ = bytes_of_mesh(wavy_mesh(12, 1000), enu_reference(), mesh_format(path_));
    }
    // Whether it is still read.
    bool reads(const std::string& bytes) {
        std::filesystem::remove(path_);  // some file systems wait for the disk when a file is written over
        write_bytes(path_, bytes);
        try {
            const SurfaceMesh mesh = read_mesh(path_);
            for (const auto& t : mesh.triangles)
                for (const std::uint32_t i : t) EXPECT_LT(i, mesh.vertices.size());
            return !mesh.triangles.empty();
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            EXPECT_TRUE(std::string(e.what()).starts_with(path_)) << e.what();
            return false;
        }
    }

    TemporaryFolder folder_;
    std::string path_, file_;
};

TEST_P(DamagedMesh, CutOffAnywhere) {
    ASSERT_TRUE(reads(file_));
    for (std::size_t size = 0; size < file_.size(); size += 97) {
        const bool whole = reads(file_.substr(0, size));
        EXPECT_FALSE(whole && path_.find(".obj") == std::string::npos) << "at byte " << size;
    }
}

TEST_P(DamagedMesh, BitsFlippedAnywhere) {
    std::mt19937 random(7);
    const std::size_t head = std::min<std::size_t>(file_.size(), 1500);
    std::size_t refused = 0;
    for (int i = 0; i < 1500; ++i) {
        std::string damaged = file_;
        for (int k = 0; k <= i % 4; ++k) {
            const std::size_t at = random() % (i % 3 == 0 ? file_.size() : head);
            damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
        }
        refused += !reads(damaged);
    }
    EXPECT_GT(refused, 0u);
}

TEST_P(DamagedMesh, PiecesMissingOrRepeated) {
    std::mt19937 random(11);
    for (int i = 0; i < 300; ++i) {
        std::string damaged = file_;
        const std::size_t at = random() % std::min<std::size_t>(file_.size(), 2000), length = 1 + random() % 40;
        if (i % 2 == 0)
            damaged.erase(at, length);
        else
            damaged.insert(at, file_.substr(random() % file_.size(), length));
        reads(damaged);
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedMesh, ::testing::Values(".glb", ".ply", ".obj", ".stl"),
                         [](const auto& test) { return std::string(test.param).substr(1); });

}  // namespace
}  // namespace planet
