#pragma once
// Turns a store of version 4 into what version 3 was: nothing in it says which source a height came from.

#include <gtest/gtest.h>
#include <zstd.h>

#include "planet/store/origin_code.h"
#include "planet/store/store_tables.h"

namespace planet::testing {

/// The bytes of a tile without its origins: those come last, and two flags tell of them.
inline std::vector<std::uint8_t> without_origins(const Tile& tile, std::span<const std::uint8_t> frame) {
    std::vector<std::uint8_t> payload(1 << 17);
    payload.resize(ZSTD_decompress(payload.data(), payload.size(), frame.data(), frame.size()));
    ByteWriter origins, root;
    write_origins(origins, tile.origins);
    root.varint(tile.root.bits());
    payload.resize(payload.size() - origins.bytes().size());
    payload[root.bytes().size() + 1] &= 7;  // after the depth
    std::vector<std::uint8_t> bytes(ZSTD_compressBound(payload.size()));
    bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), payload.data(), payload.size(), 1));
    return bytes;
}

inline void make_version_3(const std::filesystem::path& path) {
    std::vector<std::pair<std::int64_t, std::vector<std::uint8_t>>> rows;
    StoreMetadata metadata;
    {
        const ElevationStore store = ElevationStore::open(path);
        metadata = store.metadata();
        SqliteFile file(path, SqliteFile::Access::read);
        SqliteStatement select(file, "SELECT code, data FROM tiles");
        while (select.step()) {
            const LocationCode root(static_cast<std::uint64_t>(select.integer(0)));
            rows.emplace_back(select.integer(0), without_origins(*store.read(root), select.bytes(1)));
        }
    }
    SqliteFile file(path, SqliteFile::Access::recover);
    file.run("BEGIN");
    SqliteStatement update(file, "UPDATE tiles SET data = ? WHERE code = ?");
    for (const auto& [code, bytes] : rows) {
        update.bind(1, bytes).bind(2, code).step();
        update.reset();
    }
    for (SourceInfo& source : metadata.sources) source.files.clear();
    write_metadata(file, metadata);
    file.run("ALTER TABLE sources DROP COLUMN files; PRAGMA user_version = 3; COMMIT");
}

}  // namespace planet::testing
