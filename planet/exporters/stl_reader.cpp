// STL, binary and ascii. It repeats each vertex in every triangle: those at the same place are made one.

#include <algorithm>
#include <cmath>
#include <tuple>

#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

constexpr std::size_t header_bytes = 80, facet_bytes = 50;

std::vector<glm::vec3> binary_corners(ByteReader in) {
    std::uint32_t count;
    std::memcpy(&count, in.raw(4).data(), 4);
    if (in.left().size() / facet_bytes < count) throw MalformedBytes("it ends early");
    std::vector<glm::vec3> corners(std::size_t{3} * count);
    for (std::size_t i = 0; i < corners.size(); i += 3) std::memcpy(&corners[i], in.raw(facet_bytes).data() + 12, 36);
    return corners;
}

std::vector<glm::vec3> ascii_corners(std::string_view text) {
    std::vector<glm::vec3> corners;
    for (auto word = take_word(text); !word.empty(); word = take_word(text)) {
        if (word != "vertex") continue;
        glm::vec3 v;
        for (int axis = 0; axis < 3; ++axis) {
            const auto value = number_from<float>(take_word(text));
            if (!value) throw MalformedBytes("a vertex is not three numbers");
            v[axis] = *value;
        }
        corners.push_back(v);
    }
    if (corners.size() % 3 != 0) throw MalformedBytes("a facet has no three vertices");
    return corners;
}

// By corner, the first one at the same place. Sorted, not hashed, so that no file can make it slow.
std::vector<std::uint32_t> first_at_place(const std::vector<glm::vec3>& corners) {
    struct Corner {
        glm::vec3 place;
        std::uint32_t index;
        auto key() const { return std::tie(place.x, place.y, place.z, index); }
    };
    std::vector<Corner> sorted(corners.size());
    for (std::uint32_t i = 0; i < corners.size(); ++i) sorted[i] = {corners[i], i};
    std::sort(sorted.begin(), sorted.end(), [](const Corner& a, const Corner& b) { return a.key() < b.key(); });
    std::vector<std::uint32_t> first(corners.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const bool same = i > 0 && sorted[i].place == sorted[i - 1].place;
        first[sorted[i].index] = same ? first[sorted[i - 1].index] : sorted[i].index;
    }
    return first;
}

// Vertices in the order in which triangles first name them.
SurfaceMesh joined(const std::vector<glm::vec3>& corners) {
    if (corners.size() >= strip_restart) throw MalformedBytes("has too many triangles");
    for (const glm::vec3& v : corners)  // NaN has no place in an order
        if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
            throw MalformedBytes("a coordinate is not finite");
    std::vector<std::uint32_t> first = first_at_place(corners);
    SurfaceMesh mesh;
    mesh.triangles.resize(corners.size() / 3);
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        if (first[i] == i) {
            first[i] = static_cast<std::uint32_t>(mesh.vertices.size());  // from here on the vertex, not the corner
            mesh.vertices.emplace_back(corners[i]);
        } else {
            first[i] = first[first[i]];
        }
        mesh.triangles[i / 3][i % 3] = first[i];
    }
    return mesh;
}

}  // namespace

ReadMesh read_stl(std::span<const std::uint8_t> file) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    ByteReader in(file);
    const std::string_view header(text.substr(0, header_bytes));
    const bool ours = header.starts_with("Octaglobe");
    ReadMesh read;
    if (ours) read.reference.frame = MeshFrame::enu;
    // Some binary files begin with "solid" too: they are known by their size.
    std::uint32_t count = 0;
    if (file.size() >= header_bytes + 4) std::memcpy(&count, file.data() + header_bytes, 4);
    const bool is_binary = file.size() == header_bytes + 4 + facet_bytes * std::size_t{count};
    if (text.starts_with("solid") && !is_binary) {
        read.mesh = joined(ascii_corners(text));
    } else {
        in.raw(header_bytes);
        read.mesh = joined(binary_corners(in));
    }
    return read;
}

}  // namespace planet
