#pragma once
// Which sides of triangles are closed by the bits of their ends alone.

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "tests/render/app/segment_triangles.h"

namespace render::testing {

using DecodedVertex = std::array<std::uint32_t, 7>;  ///< a CapturedVertex as bits

struct BitHash {
    std::size_t operator()(const DecodedVertex& v) const {
        std::uint64_t h = 0;
        for (const std::uint32_t word : v) h = (h ^ word) * 0x9e3779b97f4a7c15u ^ h >> 29;
        return h;
    }
};

struct Seams {
    std::size_t open = 0;      ///< directed sides without their reverse
    std::size_t border = 0;    ///< sides between two segments, closed
    std::size_t vertices = 0;  ///< different ones on those
};

/// @param decoded by vertex of Segments::vertices()
inline Seams seams_of(const std::vector<SegmentTriangle>& triangles, const std::vector<DecodedVertex>& decoded) {
    struct Side {
        std::uint64_t ends;  // numbers of the bits, from and to
        std::uint32_t segment;
    };
    std::unordered_map<DecodedVertex, std::uint32_t, BitHash> numbers;
    std::vector<Side> sides, reversed;
    for (const SegmentTriangle& t : triangles) {
        std::uint64_t n[3];
        for (std::size_t k = 0; k < 3; ++k)
            n[k] = numbers.try_emplace(decoded[t.vertex[k]], static_cast<std::uint32_t>(numbers.size())).first->second;
        // Far away vertices can fall together; a triangle of two such vertices has no area, and its sides cancel.
        for (std::size_t k = 0; k < 3; ++k) {
            sides.push_back({n[k] << 32 | n[(k + 1) % 3], t.segment});
            reversed.push_back({n[(k + 1) % 3] << 32 | n[k], t.segment});
        }
    }
    const auto less = [](const Side& a, const Side& b) {
        return std::pair(a.ends, a.segment) < std::pair(b.ends, b.segment);
    };
    std::sort(sides.begin(), sides.end(), less);
    std::sort(reversed.begin(), reversed.end(), less);
    Seams seams;
    std::vector<std::uint64_t> at_border;
    auto other = reversed.begin();
    for (const Side& side : sides) {
        while (other != reversed.end() && other->ends < side.ends) ++other, ++seams.open;
        if (other == reversed.end() || other->ends != side.ends) {
            ++seams.open;
            continue;
        }
        if (other->segment != side.segment) {
            ++seams.border;
            at_border.push_back(side.ends >> 32);
        }
        ++other;
    }
    seams.open += static_cast<std::size_t>(reversed.end() - other);
    seams.border /= 2;
    std::sort(at_border.begin(), at_border.end());
    seams.vertices = static_cast<std::size_t>(std::unique(at_border.begin(), at_border.end()) - at_border.begin());
    return seams;
}

}  // namespace render::testing
