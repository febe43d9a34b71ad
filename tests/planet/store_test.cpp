#include "planet/store/elevation_store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zstd.h>

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include "bumpy_field.h"
#include "planet/bake/bake.h"
#include "planet/error.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/byte_stream.h"
#include "planet/store/store_field.h"
#include "planet/store/tile_cache.h"
#include "planet/store/tile_codec.h"

namespace planet {
namespace {

using testing::BumpyField;

class StoreFile : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("octaglobe store's test " + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path path(const char* name) const { return folder_ / name; }

    // A small planet with a finer patch: two levels of tiles.
    static BumpyField field() { return {2e6, {glm::normalize(glm::dvec3(1, 1, 1)), 0.01}, 4000}; }
    static BakeOptions options() {
        BakeOptions o;
        o.least_level = 8;
        o.undulation = testing::bumpy_undulation;
        return o;
    }
    std::filesystem::path baked(const char* name) const {
        bake(field(), options(), path(name));
        return path(name);
    }
    static std::vector<char> bytes(const std::filesystem::path& p) {
        std::ifstream in(p, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static void put(const std::filesystem::path& p, const std::vector<char>& b) {
        std::ofstream(p, std::ios::binary).write(b.data(), static_cast<std::streamsize>(b.size()));
    }
    static void sql(const std::filesystem::path& p, const char* statement) {
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(p.c_str(), &db), SQLITE_OK);
        char* message = nullptr;
        EXPECT_EQ(sqlite3_exec(db, statement, nullptr, nullptr, &message), SQLITE_OK) << message;
        sqlite3_close(db);
    }
    static std::string refusal(const std::filesystem::path& p) {
        try {
            ElevationStore::open(p, wgs84);
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            EXPECT_NE(std::string(e.what()).find(p.string()), std::string::npos) << e.what();
            return e.what();
        }
        return "accepted";
    }
    static ::testing::AssertionResult says(const std::string& text, const char* part) {
        if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
        return ::testing::AssertionFailure() << "\"" << text << "\" does not say \"" << part << "\"";
    }

  private:
    std::filesystem::path folder_;
};

bool same(const Tile& a, const Tile& b) {
    const auto N = [](const Tile& t) {
        std::vector<double> m;
        for (const GeoidUndulation u : t.undulation) m.push_back(u.m);
        return m;
    };
    return a.root == b.root && a.depth == b.depth && a.height == b.height && N(a) == N(b) &&
           a.deviation == b.deviation && a.radius == b.radius && a.child_exists == b.child_exists &&
           a.min_height == b.min_height && a.max_height == b.max_height && a.resampling == b.resampling;
}

TEST_F(StoreFile, BakingTwiceGivesTheSameBytes) {
    EXPECT_EQ(bytes(baked("a.octa")), bytes(baked("b.octa")));
}

TEST_F(StoreFile, FileAndMemoryHoldTheSameTiles) {
    BakeReport in_memory;
    const ElevationStore memory = bake_in_memory(field(), options(), &in_memory);
    const BakeReport in_file = bake(field(), options(), path("a.octa"));
    EXPECT_EQ(in_memory.tile_bytes, in_file.tile_bytes);
    const ElevationStore file = ElevationStore::open(path("a.octa"));
    ASSERT_EQ(memory.tiles(), file.tiles());
    EXPECT_EQ(file.tiles().size(), in_file.tiles);
    for (const LocationCode root : file.tiles()) EXPECT_TRUE(same(*memory.read(root), *file.read(root)));
    EXPECT_TRUE(file.verify().ok());
}

TEST_F(StoreFile, MetadataComesBack) {
    const ElevationStore store = ElevationStore::open(baked("a.octa"), wgs84);
    const StoreMetadata& m = store.metadata();
    EXPECT_EQ(m.ellipsoid, wgs84);
    EXPECT_EQ(m.ellipsoid.name, "wgs84");
    EXPECT_EQ(m.datum, VerticalDatum::egm96);
    EXPECT_EQ(m.undulation, "unnamed");
    EXPECT_EQ(m.quantum_m, 0.25);
    EXPECT_EQ(m.finest_level, 23);
    EXPECT_TRUE(m.complete);
    ASSERT_EQ(m.sources.size(), 1u);
    EXPECT_EQ(m.sources[0].name, "bumps");
    EXPECT_EQ(m.sources[0].checksum, std::string(64, 'b'));
    EXPECT_EQ(m.sources[0].spacing_m, 2e6);
    EXPECT_FALSE(std::filesystem::exists(path("a.octa").string() + "-journal"));
}

TEST_F(StoreFile, FilesThatAreNoStoreAreRefusedInOneLine) {
    EXPECT_TRUE(says(refusal(path("missing.octa")), "no such file"));
    EXPECT_TRUE(says(refusal(std::filesystem::temp_directory_path()), "not a file"));
    put(path("empty.octa"), {});
    EXPECT_TRUE(says(refusal(path("empty.octa")), "empty"));
    put(path("text.octa"), std::vector<char>(5000, 'x'));
    EXPECT_TRUE(says(refusal(path("text.octa")), "not an elevation store"));
    put(path("short.octa"), std::vector<char>(50, 'x'));
    EXPECT_TRUE(says(refusal(path("short.octa")), "not an elevation store"));
    sql(path("other.octa"), "CREATE TABLE t(x)");
    EXPECT_TRUE(says(refusal(path("other.octa")), "SQLite"));
    sql(baked("newer.octa"), "PRAGMA user_version = 5");
    EXPECT_TRUE(says(refusal(path("newer.octa")), "version 5 is newer"));
    BakeOptions on_mars = options();
    on_mars.ellipsoid = mars;
    bake(field(), on_mars, path("mars.octa"));
    EXPECT_TRUE(says(refusal(path("mars.octa")), "another planet, mars"));
    EXPECT_EQ(ElevationStore::open(path("mars.octa")).metadata().ellipsoid, mars);
}

TEST_F(StoreFile, ATruncatedFileIsRefusedAtAnyLength) {
    const std::vector<char> whole = bytes(baked("whole.octa"));
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{99}, std::size_t{100}, std::size_t{5000}, whole.size() / 2, whole.size() - 1}) {
        put(path("cut.octa"), {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        EXPECT_NE(refusal(path("cut.octa")), "accepted") << size;
    }
    EXPECT_TRUE(says(refusal(path("cut.octa")), "cut short"));
}

TEST_F(StoreFile, DamagedMetadataIsRefused) {
    sql(baked("a.octa"), "UPDATE metadata SET value = '0.5' WHERE key = 'quantum_m'");
    EXPECT_TRUE(says(refusal(path("a.octa")), "checksum"));
    sql(baked("b.octa"), "DELETE FROM metadata WHERE key = 'checksum'");
    EXPECT_TRUE(says(refusal(path("b.octa")), "metadata"));
    sql(baked("c.octa"), "UPDATE sources SET name = 'else'");
    EXPECT_TRUE(says(refusal(path("c.octa")), "checksum"));
}

// Any byte of any kind of tile: found, named, never a crash; and the cache goes on with a tile that stands in for it.
TEST_F(StoreFile, ACorruptTileIsDetectedAndNamed) {
    const auto whole = baked("whole.octa");
    const std::vector<LocationCode> roots = ElevationStore::open(whole).tiles();
    std::mt19937 random(11);
    for (int trial = 0; trial < 40; ++trial) {
        const LocationCode root = trial % 3 ? roots[random() % roots.size()] : LocationCode::face_root(trial % 8);
        std::filesystem::copy_file(whole, path("bad.octa"), std::filesystem::copy_options::overwrite_existing);
        const std::string code = std::to_string(root.bits());
        const std::string at = std::to_string(1 + random() % 60);
        sql(path("bad.octa"), ("UPDATE tiles SET data = CAST(substr(data, 1, length(data) * " + at +
                               " / 61) || CASE substr(data, length(data) * " + at +
                               " / 61 + 1, 1) WHEN x'00' THEN x'01' ELSE x'00' END || substr(data, length(data) * " +
                               at + " / 61 + 2) AS BLOB) WHERE code = " + code)
                                  .c_str());
        const ElevationStore store = ElevationStore::open(path("bad.octa"));
        try {
            store.read(root);
            ADD_FAILURE() << to_string(root) << " " << at;
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            EXPECT_TRUE(says(e.what(), ("tile " + to_string(root) + " is damaged").c_str()));
        }
        const TileCache cache(store);
        const auto stand_in = cache.tile(root);
        ASSERT_TRUE(stand_in);
        EXPECT_TRUE(stand_in->damaged);
        EXPECT_EQ(stand_in->deviation, std::vector<float>({0, 0}));
        EXPECT_EQ(cache.damage().size(), 1u);
        const StoreCheck check = store.verify();
        EXPECT_GE(check.problems, 1u);
        EXPECT_TRUE(says(check.first_problems.front(), to_string(root).c_str()));
    }
}

// Bytes of the file, not of a blob: whatever SQLite makes of them, reading ends with an Error or with the right tiles.
TEST_F(StoreFile, FlippedBytesOfTheFileNeverGoUnnoticed) {
    const std::vector<char> whole = bytes(baked("whole.octa"));
    const ElevationStore right = ElevationStore::open(path("whole.octa"));
    const std::vector<LocationCode> roots = right.tiles();
    std::mt19937 random(5);
    int noticed = 0;
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<char> flipped = whole;
        const std::size_t at = trial % 2 ? random() % flipped.size() : random() % 2000 + 16384 * (random() % 3);
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << random() % 8));
        put(path("flipped.octa"), flipped);
        try {
            const ElevationStore store = ElevationStore::open(path("flipped.octa"));
            for (const LocationCode root : roots) {
                const std::optional<Tile> tile = store.read(root);
                ASSERT_TRUE(tile && same(*tile, *right.read(root))) << at;
            }
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            ++noticed;
        }
    }
    EXPECT_GE(noticed, 10);
}

// Damage that a checksum cannot see, because somebody made it: bytes that decompress, but are not a tile.
TEST_F(StoreFile, CraftedTilesNeverCrash) {
    const auto file = baked("a.octa");
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
    sqlite3_stmt* select = nullptr;
    sqlite3_prepare_v2(db, "SELECT code, data FROM tiles ORDER BY code", -1, &select, nullptr);
    const TileScale scale{Placement{}, 0.25, true, {}, 1};
    std::mt19937 random(17);
    int decoded = 0, refused = 0;
    while (sqlite3_step(select) == SQLITE_ROW) {
        const LocationCode root(static_cast<std::uint64_t>(sqlite3_column_int64(select, 0)));
        std::vector<std::uint8_t> payload(1 << 16);
        payload.resize(ZSTD_decompress(payload.data(), payload.size(), sqlite3_column_blob(select, 1),
                                       static_cast<std::size_t>(sqlite3_column_bytes(select, 1))));
        for (int trial = 0; trial < 6; ++trial) {
            std::vector<std::uint8_t> crafted = payload;
            for (int k = 0; k <= trial; ++k)
                crafted[random() % crafted.size()] = static_cast<std::uint8_t>(trial % 2 ? random() : 255);
            if (trial == 5) crafted.resize(random() % crafted.size());
            std::vector<std::uint8_t> frame(ZSTD_compressBound(crafted.size()));
            frame.resize(ZSTD_compress(frame.data(), frame.size(), crafted.data(), crafted.size(), 1));
            try {
                const Tile tile = decode_tile(root, frame, scale);
                EXPECT_TRUE(
                    std::all_of(tile.height.begin(), tile.height.end(), [](float h) { return std::isfinite(h); }));
                ++decoded;
            } catch (const MalformedBytes&) {
                ++refused;
            }
        }
    }
    sqlite3_finalize(select);
    sqlite3_close(db);
    EXPECT_GT(decoded, 10);  // other heights are a tile too
    EXPECT_GT(refused, 10);
}

TEST_F(StoreFile, ATileThatIsListedButMissingIsDamage) {
    const auto file = baked("a.octa");
    const std::vector<LocationCode> roots = ElevationStore::open(file).tiles();
    const LocationCode gone = roots.back();
    ASSERT_GT(gone.bisection_level(), 0);
    sql(file, ("DELETE FROM tiles WHERE code = " + std::to_string(gone.bits())).c_str());
    const ElevationStore store = ElevationStore::open(file);
    EXPECT_THROW(store.read(gone), Error);
    EXPECT_FALSE(store.verify().ok());
    // One that nobody lists is not.
    LocationCode absent = gone;
    while (std::binary_search(roots.begin(), roots.end(), absent)) absent = LocationCode(absent.bits() - 1);
    EXPECT_EQ(store.read(absent), std::nullopt);
    // What has not been written yet is no damage either.
    sql(file, "UPDATE metadata SET value = '0' WHERE key = 'complete'");
    const ElevationStore unfinished = ElevationStore::open(file);
    EXPECT_FALSE(unfinished.metadata().complete);
    EXPECT_EQ(unfinished.read(gone), std::nullopt);
}

TEST_F(StoreFile, AnInterruptedTransactionIsRolledBackOnOpening) {
    const auto file = baked("a.octa");
    const std::vector<char> before = bytes(file);
    // A writer that dies in mid-transaction, after its changes have reached the file.
    const pid_t child = fork();
    if (child == 0) {
        sqlite3* db = nullptr;
        sqlite3_open(file.c_str(), &db);
        sqlite3_exec(db, "PRAGMA cache_size = 1; PRAGMA cache_spill = 1; BEGIN; DELETE FROM tiles;", nullptr, nullptr,
                     nullptr);
        sqlite3_db_cacheflush(db);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(std::filesystem::exists(file.string() + "-journal"));
    ASSERT_NE(bytes(file), before);
    EXPECT_TRUE(ElevationStore::open(file).verify().ok());
    EXPECT_EQ(bytes(file), before);
}

TEST_F(StoreFile, WhatCannotBeWrittenLeavesNothingBehind) {
    EXPECT_THROW(bake(field(), options(), path("no folder") / "a.octa"), Error);
    EXPECT_FALSE(std::filesystem::exists(path("no folder")));
    BakeOptions small = options();
    small.memory_bytes = 1;
    EXPECT_THROW(bake(field(), small, path("b.octa")), Error);
    EXPECT_FALSE(std::filesystem::exists(path("b.octa")));
}

TEST_F(StoreFile, ReadingIsSafeFromSeveralThreads) {
    const ElevationStore store = ElevationStore::open(baked("a.octa"));
    const std::vector<LocationCode> roots = store.tiles();
    const TileCache cache(store, 200000);
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (unsigned t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t);
            for (int i = 0; i < 400; ++i) {
                const LocationCode root = roots[random() % roots.size()];
                const auto tile = cache.tile(root);
                if (!tile || tile->root != root || tile->damaged) ++wrong;
            }
        });
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(cache.memory_bytes(), 200000u);
    EXPECT_TRUE(cache.damage().empty());
}

// ---- the store as a field -------------------------------------------------------------------------------------------

const StoreField& surface() {
    static const StoreField field = [] {
        BakeOptions o;
        o.undulation = testing::bumpy_undulation;
        const BumpyField bumps(2e5, {glm::normalize(glm::dvec3(1, 1, 1)), 0.02}, 4000);
        return StoreField(std::make_shared<const ElevationStore>(bake_in_memory(bumps, o)));
    }();
    return field;
}

TEST(StoreField, AtVerticesItIsTheirHeight) {
    const ElevationStore& store = surface().store();
    for (const LocationCode root : store.tiles()) {
        const Tile tile = *store.read(root);
        const auto normals = tile_normals(root, tile.depth);
        for (unsigned i = 1; i < tile.deviation.size(); i += 7) {
            if (!(tile.deviation[i] > 0)) continue;
            const std::size_t v = tile_layout().split_vertex[i];
            ASSERT_NEAR(surface().height_at(normals[v]), tile.height[v], 2e-3) << to_string(root) << " " << i;
        }
    }
}

TEST(StoreField, BatchesAndSinglePointsAgreeAnywhere) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<glm::dvec3> n{{1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {-1, -0.0, 0}, {0, -1, 0}};
    for (int i = 0; i < 2000; ++i)
        n.push_back(glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))));
    const glm::dvec3 patch = glm::normalize(glm::dvec3(1, 1, 1));
    for (int i = 0; i < 2000; ++i)
        n.push_back(glm::normalize(patch + 0.01 * glm::dvec3(normal(random), normal(random), normal(random))));
    std::vector<float> h(n.size());
    surface().heights(n, h);
    for (std::size_t i = 0; i < n.size(); ++i) ASSERT_EQ(h[i], surface().height_at(n[i])) << i;
}

TEST(StoreField, ALevelStaysWithinItsBoundOfTheFinestSurface) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 3000; ++i) {
        const glm::dvec3 around = i % 2 ? glm::normalize(glm::dvec3(1, 1, 1)) : glm::dvec3(0);
        const glm::dvec3 n =
            glm::normalize(around + (i % 2 ? 0.01 : 1.0) * glm::dvec3(normal(random), normal(random), normal(random)));
        for (const int level : {0, 5, 11, 12, 13, 17, 22, 60}) {
            const double off = std::abs(static_cast<double>(surface().height_at(n, level)) -
                                        static_cast<double>(surface().height_at(n)));
            // Inside finest cells the difference of two planes is at most that at the corners, but for the curvature
            // between normals and the undulation's own bend: some parts in a thousand.
            ASSERT_LE(off, surface().bound_at(n, level).deviation * 1.01 + 0.05) << level;
        }
        EXPECT_EQ(surface().bound_at(n).deviation, 0.0);
    }
}

TEST(StoreField, SpacingIsThatOfTheFinestLevelInTheCap) {
    const glm::dvec3 patch = glm::normalize(glm::dvec3(1, 1, 1));
    EXPECT_NEAR(surface().spacing({patch, 1e-4}), 11292e3 / std::pow(2, 11.5), 10);
    EXPECT_NEAR(surface().spacing({{0, 0, 1}, 3.2}), 11292e3 / std::pow(2, 11.5), 10);
    EXPECT_NEAR(surface().spacing({-patch, 1e-4}), 11292e3 / std::pow(2, 6), 30);
}

TEST(StoreField, WhatIsNoDirectionHasNoHeight) {
    const double nan = std::nan("");
    for (const glm::dvec3 n : {glm::dvec3(0), glm::dvec3(nan, 0, 1), glm::dvec3(INFINITY, 0, 0)}) {
        EXPECT_TRUE(std::isnan(surface().height_at(n)));
        EXPECT_TRUE(std::isnan(surface().height(n)));
    }
}

}  // namespace
}  // namespace planet
