// glTF 2.0, binary: Khronos, "glTF 2.0 Specification" (2021); the container is its section 4.

#include <algorithm>
#include <cassert>
#include <limits>
#include <nlohmann/json.hpp>

#include "planet/exporters/block_writer.h"
#include "planet/exporters/float_grid.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"
#include "planet/frames.h"

namespace planet {
namespace {

using Json = nlohmann::ordered_json;

Json list(const auto& v) {
    return {v[0], v[1], v[2]};
}

// y-up. 0 stays 0.
glm::dvec3 gltf_from_frame(const glm::dvec3& v) {
    return {v.x, v.z, 0 - v.y};
}
glm::vec3 offset_of(const glm::dvec3& v, const glm::dvec3& origin) {
    return glm::vec3(v.x - origin.x, v.z - origin.z, origin.y - v.y);
}

// Of an enu frame, where it stands; else the place of the root node in the axes of the frame.
Json origin_of(const MeshReference& reference, const glm::dvec3& root) {
    if (reference.frame == MeshFrame::ecef) return {{"ecef", list(root)}};
    if (reference.frame != MeshFrame::enu) return {{"position", list(root)}};
    const Geodetic g = geodetic_from_normal(reference.ecef_from_enu[2]);
    return {{"ecef", list(reference.origin)}, {"latitude", g.latitude / degrees}, {"longitude", g.longitude / degrees}};
}

Json extras_of(const MeshReference& reference, const glm::dvec3& root, const std::optional<MeshRounding>& rounding) {
    Json extras{{"frame", to_string(reference.frame)}};
    if (!reference.crs.empty()) extras["crs"] = reference.crs;
    if (!reference.vertical_datum.empty()) extras["vertical_datum"] = reference.vertical_datum;
    extras["origin"] = origin_of(reference, root);
    if (reference.frame == MeshFrame::enu) {
        const glm::dmat3& axes = reference.ecef_from_enu;
        extras["ecef_from_enu"] = {list(axes[0]), list(axes[1]), list(axes[2])};
    }
    if (rounding) extras["rounding"] = {{"xy", rounding->xy}, {"z", rounding->z}, {"step", rounding->step}};
    return extras;
}

// The numbers are glTF's: component types, targets and modes.
struct Layout {
    glm::dvec3 root{0};
    glm::vec3 low{0}, high{0};  ///< of the offsets
    std::size_t vertices = 0, indices = 0;
    bool short_indices = false;

    std::size_t position_bytes() const { return 12 * vertices; }
    std::size_t index_bytes() const { return (short_indices ? 2 : 4) * indices; }
    std::size_t bytes() const { return position_bytes() + index_bytes(); }
};

// The largest index of its type stands for "restart" and must not occur: 65,535 vertices are the most for 16 bits.
Layout layout_of(const SurfaceMesh& mesh) {
    Layout layout{float_origin(bounds_of(mesh.vertices, ".glb")),
                  {},
                  {},
                  mesh.vertices.size(),
                  3 * mesh.triangles.size(),
                  mesh.vertices.size() <= 65535};
    layout.low = layout.high = offset_of(mesh.vertices[0], layout.root);
    for (const glm::dvec3& v : mesh.vertices) {
        const glm::vec3 offset = offset_of(v, layout.root);
        layout.low = glm::min(layout.low, offset);
        layout.high = glm::max(layout.high, offset);
    }
    return layout;
}

std::string json_of(const Layout& layout, const MeshReference& reference, const std::optional<MeshRounding>& rounding) {
    const std::size_t positions = layout.position_bytes();
    Json gltf{
        {"asset",
         {{"version", "2.0"}, {"generator", "Octaglobe"}, {"extras", extras_of(reference, layout.root, rounding)}}}};
    gltf["scene"] = 0;
    gltf["scenes"] = Json::array({{{"nodes", {0}}}});
    Json node{{"name", "terrain"}, {"mesh", 0}};
    if (layout.root != glm::dvec3(0)) node["translation"] = list(gltf_from_frame(layout.root));
    gltf["nodes"] = Json::array({node});
    const Json primitive{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", 0}, {"mode", 4}};
    gltf["meshes"] = Json::array({{{"name", "terrain"}, {"primitives", Json::array({primitive})}}});
    const Json rough{{"baseColorFactor", {0.6, 0.6, 0.6, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    gltf["materials"] = Json::array({{{"name", "terrain"}, {"pbrMetallicRoughness", rough}}});
    gltf["accessors"] = Json::array({{{"bufferView", 0},
                                      {"componentType", 5126},
                                      {"count", layout.vertices},
                                      {"type", "VEC3"},
                                      {"min", list(layout.low)},
                                      {"max", list(layout.high)}},
                                     {{"bufferView", 1},
                                      {"componentType", layout.short_indices ? 5123 : 5125},
                                      {"count", layout.indices},
                                      {"type", "SCALAR"}}});
    gltf["bufferViews"] = Json::array(
        {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions}, {"target", 34962}},
         {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", layout.index_bytes()}, {"target", 34963}}});
    gltf["buffers"] = Json::array({{{"byteLength", layout.bytes()}}});
    return gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::size_t padded(std::size_t size) {
    return (size + 3) / 4 * 4;
}

void put_offsets(BlockWriter& out, const SurfaceMesh& mesh, const glm::dvec3& origin) {
    for (const glm::dvec3& v : mesh.vertices) out.put(offset_of(v, origin));
}

void put_indices(BlockWriter& out, const SurfaceMesh& mesh, bool short_indices) {
    if (!short_indices) return out.put_bytes(bytes_of(mesh.triangles));
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t i : t) out.put(static_cast<std::uint16_t>(i));
}

}  // namespace

void write_glb(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference,
               const std::optional<MeshRounding>& rounding) {
    const Layout layout = layout_of(mesh);
    std::string json = json_of(layout, reference, rounding);
    json.resize(padded(json.size()), ' ');
    const std::size_t binary = padded(layout.bytes()), size = 12 + 8 + json.size() + 8 + binary;
    if (size > std::numeric_limits<std::uint32_t>::max()) refuse_size(".glb", "files below 4 GiB; .ply holds more");
    const auto word = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    constexpr std::uint32_t magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
    BlockWriter out(sink);
    for (const std::uint32_t w : {magic, 2u, word(size), word(json.size()), json_chunk}) out.put(w);
    out.put_bytes(json);
    for (const std::uint32_t w : {word(binary), binary_chunk}) out.put(w);
    put_offsets(out, mesh, layout.root);
    put_indices(out, mesh, layout.short_indices);
    out.put_bytes(std::string_view("\0\0\0", binary - layout.bytes()));
    out.flush();
}

}  // namespace planet
