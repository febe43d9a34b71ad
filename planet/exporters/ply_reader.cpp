#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/ply_header.h"
#include "planet/exporters/polygon_fan.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

// Scalars one after the other. Every type fits a double.
class AsciiScalars {
  public:
    explicit AsciiScalars(std::string_view body) : left_(body) {}
    double next(PlyType) {
        const std::string_view word = take_word(left_);
        if (word.empty()) throw MalformedBytes("it ends early");
        const auto value = number_from<double>(word);
        if (!value) throw MalformedBytes(shown_word(word) + " is not a number");
        return *value;
    }
    std::size_t left() const { return left_.size(); }

  private:
    std::string_view left_;
};

template <bool swapped>
class BinaryScalars {
  public:
    explicit BinaryScalars(std::string_view body) : left_(body) {}
    double next(PlyType type) {
        switch (type) {
            case PlyType::i8:
                return take<std::int8_t>();
            case PlyType::u8:
                return take<std::uint8_t>();
            case PlyType::i16:
                return take<std::int16_t>();
            case PlyType::u16:
                return take<std::uint16_t>();
            case PlyType::i32:
                return take<std::int32_t>();
            case PlyType::u32:
                return take<std::uint32_t>();
            case PlyType::f32:
                return static_cast<double>(take<float>());
            case PlyType::f64:
                break;
        }
        return take<double>();
    }
    std::size_t left() const { return left_.size(); }

  private:
    template <class T>
    T take() {
        if (left_.size() < sizeof(T)) throw MalformedBytes("it ends early");
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), left_.data(), sizeof(T));
        if (swapped) std::reverse(bytes.begin(), bytes.end());
        left_.remove_prefix(sizeof(T));
        return std::bit_cast<T>(bytes);
    }

    std::string_view left_;
};

std::uint32_t whole(double value) {
    if (!(value >= 0 && value <= std::numeric_limits<std::uint32_t>::max()) || value != std::floor(value))
        throw MalformedBytes("an index or the length of a list is no whole number");
    return static_cast<std::uint32_t>(value);
}

template <class Scalars>
void skip(Scalars& in, const PlyProperty& property) {
    const std::uint32_t count = property.is_list ? whole(in.next(property.count_type)) : 1;
    for (std::uint32_t i = 0; i < count; ++i) in.next(property.type);
}

// A number of a vertex: a coordinate, or part of an attribute.
struct VertexPart {
    enum Kind { other, place, normal, uv, color } kind = other;
    int axis = 0;
    double scale = 1;
};
constexpr int parts_of_kind[] = {0, 3, 3, 2, 3};  // that make it whole; alpha may be missing

VertexPart part_from(const PlyProperty& p) {
    struct Name {
        std::string_view name;
        VertexPart::Kind kind;
        int axis;
    };
    using enum VertexPart::Kind;
    static constexpr Name names[] = {{"x", place, 0},   {"y", place, 1},     {"z", place, 2},      {"nx", normal, 0},
                                     {"ny", normal, 1}, {"nz", normal, 2},   {"s", uv, 0},         {"t", uv, 1},
                                     {"u", uv, 0},      {"v", uv, 1},        {"texture_u", uv, 0}, {"texture_v", uv, 1},
                                     {"red", color, 0}, {"green", color, 1}, {"blue", color, 2},   {"alpha", color, 3}};
    const auto found =
        std::find_if(std::begin(names), std::end(names), [&](const Name& n) { return n.name == p.name; });
    if (p.is_list || found == std::end(names)) return {};
    VertexPart part{found->kind, found->axis, 1};
    if (part.kind == color && p.type == PlyType::u8) part.scale = 1 / 255.0;
    if (part.kind == color && p.type == PlyType::u16) part.scale = 1 / 65535.0;
    return part;
}

template <class Scalars>
void read_vertices(Scalars& in, const PlyElement& element, SurfaceMesh& mesh, MeshLooks& looks) {
    mesh.vertices.reserve(element.count);
    for (const char* axis : {"x", "y", "z"})
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const PlyProperty& p) { return p.name == axis && !p.is_list; }))
            throw MalformedBytes(std::string("its vertices have no ") + axis);
    std::vector<VertexPart> parts;  // by property
    unsigned had[5] = {};           // by kind: which of its parts there are
    for (const PlyProperty& p : element.properties) {
        parts.push_back(part_from(p));
        had[parts.back().kind] |= 1u << parts.back().axis;
    }
    const auto whole_kind = [&](VertexPart::Kind kind) {
        const unsigned all = (1u << parts_of_kind[kind]) - 1;
        return (had[kind] & all) == all;
    };
    const bool normals = whole_kind(VertexPart::normal), uv = whole_kind(VertexPart::uv),
               colors = whole_kind(VertexPart::color);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        glm::dvec4 value[5] = {};
        value[VertexPart::color].a = 1;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (parts[k].kind == VertexPart::other)
                skip(in, element.properties[k]);
            else
                value[parts[k].kind][parts[k].axis] = parts[k].scale * in.next(element.properties[k].type);
        }
        mesh.vertices.emplace_back(value[VertexPart::place]);
        if (normals) looks.normals.emplace_back(value[VertexPart::normal]);
        if (uv) looks.uv.emplace_back(value[VertexPart::uv].x, 1 - value[VertexPart::uv].y);  // from the bottom left
        if (colors) looks.colors.emplace_back(value[VertexPart::color]);
    }
}

bool holds_corners(const PlyProperty& p) {
    return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

template <class Scalars>
void read_faces(Scalars& in, const PlyElement& element, SurfaceMesh& mesh) {
    mesh.triangles.reserve(mesh.triangles.size() + element.count);  // as many as there is room for in the file
    for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty& p : element.properties) {
            if (!holds_corners(p)) {
                skip(in, p);
                continue;
            }
            PolygonFan fan(mesh.triangles);
            const std::uint32_t corners = whole(in.next(p.count_type));
            for (std::uint32_t k = 0; k < corners; ++k) fan.add(whole(in.next(p.type)));
        }
}

template <class Scalars>
void read_body(Scalars in, const PlyHeader& header, ReadMesh& read) {
    for (const PlyElement& element : header.elements) {
        if (element.properties.empty()) continue;
        // Before anything of that size is allocated or counted.
        if (element.count > in.left() / element.least_size(header.encoding == PlyEncoding::ascii))
            throw MalformedBytes("it ends early: there is no room for " + std::to_string(element.count) +
                                 " of its element " + shown_word(element.name));
        if (element.name == "vertex") {
            read_vertices(in, element, read.mesh, read.looks);
        } else if (element.name == "face") {
            read_faces(in, element, read.mesh);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i)
                for (const PlyProperty& p : element.properties) skip(in, p);
        }
    }
}

}  // namespace

ReadMesh read_ply(std::span<const std::uint8_t> file) {
    std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    PlyHeader header = take_ply_header(text);
    ReadMesh read;
    switch (header.encoding) {
        case PlyEncoding::ascii:
            read_body(AsciiScalars(text), header, read);
            break;
        case PlyEncoding::little_endian:
            read_body(BinaryScalars<false>(text), header, read);
            break;
        case PlyEncoding::big_endian:
            read_body(BinaryScalars<true>(text), header, read);
            break;
    }
    read.reference = std::move(header.reference);
    return read;
}

}  // namespace planet
