#include "planet/bake/file.h"

#include <algorithm>

#include "planet/error.h"

namespace planet {

namespace {

constexpr const char* write_tile = "INSERT INTO tiles VALUES(?, ?)";
constexpr const char* write_unfinished = "INSERT OR REPLACE INTO unfinished VALUES(?, ?)";

[[noreturn]] void differ(const std::filesystem::path& path, const std::string& what) {
    throw Error(Fault::bad_usage, path.string(), "the store there was begun otherwise: " + what,
                "the same sources and options, or --replace");
}

std::string text_of(const SourceInfo& s) {
    return s.name + " (SHA-256 " + s.checksum.substr(0, 12) + ", " + std::string(name_of(s.datum)) + ")";
}

bool is_same(const SourceInfo& a, const SourceInfo& b) {
    return a.checksum == b.checksum && a.crs == b.crs && a.datum == b.datum && a.spacing_m == b.spacing_m;
}

// What determines the content of a store, in the order in which a user thinks of it.
void check_is_same(const std::filesystem::path& path, const StoreMetadata& there, const StoreMetadata& now) {
    const auto number = [&](const char* name, auto a, auto b) {
        if (!(a == b)) differ(path, std::string(name) + " " + std::to_string(a) + ", not " + std::to_string(b));
    };
    for (std::size_t s = 0; s < std::max(there.sources.size(), now.sources.size()); ++s) {
        const std::string name = "source " + std::to_string(s + 1) + " ";
        if (s >= now.sources.size()) differ(path, name + text_of(there.sources[s]) + " is not given");
        if (s >= there.sources.size()) differ(path, "without " + name + text_of(now.sources[s]));
        if (!is_same(there.sources[s], now.sources[s]))
            differ(path, name + text_of(there.sources[s]) + ", not " + text_of(now.sources[s]));
        if (there.format_version > 3 && there.sources[s].files != now.sources[s].files)
            differ(path, name + text_of(there.sources[s]) + " of files of other names");
    }
    if (!(there.ellipsoid == now.ellipsoid))
        differ(path, "the planet " + to_string(there.ellipsoid) + ", not " + to_string(now.ellipsoid));
    if (there.datum != now.datum)
        differ(path, "heights above " + std::string(name_of(there.datum)) + ", not " + std::string(name_of(now.datum)));
    if (there.undulation != now.undulation)
        differ(path, "the geoid \"" + there.undulation + "\", not \"" + now.undulation + "\"");
    number("least level", there.settings.least_level, now.settings.least_level);
    number("finest level", there.settings.finest_level, now.settings.finest_level);
    number("extra levels", there.settings.extra_levels, now.settings.extra_levels);
    number("quantum", there.settings.quantum_m, now.settings.quantum_m);
}

bool is_missing_or_empty(const std::filesystem::path& path) {
    std::error_code fault;
    const auto size = std::filesystem::file_size(path, fault);
    return !std::filesystem::exists(path) || (!fault && size == 0);
}

// The names under which a store is begun, and put together when it is finished.
std::filesystem::path beside(const std::filesystem::path& path) {
    return path.string() + "-finishing";
}
std::filesystem::path before(const std::filesystem::path& path) {
    return path.string() + "-beginning";
}

// The journal too: so no writer may have been killed in a transaction, or it has been rolled back.
void remove_leftovers(const std::filesystem::path& path) {
    std::error_code ignored;
    for (const std::string_view ending : leftover_endings)
        std::filesystem::remove(path.string().append(ending), ignored);
}

}  // namespace

BakeFile::BakeFile(SqliteFile&& file, const StoreMetadata& metadata) : file_(std::move(file)), metadata_(metadata) {
    if (file_.where() != SqliteFile::in_memory_name) path_ = file_.where();
    file_.run("PRAGMA locking_mode = EXCLUSIVE");
    create_tables(file_, metadata);
}

std::optional<StoreMetadata> BakeFile::finished(const std::filesystem::path& path, const StoreMetadata& metadata) {
    if (is_missing_or_empty(path)) return std::nullopt;
    const ElevationStore store = ElevationStore::open(path);
    check_is_same(path, store.metadata(), metadata);
    if (!store.metadata().complete) return std::nullopt;
    remove_leftovers(path);
    return store.metadata();
}

std::unique_ptr<BakeFile> BakeFile::begin(const std::filesystem::path& path, const StoreMetadata& metadata) {
    const std::filesystem::path fresh = before(path);
    { BakeFile tables(SqliteFile(fresh, SqliteFile::Access::create), metadata); }
    std::error_code fault;
    std::filesystem::remove(path.string() + "-journal", fault);  // of what is replaced: it must not be rolled back
    std::filesystem::rename(fresh, path, fault);
    if (fault) throw Error(Fault::bad_data, path.string(), "cannot be written (" + fault.message() + ")");
    return resume(path, metadata);
}

std::unique_ptr<BakeFile> BakeFile::resume(const std::filesystem::path& path, const StoreMetadata& metadata) {
    if (is_missing_or_empty(path)) return begin(path, metadata);
    check_store_file(path);
    std::unique_ptr<BakeFile> resumed(new BakeFile(SqliteFile(path, SqliteFile::Access::recover)));
    resumed->path_ = path;
    resumed->file_.run("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE; COMMIT");
    resumed->metadata_ = read_metadata(resumed->file_);
    check_is_same(path, resumed->metadata_, metadata);
    if (resumed->metadata_.format_version != store_format_version)
        throw Error(Fault::bad_usage, path.string(),
                    "the store there was begun in format version " + std::to_string(resumed->metadata_.format_version) +
                        ", which only older programs write",
                    "--replace to begin anew");
    if (!(resumed->metadata_.layers == metadata.layers)) differ(path, "its tiles begin at other levels");
    return resumed;
}

std::vector<LocationCode> BakeFile::tiles() const {
    const std::lock_guard lock(mutex_);
    SqliteStatement codes(file_, "SELECT code FROM tiles ORDER BY code");
    std::vector<LocationCode> found;
    while (codes.step()) {
        const auto bits = static_cast<std::uint64_t>(codes.integer(0));
        if (!LocationCode::is_valid(bits)) throw Error(Fault::bad_data, file_.where(), "a row is not a tile");
        found.emplace_back(bits);
    }
    return found;
}

std::optional<std::vector<std::uint8_t>> BakeFile::row(const char* sql, LocationCode root) const {
    const std::lock_guard lock(mutex_);
    SqliteStatement select(file_, sql);
    select.bind(1, static_cast<std::int64_t>(root.bits()));
    if (!select.step()) return std::nullopt;
    const auto bytes = select.bytes(0);
    return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
}

std::optional<std::vector<std::uint8_t>> BakeFile::tile(LocationCode root) const {
    return row("SELECT data FROM tiles WHERE code = ?", root);
}

std::optional<std::vector<std::uint8_t>> BakeFile::unfinished(LocationCode root) const {
    return row("SELECT data FROM unfinished WHERE code = ?", root);
}

std::uint64_t BakeFile::tile_bytes() const {
    const std::lock_guard lock(mutex_);
    return static_cast<std::uint64_t>(file_.number("SELECT total(length(data)) FROM tiles"));
}

void BakeFile::write(std::span<const TileRow> tiles, std::span<const TileRow> unfinished, double resampling_max_m) {
    const std::lock_guard lock(mutex_);
    file_.run("BEGIN");
    for (const auto& [sql, rows] : {std::pair(write_tile, tiles), std::pair(write_unfinished, unfinished)}) {
        SqliteStatement insert(file_, sql);
        for (const TileRow& row : rows) {
            insert.bind(1, static_cast<std::int64_t>(row.root.bits())).bind(2, row.bytes).step();
            insert.reset();
        }
    }
    metadata_.resampling_max_m = resampling_max_m;
    write_metadata(file_, metadata_);
    file_.run("COMMIT");
}

std::optional<SqliteFile> BakeFile::finish() {
    const std::lock_guard lock(mutex_);
    if (path_.empty()) {
        file_.run("DROP TABLE unfinished; UPDATE metadata SET value = '1' WHERE key = 'complete'");
        return std::move(file_);
    }
    file_.run("DELETE FROM unfinished");
    rewrite();
    return std::nullopt;
}

// Rows went in as tiles became final, which depends on threads and interruptions. The copy has them in order, and only
// the copy is ever marked complete.
void BakeFile::rewrite() {
    std::error_code ignored;
    const std::filesystem::path copy = beside(path_);
    std::filesystem::remove(copy, ignored);
    std::filesystem::remove(copy.string() + "-journal", ignored);  // of a bake that was killed here
    {
        SqliteStatement vacuum(file_, "VACUUM INTO ?");
        const std::string name = copy.string();
        vacuum.bind(1, name).step();
    }
    {
        SqliteFile finished(copy, SqliteFile::Access::recover);
        finished.run("BEGIN; DROP TABLE unfinished; UPDATE metadata SET value = '1' WHERE key = 'complete'; COMMIT");
    }
    file_ = SqliteFile({}, SqliteFile::Access::in_memory);  // closed before its file is replaced
    std::filesystem::rename(copy, path_, ignored);
    remove_leftovers(path_);
    if (ignored) throw Error(Fault::bad_data, path_.string(), "cannot be replaced (" + ignored.message() + ")");
}

}  // namespace planet
