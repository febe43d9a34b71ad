#include "planet/store/elevation_store.h"

#include <array>
#include <cstring>
#include <fstream>
#include <mutex>

#include "planet/error.h"
#include "planet/store/byte_stream.h"
#include "planet/store/store_tables.h"

namespace planet {

namespace {

constexpr std::string_view accepted = "an elevation store made by octaglobe bake";

[[noreturn]] void refuse(const std::filesystem::path& path, std::string_view what) {
    throw Error(Fault::bad_data, path.string(), what, accepted);
}

// The first 100 bytes of an SQLite file (sqlite.org/fileformat.html, 1.3), big-endian.
using Header = std::array<unsigned char, 100>;

std::uint32_t big_endian(const Header& h, std::size_t at) {
    return static_cast<std::uint32_t>(h[at]) << 24 | static_cast<std::uint32_t>(h[at + 1]) << 16 |
           static_cast<std::uint32_t>(h[at + 2]) << 8 | h[at + 3];
}

Header read_header(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) refuse(path, "cannot be read");
    Header h{};
    in.read(reinterpret_cast<char*>(h.data()), h.size());
    if (in.gcount() == 0) refuse(path, "the file is empty");
    if (in.gcount() < static_cast<std::streamsize>(h.size()) || std::memcmp(h.data(), "SQLite format 3", 16) != 0)
        refuse(path, "not an elevation store");
    return h;
}

}  // namespace

std::filesystem::path store_of_leftover(const std::filesystem::path& path) {
    std::filesystem::path store;
    for (const std::string_view ending : leftover_endings) {  // of two that fit, the longer one
        const std::string& name = path.native();
        if (!name.ends_with(ending) || path.filename().native().size() == ending.size()) continue;
        const std::string rest = name.substr(0, name.size() - ending.size());
        if (store.empty() || rest.size() < store.native().size()) store = rest;
    }
    return store;
}

void check_store_file(const std::filesystem::path& path) {
    const Header h = read_header(path);
    if (big_endian(h, 68) != store_application_id) refuse(path, "an SQLite file, but not an elevation store");
    const std::uint32_t version = big_endian(h, 60);
    if (version < oldest_store_format_version || version > store_format_version)
        throw Error(
            Fault::bad_data, path.string(),
            "format version " + std::to_string(version) +
                (version > store_format_version ? " is newer than this program" : " is not known"),
            "version " + std::to_string(oldest_store_format_version) + " or " + std::to_string(store_format_version));
    const std::uint64_t page = (h[16] << 8 | h[17]) == 1 ? 65536u : static_cast<unsigned>(h[16] << 8 | h[17]);
    const std::uint64_t said = page * big_endian(h, 28), there = std::filesystem::file_size(path);
    if (there < said)
        refuse(path, "cut short: " + std::to_string(there) + " of " + std::to_string(said) + " bytes are there");
}

namespace {

bool has_journal(const std::filesystem::path& path) {
    std::error_code missing;
    const auto size = std::filesystem::file_size(path.string() + "-journal", missing);
    return !missing && size > 0;
}

}  // namespace

struct ElevationStore::Open {
    explicit Open(SqliteFile&& connection)
        : file(std::move(connection)), metadata(read_metadata(file)), scale(tile_scale(metadata)) {
        select = std::make_unique<SqliteStatement>(file, "SELECT data FROM tiles WHERE code = ?");
    }
    // The bytes of a tile, or none. The connection is one thread's at a time; decoding is not.
    std::optional<std::vector<std::uint8_t>> bytes(LocationCode root) {
        const std::lock_guard lock(mutex);
        select->reset();
        select->bind(1, static_cast<std::int64_t>(root.bits()));
        std::optional<std::vector<std::uint8_t>> found;
        if (select->step()) {
            const auto row = select->bytes(0);
            found.emplace(row.begin(), row.end());
        }
        select->reset();
        return found;
    }
    [[noreturn]] void damaged(LocationCode root, std::string_view what) const {
        throw Error(Fault::bad_data, file.where(),
                    "tile " + to_string(root) + " is damaged (" + std::string(what) + ")");
    }

    SqliteFile file;
    StoreMetadata metadata;
    TileScale scale;
    std::mutex mutex;
    std::unique_ptr<SqliteStatement> select;
};

ElevationStore ElevationStore::open(const std::filesystem::path& path) {
    std::error_code fault;
    if (!std::filesystem::exists(path, fault)) refuse(path, "no such file");
    if (!std::filesystem::is_regular_file(path, fault)) refuse(path, "not a file");
    if (const auto store = store_of_leftover(path); !store.empty())
        throw Error(Fault::bad_data, path.string(), "what a bake left beside its store when it was stopped",
                    store.string() + ", or octaglobe bake --resume into that, which removes this");
    if (has_journal(path)) {
        read_header(path);
        SqliteFile recovering(path, SqliteFile::Access::recover);
        recovering.number("SELECT count(*) FROM sqlite_schema");
    }
    check_store_file(path);
    return ElevationStore(SqliteFile(path, SqliteFile::Access::read));
}

ElevationStore ElevationStore::open(const std::filesystem::path& path, const Ellipsoid& expected) {
    ElevationStore store = open(path);
    const Ellipsoid& there = store.metadata().ellipsoid;
    if (!(there == expected))
        throw Error(Fault::bad_data, path.string(), "a store of another planet, " + to_string(there),
                    to_string(expected));
    store.require_complete();
    return store;
}

void ElevationStore::require_complete() const {
    if (!metadata().complete)
        throw Error(Fault::bad_data, where(), "the store is not finished",
                    "one whose bake has been ended with --resume");
}

ElevationStore::ElevationStore(SqliteFile&& file) : open_(std::make_unique<Open>(std::move(file))) {}
ElevationStore::ElevationStore(ElevationStore&&) noexcept = default;
ElevationStore& ElevationStore::operator=(ElevationStore&&) noexcept = default;
ElevationStore::~ElevationStore() = default;

const StoreMetadata& ElevationStore::metadata() const {
    return open_->metadata;
}

const std::string& ElevationStore::where() const {
    return open_->file.where();
}

std::optional<Tile> ElevationStore::read(LocationCode root) const {
    std::optional<std::vector<std::uint8_t>> bytes;
    try {
        bytes = open_->bytes(root);
        if (bytes) return decode_tile(root, *bytes, open_->scale);
    } catch (const MalformedBytes& malformed) {
        open_->damaged(root, malformed.what());
    } catch (const Error& error) {
        open_->damaged(root, error.what());
    }
    if (!open_->metadata.complete) return std::nullopt;
    if (root.bisection_level() == 0) open_->damaged(root, "it is missing");
    const TileLayers layers = open_->metadata.layers;
    const std::optional<Tile> parent = read(layers.above(root));
    if (parent && parent->child_exists[layers.position(root)]) open_->damaged(root, "it is missing");
    return std::nullopt;
}

std::vector<LocationCode> ElevationStore::tiles() const {
    const std::lock_guard lock(open_->mutex);
    SqliteStatement codes(open_->file, "SELECT code FROM tiles ORDER BY code");
    std::vector<LocationCode> found;
    while (codes.step()) {
        const auto bits = static_cast<std::uint64_t>(codes.integer(0));
        if (!LocationCode::is_valid(bits) || !open_->metadata.layers.begin_at(LocationCode(bits).bisection_level()) ||
            LocationCode(bits).bisection_level() >= max_bisection_level)
            throw Error(Fault::bad_data, where(), "the row " + std::to_string(bits) + " is not a tile");
        found.emplace_back(bits);
    }
    return found;
}

}  // namespace planet
