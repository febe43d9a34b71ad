#include "planet/mesh/mesh_sides.h"

#include <algorithm>
#include <vector>

#include "planet/mesh/surface_mesh.h"

namespace planet {

SideCounts count_sides(std::span<const TriangleIndices> triangles) {
    // Each side as (low vertex, high vertex, direction): sorted, a sound inner side is the pair direction 0, direction 1.
    std::vector<std::uint64_t> directed;
    directed.reserve(triangles.size() * 3);
    for (const auto& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint64_t a = t[i], b = t[(i + 1) % 3];
            directed.push_back(a < b ? a << 32 | b << 1 : b << 32 | a << 1 | 1);
        }
    std::sort(directed.begin(), directed.end());
    SideCounts counts;
    for (std::size_t i = 0; i < directed.size();) {
        std::size_t j = i;
        while (j < directed.size() && directed[j] >> 1 == directed[i] >> 1) ++j;
        ++counts.sides;
        if (j - i == 1)
            ++counts.border;
        else if (j - i != 2 || directed[i] == directed[i + 1])
            ++counts.wrong;
        i = j;
    }
    return counts;
}

bool strips_match(std::span<const std::uint32_t> strips, std::span<const TriangleIndices> triangles) {
    const auto from_least = [](TriangleIndices t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    std::size_t next = 0, start = 0;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        if (strips[i] == strip_restart) start = i + 1;
        if (i < start + 2) continue;
        TriangleIndices t{strips[i - 2], strips[i - 1], strips[i]};
        if (is_degenerate(t)) continue;
        if ((i - start) % 2 == 1) std::swap(t[0], t[1]);
        if (next == triangles.size() || from_least(t) != from_least(triangles[next])) return false;
        ++next;
    }
    return next == triangles.size();
}

}  // namespace planet
