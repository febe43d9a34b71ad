// PLY, binary and little-endian: Turk, "The PLY Polygon File Format" (1994).

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/exporters/block_writer.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"

namespace planet {

namespace {

std::string vertex_properties(const MeshLooks& looks) {
    std::string text = "\nproperty double x\nproperty double y\nproperty double z";
    if (!looks.normals.empty()) text += "\nproperty float nx\nproperty float ny\nproperty float nz";
    if (!looks.uv.empty()) text += "\nproperty float s\nproperty float t";
    if (!looks.colors.empty())
        text += "\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha";
    return text;
}

std::uint8_t byte_of(float share) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
}

void put_vertices(BlockWriter& out, const SurfaceMesh& mesh, const MeshLooks& looks) {
    static_assert(sizeof mesh.vertices[0] == 24);
    if (looks.normals.empty() && looks.uv.empty() && looks.colors.empty())
        return out.put_bytes(bytes_of(mesh.vertices));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        out.put(mesh.vertices[i]);
        if (!looks.normals.empty()) out.put(looks.normals[i]);
        if (!looks.uv.empty()) out.put(glm::vec2(looks.uv[i].x, 1 - looks.uv[i].y));  // from the bottom left
        if (looks.colors.empty()) continue;
        for (int k = 0; k < 4; ++k) out.put(byte_of(looks.colors[i][k]));
    }
}

}  // namespace

void write_ply(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, const MeshLooks& looks) {
    if (mesh.vertices.size() > std::numeric_limits<std::int32_t>::max())
        refuse_size(".ply", "at most 2147483647 vertices");  // vertex_indices are signed
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& line : reference_lines(reference)) header += "comment " + line + "\n";
    header += "element vertex " + std::to_string(mesh.vertices.size()) + vertex_properties(looks) + "\nelement face " +
              std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    BlockWriter out(sink);
    out.put_bytes(header);
    put_vertices(out, mesh, looks);
    for (const auto& t : mesh.triangles) {
        char* const at = out.room(13);
        *at = 3;
        std::memcpy(at + 1, t.data(), 12);
        out.taken(at + 13);
    }
    out.flush();
}

}  // namespace planet
