#pragma once
// The tables of a store: metadata, sources, tiles.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "planet/store/elevation_store.h"
#include "planet/store/sqlite_file.h"
#include "planet/store/tile_codec.h"

namespace planet {

inline constexpr std::uint32_t store_application_id = 0x4f637461;  ///< "Octa", in the SQLite header
inline constexpr double least_quantum_m = 1.0 / 256, most_quantum_m = 64;

/// What a bake that is stopped may leave beside its store: the store's name and one of these.
inline constexpr std::array<std::string_view, 5> leftover_endings{"-journal", "-beginning", "-beginning-journal",
                                                                  "-finishing", "-finishing-journal"};
/// The store beside which a bake leaves a file of this name; empty: none does.
std::filesystem::path store_of_leftover(const std::filesystem::path& path);

/// Throws Error(bad_data) if an entry is missing, out of range, or the checksum over all of them does not match.
StoreMetadata read_metadata(SqliteFile& file);

/// What decoding a tile needs of the metadata.
TileScale tile_scale(const StoreMetadata& metadata);

/// Refuses, with one line, a file whose header says that it is not a store, of another version, or cut short.
void check_store_file(const std::filesystem::path& path);

/// The tables of a new store, in one transaction. Beside those of a finished store there is `unfinished`, in which a
/// bake keeps what it knows of tiles that are not written yet.
void create_tables(SqliteFile& file, const StoreMetadata& metadata);

/// Replaces metadata and sources; in the caller's transaction.
void write_metadata(SqliteFile& file, const StoreMetadata& metadata);

}  // namespace planet
