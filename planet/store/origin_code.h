#pragma once
// The origins of a tile's heights as bytes: one number where all are alike, else how many vertices in a row are as their
// place lets expect, and what the next one is.
//
// A vertex is expected to be as the ends of the side it splits, the lesser one if they differ. README.md has the format.

#include <cstdint>

#include "planet/elevation/height_origin.h"
#include "planet/store/byte_stream.h"

namespace planet {

/// @param origins  known; of the vertices of a tile
void write_origins(ByteWriter& out, const OriginPlane& origins);

/// @param several   whether they have more than one kind
/// @param vertices  of the tile
/// @param files     that the store knows; throws MalformedBytes where there are others
OriginPlane read_origins(ByteReader& in, bool several, std::size_t vertices, std::uint32_t files);

}  // namespace planet
