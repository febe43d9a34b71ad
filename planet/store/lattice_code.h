#pragma once
// Whole numbers at the vertices of a tile as bytes: what each differs from its prediction, Rice coded level by level.
//
//         a - - - c        interior vertices split a diamond: predicted is (a + b + c + d + 2) >> 2, its four corners
//         |  \    |
//         |    v  |        on the tile's sides only the ends of the split side are the same from both tiles' point of
//         |      \|        view, and the other apex is not there: (a + b + 1) >> 1
//         d - - - b
//
// On mountains at 90 m, quanta of 0.25 m, the two ends alone take 5 % more.

#include <cstdint>
#include <span>

#include "planet/store/byte_stream.h"

namespace planet {

/// Largest |number| that a tile can hold: heights in quanta stay exact in float.
inline constexpr std::int32_t largest_height_quanta = 1 << 23;

/// @param q by vertex index, all vertices of a depth of 1 to 12, each at most largest_height_quanta up or down
void write_lattice(ByteWriter& out, std::span<const std::int32_t> q);

/// Fills q. Throws MalformedBytes if the bytes end early or a number is out of range.
void read_lattice(ByteReader& in, std::span<std::int32_t> q);

}  // namespace planet
