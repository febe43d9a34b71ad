#pragma once
// The file that a bake writes: begun, gone on with, finished.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "planet/store/sqlite_file.h"
#include "planet/store/store_tables.h"

namespace planet {

/// The bytes of a tile, or of what is known of one that is not written yet.
struct TileRow {
    LocationCode root;
    std::vector<std::uint8_t> bytes;
};

/// Safe to use from several threads.
class BakeFile {
  public:
    /// A new store.
    BakeFile(SqliteFile&& file, const StoreMetadata& metadata);
    /// A new store in place of what is there. Its tables are made under another name, so that the file is never without.
    static std::unique_ptr<BakeFile> begin(const std::filesystem::path& path, const StoreMetadata& metadata);
    /// An unfinished store, or a new one where there is no file or an empty one. Throws Error(bad_usage) if it was begun
    /// with other sources or options than `metadata` says.
    static std::unique_ptr<BakeFile> resume(const std::filesystem::path& path, const StoreMetadata& metadata);

    /// The metadata of the finished store of the same sources and options that is there, if one is. Throws as resume().
    static std::optional<StoreMetadata> finished(const std::filesystem::path& path, const StoreMetadata& metadata);

    /// The tiles that are written.
    std::vector<LocationCode> tiles() const;
    std::optional<std::vector<std::uint8_t>> tile(LocationCode root) const;
    std::optional<std::vector<std::uint8_t>> unfinished(LocationCode root) const;
    std::uint64_t tile_bytes() const;

    /// One transaction. Rows of `unfinished` replace those that are there.
    /// @param resampling_max_m of the tiles written so far
    void write(std::span<const TileRow> tiles, std::span<const TileRow> unfinished, double resampling_max_m);

    /// As it is in the file.
    const StoreMetadata& metadata() const { return metadata_; }

    /// Marks the store as complete and makes its bytes those that its content determines. Ends the use of this object.
    /// @returns the connection, if the store is in memory
    std::optional<SqliteFile> finish();

  private:
    explicit BakeFile(SqliteFile&& file) : file_(std::move(file)) {}
    std::optional<std::vector<std::uint8_t>> row(const char* sql, LocationCode root) const;
    void rewrite();

    mutable SqliteFile file_;
    StoreMetadata metadata_;
    std::filesystem::path path_;  // empty: in memory
    mutable std::mutex mutex_;
};

}  // namespace planet
