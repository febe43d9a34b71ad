#include "planet/store/store_tables.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "planet/error.h"

namespace planet {

namespace {

std::string shortest(double v) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), v).ptr;
    return {digits.data(), end};
}

// FNV-1a, 64 bits: enough to find damage.
std::string checksum_of(std::string_view text) {
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    std::array<char, 17> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), h, 16).ptr;
    return {digits.data(), end};
}

std::string_view text_of(VerticalDatum datum) {
    return datum == VerticalDatum::egm96 ? "egm96" : "ellipsoid";
}

using Entries = std::map<std::string, std::string>;

// "0:17160 12:1523732"
std::string text_of(const std::map<int, std::uint64_t>& by_level) {
    std::string text;
    for (const auto& [level, count] : by_level)
        text += (text.empty() ? "" : " ") + std::to_string(level) + ":" + std::to_string(count);
    return text;
}

Entries entries_of(const StoreMetadata& m) {
    return {{"ellipsoid", std::string(m.ellipsoid.name)},
            {"ellipsoid_a_m", shortest(m.ellipsoid.a)},
            {"ellipsoid_f", shortest(m.ellipsoid.f)},
            {"vertical_datum", std::string(text_of(m.datum))},
            {"undulation", m.undulation},
            {"quantum_m", shortest(m.quantum_m)},
            {"first_tile_level", std::to_string(m.layers.first)},
            {"finest_level", std::to_string(m.finest_level)},
            {"resampling_max_m", shortest(m.resampling_max_m)},
            {"tiles", std::to_string(m.tiles)},
            {"vertices", std::to_string(m.vertices)},
            {"vertices_by_level", text_of(m.vertices_by_level)},
            {"bake_least_level", std::to_string(m.settings.least_level)},
            {"bake_finest_level", std::to_string(m.settings.finest_level)},
            {"bake_extra_levels", std::to_string(m.settings.extra_levels)},
            {"bake_quantum_m", shortest(m.settings.quantum_m)}};
}

std::string checksum_of(const Entries& entries, const std::vector<SourceInfo>& sources) {
    std::string text;
    for (const auto& [key, value] : entries) text.append(key).append("=").append(value).append("\n");
    for (const SourceInfo& s : sources) {
        for (const std::string_view part :
             {std::string_view(s.name), std::string_view(s.checksum), std::string_view(s.crs), text_of(s.datum)})
            text.append(part).append("\n");
        text.append(shortest(s.spacing_m)).append("\n");
        for (const std::string& file : s.files) text.append(file).append("\n");
    }
    return checksum_of(text);
}

class EntryReader {
  public:
    EntryReader(const Entries& entries, const std::string& where) : entries_(entries), where_(where) {}

    const std::string& text(const char* key) const {
        const auto found = entries_.find(key);
        if (found == entries_.end()) fail(key, "is missing");
        return found->second;
    }
    template <class Number>
    Number number(const char* key, Number least, Number most) const {
        const std::string& t = text(key);
        Number v{};
        const auto [end, fault] = std::from_chars(t.data(), t.data() + t.size(), v);
        if (fault != std::errc{} || end != t.data() + t.size() || !(v >= least && v <= most))
            fail(key, "is \"" + t + "\"");
        return v;
    }
    std::map<int, std::uint64_t> by_level(const char* key) const {
        std::map<int, std::uint64_t> counts;
        std::istringstream in(text(key));
        int level;
        char colon;
        std::uint64_t count;
        while (in >> level >> colon >> count) counts[level] = count;
        if (text_of(counts) != text(key)) fail(key, "is \"" + text(key) + "\"");
        return counts;
    }
    [[noreturn]] void fail(std::string_view key, std::string_view what) const {
        throw Error(Fault::bad_data, where_, "the metadata is damaged: " + std::string(key) + " " + std::string(what));
    }

  private:
    const Entries& entries_;
    const std::string& where_;
};

VerticalDatum datum_from(const std::string& text, const EntryReader& read) {
    if (text == "egm96") return VerticalDatum::egm96;
    if (text == "ellipsoid") return VerticalDatum::ellipsoid;
    read.fail("vertical_datum", "is \"" + text + "\"");
}

// Names are of static storage; an ellipsoid that is not one of those known keeps its constants.
Ellipsoid ellipsoid_from(const EntryReader& read) {
    const std::string& name = read.text("ellipsoid");
    std::string_view kept = "ellipsoid";
    for (const std::string_view known : {wgs84.name, moon.name, mars.name, sphere().name})
        if (name == known) kept = known;
    return ellipsoid(kept, read.number<double>("ellipsoid_a_m", 1, 1e9), read.number<double>("ellipsoid_f", 0, 0.9));
}

// Of names of files, one a line.
std::string lines_of(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text.append(name).push_back('\n');
        std::replace(text.end() - static_cast<std::ptrdiff_t>(name.size()) - 1, text.end() - 1, '\n', ' ');
    }
    return text;
}

std::vector<SourceInfo> read_sources(SqliteFile& file, int format_version, const EntryReader& read) {
    const std::string sql = std::string("SELECT name, checksum, crs, datum, spacing_m, ") +
                            (format_version > 3 ? "files" : "''") + " FROM sources ORDER BY rank";
    SqliteStatement source(file, sql.c_str());
    std::vector<SourceInfo> sources;
    while (source.step()) {
        sources.push_back(
            {source.text(0), source.text(1), source.text(2), datum_from(source.text(3), read), source.real(4)});
        std::istringstream lines(source.text(5));
        for (std::string name; std::getline(lines, name);) sources.back().files.push_back(name);
    }
    return sources;
}

}  // namespace

void create_tables(SqliteFile& file, const StoreMetadata& metadata) {
    const std::string pragmas =
        "PRAGMA page_size = 16384; BEGIN; PRAGMA application_id = " + std::to_string(store_application_id) +
        "; PRAGMA user_version = " + std::to_string(store_format_version) + ";";
    file.run(pragmas.c_str());
    file.run(
        "CREATE TABLE metadata(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;"
        "CREATE TABLE sources(rank INTEGER PRIMARY KEY, name TEXT, checksum TEXT, crs TEXT, datum TEXT, spacing_m "
        "REAL, files TEXT);"
        "CREATE TABLE tiles(code INTEGER PRIMARY KEY, data BLOB NOT NULL);"
        "CREATE TABLE unfinished(code INTEGER PRIMARY KEY, data BLOB NOT NULL);");
    write_metadata(file, metadata);
    file.run("COMMIT");
}

void write_metadata(SqliteFile& file, const StoreMetadata& m) {
    Entries entries = entries_of(m);
    entries.emplace("checksum", checksum_of(entries, m.sources));
    entries.emplace("complete", m.complete ? "1" : "0");
    file.run("DELETE FROM metadata; DELETE FROM sources;");
    SqliteStatement entry(file, "INSERT INTO metadata VALUES(?, ?)");
    for (const auto& [key, value] : entries) {
        entry.bind(1, key).bind(2, value).step();
        entry.reset();
    }
    SqliteStatement source(file, "INSERT INTO sources VALUES(?, ?, ?, ?, ?, ?, ?)");
    std::int64_t rank = 0;
    for (const SourceInfo& s : m.sources) {
        source.bind(1, rank++).bind(2, s.name).bind(3, s.checksum).bind(4, s.crs);
        source.bind(5, text_of(s.datum)).bind(6, s.spacing_m).bind(7, lines_of(s.files)).step();
        source.reset();
    }
}

StoreMetadata read_metadata(SqliteFile& file) {
    Entries entries;
    SqliteStatement entry(file, "SELECT key, value FROM metadata");
    while (entry.step()) entries[entry.text(0)] = entry.text(1);
    const EntryReader read(entries, file.where());

    StoreMetadata m;
    m.format_version = static_cast<int>(file.number("PRAGMA user_version"));
    m.sources = read_sources(file, m.format_version, read);
    m.complete = read.text("complete") == "1";
    const std::string checksum = read.text("checksum");
    entries.erase("complete");
    entries.erase("checksum");
    if (checksum_of(entries, m.sources) != checksum) read.fail("its checksum", "does not match");

    m.ellipsoid = ellipsoid_from(read);
    m.datum = datum_from(read.text("vertical_datum"), read);
    m.undulation = read.text("undulation");
    m.quantum_m = read.number<double>("quantum_m", least_quantum_m, most_quantum_m);
    if (m.format_version > 2) {
        m.layers.first = read.number<int>("first_tile_level", 1, tile_levels);
        m.vertices_by_level = read.by_level("vertices_by_level");
    }
    m.finest_level = read.number<int>("finest_level", 1, max_bisection_level);
    m.resampling_max_m = read.number<double>("resampling_max_m", 0, 1e9);
    m.tiles = read.number<std::uint64_t>("tiles", 0, std::uint64_t{1} << 60);
    m.vertices = read.number<std::uint64_t>("vertices", 0, std::uint64_t{1} << 60);
    m.settings = {read.number<int>("bake_least_level", 1, max_bisection_level),
                  read.number<int>("bake_finest_level", 1, max_bisection_level),
                  read.number<int>("bake_extra_levels", -max_bisection_level, max_bisection_level),
                  read.number<double>("bake_quantum_m", 0, most_quantum_m)};
    return m;
}

TileScale tile_scale(const StoreMetadata& m) {
    return {{m.ellipsoid, 1.0},
            m.quantum_m,
            !m.undulation.empty(),
            m.layers,
            static_cast<std::uint32_t>(source_files(m.sources).size())};
}

}  // namespace planet
