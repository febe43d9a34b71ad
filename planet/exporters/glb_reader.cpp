// glTF 2.0, binary: Khronos, "glTF 2.0 Specification" (2021). Section numbers are its.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/polygon_fan.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

using namespace nlohmann::literals;
using Json = nlohmann::json;
using Bytes = std::span<const std::uint8_t>;

template <class T>
T number_at(Bytes bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

// A count or an index. Not left to the JSON library, which casts 1e300 and -1.
std::size_t whole(const Json& object, const char* key) {
    const Json& value = object.at(key);
    if (!value.is_number_unsigned()) throw MalformedBytes(std::string(key) + " is no whole number");
    return value.get<std::size_t>();
}
std::size_t whole(const Json& object, const char* key, std::size_t otherwise) {
    return object.contains(key) ? whole(object, key) : otherwise;
}

// Empty if it is anything else: others have their own extras.
std::string text_at(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

template <class Vector>
Vector vector_at(const Json& object, const char* key, Vector v) {
    if (!object.contains(key)) return v;
    for (int i = 0; i < Vector::length(); ++i) v[i] = object.at(key).at(static_cast<std::size_t>(i)).get<double>();
    return v;
}

// 3.5.2: a matrix, column by column, or translation * rotation (x, y, z, w) * scale.
glm::dmat4 parent_from_node(const Json& node) {
    glm::dmat4 m(1);
    if (node.contains("matrix")) {
        for (std::size_t i = 0; i < 16; ++i)
            m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node["matrix"].at(i).get<double>();
        return m;
    }
    const auto r = vector_at(node, "rotation", glm::dvec4(0, 0, 0, 1));
    const auto scale = vector_at(node, "scale", glm::dvec3(1));
    const glm::dmat3 rotation = glm::mat3_cast(glm::dquat(r.w, r.x, r.y, r.z));
    for (int axis = 0; axis < 3; ++axis) m[axis] = glm::dvec4(rotation[axis] * scale[axis], 0);
    m[3] = glm::dvec4(vector_at(node, "translation", glm::dvec3(0)), 1);
    return m;
}

struct Chunks {
    Bytes json, binary;
};

// 4.4: a header of 12 bytes, then chunks: length, type, bytes.
Chunks chunks_of(Bytes file) {
    ByteReader in(file);
    const Bytes header = in.raw(12);
    if (number_at<std::uint32_t>(header, 0) != 0x46546c67) throw MalformedBytes("is not a binary glTF file");
    if (number_at<std::uint32_t>(header, 4) != 2) throw MalformedBytes("is not of version 2 of glTF");
    if (number_at<std::uint32_t>(header, 8) > file.size()) throw MalformedBytes("it ends early");
    Chunks chunks;
    while (in.left().size() >= 8) {
        const Bytes head = in.raw(8);
        const Bytes bytes = in.raw(number_at<std::uint32_t>(head, 0));
        const auto type = number_at<std::uint32_t>(head, 4);
        if (type == 0x4e4f534a && chunks.json.empty()) chunks.json = bytes;
        if (type == 0x004e4942 && chunks.binary.empty()) chunks.binary = bytes;
    }
    return chunks;
}

// Elements of one size, some stride apart, all of them within the file.
struct Accessor {
    Bytes bytes;
    std::size_t count = 0, stride = 0, component_type = 0;
};

constexpr std::size_t type_byte = 5121, type_short = 5123, type_int = 5125, type_float = 5126;

std::size_t component_bytes(std::size_t type) {
    return type == type_byte ? 1 : type == type_short ? 2 : 4;
}

// Of a primitive's triangles, one after the other.
struct Corners {
    std::optional<Accessor> indices;  ///< none: the vertices in their order
    std::size_t count, vertices, base;

    std::uint32_t operator[](std::size_t i) const {
        const std::size_t vertex = indices ? index(i) : i;
        if (vertex >= vertices) throw MalformedBytes("a triangle has no vertex");
        return static_cast<std::uint32_t>(base + vertex);
    }

  private:
    std::size_t index(std::size_t i) const {
        const std::size_t at = i * indices->stride;
        switch (indices->component_type) {
            case type_byte:
                return indices->bytes[at];
            case type_short:
                return number_at<std::uint16_t>(indices->bytes, at);
            case type_int:
                return number_at<std::uint32_t>(indices->bytes, at);
            default:
                throw MalformedBytes("has indices that are not whole numbers");
        }
    }
};

class GlbScene {
  public:
    GlbScene(const Chunks& chunks, std::size_t file_bytes)
        : json_(Json::parse(chunks.json.begin(), chunks.json.end())), binary_(chunks.binary), file_bytes_(file_bytes) {
        if (!json_.contains("extensionsRequired")) return;
        for (const Json& extension : json_["extensionsRequired"]) {
            const auto name = extension.get<std::string>();
            if (!name.starts_with("KHR_materials_") && !name.starts_with("KHR_texture_"))
                throw MalformedBytes("needs the extension " + shown_word(name));
        }
    }

    ReadMesh read() {
        walk();
        apply_factors();
        for (glm::dvec3& v : read_.mesh.vertices) v = {v.x, 0 - v.z, v.y};
        for (glm::vec3& n : read_.looks.normals) n = {n.x, 0 - n.z, n.y};
        read_reference();
        return std::move(read_);
    }

  private:
    // 3.5.1: nodes are trees, so that no node is met twice.
    void walk() {
        struct Visit {
            std::size_t node;
            glm::dmat4 scene_from_parent;
        };
        std::vector<Visit> left;  // the next one last
        const auto add_visits = [&](const std::vector<std::size_t>& children, const glm::dmat4& scene_from_parent) {
            for (auto child = children.rbegin(); child != children.rend(); ++child)
                left.push_back({*child, scene_from_parent});
        };
        add_visits(roots(), glm::dmat4(1));
        const Json& nodes = json_.at("nodes");
        std::vector<bool> met(nodes.size());
        while (!left.empty()) {
            const Visit visit = left.back();
            left.pop_back();
            const Json& node = nodes.at(visit.node);
            if (met[visit.node]) throw MalformedBytes("its nodes are no trees");
            met[visit.node] = true;
            const glm::dmat4 scene_from_node = visit.scene_from_parent * parent_from_node(node);
            if (node.contains("mesh"))
                for (const Json& primitive : json_.at("meshes").at(whole(node, "mesh")).at("primitives"))
                    add(primitive, scene_from_node);
            if (node.contains("children")) add_visits(wholes(node["children"]), scene_from_node);
        }
    }

    static std::vector<std::size_t> wholes(const Json& list) {
        std::vector<std::size_t> values;
        for (const Json& value : list) {
            if (!value.is_number_unsigned()) throw MalformedBytes("the number of a node is no whole number");
            values.push_back(value.get<std::size_t>());
        }
        return values;
    }

    // The nodes of the scene to be shown; without one, node 0.
    std::vector<std::size_t> roots() const {
        if (!json_.contains("scenes")) return {0};
        return wholes(json_["scenes"].at(whole(json_, "scene", 0)).at("nodes"));
    }

    Accessor accessor(std::size_t index, std::string_view type, std::size_t components) const {
        const Json& a = json_.at("accessors").at(index);
        if (a.contains("sparse") || !a.contains("bufferView")) throw MalformedBytes("has a sparse accessor");
        if (a.at("type").get<std::string>() != type) throw MalformedBytes("an accessor is not of " + std::string(type));
        const Json& view = json_.at("bufferViews").at(whole(a, "bufferView"));
        if (whole(view, "buffer") != 0 || json_.at("buffers").at(0).contains("uri"))
            throw MalformedBytes("has its arrays in another file");
        Accessor found;
        found.component_type = whole(a, "componentType");
        const std::size_t element = components * component_bytes(found.component_type);
        const std::size_t view_offset = whole(view, "byteOffset", 0), length = whole(view, "byteLength");
        const std::size_t offset = whole(a, "byteOffset", 0);
        found.count = whole(a, "count");
        found.stride = whole(view, "byteStride", element);
        if (view_offset > binary_.size() || length > binary_.size() - view_offset || offset > length ||
            found.stride < element || (found.count > 0 && length - offset < element) ||
            (found.count > 1 && (length - offset - element) / found.stride < found.count - 1))
            throw MalformedBytes("an array reaches beyond its end");
        found.bytes = binary_.subspan(view_offset + offset, length - offset);
        return found;
    }

    void add(const Json& primitive, const glm::dmat4& scene_from_node) {
        const std::size_t mode = whole(primitive, "mode", 4);
        count_corners(1);
        if (mode < 4 || mode > 6) return;  // points and lines
        const std::size_t base = read_.mesh.vertices.size();
        const std::size_t vertices =
            add_vertices(accessor(whole(primitive.at("attributes"), "POSITION"), "VEC3", 3), scene_from_node);
        add_looks(primitive, vertices, scene_from_node);
        const bool mirrored = glm::determinant(glm::dmat3(scene_from_node)) < 0;
        add_triangles(corners_of(primitive, vertices, base), mode, mirrored);
    }

    // Small files of many instances would else take for ever.
    void count_corners(std::size_t count) {
        corners_ += count;
        if (corners_ > 3 * file_bytes_) throw MalformedBytes("repeats its parts too often");
    }

    std::size_t add_vertices(const Accessor& positions, const glm::dmat4& scene_from_node) {
        if (positions.component_type != type_float) throw MalformedBytes("has positions that are not floats");
        auto& vertices = read_.mesh.vertices;
        if (vertices.size() + positions.count > std::min<std::size_t>(file_bytes_, strip_restart))
            throw MalformedBytes("repeats its parts too often");
        if (vertices.empty()) vertices.reserve(positions.count);
        for (std::size_t i = 0; i < positions.count; ++i) {
            const auto p = number_at<std::array<float, 3>>(positions.bytes, i * positions.stride);
            vertices.push_back(scene_from_node * glm::dvec4(p[0], p[1], p[2], 1));
        }
        return positions.count;
    }

    // An attribute that a part of the scene lacks ends up shorter than the vertices, and so as none.
    void add_looks(const Json& primitive, std::size_t vertices, const glm::dmat4& scene_from_node) {
        const Json& attributes = primitive.at("attributes");
        MeshLooks& looks = read_.looks;
        if (attributes.contains("NORMAL")) {
            const glm::dmat3 scene_from_normal = glm::transpose(glm::inverse(glm::dmat3(scene_from_node)));
            const std::size_t first = looks.normals.size();
            append(looks.normals, accessor(whole(attributes, "NORMAL"), "VEC3", 3), vertices, 3);
            for (std::size_t i = first; i < looks.normals.size(); ++i) {
                const glm::dvec3 n = scene_from_normal * glm::dvec3(looks.normals[i]);
                const double length = glm::length(n);
                looks.normals[i] = length > 0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0);
            }
        }
        if (attributes.contains("TEXCOORD_0"))
            append(looks.uv, accessor(whole(attributes, "TEXCOORD_0"), "VEC2", 2), vertices, 2);
        if (attributes.contains("COLOR_0")) {
            const std::size_t index = whole(attributes, "COLOR_0");
            const int numbers = json_.at("accessors").at(index).at("type") == "VEC3" ? 3 : 4;
            const Accessor colors = accessor(index, numbers == 3 ? "VEC3" : "VEC4", static_cast<std::size_t>(numbers));
            append(looks.colors, colors, vertices, numbers);
        }
        factors_.emplace_back(vertices, factor_of(primitive));
        if (looks.picture.empty()) read_picture(primitive);
    }

    // 3.9.2: the base colour of its material, which is 1 if it says none.
    glm::vec4 factor_of(const Json& primitive) const {
        glm::vec4 color(1);
        if (!primitive.contains("material")) return color;
        const Json factor = json_.at("materials")
                                .at(whole(primitive, "material"))
                                .value("/pbrMetallicRoughness/baseColorFactor"_json_pointer, Json());
        if (factor.is_array() && factor.size() == 4)
            for (int k = 0; k < 4; ++k) color[k] = factor[static_cast<std::size_t>(k)].get<float>();
        return color;
    }

    void apply_factors() {
        MeshLooks& looks = read_.looks;
        if (factors_.empty()) return;
        const auto same = [&](const auto& part) { return part.second == factors_.front().second; };
        if (std::ranges::all_of(factors_, same)) {
            looks.base_color = factors_.front().second;
            return;
        }
        if (looks.colors.size() != read_.mesh.vertices.size())
            looks.colors.assign(read_.mesh.vertices.size(), glm::vec4(1));
        auto color = looks.colors.begin();
        for (const auto& [vertices, factor] : factors_)
            for (std::size_t i = 0; i < vertices; ++i) *color++ *= factor;
    }

    // Floats, or shares of the largest whole number. What is not given is 1.
    template <class Vector>
    static void append(std::vector<Vector>& out, const Accessor& a, std::size_t vertices, int numbers) {
        if (a.count != vertices) throw MalformedBytes("an attribute has not one element a vertex");
        if (a.component_type != type_float && a.component_type != type_byte && a.component_type != type_short)
            throw MalformedBytes("an attribute has numbers of an unknown type");
        if (out.empty()) out.reserve(vertices);
        for (std::size_t i = 0; i < vertices; ++i) {
            Vector v(1);
            for (int k = 0; k < numbers; ++k) {
                const std::size_t at = i * a.stride + static_cast<std::size_t>(k) * component_bytes(a.component_type);
                v[k] = a.component_type == type_float ? number_at<float>(a.bytes, at)
                       : a.component_type == type_byte
                           ? static_cast<float>(a.bytes[at]) / 255
                           : static_cast<float>(number_at<std::uint16_t>(a.bytes, at)) / 65535;
            }
            out.push_back(v);
        }
    }

    // The picture of its material, if it is in the file.
    void read_picture(const Json& primitive) {
        if (!primitive.contains("material")) return;
        const Json& material = json_.at("materials").at(whole(primitive, "material"));
        const Json pointer = material.value("/pbrMetallicRoughness/baseColorTexture"_json_pointer, Json());
        if (!pointer.is_object()) return;
        const Json& texture = json_.at("textures").at(whole(pointer, "index"));
        if (!texture.contains("source")) return;
        const Json& image = json_.at("images").at(whole(texture, "source"));
        if (!image.contains("bufferView")) return;
        const Json& view = json_.at("bufferViews").at(whole(image, "bufferView"));
        const std::size_t offset = whole(view, "byteOffset", 0), length = whole(view, "byteLength");
        if (offset > binary_.size() || length > binary_.size() - offset)
            throw MalformedBytes("a picture reaches beyond its end");
        read_.looks.picture.assign(reinterpret_cast<const char*>(binary_.data()) + offset, length);
    }

    Corners corners_of(const Json& primitive, std::size_t vertices, std::size_t base) {
        Corners corners{{}, vertices, vertices, base};
        if (primitive.contains("indices")) {
            corners.indices = accessor(whole(primitive, "indices"), "SCALAR", 1);
            corners.count = corners.indices->count;
        }
        count_corners(corners.count);
        return corners;
    }

    // 3.7.2.1. A strip's triangle with two equal corners only turns it.
    void add_triangles(const Corners& corners, std::size_t mode, bool mirrored) {
        auto& triangles = read_.mesh.triangles;
        const std::size_t before = triangles.size();
        if (mode == 4) {
            if (before == 0) triangles.reserve(corners.count / 3);
            for (std::size_t i = 0; i + 2 < corners.count; i += 3)
                triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
        } else if (mode == 5) {
            for (std::size_t i = 0; i + 2 < corners.count; ++i) {
                const std::uint32_t a = corners[i], b = corners[i + 1 + i % 2], c = corners[i + 2 - i % 2];
                if (a != b && b != c && c != a) triangles.push_back({a, b, c});
            }
        } else {
            PolygonFan fan(triangles);
            for (std::size_t i = 0; i < corners.count; ++i) fan.add(corners[i]);
        }
        if (!mirrored) return;
        for (std::size_t i = before; i < triangles.size(); ++i) std::swap(triangles[i][1], triangles[i][2]);
    }

    void read_reference() {
        const Json extras = json_.at("asset").value("extras", Json::object());
        if (!extras.is_object()) return;
        MeshReference& reference = read_.reference;
        set_frame(reference, text_at(extras, "frame"));
        reference.crs = text_at(extras, "crs");
        reference.vertical_datum = text_at(extras, "vertical_datum");
        if (reference.frame != MeshFrame::enu) return;
        reference.origin = vector_at(extras.value("origin", Json::object()), "ecef", glm::dvec3(0));
        if (!extras.contains("ecef_from_enu")) return;
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < 3; ++i)
                reference.ecef_from_enu[axis][i] = extras["ecef_from_enu"]
                                                       .at(static_cast<std::size_t>(axis))
                                                       .at(static_cast<std::size_t>(i))
                                                       .get<double>();
    }

    const Json json_;
    const Bytes binary_;
    const std::size_t file_bytes_;
    std::size_t corners_ = 0;  ///< met so far, and one for each primitive
    ReadMesh read_;
    std::vector<std::pair<std::size_t, glm::vec4>> factors_;  ///< of so many vertices each, in order
};

}  // namespace

ReadMesh read_glb(std::span<const std::uint8_t> file) {
    try {
        return GlbScene(chunks_of(file), file.size()).read();
    } catch (const Json::parse_error& e) {
        throw MalformedBytes("its JSON is damaged at its byte " + std::to_string(e.byte));
    } catch (const Json::exception& e) {
        throw MalformedBytes(std::string("its JSON is not that of a mesh: ") + e.what());
    }
}

}  // namespace planet
