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
    double quantum_m = 0;   ///< of heights: a power of two, 1/256 .. 64; 0: 0.25, less below 30 m spacing
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< of the tiles being baked; more is refused

    /// Called from time to time with what is being done and how much of it, 0..1.
    std::function<void(std::string_view step, double fraction)> progress;
};

struct BakeReport {
    std::uint64_t tiles = 0;
    std::uint64_t vertices = 0;
    int finest_level = 0;
    double quantum_m = 0;
    double resampling_max_m = 0;                          ///< no source sample is farther from the finest surface
    std::uint64_t tile_bytes = 0;                         ///< of all tiles as stored
    std::uint64_t planned_bytes = 0;                      ///< upper bound of the memory of the tiles
    std::vector<std::pair<std::string, double>> seconds;  ///< by step
};

/// Bakes a field into a new store; a file that is there is replaced. Not atomic: give a temporary name and rename it.
/// A file that could not be finished is removed. Where the field has no answer the height is 0.
/// Throws Error(bad_usage) for an option out of range or more memory than allowed, Error(bad_data) for a height that is
/// beyond 2^23 quanta or a file that cannot be written.
BakeReport bake(const ElevationField& field, const BakeOptions& options, const std::filesystem::path& path);

/// The same into memory.
ElevationStore bake_in_memory(const ElevationField& field, const BakeOptions& options, BakeReport* report = nullptr);

}  // namespace planet
