#pragma once
// What a store holds, without decoding most of it.

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "planet/store/elevation_store.h"

namespace render {

/// Tiles that begin at one bisection level.
struct StoreLevel {
    int level = 0;  ///< of the tiles' roots
    std::uint64_t tiles = 0;
    std::optional<std::uint64_t> vertices{};  ///< nothing if the store does not say: version 2, or not complete
};

/// A region that has tiles of its own at a level that does not cover the planet. Degrees; west > east across the
/// antimeridian. The margin of tiles that lets its border be refined is part of it.
struct StoreArea {
    int level = 0;
    std::uint64_t tiles = 0;
    double south = 0, west = 0, north = 0, east = 0;
};

struct StoreSummary {
    std::uint64_t tiles = 0;         ///< that are there
    double done = 1;                 ///< 0..1 of the tiles that are planned
    std::vector<StoreLevel> levels;  ///< coarse to fine
    std::vector<StoreArea> areas;    ///< fine to coarse, then by size
    /// Heights; least > most while no face has been written.
    double least_m = std::numeric_limits<double>::infinity(), most_m = -least_m;
};

/// Throws planet::Error(bad_data) for what is damaged among the tables and the tiles it reads.
StoreSummary summarize(const planet::ElevationStore& store);

/// The mean distance of vertices of a bisection level, metres.
double spacing_of_level(const planet::Ellipsoid& ellipsoid, int bisection_level);

}  // namespace render
