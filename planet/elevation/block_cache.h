#pragma once
// Blocks of samples in a given amount of memory, shared by all rasters that are read in blocks.

#include <vector>

#include "planet/elevation/memory_cache.h"
#include "planet/elevation/raster_io.h"

namespace planet {

struct SampleBlock {
    SampleWindow window;
    std::vector<std::int16_t> shorts;  ///< one of both is empty
    std::vector<float> floats;

    std::size_t bytes() const { return sizeof *this + 2 * shorts.size() + 4 * floats.size(); }
};

using BlockCache = MemoryCache<SampleBlock>;

}  // namespace planet
