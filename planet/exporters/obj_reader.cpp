// Wavefront OBJ: "v x y z", "f a b c ..." with a as 7, 7/1, 7//2 or -1 (the latest vertex).

#include <limits>

#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/polygon_fan.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

glm::dvec3 place_from(std::string_view& words) {
    glm::dvec3 v;
    for (int axis = 0; axis < 3; ++axis) {
        const auto value = number_from<double>(take_word(words));
        if (!value) throw MalformedBytes("a vertex is not three numbers");
        v[axis] = *value;
    }
    return v;
}

/// What is missing is 0, as the second of a texture coordinate may be.
glm::vec3 attribute_from(std::string_view words) {
    glm::vec3 v(0);
    for (int i = 0; i < 3; ++i) v[i] = number_from<float>(take_word(words)).value_or(0);
    return v;
}

/// x y z, or x y z red green blue; a fourth number alone is a weight.
void read_vertex(std::string_view words, ReadMesh& read) {
    read.mesh.vertices.push_back(place_from(words));
    glm::vec4 color(0, 0, 0, 1);
    for (int i = 0; i < 3; ++i) {
        const auto value = number_from<float>(take_word(words));
        if (!value) return;
        color[i] = *value;
    }
    read.looks.colors.push_back(color);
}

std::uint32_t corner_from(std::string_view word, std::size_t vertices) {
    const auto number = number_from<std::int64_t>(word.substr(0, word.find('/')));
    const auto count = static_cast<std::int64_t>(vertices);
    // A face may stand before its vertices, so that only the final count is an upper limit.
    if (!number || *number == 0 || *number < -count || *number > std::numeric_limits<std::uint32_t>::max())
        throw MalformedBytes("a face has no vertex " + shown_word(word));
    return static_cast<std::uint32_t>(*number > 0 ? *number - 1 : count + *number);
}

/// Texture coordinates and normals, numbered apart from vertices: each vertex gets those of its first corner.
class CornerAttributes {
  public:
    void add_uv(std::string_view words) {
        const glm::vec3 uv = attribute_from(words);
        uv_.emplace_back(uv.x, 1 - uv.y);  // from the bottom left
    }
    void add_normal(std::string_view words) { normals_.push_back(attribute_from(words)); }

    /// @param word 7/1/2, 7//2, 7/1 or 7. Faces before their vertices get none.
    void add_corner(std::string_view word, std::uint32_t vertex, std::size_t vertices) {
        const std::size_t first = word.find('/');
        if (first == std::string_view::npos || vertex >= vertices) return;
        const std::string_view rest = word.substr(first + 1);
        const std::size_t second = rest.find('/');
        note(uv_of_, rest.substr(0, second), uv_.size(), vertex, vertices);
        if (second != std::string_view::npos)
            note(normal_of_, rest.substr(second + 1), normals_.size(), vertex, vertices);
    }

    /// Nothing if a vertex has none.
    void put(MeshLooks& looks, std::size_t vertices) const {
        looks.uv = by_vertex(uv_of_, uv_, vertices);
        looks.normals = by_vertex(normal_of_, normals_, vertices);
    }

  private:
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    static void note(std::vector<std::uint32_t>& of, std::string_view word, std::size_t count, std::uint32_t vertex,
                     std::size_t vertices) {
        const auto number = number_from<std::int64_t>(word);
        if (!number || *number == 0) return;
        const std::int64_t index = *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
        if (index < 0 || index >= none) return;
        if (of.size() < vertices) of.resize(vertices, none);
        if (of[vertex] == none) of[vertex] = static_cast<std::uint32_t>(index);
    }

    template <class Vector>
    static std::vector<Vector> by_vertex(const std::vector<std::uint32_t>& of, const std::vector<Vector>& values,
                                         std::size_t vertices) {
        if (of.size() != vertices) return {};
        std::vector<Vector> out;
        for (const std::uint32_t i : of) {
            if (i >= values.size()) return {};
            out.push_back(values[i]);
        }
        return out;
    }

    std::vector<glm::vec2> uv_;
    std::vector<glm::vec3> normals_;
    std::vector<std::uint32_t> uv_of_, normal_of_;  ///< by vertex
};

}  // namespace

ReadMesh read_obj(std::span<const std::uint8_t> file) {
    ReadMesh read;
    CornerAttributes attributes;
    std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    while (!text.empty()) {
        std::string_view line = take_line(text);
        const std::string_view key = take_word(line);
        if (key == "#") read_reference_line(line, read.reference);
        if (key == "v") read_vertex(line, read);
        if (key == "vt") attributes.add_uv(line);
        if (key == "vn") attributes.add_normal(line);
        if (key != "f") continue;
        PolygonFan fan(read.mesh.triangles);
        for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
            const std::uint32_t vertex = corner_from(word, read.mesh.vertices.size());
            fan.add(vertex);
            attributes.add_corner(word, vertex, read.mesh.vertices.size());
        }
    }
    attributes.put(read.looks, read.mesh.vertices.size());
    return read;
}

}  // namespace planet
