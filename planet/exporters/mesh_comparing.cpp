// Whether a file has the triangles of a mesh.

#include <cstring>
#include <fstream>

#include "planet/exporters/mesh_file.h"

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

}  // namespace

bool file_holds(const std::string& path, MeshFormat format, const SurfaceMesh& mesh) {
    if (format == MeshFormat::stl) return binary_stl_holds(path, mesh);
    const SurfaceMesh found = read_mesh(path, format);
    if (found.triangles.size() != mesh.triangles.size()) return false;
    for (std::size_t i = 0; i < found.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            if (found.vertices[found.triangles[i][k]] != mesh.vertices[mesh.triangles[i][k]]) return false;
    return true;
}

}  // namespace planet
