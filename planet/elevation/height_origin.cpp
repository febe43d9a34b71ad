#include "planet/elevation/height_origin.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace planet {

OriginPlane::OriginPlane(std::span<const WeighedOrigin> origins) {
    if (origins.empty()) return;
    kinds_.push_back(origins[0].origin);
    const auto differs = [this](const WeighedOrigin& o) { return o.origin != kinds_[0]; };
    if (std::find_if(origins.begin(), origins.end(), differs) == origins.end()) return;
    kind_.reserve(origins.size());
    std::size_t kind = 0;
    for (const WeighedOrigin& o : origins) {
        if (kinds_[kind] != o.origin) {
            kind = static_cast<std::size_t>(std::find(kinds_.begin(), kinds_.end(), o.origin) - kinds_.begin());
            if (kind == kinds_.size()) kinds_.push_back(o.origin);
        }
        assert(kind <= std::numeric_limits<std::uint16_t>::max());
        kind_.push_back(static_cast<std::uint16_t>(kind));
    }
}

}  // namespace planet
