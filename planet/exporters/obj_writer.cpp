// Wavefront OBJ: vertices and triangles, counted from 1.

#include <algorithm>

#include "planet/exporters/block_writer.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"

namespace planet {

namespace {

constexpr std::size_t longest_line = 6 * 25 + 3 * 2 * 21 + 3;

/// " 1 2 3"
template <class Vector>
char* put_numbers(char* at, const Vector& v, int count) {
    for (int i = 0; i < count; ++i) {
        *at++ = ' ';
        at = std::to_chars(at, at + 24, v[i]).ptr;
    }
    return at;
}

/// One line for each.
template <class Vector>
void put_lines(BlockWriter& out, std::string_view key, const std::vector<Vector>& values) {
    for (const Vector& v : values) {
        char* at = out.room(longest_line);
        at = std::copy(key.begin(), key.end(), at);
        at = put_numbers(at, v, Vector::length());
        *at++ = '\n';
        out.taken(at);
    }
}

/// "7", "7/7", "7//7" or "7/7/7".
char* put_corner(char* at, std::uint64_t number, const MeshLooks& looks) {
    at = std::to_chars(at, at + 20, number).ptr;
    if (looks.uv.empty() && looks.normals.empty()) return at;
    *at++ = '/';
    if (!looks.uv.empty()) at = std::to_chars(at, at + 20, number).ptr;
    if (looks.normals.empty()) return at;
    *at++ = '/';
    return std::to_chars(at, at + 20, number).ptr;
}

}  // namespace

void write_obj(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, const MeshLooks& looks) {
    BlockWriter out(sink);
    for (const std::string& line : reference_lines(reference)) out.put_bytes("# " + line + "\n");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        char* at = out.room(longest_line);
        *at++ = 'v';
        at = put_numbers(at, mesh.vertices[i], 3);
        if (!looks.colors.empty()) at = put_numbers(at, looks.colors[i], 3);
        *at++ = '\n';
        out.taken(at);
    }
    for (const glm::vec2& uv : looks.uv) {  // from the bottom left
        const std::string line =
            "vt " + text_of(static_cast<double>(uv.x)) + " " + text_of(1 - static_cast<double>(uv.y)) + "\n";
        out.put_bytes(line);
    }
    put_lines(out, "vn", looks.normals);
    for (const auto& t : mesh.triangles) {
        char* at = out.room(longest_line);
        *at++ = 'f';
        for (const std::uint64_t vertex : t) {
            *at++ = ' ';
            at = put_corner(at, vertex + 1, looks);
        }
        *at++ = '\n';
        out.taken(at);
    }
    out.flush();
}

}  // namespace planet
