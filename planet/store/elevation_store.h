#pragma once
// The elevation store: tiles of heights and certified deviations in one SQLite file. README.md describes the format.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/tile.h"

namespace planet {

class SqliteFile;

inline constexpr int store_format_version = 4;
/// The oldest that can be read: all its tiles begin at multiples of 12. Before version 4 it is not known which source a
/// height came from.
inline constexpr int oldest_store_format_version = 2;

/// The options of a bake that determine what is in its store. See BakeOptions.
struct BakeSettings {
    int least_level = 12, finest_level = 60, extra_levels = 0;
    double quantum_m = 0;
    bool operator==(const BakeSettings&) const = default;
};

/// What a store says of itself.
struct StoreMetadata {
    int format_version = store_format_version;
    Ellipsoid ellipsoid = wgs84;
    VerticalDatum datum = VerticalDatum::egm96;
    std::string undulation;  ///< what the datum's height above the ellipsoid was taken from; empty: 0 everywhere
    double quantum_m = 0.25;
    TileLayers layers;     ///< where tiles begin
    int finest_level = 0;  ///< bisection level of the finest cells
    /// Largest Tile::resampling: no source sample is farther from the finest surface, metres.
    double resampling_max_m = 0;
    std::uint64_t tiles = 0;
    std::uint64_t vertices = 0;  ///< of all tiles, those that tiles share counted in each
    /// The same by the level at which tiles begin. Empty for stores of version 2.
    std::map<int, std::uint64_t> vertices_by_level;
    bool complete = false;  ///< the bake came to its end; before, resampling_max_m is that of the tiles so far
    BakeSettings settings;
    std::vector<SourceInfo> sources;
};

/// What verify() found.
struct StoreCheck {
    std::uint64_t tiles = 0;
    std::uint64_t vertices = 0;
    std::uint64_t side_records = 0;  ///< compared with those of the tile beside
    std::uint64_t problems = 0;
    std::vector<std::string> first_problems;  ///< at most 20, one line each
    bool ok() const { return problems == 0; }
};

/// Reading is safe from several threads. Moved-from stores may only be destroyed or assigned to.
class ElevationStore {
  public:
    /// Opens a store for reading. A store whose writer was killed is rolled back to its last transaction first; any
    /// other is not written to, and must not be written by others meanwhile.
    /// Throws Error(bad_data): missing, empty, not a store or what a bake left beside one, cut short, of a newer version,
    /// damaged.
    static ElevationStore open(const std::filesystem::path& path);
    /// The same, to draw or to query: Error(bad_data) too if the store is of another planet or not complete.
    static ElevationStore open(const std::filesystem::path& path, const Ellipsoid& expected);
    /// Error(bad_data), naming --resume, if the bake did not come to its end.
    void require_complete() const;
    /// Takes over a connection that a bake has filled.
    explicit ElevationStore(SqliteFile&& file);

    ElevationStore(ElevationStore&&) noexcept;
    ElevationStore& operator=(ElevationStore&&) noexcept;
    ~ElevationStore();

    const StoreMetadata& metadata() const;
    /// The path, or "store in memory".
    const std::string& where() const;

    /// The tile below a cell, or nullopt if the store has none there. A tile that is listed by the one above it (or is
    /// a face) but cannot be read is damage: Error(bad_data) naming it. In a store that is not complete, a listed tile
    /// that is missing has not been written yet: nullopt.
    /// @param root of a level at which tiles begin
    std::optional<Tile> read(LocationCode root) const;

    /// Every tile, ascending by code.
    std::vector<LocationCode> tiles() const;

    /// Reads everything: checksums, that listed tiles exist and no others, that deviations and radii are nested, that
    /// tiles hold the same bits on the sides they share and at the corners they inherit, that inner deviations bound
    /// the tile's own vertices.
    /// @param progress told the share that is done, 0..1, from time to time
    StoreCheck verify(const std::function<void(double)>& progress = {}) const;

  private:
    struct Open;
    std::unique_ptr<Open> open_;
};

}  // namespace planet
