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

std::size_t padded(std::size_t size) {
    return (size + 3) / 4 * 4;
}

// An array of the binary chunk, or the picture. They begin at multiples of 4 bytes.
struct Part {
    std::size_t offset = 0, bytes = 0;
};

// The numbers are glTF's: component types, targets and modes.
struct Layout {
    glm::dvec3 root{0};
    glm::vec3 low{0}, high{0};  ///< of the offsets
    std::size_t vertices = 0, indices = 0;
    bool short_indices = false;
    Part positions{}, corners{}, normals{}, uv{}, colors{}, picture{};
    std::size_t bytes = 0;  ///< of all, without padding behind the last

    void place(const MeshLooks& looks) {
        const auto put = [this](Part& part, std::size_t size) {
            if (size == 0) return;
            part = {padded(bytes), size};
            bytes = part.offset + size;
        };
        put(positions, 12 * vertices);
        put(corners, (short_indices ? 2 : 4) * indices);
        put(normals, 12 * looks.normals.size());
        put(uv, 8 * looks.uv.size());
        put(colors, 16 * looks.colors.size());
        put(picture, looks.picture.size());
    }
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

// Arrays are named by the order in which they are added.
class Arrays {
  public:
    std::size_t add(const Part& part, const char* type, std::size_t component, std::size_t count) {
        constexpr int vertices = 34962, indices = 34963;
        views_.push_back({{"buffer", 0}, {"byteOffset", part.offset}, {"byteLength", part.bytes}});
        views_.back()["target"] = type == std::string_view("SCALAR") ? indices : vertices;
        accessors_.push_back(
            {{"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
        return accessors_.size() - 1;
    }
    std::size_t add_picture(const Part& part) {
        views_.push_back({{"buffer", 0}, {"byteOffset", part.offset}, {"byteLength", part.bytes}});
        return views_.size() - 1;
    }
    Json& accessor(std::size_t i) { return accessors_[i]; }
    void put(Json& gltf) const {
        gltf["accessors"] = accessors_;
        gltf["bufferViews"] = views_;
    }

  private:
    Json accessors_ = Json::array(), views_ = Json::array();
};

void put_picture(Json& gltf, Json& surface, const Layout& layout, const MeshLooks& looks, Arrays& arrays) {
    const bool png = std::string_view(looks.picture).starts_with("\x89PNG");
    gltf["images"] = Json::array({{{"bufferView", arrays.add_picture(layout.picture)},
                                   {"mimeType", png ? "image/png" : "image/jpeg"},
                                   {"name", "drape"}}});
    constexpr int clamp_to_edge = 33071, linear = 9729, linear_mipmap_linear = 9987;
    gltf["samplers"] = Json::array({{{"magFilter", linear},
                                     {"minFilter", linear_mipmap_linear},
                                     {"wrapS", clamp_to_edge},
                                     {"wrapT", clamp_to_edge}}});
    gltf["textures"] = Json::array({{{"sampler", 0}, {"source", 0}}});
    surface["baseColorTexture"] = {{"index", 0}};
}

std::string json_of(const Layout& layout, const MeshReference& reference, const std::optional<MeshRounding>& rounding,
                    const MeshLooks& looks) {
    constexpr std::size_t floats = 5126, shorts = 5123, ints = 5125;
    Json gltf{
        {"asset",
         {{"version", "2.0"}, {"generator", "Octaglobe"}, {"extras", extras_of(reference, layout.root, rounding)}}}};
    gltf["scene"] = 0;
    gltf["scenes"] = Json::array({{{"nodes", {0}}}});
    Json node{{"name", "terrain"}, {"mesh", 0}};
    if (layout.root != glm::dvec3(0)) node["translation"] = list(gltf_from_frame(layout.root));
    gltf["nodes"] = Json::array({node});
    Arrays arrays;
    Json attributes{{"POSITION", arrays.add(layout.positions, "VEC3", floats, layout.vertices)}};
    arrays.accessor(0)["min"] = list(layout.low);
    arrays.accessor(0)["max"] = list(layout.high);
    const std::size_t corners =
        arrays.add(layout.corners, "SCALAR", layout.short_indices ? shorts : ints, layout.indices);
    if (layout.normals.bytes > 0) attributes["NORMAL"] = arrays.add(layout.normals, "VEC3", floats, layout.vertices);
    if (layout.uv.bytes > 0) attributes["TEXCOORD_0"] = arrays.add(layout.uv, "VEC2", floats, layout.vertices);
    if (layout.colors.bytes > 0) attributes["COLOR_0"] = arrays.add(layout.colors, "VEC4", floats, layout.vertices);
    const Json primitive{{"attributes", attributes}, {"indices", corners}, {"material", 0}, {"mode", 4}};
    gltf["meshes"] = Json::array({{{"name", "terrain"}, {"primitives", Json::array({primitive})}}});
    const bool draped = layout.picture.bytes > 0;
    const double grey = draped || layout.colors.bytes > 0 ? 1 : unknown_color;
    Json surface{{"baseColorFactor", {grey, grey, grey, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    if (draped) put_picture(gltf, surface, layout, looks, arrays);
    gltf["materials"] = Json::array({{{"name", "terrain"}, {"pbrMetallicRoughness", surface}}});
    arrays.put(gltf);
    gltf["buffers"] = Json::array({{{"byteLength", layout.bytes}}});
    return gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void put_padding(BlockWriter& out, const Part& part) {
    out.put_bytes(std::string_view("\0\0\0", padded(part.bytes) - part.bytes));
}

void put_offsets(BlockWriter& out, const SurfaceMesh& mesh, const glm::dvec3& origin) {
    for (const glm::dvec3& v : mesh.vertices) out.put(offset_of(v, origin));
}

void put_indices(BlockWriter& out, const SurfaceMesh& mesh, bool short_indices) {
    if (!short_indices) return out.put_bytes(bytes_of(mesh.triangles));
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t i : t) out.put(static_cast<std::uint16_t>(i));
}

void put_looks(BlockWriter& out, const MeshLooks& looks, const Layout& layout) {
    for (const glm::vec3& n : looks.normals) out.put(glm::vec3(n.x, n.z, 0 - n.y));
    out.put_bytes(bytes_of(looks.uv));
    out.put_bytes(bytes_of(looks.colors));
    out.put_bytes(looks.picture);
    put_padding(out, layout.picture);
}

}  // namespace

void write_glb(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference,
               const std::optional<MeshRounding>& rounding, const MeshLooks& looks) {
    Layout layout = layout_of(mesh);
    layout.place(looks);
    std::string json = json_of(layout, reference, rounding, looks);
    json.resize(padded(json.size()), ' ');
    const std::size_t binary = padded(layout.bytes), size = 12 + 8 + json.size() + 8 + binary;
    if (size > std::numeric_limits<std::uint32_t>::max()) refuse_size(".glb", "files below 4 GiB; .ply holds more");
    const auto word = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    constexpr std::uint32_t magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
    BlockWriter out(sink);
    for (const std::uint32_t w : {magic, 2u, word(size), word(json.size()), json_chunk}) out.put(w);
    out.put_bytes(json);
    for (const std::uint32_t w : {word(binary), binary_chunk}) out.put(w);
    put_offsets(out, mesh, layout.root);
    put_indices(out, mesh, layout.short_indices);
    put_padding(out, layout.corners);
    put_looks(out, looks, layout);
    out.flush();
}

}  // namespace planet
