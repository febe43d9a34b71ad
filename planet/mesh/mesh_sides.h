#pragma once
// What the sides and the strips of any triangle list tell of it: shared by the checks.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace planet {

using TriangleIndices = std::array<std::uint32_t, 3>;

struct SideCounts {
    std::size_t sides = 0;
    std::size_t border = 0;  ///< sides of one triangle only
    std::size_t wrong = 0;   ///< sides of more than two, or of two that run the same way: not a surface
};

/// O(n log n).
SideCounts count_sides(std::span<const TriangleIndices> triangles);

/// Whether the strips (surface_mesh.h) draw exactly the triangles, same winding, same order.
bool strips_match(std::span<const std::uint32_t> strips, std::span<const TriangleIndices> triangles);

inline bool is_degenerate(const TriangleIndices& t) {
    return t[0] == t[1] || t[1] == t[2] || t[0] == t[2];
}

}  // namespace planet
