// Wavefront OBJ: vertices and triangles, counted from 1.

#include "planet/exporters/block_writer.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"

namespace planet {

void write_obj(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference) {
    BlockWriter out(sink);
    for (const std::string& line : reference_lines(reference)) out.put_bytes("# " + line + "\n");
    constexpr std::size_t longest_line = 3 * 25 + 2;
    for (const glm::dvec3& v : mesh.vertices) {
        char* at = out.room(longest_line);
        *at++ = 'v';
        for (int axis = 0; axis < 3; ++axis) {
            *at++ = ' ';
            at = put_number(at, v[axis]);
        }
        *at++ = '\n';
        out.taken(at);
    }
    for (const auto& t : mesh.triangles) {
        char* at = out.room(longest_line);
        *at++ = 'f';
        for (const std::uint64_t vertex : t) {
            *at++ = ' ';
            at = std::to_chars(at, at + 20, vertex + 1).ptr;
        }
        *at++ = '\n';
        out.taken(at);
    }
    out.flush();
}

}  // namespace planet
