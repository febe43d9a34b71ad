// The streaming bake against the pedestrian one, and against itself: other threads, less memory, interruptions.

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include "bumpy_field.h"
#include "planet/bake/frontier.h"
#include "planet/bake/settling.h"
#include "planet/error.h"
#include "reference_bake.h"

namespace planet {
namespace {

using testing::BumpyField;

// Tiles of three levels over a patch where the equator, a meridian side and a point of valence four meet.
BumpyField corner_field() {
    BumpyField field(4e5, {glm::normalize(glm::dvec3(1, 0.0004, -0.0003)), 4e-4}, 120);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 400; ++i) {
        const double wide = i % 2 ? 1.0 : 4e-4;
        field.extra_samples.push_back(
            glm::normalize(glm::dvec3(1, 0, 0) + wide * glm::dvec3(normal(random), normal(random), normal(random))));
    }
    return field;
}

// Many tiles beside each other, on five faces, around a pole.
BumpyField pole_field() {
    return {2e6, {glm::normalize(glm::dvec3(0.02, 0.01, 1)), 0.3}, 9000};
}

BakeOptions options_with_geoid() {
    BakeOptions o;
    o.least_level = 6;
    o.first_tile_level = 12;  // many tiles
    o.undulation = testing::bumpy_undulation;
    o.undulation_name = "made up";
    o.threads = 1;
    return o;
}

void expect_same(const Tile& a, const Tile& b) {
    const auto N = [](const Tile& t) {
        std::vector<double> m;
        for (const GeoidUndulation u : t.undulation) m.push_back(u.m);
        return m;
    };
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(N(a), N(b));
    EXPECT_EQ(a.deviation, b.deviation);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.child_exists, b.child_exists);
    EXPECT_EQ(a.child_deviation, b.child_deviation);
    EXPECT_EQ(a.child_radius, b.child_radius);
    EXPECT_EQ(a.min_height, b.min_height);
    EXPECT_EQ(a.max_height, b.max_height);
    EXPECT_FLOAT_EQ(a.resampling, b.resampling);
}

void expect_as_reference(const ElevationField& field, const BakeOptions& options) {
    const ElevationStore store = bake_in_memory(field, options);
    const auto reference = testing::reference_bake(field, options, store.metadata());
    ASSERT_EQ(store.tiles().size(), reference.size());
    EXPECT_EQ(store.metadata().tiles, reference.size());
    for (const auto& [root, tile] : reference) {
        SCOPED_TRACE(to_string(root));
        const std::optional<Tile> baked = store.read(root);
        ASSERT_TRUE(baked);
        expect_same(tile, *baked);
        if (::testing::Test::HasFailure()) return;
    }
    const StoreCheck check = store.verify();
    EXPECT_TRUE(check.ok()) << check.first_problems.front();
}

TEST(BakeReference, TheSameTilesOverAPatchAtACorner) {
    expect_as_reference(corner_field(), options_with_geoid());
}

TEST(BakeReference, TheSameTilesAroundAPole) {
    expect_as_reference(pole_field(), options_with_geoid());
}

TEST(BakeReference, TheSameTilesOfAWholePlanet) {
    BakeOptions o = options_with_geoid();
    o.least_level = 15;
    o.undulation = nullptr;
    expect_as_reference(BumpyField(2e6, {}, 2e6), o);
}

// ---- threads, memory, interruptions --------------------------------------------------------------------------------

class BakedFile : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("octaglobe bake test " + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path path(const std::string& name) const { return folder_ / name; }
    static std::vector<char> bytes(const std::filesystem::path& p) {
        std::ifstream in(p, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
    }

  private:
    std::filesystem::path folder_;
};

TEST_F(BakedFile, IsTheSameForAnyNumberOfThreads) {
    BakeOptions o = options_with_geoid();
    bake(pole_field(), o, path("1.octa"));
    for (const int threads : {2, 7}) {
        o.threads = threads;
        bake(pole_field(), o, path("many.octa"));
        EXPECT_EQ(bytes(path("1.octa")), bytes(path("many.octa"))) << threads;
        std::filesystem::remove(path("many.octa"));
    }
    EXPECT_EQ(files(), 1u);  // nothing is left of what it was put together in
}

TEST_F(BakedFile, IsTheSameWithLittleMemory) {
    BakeOptions o = options_with_geoid();
    o.memory_bytes = std::size_t{1} << 30;
    const BakeReport much = bake(pole_field(), o, path("much.octa"));
    // So little that nearly no tile keeps its records while it waits.
    BakeReport little;
    for (o.memory_bytes = std::size_t{8} << 20;; o.memory_bytes += std::size_t{1} << 20) try {
            o.replace = true;
            little = bake(pole_field(), o, path("little.octa"));
            break;
        } catch (const Error& e) {
            ASSERT_EQ(e.fault(), Fault::bad_usage) << e.what();
        }
    EXPECT_EQ(bytes(path("much.octa")), bytes(path("little.octa")));
    EXPECT_LE(little.memory_bytes, o.memory_bytes);
    EXPECT_LT(little.memory_bytes, much.memory_bytes);
}

struct Stop {};

// Bakes until a given call of progress.
bool stopped_at(const ElevationField& field, BakeOptions o, int call, const std::filesystem::path& path) {
    o.progress = [&](std::string_view, double) {
        if (call-- == 0) throw Stop{};
    };
    try {
        bake(field, o, path);
    } catch (const Stop&) {
        return true;
    }
    return false;
}

TEST_F(BakedFile, GoesOnWhereItWasStopped) {
    BakeOptions o = options_with_geoid();
    o.threads = 2;
    bake(pole_field(), o, path("whole.octa"));
    const std::vector<char> whole = bytes(path("whole.octa"));
    o.resume = true;
    o.transaction_tiles = 20;
    std::mt19937 random(5);
    int stops = 0;
    for (int trial = 0; trial < 3; ++trial) {
        // Later and later: what is not final when a bake stops is lost, and may be more than it got to.
        for (int calls = 0; stopped_at(pole_field(), o, calls + static_cast<int>(random() % 50), path("a.octa"));) {
            calls += 20;
            ++stops;
            if (!std::filesystem::exists(path("a.octa"))) continue;
            const ElevationStore store = ElevationStore::open(path("a.octa"));
            // Stopped in the very last call, when all was done.
            EXPECT_TRUE(!store.metadata().complete || bytes(path("a.octa")) == whole);
            const StoreCheck check = store.verify();
            ASSERT_TRUE(check.ok()) << check.first_problems.front();
        }
        ASSERT_EQ(bytes(path("a.octa")), whole);
        std::filesystem::remove(path("a.octa"));
    }
    EXPECT_GT(stops, 5);  // a busy machine hears of progress less often
}

// A process that bakes, telling through a pipe how far it is.
pid_t start_baking(const ElevationField& field, BakeOptions o, const std::filesystem::path& path, int pipe_end) {
    const pid_t child = fork();
    if (child != 0) return child;
    o.progress = [&](std::string_view, double) { static_cast<void>(!write(pipe_end, "x", 1)); };
    try {
        bake(field, o, path);
    } catch (...) {
        _exit(1);
    }
    _exit(0);
}

// Kills it after some calls of progress and a moment more. @returns whether it was still baking
bool killed(pid_t child, int pipe_end, std::uint64_t calls, std::uint64_t microseconds) {
    char byte;
    for (std::uint64_t c = 0; c < calls; ++c)
        if (read(pipe_end, &byte, 1) != 1) break;
    const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(microseconds);
    while (std::chrono::steady_clock::now() < until) std::this_thread::yield();
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    return WIFSIGNALED(status);
}

TEST_F(BakedFile, SurvivesBeingKilledAtAnyMoment) {
    BakeOptions o = options_with_geoid();
    bake(corner_field(), o, path("whole.octa"));
    const std::vector<char> whole = bytes(path("whole.octa"));
    o.resume = true;
    o.threads = 2;
    o.transaction_tiles = 8;
    std::mt19937 random(9);
    int kills = 0, unfinished = 0, finished = 0;
    while (kills < 60 || finished == 0) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = start_baking(corner_field(), o, path("a.octa"), ends[1]);
        close(ends[1]);
        const bool was_killed = killed(child, ends[0], random() % 60, random() % 4000);
        close(ends[0]);
        kills += was_killed;
        if (!std::filesystem::exists(path("a.octa")) || std::filesystem::file_size(path("a.octa")) == 0) continue;
        const ElevationStore store = ElevationStore::open(path("a.octa"));
        const StoreCheck check = store.verify();
        ASSERT_TRUE(check.ok()) << check.first_problems.front();
        unfinished += !store.metadata().complete && check.tiles > 0;
        if (!store.metadata().complete) continue;
        ++finished;
        ASSERT_EQ(bytes(path("a.octa")), whole);
        std::filesystem::remove(path("a.octa"));
    }
    EXPECT_GT(unfinished, 10);
}

std::string refusal(const ElevationField& field, const BakeOptions& o, const std::filesystem::path& path) {
    try {
        bake(field, o, path);
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_usage) << e.what();
        EXPECT_EQ(std::string(e.what()).find(path.string()), 0u) << e.what();
        return e.what();
    }
    return "accepted";
}

::testing::AssertionResult says(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "\"" << text << "\" does not say \"" << part << "\"";
}

TEST_F(BakedFile, ThatIsThereIsNeitherReplacedNorResumedUnasked) {
    BakeOptions o = options_with_geoid();
    std::ofstream(path("text.octa")) << "not a store";
    EXPECT_TRUE(says(refusal(corner_field(), o, path("text.octa")), "there already"));
    EXPECT_EQ(bytes(path("text.octa")).size(), 11u);
    ASSERT_TRUE(stopped_at(corner_field(), o, 5, path("a.octa")));
    EXPECT_TRUE(says(refusal(corner_field(), o, path("a.octa")), "--resume"));
    o.resume = true;
    EXPECT_THROW(bake(corner_field(), o, path("text.octa")), Error);
    EXPECT_EQ(bytes(path("text.octa")).size(), 11u);
    o.resume = false;
    o.replace = true;
    bake(corner_field(), o, path("text.octa"));
    EXPECT_TRUE(ElevationStore::open(path("text.octa"), wgs84).verify().ok());
}

TEST_F(BakedFile, IsNotResumedWithOtherSourcesOrOptions) {
    const BakeOptions right = options_with_geoid();
    ASSERT_TRUE(stopped_at(corner_field(), right, 8, path("half.octa")));
    bake(corner_field(), right, path("whole.octa"));
    for (const char* name : {"half.octa", "whole.octa"}) {
        const auto spoilt = [&](void (*spoil)(BakeOptions&)) {
            BakeOptions o = right;
            o.resume = true;
            spoil(o);
            const std::vector<char> before = bytes(path(name));
            const std::string line = refusal(corner_field(), o, path(name));
            EXPECT_EQ(bytes(path(name)), before);
            return line;
        };
        EXPECT_TRUE(says(spoilt([](BakeOptions& o) { o.least_level = 7; }), "least level 6, not 7"));
        EXPECT_TRUE(says(spoilt([](BakeOptions& o) { o.finest_level = 30; }), "finest level 60, not 30"));
        EXPECT_TRUE(says(spoilt([](BakeOptions& o) { o.extra_levels = 1; }), "extra levels 0, not 1"));
        EXPECT_TRUE(says(spoilt([](BakeOptions& o) { o.quantum_m = 0.5; }), "quantum 0"));
        EXPECT_TRUE(says(spoilt([](BakeOptions& o) { o.ellipsoid = mars; }), "the planet wgs84"));
        EXPECT_TRUE(
            says(spoilt([](BakeOptions& o) { o.undulation_name = "else"; }), "the geoid \"made up\", not \"else\""));
    }
    BakeOptions o = right;
    o.resume = true;
    const BumpyField other(5e5, {}, 5e5);  // another spacing, though its checksum is the same
    EXPECT_TRUE(says(refusal(other, o, path("half.octa")), "source 1 bumps"));
}

TEST_F(BakedFile, ThatIsFinishedIsLeftAloneByResume) {
    BakeOptions o = options_with_geoid();
    const BakeReport first = bake(corner_field(), o, path("a.octa"));
    EXPECT_EQ(first.vertices_resumed, 0u);
    const std::vector<char> before = bytes(path("a.octa"));
    const auto time = std::filesystem::last_write_time(path("a.octa"));
    o.resume = true;
    o.progress = [](std::string_view, double) { FAIL(); };
    const BakeReport again = bake(corner_field(), o, path("a.octa"));
    EXPECT_EQ(bytes(path("a.octa")), before);
    EXPECT_EQ(std::filesystem::last_write_time(path("a.octa")), time);
    EXPECT_EQ(again.tiles, first.tiles);
    EXPECT_EQ(again.vertices_resumed, first.vertices);
    EXPECT_EQ(again.resampling_max_m, first.resampling_max_m);
}

TEST_F(BakedFile, ThatIsMissingOrEmptyIsBegunByResume) {
    BakeOptions o = options_with_geoid();
    o.resume = true;
    std::ofstream(path("empty.octa"));
    bake(corner_field(), o, path("empty.octa"));
    bake(corner_field(), o, path("missing.octa"));
    EXPECT_EQ(bytes(path("empty.octa")), bytes(path("missing.octa")));
}

TEST_F(BakedFile, ThatIsNotFinishedIsNotDrawn) {
    ASSERT_TRUE(stopped_at(corner_field(), options_with_geoid(), 8, path("half.octa")));
    EXPECT_FALSE(ElevationStore::open(path("half.octa")).metadata().complete);
    try {
        ElevationStore::open(path("half.octa"), wgs84);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data);
        EXPECT_TRUE(says(e.what(), path("half.octa").string()));
        EXPECT_TRUE(says(e.what(), "--resume"));
    }
}

TEST_F(BakedFile, ThatIsDamagedIsNotResumed) {
    BakeOptions o = options_with_geoid();
    o.transaction_tiles = 4;
    ASSERT_TRUE(stopped_at(corner_field(), o, 60, path("a.octa")));
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path("a.octa").c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, "UPDATE unfinished SET data = CAST(zeroblob(100) || substr(data, 101) AS BLOB)", nullptr,
                           nullptr, nullptr),
              SQLITE_OK);
    ASSERT_GT(sqlite3_changes(db), 0);
    sqlite3_close(db);
    o.resume = true;
    try {
        bake(corner_field(), o, path("a.octa"));
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data);
        EXPECT_TRUE(says(e.what(), "damaged"));
        EXPECT_TRUE(says(e.what(), "--replace"));
    }
}

TEST_F(BakedFile, IsBakedByOneAtATime) {
    BakeOptions o = options_with_geoid();
    o.transaction_tiles = 4;
    int calls = 0;
    bool refused = false;
    o.progress = [&](std::string_view, double) {
        if (++calls != 8) return;
        BakeOptions second = options_with_geoid();
        second.resume = true;
        try {
            bake(corner_field(), second, path("a.octa"));
        } catch (const Error& e) {
            refused = true;
            EXPECT_TRUE(says(e.what(), path("a.octa").string()));
        }
    };
    bake(corner_field(), o, path("a.octa"));
    EXPECT_TRUE(refused);
    EXPECT_TRUE(ElevationStore::open(path("a.octa"), wgs84).verify().ok());
}

TEST_F(BakedFile, ProgressRisesToItsEnd) {
    BakeOptions o = options_with_geoid();
    o.threads = 3;
    std::vector<std::string> steps;
    double last = 0;
    const std::thread::id here = std::this_thread::get_id();
    o.progress = [&](std::string_view step, double fraction) {
        EXPECT_EQ(std::this_thread::get_id(), here);
        if (steps.empty() || steps.back() != step) {
            EXPECT_TRUE(steps.empty() || last == 1) << step;
            steps.emplace_back(step);
            last = 0;
        }
        EXPECT_GE(fraction, last);
        EXPECT_LE(fraction, 1);
        last = fraction;
    };
    const BakeReport report = bake(pole_field(), o, path("a.octa"));
    EXPECT_EQ(steps, (std::vector<std::string>{"coverage", "tiles", "finishing"}));
    std::set<std::string> timed;
    for (const auto& [step, seconds] : report.seconds) {
        EXPECT_GE(seconds, 0) << step;
        timed.insert(step);
    }
    EXPECT_EQ(timed, (std::set<std::string>{"coverage", "resampling", "deviation", "settling", "certifying",
                                            "compression", "writing"}));
}

// ---- the arithmetic it rests on ------------------------------------------------------------------------------------

// The tiles with a diamond that one of this tile's depends on, found by following every dependency.
std::set<LocationCode> tiles_depended_on(LocationCode tile) {
    std::set<std::uint64_t> seen;
    std::vector<LocationCode> next;
    const auto visit = [&](LocationCode c) {
        if (seen.insert(c.bits()).second) next.push_back(c);
    };
    std::set<LocationCode> tiles;
    for (unsigned i = 1; i < tile_cells; ++i) visit(cell_code(tile, i));
    while (!next.empty()) {
        const LocationCode c = next.back();
        next.pop_back();
        tiles.insert(c.ancestor(tile.bisection_level()));
        visit(neighbor(c));
        if (c.bisection_level() + 1 == tile.bisection_level() + tile_levels) continue;
        visit(c.child(0));
        visit(c.child(1));
    }
    tiles.erase(tile);
    return tiles;
}

std::vector<LocationCode> some_tiles() {
    std::vector<LocationCode> tiles;
    std::mt19937_64 random(1);
    for (int face = 0; face < face_count; ++face) {
        tiles.push_back(LocationCode::face_root(face));
        for (const std::uint64_t path : {0u, 4095u, 2047u, 2048u, 1365u, 2730u})
            tiles.push_back(LocationCode::from_path(face, 12, path));
        for (int k = 0; k < 6; ++k) tiles.push_back(LocationCode::from_path(face, 24, random() % (1 << 24)));
    }
    return tiles;
}

TEST(TilesAround, HoldAllThatATileDependsOn) {
    for (const LocationCode tile : some_tiles()) {
        const auto around = tiles_around(tile);
        EXPECT_LE(around.size(), 16u);
        for (const LocationCode needed : tiles_depended_on(tile))
            EXPECT_EQ(std::count(around.begin(), around.end(), needed), 1) << to_string(tile) << to_string(needed);
    }
}

TEST(TilesAround, AreMutual) {
    for (const LocationCode tile : some_tiles()) {
        for (const LocationCode other : tiles_around(tile)) {
            const auto around = tiles_around(other);
            EXPECT_NE(other, tile);
            EXPECT_EQ(std::count(around.begin(), around.end(), tile), 1) << to_string(tile) << to_string(other);
        }
    }
}

TEST(SideCellsAcross, AreTheOtherCellsOfTheirDiamonds) {
    const auto sides = side_cells(tile_levels);
    for (const LocationCode tile : some_tiles())
        for (std::size_t k = 0; k < sides.size(); ++k) {
            const CellInTile across = cell_in_tile(neighbor(cell_code(tile, sides[k].cell)), {});
            ASSERT_EQ(across.root, neighbor(tile, sides[k].side));
            ASSERT_EQ(across.local, sides[side_cells_across()[k]].cell);
        }
}

}  // namespace
}  // namespace planet
