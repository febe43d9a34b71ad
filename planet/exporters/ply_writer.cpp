// PLY, binary and little-endian: Turk, "The PLY Polygon File Format" (1994).

#include <limits>

#include "planet/exporters/block_writer.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"

namespace planet {

void write_ply(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference) {
    if (mesh.vertices.size() > std::numeric_limits<std::int32_t>::max())
        refuse_size(".ply", "at most 2147483647 vertices");  // vertex_indices are signed
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& line : reference_lines(reference)) header += "comment " + line + "\n";
    header += "element vertex " + std::to_string(mesh.vertices.size()) +
              "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
              std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    BlockWriter out(sink);
    out.put_bytes(header);
    static_assert(sizeof mesh.vertices[0] == 24);
    out.put_bytes(bytes_of(mesh.vertices));
    for (const auto& t : mesh.triangles) {
        char* const at = out.room(13);
        *at = 3;
        std::memcpy(at + 1, t.data(), 12);
        out.taken(at + 13);
    }
    out.flush();
}

}  // namespace planet
