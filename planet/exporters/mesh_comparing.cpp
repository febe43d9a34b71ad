// Whether a file has the triangles of a mesh.

#include <array>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

#include "planet/exporters/mesh_file.h"
#include "planet/exporters/text_words.h"

namespace planet {
namespace {

// Facet by facet, as its reader needs many times the size of the file to find out which corners are one vertex.
bool binary_stl_holds(const std::string& path, const SurfaceMesh& mesh) {
    std::ifstream in(path, std::ios::binary);
    std::uint32_t count = 0;
    in.ignore(80);
    in.read(reinterpret_cast<char*>(&count), sizeof count);
    if (!in || count != mesh.triangles.size()) return false;
    for (const auto& t : mesh.triangles) {
        char facet[50];
        in.read(facet, sizeof facet);
        glm::vec3 corners[3];
        std::memcpy(corners, facet + sizeof(glm::vec3), sizeof corners);
        for (std::size_t k = 0; k < 3; ++k)
            if (glm::dvec3(corners[k]) != mesh.vertices[t[k]]) return false;
    }
    return in && in.get() == std::ifstream::traits_type::eof();
}

template <class Number>
std::optional<std::array<Number, 3>> three_numbers(std::string_view words) {
    std::array<Number, 3> out;
    for (Number& number : out) {
        const std::string_view word = take_word(words);
        const auto value = number_from<Number>(word.substr(0, word.find('/')));
        if (!value) return std::nullopt;
        number = *value;
    }
    return out;
}

// Line by line, as a text takes more memory than the mesh. Vertices are numbered from 1.
bool obj_holds(const std::string& path, const SurfaceMesh& mesh) {
    std::ifstream in(path);
    std::size_t vertices = 0, triangles = 0;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("v ")) {
            const auto p = three_numbers<double>(std::string_view(line).substr(2));
            if (vertices == mesh.vertices.size() || !p) return false;
            const glm::dvec3& v = mesh.vertices[vertices++];
            if (*p != std::array{v.x, v.y, v.z}) return false;
        } else if (line.starts_with("f ")) {
            const auto t = three_numbers<std::uint32_t>(std::string_view(line).substr(2));
            if (triangles == mesh.triangles.size() || !t) return false;
            const auto& [a, b, c] = mesh.triangles[triangles++];
            if (*t != std::array{a + 1, b + 1, c + 1}) return false;
        }
    }
    return in.eof() && vertices == mesh.vertices.size() && triangles == mesh.triangles.size();
}

}  // namespace

bool file_holds(const std::string& path, MeshFormat format, const SurfaceMesh& mesh) {
    if (format == MeshFormat::stl) return binary_stl_holds(path, mesh);
    if (format == MeshFormat::obj) return obj_holds(path, mesh);
    const SurfaceMesh found = read_mesh(path, format);
    if (found.triangles.size() != mesh.triangles.size()) return false;
    for (std::size_t i = 0; i < found.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            if (found.vertices[found.triangles[i][k]] != mesh.vertices[mesh.triangles[i][k]]) return false;
    return true;
}

}  // namespace planet
