// Wavefront OBJ: "v x y z", "f a b c ..." with a as 7, 7/1, 7//2 or -1 (the latest vertex).

#include <limits>

#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/polygon_fan.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

glm::dvec3 vertex_from(std::string_view words) {
    glm::dvec3 v;
    for (int axis = 0; axis < 3; ++axis) {
        const auto value = number_from<double>(take_word(words));
        if (!value) throw MalformedBytes("a vertex is not three numbers");
        v[axis] = *value;
    }
    return v;
}

std::uint32_t corner_from(std::string_view word, std::size_t vertices) {
    const auto number = number_from<std::int64_t>(word.substr(0, word.find('/')));
    const auto count = static_cast<std::int64_t>(vertices);
    // A face may stand before its vertices, so that only the final count is an upper limit.
    if (!number || *number == 0 || *number < -count || *number > std::numeric_limits<std::uint32_t>::max())
        throw MalformedBytes("a face has no vertex " + shown_word(word));
    return static_cast<std::uint32_t>(*number > 0 ? *number - 1 : count + *number);
}

}  // namespace

ReadMesh read_obj(std::span<const std::uint8_t> file) {
    ReadMesh read;
    std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    while (!text.empty()) {
        std::string_view line = take_line(text);
        const std::string_view key = take_word(line);
        if (key == "#") read_reference_line(line, read.reference);
        if (key == "v") read.mesh.vertices.push_back(vertex_from(line));
        if (key != "f") continue;
        PolygonFan fan(read.mesh.triangles);
        for (auto word = take_word(line); !word.empty(); word = take_word(line))
            fan.add(corner_from(word, read.mesh.vertices.size()));
    }
    return read;
}

}  // namespace planet
