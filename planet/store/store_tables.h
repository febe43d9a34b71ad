#pragma once
// The tables of a store: metadata, sources, tiles.

#include <cstdint>
#include <memory>
#include <span>

#include "planet/store/elevation_store.h"
#include "planet/store/sqlite_file.h"
#include "planet/store/tile_codec.h"

namespace planet {

inline constexpr std::uint32_t store_application_id = 0x4f637461;  ///< "Octa", in the SQLite header
inline constexpr double least_quantum_m = 1.0 / 256, most_quantum_m = 64;

/// Throws Error(bad_data) if an entry is missing, out of range, or the checksum over all of them does not match.
StoreMetadata read_metadata(SqliteFile& file);

/// What decoding a tile needs of the metadata.
TileScale tile_scale(const StoreMetadata& metadata);

/// Fills a new file. In transactions, so that a killed writer leaves a store that opens, marked as not complete.
class StoreWriter {
  public:
    StoreWriter(SqliteFile& file, StoreMetadata metadata);
    void write(LocationCode root, std::span<const std::uint8_t> bytes);
    /// Ends the last transaction and marks the store complete.
    void finish();

  private:
    static constexpr std::uint64_t tiles_in_a_transaction = 4096;
    SqliteFile& file_;
    StoreMetadata metadata_;
    std::unique_ptr<SqliteStatement> insert_;
    std::uint64_t written_ = 0;
};

}  // namespace planet
