#pragma once
// Baking: an elevation field becomes a store.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/geodesy/ellipsoid.h"
#include "planet/store/elevation_store.h"

namespace planet {

struct BakeOptions {
    Ellipsoid ellipsoid = wgs84;

    /// The field's datum above the ellipsoid at unit geodetic normals, e.g. Geoid::undulations; empty: 0 everywhere.
    /// Not asked for a field above the ellipsoid. The store keeps what it answers, so readers need no geoid.
    std::function<void(std::span<const glm::dvec3>, std::span<GeoidUndulation>)> undulation;
    std::string undulation_name = "unnamed";  ///< recorded, e.g. Geoid::description()

    int least_level = 12;   ///< bisection level; cells are at least this fine everywhere, 1..60
    int finest_level = 60;  ///< and nowhere finer than this, least_level..60
    int extra_levels = 0;   ///< finer than one vertex a sample by this much; may be negative
    /// TileLayers::first: the faces' tiles have this many levels if there are tiles below them, 1..12. 0: what makes the
    /// cheapest store.
    int first_tile_level = 0;
    double quantum_m = 0;  ///< of heights: a power of two, 1/256 .. 64; 0: 0.25, less below 30 m spacing

    /// Of the bake itself: the plan, the tiles that can still change, buffers. Not of the field's own windows. Content
    /// does not depend on it.
    std::size_t memory_bytes = std::size_t{1} << 30;
    int threads = 0;  ///< 0: one for each processor. Content does not depend on it

    /// At most so many tiles are lost when a bake is stopped, but for those that were not final yet. Fewer are written
    /// at once if they are large.
    int transaction_tiles = 4096;

    bool replace = false;  ///< a file that is there goes
    bool resume = false;   ///< a file that is there is an unfinished store of the same sources and options: go on

    /// Called from time to time, on the thread that called bake(), with what is being done and how much of it, 0..1;
    /// of "tiles", which takes nearly all of the time, by vertices. What it throws stops the bake.
    std::function<void(std::string_view step, double fraction)> progress;
};

struct BakeReport {
    std::uint64_t tiles = 0;
    std::uint64_t vertices = 0;
    std::uint64_t vertices_resumed = 0;  ///< of tiles that were in the file already
    TileLayers layers;
    int finest_level = 0;
    double quantum_m = 0;
    double resampling_max_m = 0;     ///< no source sample is farther from the finest surface
    std::uint64_t tile_bytes = 0;    ///< of all tiles as stored
    std::uint64_t memory_bytes = 0;  ///< the most that the bake itself held, by its own account
    /// By step, of all threads together: coverage, resampling (the field's heights, its reading included), deviation,
    /// settling, certifying (what resampling lost), compression, writing.
    std::vector<std::pair<std::string, double>> seconds;
};

/// Bakes a field into a new store. Where the field has no answer the height is 0.
///
/// The file is written as the bake goes on, in transactions. Until it is finished it is a store that opens and verifies,
/// but says that it is not complete. Whatever ends a bake early (an Error, a kill) leaves it so, and `resume` goes on
/// from there: the result has the same tiles and metadata as if nothing had happened. With `resume`, a file that is
/// missing or empty is begun, one that is complete is left alone, and one that was begun with other sources or options
/// is refused. Finishing rewrites the file in order of codes beside itself and renames it, so it needs room for it
/// twice, and the bytes of a finished file depend on its content only.
///
/// Options and the undulation function are used by all threads at once.
/// Throws Error(bad_usage) for an option out of range, a file that is there (without `replace` or `resume`), a file that
/// was begun otherwise, or too little memory; Error(bad_data) for a height that is beyond 2^23 quanta or a file that
/// cannot be written or is no store.
BakeReport bake(const ElevationField& field, const BakeOptions& options, const std::filesystem::path& path);

/// The same into memory.
ElevationStore bake_in_memory(const ElevationField& field, const BakeOptions& options, BakeReport* report = nullptr);

}  // namespace planet
