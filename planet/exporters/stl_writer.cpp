// Binary STL: an 80 byte header, a count, and 50 bytes a triangle: its normal, its corners, two bytes of nothing.

#include <cassert>
#include <limits>

#include "planet/exporters/block_writer.h"
#include "planet/exporters/float_grid.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"

namespace planet {
namespace {

// Does not begin with "solid", which is how readers know a text.
std::string stl_header(const MeshReference& reference) {
    std::string header = "Octaglobe, metres";
    const auto lines = reference_lines(reference);
    for (std::size_t i = 1; i < lines.size(); ++i) header += ", " + lines[i];
    header.resize(80, ' ');
    return header;
}

// Of the triangle as it is written; 0 if it has no area.
glm::vec3 unit_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    return length > 0 ? glm::vec3(normal / length) : glm::vec3(0);
}

}  // namespace

void write_stl(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference) {
    if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
        refuse_size(".stl", "at most 4294967295 triangles");
    bounds_of(mesh.vertices, ".stl");
    BlockWriter out(sink);
    out.put_bytes(stl_header(reference));
    out.put(static_cast<std::uint32_t>(mesh.triangles.size()));
    struct Facet {
        glm::vec3 normal, corners[3];
    };
    static_assert(sizeof(Facet) == 48);
    for (const auto& t : mesh.triangles) {
        Facet facet;
        for (std::size_t i = 0; i < 3; ++i) {
            assert(t[i] < mesh.vertices.size());
            facet.corners[i] = glm::vec3(mesh.vertices[t[i]]);
        }
        facet.normal = unit_normal(facet.corners[0], facet.corners[1], facet.corners[2]);
        out.put(facet);
        out.put(std::uint16_t{0});
    }
    out.flush();
}

}  // namespace planet
