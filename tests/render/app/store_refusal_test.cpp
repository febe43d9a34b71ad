// Stores that are not what they should be, through the whole program: one line that names the file, the right exit
// status, nothing left behind and nothing changed.

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <algorithm>
#include <csignal>

#include "planet/bake/bake.h"
#include "planet/elevation/constant_field.h"
#include "planet/octahedron/octahedron_map.h"
#include "render/app/picture/earth_store.h"
#include "render/app/store/bake_sources.h"
#include "tests/render/app/baked_store.h"

namespace render {
namespace {

namespace fs = std::filesystem;

/// A folder with dem.vrt and the store that was baked from it.
struct StoreFolder : ScratchFolder {
    StoreFolder() {
        hilly_terrain().write(*this / "dem.vrt");
        bake(*this, "dem.vrt --finest-level 25");
    }
    std::string store() const { return content(*this / "store.octa"); }
    void put_store(const std::string& bytes, const char* name = "bad.octa") const {
        std::ofstream(*this / name, std::ios::binary) << bytes;
    }
};

const std::vector<std::string> readers = {"info bad.octa --json r.json", "verify bad.octa --json r.json",
                                          "query height 49.9,10.1 --store bad.octa --json r.json",
                                          "bake dem.vrt --resume --finest-level 25 --least-level 12 -o bad.octa"};

void expect_one_line(const Outcome& outcome, int status, const std::string& start, const std::string& what) {
    EXPECT_EQ(outcome.status, status) << what << ": " << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("octaglobe: " + start)) << what << ": " << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << what << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "") << what;
}

/// All commands refuse bad.octa, and leave the folder as it is.
void expect_refused(const ScratchFolder& folder, const std::string& part, bool by_bake = true) {
    const auto before = folder.names();
    const std::string bytes = fs::is_regular_file(folder / "bad.octa") ? content(folder / "bad.octa") : "";
    for (const std::string& arguments : readers) {
        const bool baking = arguments.starts_with("bake");
        if (baking && !by_bake) continue;
        const Outcome outcome = run(folder.path(), words(arguments));
        const bool usage = baking && outcome.status == 2;  // a bake refuses its output
        expect_one_line(outcome, usage ? 2 : 3, usage ? "--output: " : "bad.octa: ", arguments);
        EXPECT_NE(outcome.err.find(usage ? "bad.octa" : part), std::string::npos) << outcome.err;
    }
    EXPECT_EQ(folder.names(), before);
    EXPECT_EQ(bytes.empty() ? bytes : content(folder / "bad.octa"), bytes);
}

TEST(StoreRefusal, CutShort) {
    const StoreFolder folder;
    const std::string whole = folder.store();
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{15}, std::size_t{99}, std::size_t{100}, std::size_t{4096}, std::size_t{16384},
          whole.size() / 3, whole.size() / 2, whole.size() - 16384, whole.size() - 1}) {
        SCOPED_TRACE(size);
        folder.put_store(whole.substr(0, size));
        expect_refused(folder, size < 100 ? "not an elevation store" : "cut short: ");
    }
}

TEST(StoreRefusal, NoStore) {
    const StoreFolder folder;
    expect_refused(folder, "no such file", false);  // a bake would begin it
    folder.put_store(
        "this is no store, and yet it is longer than the hundred bytes of a header: 0123456789 0123456789 "
        "0123456789");
    expect_refused(folder, "not an elevation store");
    fs::copy_file(folder / "dem.vrt", folder / "bad.octa", fs::copy_options::overwrite_existing);
    expect_refused(folder, "not an elevation store");
    fs::remove(folder / "bad.octa");
    {
        planet::SqliteFile other(folder / "bad.octa", planet::SqliteFile::Access::create);
        other.run("CREATE TABLE tiles(x); INSERT INTO tiles VALUES(1)");
    }
    expect_refused(folder, "an SQLite file, but not an elevation store");
    fs::remove(folder / "bad.octa");
    fs::create_directory(folder / "bad.octa");
    expect_refused(folder, "not a file");
}

TEST(StoreRefusal, EmptyFile) {
    const StoreFolder folder;
    folder.put_store("");
    expect_refused(folder, "empty", false);
    expect_one_line(run(folder.path(), words("bake dem.vrt -o bad.octa")), 2, "--output: 'bad.octa' is there already",
                    "bake");
    // That is what a bake leaves that was killed before it wrote anything.
    EXPECT_EQ(run(folder.path(), words("bake dem.vrt --finest-level 25 --least-level 12 --resume -o bad.octa")).status,
              0);
    EXPECT_EQ(rows_of(folder / "bad.octa"), rows_of(folder / "store.octa"));
}

TEST(StoreRefusal, NewerVersion) {
    const StoreFolder folder;
    std::string bytes = folder.store();
    bytes[63] = static_cast<char>(planet::store_format_version + 1);
    folder.put_store(bytes);
    expect_refused(folder, "is newer than this program");
}

TEST(StoreRefusal, AnotherPlanet) {
    const StoreFolder folder;
    planet::BakeOptions moon;
    moon.ellipsoid = planet::moon;
    planet::bake(planet::ConstantField(5, planet::VerticalDatum::ellipsoid), moon, folder / "moon.octa");
    for (const char* arguments :
         {"query height 1,2 --store moon.octa", "render --store moon.octa -o x.png --size 64x64"})
        expect_one_line(run(folder.path(), words(arguments)), 3,
                        "moon.octa: a store of another planet, moon; accepted: wgs84", arguments);
    EXPECT_FALSE(fs::exists(folder / "x.png"));
    const Outcome info = run(folder.path(), words("info moon.octa"));
    EXPECT_EQ(info.status, 0) << info.err;
    EXPECT_NE(info.out.find("moon"), std::string::npos);
}

/// Flips one bit of bad.octa.
void flip(const StoreFolder& folder, const std::string& whole, std::size_t at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    folder.put_store(bytes);
}

// A flipped bit anywhere is found, unless it lies in space that holds nothing: then all rows are still the same.
TEST(StoreRefusal, FlippedBitsAreFound) {
    const StoreFolder folder;
    const std::string whole = folder.store(), rows = rows_of(folder / "store.octa");
    std::vector<std::size_t> places;
    for (std::size_t at = 0; at < 100; at += 9) places.push_back(at);  // the header
    for (std::size_t page = 0; page < whole.size(); page += 16384)     // b-tree pages
        for (const std::size_t at : {0, 3, 8, 11, 16380}) places.push_back(page + at + (page == 0 ? 100 : 0));
    for (std::size_t at = 150; at < whole.size(); at += whole.size() / 40) places.push_back(at);
    int found = 0;
    for (const std::size_t at : places) {
        if (at >= whole.size()) continue;
        SCOPED_TRACE("byte " + std::to_string(at));
        flip(folder, whole, at);
        const Outcome outcome = run(folder.path(), words("verify bad.octa"));
        if (outcome.status == 0) {
            EXPECT_EQ(rows_of(folder / "bad.octa"), rows);
            continue;
        }
        ++found;
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 3) << outcome.status << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("octaglobe: bad.octa: ")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.status == 1, !outcome.out.empty()) << outcome.out;
    }
    EXPECT_GE(found, static_cast<int>(places.size()) / 3);
}

/// Where in the file the row of a tile is.
std::size_t place_of(const StoreFolder& folder, planet::LocationCode root) {
    planet::SqliteFile database(folder / "store.octa", planet::SqliteFile::Access::read);
    planet::SqliteStatement select(database, "SELECT data FROM tiles WHERE code = ?");
    select.bind(1, static_cast<std::int64_t>(root.bits()));
    if (!select.step()) return std::string::npos;
    const auto bytes = select.bytes(0);
    const std::size_t shown = std::min<std::size_t>(bytes.size(), 64);  // a long row goes on in another page
    return folder.store().find(std::string(reinterpret_cast<const char*>(bytes.data()), shown));
}

planet::LocationCode tile_at(double latitude, double longitude, int level) {
    using planet::degrees;
    return planet::cell_at(planet::normal_from_geodetic(latitude * degrees, longitude * degrees), level);
}

/// The finest tile there.
planet::LocationCode last_tile_at(const fs::path& store, double latitude, double longitude) {
    const auto place = tile_at(latitude, longitude, planet::max_bisection_level);
    planet::LocationCode last;
    for (const auto root : planet::ElevationStore::open(store).tiles())  // coarse to fine
        if (root.contains(place)) last = root;
    return last;
}

// A tile that cannot be read is named; the one above stands in for it.
TEST(StoreRefusal, ADamagedTileIsNamedAndItsParentStandsIn) {
    const StoreFolder folder;
    const auto root = last_tile_at(folder / "store.octa", 49.84, 10.2);
    ASSERT_GT(root.bisection_level(), 0);
    const std::size_t at = place_of(folder, root);
    ASSERT_NE(at, std::string::npos);
    flip(folder, folder.store(), at + 20);
    const std::string name = "bad.octa: tile " + planet::to_string(root) + " is damaged";

    const Outcome verified = run(folder.path(), words("verify bad.octa --json v.json"));
    EXPECT_EQ(verified.status, 1);
    EXPECT_TRUE(verified.out.starts_with(name)) << verified.out;
    EXPECT_EQ(std::count(verified.err.begin(), verified.err.end(), '\n'), 1) << verified.err;
    const auto report = nlohmann::json::parse(content(folder / "v.json"));
    EXPECT_EQ(report.at("passed"), false);
    EXPECT_GE(report.at("problems"), 1);

    const Outcome answered = run(folder.path(), words("query height 49.84,10.2 --store bad.octa --json q.json"));
    EXPECT_EQ(answered.status, 0);
    EXPECT_TRUE(answered.err.starts_with("octaglobe: warning: " + name)) << answered.err;
    const auto answer = nlohmann::json::parse(content(folder / "q.json"));
    EXPECT_EQ(answer.at("damaged"), true);
    EXPECT_NEAR(answer.at("height_m"), 800, 3000);  // of the coarser surface, which sags
    EXPECT_NE(answered.out.find("no bound"), std::string::npos) << answered.out;

    const std::string view = " --at 49.84,10.2 --range 30km --pitch -60 --size 96x64 ";
    const Outcome drawn = run(folder.path(), words("render --store bad.octa" + view + "-o bad.png --json b.json"));
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    EXPECT_TRUE(drawn.err.starts_with("octaglobe: warning: " + name)) << drawn.err;
    EXPECT_EQ(std::count(drawn.err.begin(), drawn.err.end(), '\n'), 1) << drawn.err;
    EXPECT_EQ(nlohmann::json::parse(content(folder / "b.json")).at("damaged"), true);
    EXPECT_EQ(run(folder.path(), words("render --store store.octa" + view + "-o good.png --json g.json")).status, 0);
    EXPECT_EQ(nlohmann::json::parse(content(folder / "g.json")).at("damaged"), false);
}

// A face has nothing above it.
TEST(StoreRefusal, ADamagedFaceIsNamed) {
    const StoreFolder folder;
    const auto root = tile_at(49.84, 10.2, 0);
    const std::size_t at = place_of(folder, root);
    ASSERT_NE(at, std::string::npos);
    flip(folder, folder.store(), at + 20);
    const Outcome outcome = run(folder.path(), words("info bad.octa"));
    expect_one_line(outcome, 3, "bad.octa: tile " + planet::to_string(root) + " is damaged", "info");
    EXPECT_EQ(run(folder.path(), words("verify bad.octa")).status, 1);
}

/// Bakes dem.vrt into bad.octa as the program does, and stops half-way.
void bake_half(const StoreFolder& folder) {
    BakeCommand command;
    command.sources = {(folder / "dem.vrt").native()};
    const auto geoid = std::make_shared<const planet::Geoid>(OCTAGLOBE_SOURCE_DIR "/data/egm96-15.pgm");
    set_geoid(command.bake, geoid);
    command.bake.finest_level = 25;
    command.bake.least_level = 12;
    command.bake.transaction_tiles = 4;
    struct Stop {};
    command.bake.progress = [](std::string_view step, double fraction) {
        if (step == "tiles" && fraction > 0.3) throw Stop();
    };
    const auto field = open_bake_sources(command, geoid, std::size_t{64} << 20, {});
    EXPECT_THROW(planet::bake(*field, command.bake, folder / "bad.octa"), Stop);
}

TEST(StoreRefusal, AnUnfinishedStoreIsNotDrawn) {
    const StoreFolder folder;
    bake_half(folder);
    const auto before = folder.names();
    for (const char* arguments :
         {"query height 49.84,10.2 --store bad.octa", "render --store bad.octa -o x.png --size 64x64",
          "mesh --planet --store bad.octa --max-deviation 1000 -o x.ply"}) {
        const Outcome outcome = run(folder.path(), words(arguments));
        expect_one_line(outcome, 3, "bad.octa: ", arguments);
        EXPECT_NE(outcome.err.find("--resume"), std::string::npos) << outcome.err;
    }
    const Outcome refused = run(folder.path(), words("bake dem.vrt -o bad.octa"));
    expect_one_line(refused, 2, "--output: 'bad.octa' is a store that is not finished; accepted: --resume", "bake");
    EXPECT_EQ(folder.names(), before);
    EXPECT_EQ(run(folder.path(), words("verify bad.octa")).status, 0);
    ASSERT_EQ(run(folder.path(), words("info bad.octa --json i.json")).status, 0);
    const auto info = nlohmann::json::parse(content(folder / "i.json"));
    EXPECT_EQ(info.at("complete"), false);
    EXPECT_LT(info.at("done"), 1);
    EXPECT_GT(info.at("tiles_planned"), info.at("tiles"));
}

// What a store was begun with is what it goes on with.
TEST(StoreRefusal, ResumingWithOtherSourcesOrOptions) {
    const StoreFolder folder;
    bake_half(folder);
    const std::string bytes = content(folder / "bad.octa");
    const std::string same = "--finest-level 25 --least-level 12 --resume -o bad.octa";
    Terrain other = hilly_terrain();
    other.height_m = [](int column, int row) { return hills(column, row) + (column == 7 && row == 9 ? 1 : 0); };
    other.write(folder / "other.vrt");
    Terrain voids = hilly_terrain();
    voids.band = "<NoDataValue>-9999</NoDataValue>";
    voids.height_m = [](int, int) { return -9999.0; };
    voids.write(folder / "void.vrt");
    const auto expect = [&](const std::string& arguments, int status, const std::string& start, const char* part) {
        const Outcome outcome = run(folder.path(), words("bake " + arguments));
        expect_one_line(outcome, status, start, arguments);
        EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
        EXPECT_EQ(content(folder / "bad.octa"), bytes) << arguments;
    };
    expect("other.vrt " + same, 2, "bad.octa: ", "source 1 dem.vrt");
    expect("dem.vrt other.vrt " + same, 2, "bad.octa: ", "source 2 other.vrt");
    expect("dem.vrt --datum ellipsoid " + same, 2, "bad.octa: ", "source 1 dem.vrt");
    expect("dem.vrt --density 1 " + same, 2, "bad.octa: ", "extra levels 0, not 1");
    expect("dem.vrt --quantum 1 " + same, 2, "bad.octa: ", "quantum");
    expect("dem.vrt --finest-level 24 --least-level 12 --resume -o bad.octa", 2,
           "bad.octa: ", "finest level 25, not 24");
    expect("missing.vrt " + same, 3, "missing.vrt: ", "");
    expect("void.vrt " + same, 3, "void.vrt: ", "");
    expect(same, 2, "bake: no sources", "");
    fs::rename(folder / "other.vrt.raw", folder / "dem.vrt.raw");  // its content changes
    expect("dem.vrt " + same, 2, "bad.octa: ", "source 1 dem.vrt");
    hilly_terrain().write(folder / "dem.vrt");
    EXPECT_EQ(run(folder.path(), words("bake dem.vrt " + same)).status, 0);
    EXPECT_EQ(rows_of(folder / "bad.octa"), rows_of(folder / "store.octa"));
}

// A limit of the size of files stands for a full disk: what SQLite is told is that bytes cannot be written.
TEST(StoreRefusal, FullDisk) {
    const StoreFolder folder;
    const std::string arguments = "bake dem.vrt --finest-level 25 --least-level 12 -o bad.octa --json r.json";
    const std::size_t whole = folder.store().size();
    for (const std::size_t limit :
         {std::size_t{0}, std::size_t{20'000}, std::size_t{70'000}, whole / 2, whole - 20'000}) {
        SCOPED_TRACE(limit);
        const Outcome outcome = run(folder.path(), words(arguments), [&] {
            const rlimit size{limit, limit};
            ::setrlimit(RLIMIT_FSIZE, &size);
            std::signal(SIGXFSZ, SIG_IGN);
        });
        if (limit == 0) {  // nor can the line that says so be written
            EXPECT_EQ(outcome.status, 3);
        } else {
            expect_one_line(outcome, 3, "bad.octa", "bake");
            EXPECT_NE(outcome.err.find(": the disk is full"), std::string::npos) << outcome.err;
        }
        EXPECT_FALSE(fs::exists(folder / "r.json"));
        if (fs::exists(folder / "bad.octa") && fs::file_size(folder / "bad.octa") > 0) {
            EXPECT_FALSE(planet::ElevationStore::open(folder / "bad.octa").metadata().complete);
        }
        EXPECT_EQ(run(folder.path(), words(arguments + " --resume")).status, 0);
        EXPECT_EQ(rows_of(folder / "bad.octa"), rows_of(folder / "store.octa"));
        EXPECT_EQ(folder.names(), (std::vector<std::string>{"bad.octa", "bake.json", "dem.vrt", "dem.vrt.raw", "r.json",
                                                            "store.octa"}));
        fs::remove(folder / "r.json");
        fs::remove(folder / "bad.octa");
    }
}

// As another user, for whom rights count, if this one may do everything.
TEST(StoreRefusal, WhatMayNotBeWritten) {
    const StoreFolder folder;
    bake_half(folder);
    fs::permissions(folder / "bad.octa", fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
    fs::permissions(folder.path(), fs::perms(0555));
    const auto prepare = [] {
        if (::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(97);
    };
    const auto may = [&](const std::string& arguments) { return run(folder.path(), words(arguments), prepare); };
    if (may("--version").status != 0) GTEST_SKIP() << "the program cannot be run as another user";
    const Outcome begun = may("bake dem.vrt -o new.octa");
    expect_one_line(begun, 2, "--output: 'new.octa' cannot be written", "new.octa");
    const Outcome resumed = may("bake dem.vrt --finest-level 25 --least-level 12 --resume -o bad.octa");
    EXPECT_NE(resumed.status, 0);
    EXPECT_TRUE(resumed.err.starts_with("octaglobe: ")) << resumed.err;
    EXPECT_EQ(std::count(resumed.err.begin(), resumed.err.end(), '\n'), 1) << resumed.err;
    for (const char* arguments : {"info store.octa", "verify store.octa", "query height 49.84,10.2 --store store.octa",
                                  "info bad.octa", "verify bad.octa"})
        EXPECT_EQ(may(arguments).status, 0) << arguments << may(arguments).err;
    fs::permissions(folder.path(), fs::perms(0755));
}

TEST(StoreRefusal, BadBakes) {
    const StoreFolder folder;
    fs::create_directory(folder / "tiles");
    std::ofstream(folder / "text.tif") << "this is no picture\n";
    const auto before = folder.names();
    struct Call {
        const char* arguments;
        int status;
        const char* line;
    };
    constexpr Call calls[] = {
        {"bake", 2, "bake: --output is required"},
        {"bake -o x.octa", 2, "bake: no sources"},
        {"bake dem.vrt", 2, "bake: --output is required"},
        {"bake '' -o x.octa", 2, "source: empty file name"},
        {"bake dem.vrt -o ''", 2, "--output: empty file name"},
        {"bake dem.vrt -o no/such/folder/x.octa", 2, "--output: 'no/such/folder/x.octa' cannot be written"},
        {"bake dem.vrt -o tiles", 2, "--output: 'tiles' is not a file"},
        {"bake dem.vrt -o dem.vrt", 2, "--output: 'dem.vrt' is one of the sources"},
        {"bake dem.vrt -o text.tif", 2, "--output: 'text.tif' is there, and no elevation store"},
        {"bake dem.vrt -o text.tif --replace", 2, "--output: 'text.tif' is there, and no elevation store"},
        {"bake dem.vrt -o store.octa", 2, "--output: 'store.octa' is a finished store"},
        {"bake dem.vrt -o x.octa --resume --replace", 2, "bake: --"},
        {"bake dem.vrt dem.vrt -o x.octa", 2, "dem.vrt: is a source twice"},
        {"bake dem.vrt ./dem.vrt -o x.octa", 2, "./dem.vrt: is a source twice"},
        {"bake *.vrt dem.vrt -o x.octa", 2, "dem.vrt: is a source twice"},
        {"bake missing.tif -o x.octa", 3, "missing.tif: "},
        {"bake tiles/*.hgt -o x.octa", 3, "tiles/*.hgt: "},
        {"bake text.tif -o x.octa", 3, "text.tif: "},
        {"bake tiles -o x.octa", 3, "tiles: "},
        {"bake dem.vrt store.octa -o x.octa", 3, "store.octa: "},
        {"bake dem.vrt --datum wgs84 -o x.octa", 2, "--datum: 'wgs84' is unknown"},
        {"bake dem.vrt --datum egm96 --datum egm96 -o x.octa", 2, "--datum: 2 for 1 sources"},
        {"bake dem.vrt --base mars -o x.octa", 2, "--base: 'mars' is unknown"},
        {"bake dem.vrt --density nan -o x.octa", 2, "--density: 'nan' is not a whole number"},
        {"bake dem.vrt --density 21 -o x.octa", 2, "--density: '21' is out of range"},
        {"bake dem.vrt --finest-level 61 -o x.octa", 2, "--finest-level: '61' is out of range"},
        {"bake dem.vrt --least-level 30 --finest-level 20 -o x.octa", 2, "--least-level: 30 is finer"},
        {"bake dem.vrt --quantum inf -o x.octa", 2, "--quantum: 'inf' is not a distance"},
        {"bake dem.vrt --quantum 0.3 -o x.octa", 2, "--quantum: '0.3' is no power of two"},
        {"bake dem.vrt --quantum 0 -o x.octa", 2, "--quantum: '0' is out of range"},
        {"bake dem.vrt --memory 1 -o x.octa", 2, "--memory: '1' is out of range"},
        {"bake dem.vrt --memory 1e30 -o x.octa", 2, "--memory: '1e30' is out of range"},
        {"bake dem.vrt --memory nan -o x.octa", 2, "--memory: 'nan' is not an amount"},
        {"bake dem.vrt --threads -1 -o x.octa", 2, "--threads: '-1' is out of range"},
        {"verify", 2, "verify: file"},
        {"verify ''", 2, "file: empty file name"},
        {"verify dem.vrt", 3, "dem.vrt: not an elevation store"},
        {"info ''", 2, "file: empty file name"},
        {"query height 1,2 --store store.octa --elevation dem.vrt", 2, "query height: --"},
    };
    for (const Call& call : calls)
        expect_one_line(run(folder.path(), words(call.arguments)), call.status, call.line, call.arguments);
    EXPECT_EQ(folder.names(), before);
}

}  // namespace
}  // namespace render
