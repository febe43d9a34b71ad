// Stores whose tiles begin at any levels: the same surface, as sound and as free of cracks, whatever the first level is.

#include "planet/mesh/tile_layers.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "patchy_store.h"
#include "planet/bake/layer_choice.h"
#include "planet/error.h"
#include "planet/store/store_field.h"
#include "planet/store/tile_sides.h"
#include "planet/streaming/resident_set.h"
#include "planet/streaming/store_tiles.h"
#include "reference_bake.h"

namespace planet {
namespace {

using testing::BumpyField;
using testing::patchy_store;

TEST(TileLayers, ATileHoldsEachCellAndIsBelowTheOneAbove) {
    std::mt19937_64 random(1);
    for (int first = 1; first <= tile_levels; ++first) {
        const TileLayers layers{first};
        for (int level = 0; level < max_bisection_level; ++level) {
            const LocationCode cell =
                LocationCode::from_path(static_cast<int>(random() % 8), level, random() >> 4 >> (60 - level));
            const auto [root, local] = cell_in_tile(cell, layers);
            ASSERT_EQ(cell_code(root, local), cell);
            ASSERT_LT(relative_level(local), layers.depth(root.bisection_level()));
            ASSERT_TRUE(layers.begin_at(root.bisection_level()));
            ASSERT_EQ(layers.begin_at(level), root == cell);
            if (root.bisection_level() == 0) {
                ASSERT_EQ(layers.layer(level), 0u);
                continue;
            }
            const LocationCode above = layers.above(root);
            ASSERT_EQ(layers.layer(level), layers.layer(above.bisection_level()) + 1);
            ASSERT_EQ(above.bisection_level() + layers.depth(above.bisection_level()), root.bisection_level());
            ASSERT_EQ(cell_code(above, layers.local_above(root)), root);
            ASSERT_EQ(layers.below(above, layers.position(root)), root);
        }
    }
}

// ---- where they begin ----------------------------------------------------------------------------------------------

// Fine in one place.
TileLayers choice(double coarse_m, double fine_m, double angle) {
    return cheapest_layers(BumpyField(coarse_m, {glm::normalize(glm::dvec3(1, 2, 3)), angle}, fine_m), {});
}

TEST(CheapestLayers, MakeTheTilesWholeThatMostOfTheFinestCellsAreIn) {
    const double level_37 = 30.5, level_32 = 173, level_21 = 7900;  // metres between vertices
    EXPECT_EQ(choice(4e5, level_37, 1e-3).first, 1);
    EXPECT_EQ(choice(4e5, level_32, 3e-2).first, 8);
    // A whole planet, with an area that is too small to matter.
    EXPECT_EQ(choice(level_21, level_32, 1e-6).first, 9);
    // Nothing to gain: more tiles all over the planet than there are to save.
    EXPECT_EQ(choice(4e5, level_32, 1e-4).first, 12);
    EXPECT_EQ(choice(4e5, 4e5, 0).first, 12);
}

TEST(CheapestLayers, AreThoseOfABakeUnlessItIsTold) {
    const BumpyField field(4e5, {glm::normalize(glm::dvec3(1, 2, 3)), 3e-4}, 30.5);
    BakeOptions o;
    const ElevationStore chosen = bake_in_memory(field, o);
    EXPECT_EQ(chosen.metadata().layers, cheapest_layers(field, {}));
    EXPECT_LE(chosen.metadata().layers.first, 2);
    o.first_tile_level = 12;
    EXPECT_EQ(bake_in_memory(field, o).metadata().layers.first, 12);
    for (const int wrong : {-1, 13}) {
        o.first_tile_level = wrong;
        EXPECT_THROW(bake_in_memory(field, o), Error);
    }
}

// ---- stores ---------------------------------------------------------------------------------------------------------

class AnyFirstLevel : public ::testing::TestWithParam<int> {
  protected:
    int first() const { return GetParam(); }
    const ElevationStore& patches() const { return patchy_store(first()); }
};
INSTANTIATE_TEST_SUITE_P(, AnyFirstLevel, ::testing::Range(1, tile_levels + 1));

TEST_P(AnyFirstLevel, AStoreVerifies) {
    EXPECT_EQ(patches().metadata().layers.first, first());
    const StoreCheck check = patches().verify();
    EXPECT_TRUE(check.ok()) << check.first_problems.front();
    for (const LocationCode root : patches().tiles())
        EXPECT_TRUE(patches().metadata().layers.begin_at(root.bisection_level()));
}

TEST_P(AnyFirstLevel, ABakeIsThePedestrianOne) {
    const BumpyField field(4e6, {glm::normalize(glm::dvec3(1, 0.0004, -0.0003)), 4e-4}, 300);
    BakeOptions o;
    o.least_level = 6;
    o.first_tile_level = first();
    o.undulation = testing::bumpy_undulation;
    const ElevationStore store = bake_in_memory(field, o);
    const auto reference = testing::reference_bake(field, o, store.metadata());
    ASSERT_EQ(store.tiles().size(), reference.size());
    for (const auto& [root, tile] : reference) {
        const std::optional<Tile> baked = store.read(root);
        ASSERT_TRUE(baked) << to_string(root);
        ASSERT_EQ(baked->height, tile.height);
        ASSERT_EQ(baked->deviation, tile.deviation) << to_string(root);
        ASSERT_EQ(baked->radius, tile.radius) << to_string(root);
        ASSERT_EQ(baked->child_exists, tile.child_exists);
        ASSERT_EQ(baked->child_deviation, tile.child_deviation);
        ASSERT_EQ(baked->child_radius, tile.child_radius);
    }
}

TEST_P(AnyFirstLevel, ABakeThatIsStoppedGoesOnToTheSameBytes) {
    const BumpyField field(4e6, {glm::normalize(glm::dvec3(1, 0.0004, -0.0003)), 4e-4}, 300);
    const auto path = std::filesystem::temp_directory_path() / ("octaglobe stopped " + std::to_string(getpid()));
    const auto bytes = [&] {
        std::ifstream in(path, std::ios::binary);
        return std::vector<char>(std::istreambuf_iterator<char>(in), {});
    };
    BakeOptions o;
    o.least_level = 6;
    o.first_tile_level = first();
    o.transaction_tiles = 8;
    o.replace = true;
    bake(field, o, path);
    const std::vector<char> whole = bytes();
    for (const double moment : {0.3, 0.8}) {
        BakeOptions stopped = o;
        stopped.progress = [&](std::string_view step, double fraction) {
            if (step == "tiles" && fraction >= moment) throw std::runtime_error("stopped");
        };
        EXPECT_THROW(bake(field, stopped, path), std::runtime_error);
        EXPECT_FALSE(ElevationStore::open(path).metadata().complete);
        BakeOptions resumed = o;
        resumed.replace = false;
        resumed.resume = true;
        bake(field, resumed, path);
        EXPECT_EQ(bytes(), whole);
    }
    std::filesystem::remove(path);
}

const ElevationStore& uniform_store(int first) {
    static std::map<int, ElevationStore> baked;
    const auto found = baked.find(first);
    if (found != baked.end()) return found->second;
    BakeOptions o;
    o.least_level = 14;
    o.first_tile_level = first;
    o.undulation = testing::bumpy_undulation;
    return baked.emplace(first, bake_in_memory(BumpyField(2e6, {}, 2e6), o)).first->second;
}

// Deviations are those of the same vertices. Tiles round them up the ladder in different places, which is done once or
// not at all: they lie on or below the same step.
TEST_P(AnyFirstLevel, TheLatticeIsTheSame) {
    const ElevationStore &store = uniform_store(first()), &other = uniform_store(12);
    std::map<LocationCode, Tile> tiles;
    for (const LocationCode root : other.tiles()) tiles.emplace(root, *other.read(root));
    std::size_t cells = 0;
    for (const LocationCode root : store.tiles()) {
        const Tile tile = *store.read(root);
        for (unsigned i = 1; i < 1u << tile.depth; ++i, ++cells) {
            const auto [there, local] = cell_in_tile(cell_code(root, i), other.metadata().layers);
            const Tile& same = tiles.at(there);
            const std::size_t v = tile_layout().split_vertex[i], w = tile_layout().split_vertex[local];
            ASSERT_EQ(tile.height[v], same.height[w]);
            ASSERT_EQ(tile.undulation[v].m, same.undulation[w].m);
            ASSERT_EQ(deviation_code(tile.deviation[i]), deviation_code(same.deviation[local]));
            ASSERT_NEAR(tile.radius[i], same.radius[local], 0.03f * same.radius[local]);
        }
    }
    EXPECT_EQ(cells, std::size_t{8} * ((1 << 14) - 1));
}

TEST_P(AnyFirstLevel, HeightsAreTheSameWhereTheSurfaceIsTheFinest) {
    const auto borrowed = [](const ElevationStore& s) {
        return std::shared_ptr<const ElevationStore>(&s, [](auto) {});
    };
    const StoreField here(borrowed(patches())), there(borrowed(patchy_store(12)));
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    for (const auto& patch : testing::PatchyField::patches)
        for (int i = 0; i < 300; ++i) {
            const double wide = 0.4 * patch.cap.angle;
            const glm::dvec3 n = glm::normalize(
                patch.cap.centre + wide * glm::dvec3(normal(random), normal(random), normal(random)) / 2.0);
            if (std::acos(std::min(1.0, glm::dot(n, patch.cap.centre))) > 0.9 * patch.cap.angle) continue;
            ASSERT_EQ(here.height_at(n), there.height_at(n));
            ASSERT_LE(here.bound_at(n, 9).deviation, 1.06 * there.bound_at(n, 9).deviation);
        }
    for (const auto& patch : testing::PatchyField::patches)
        EXPECT_EQ(here.spacing({patch.cap.centre, 1e-6}), there.spacing({patch.cap.centre, 1e-6}));
}

// ---- drawing --------------------------------------------------------------------------------------------------------

TEST_P(AnyFirstLevel, NoWalkMeetsACrackWhicheverTilesAreThere) {
    const TileLayers layers = patches().metadata().layers;
    const std::vector<LocationCode> roots = patches().tiles();
    std::mt19937 random(static_cast<unsigned>(first()));
    ResidentSet set(layers);
    const std::function<void(LocationCode)> add = [&](LocationCode root) {
        if (set.find(root)) return;
        if (root.bisection_level() > 0) add(layers.above(root));
        auto tile = std::make_unique<PlacedTile>(*patches().read(root), Placement{});
        tile->close();
        set.open(set.insert(std::move(tile), tile_support(root, patches().read(root)->depth)), tile_levels);
    };
    for (int face = 0; face < face_count; ++face) add(LocationCode::face_root(face));
    for (int step = 0; step < 3; ++step) {
        // Most of the tiles, those that are deep first: the others are many and shallow, with some first levels.
        for (const LocationCode root : roots)
            if (random() % 8 < (root.bisection_level() > 12 ? 5 : 1)) add(root);
        for (int k = 0; k < 200; ++k) {
            ResidentTile* const tile = set.find(roots[random() % roots.size()]);
            if (tile && tile->children == 0 && tile->root.bisection_level() > 0) set.erase(tile->root);
        }
        set.settle();
        for (const SegmentView& view : testing::patchy_views())
            ASSERT_EQ(testing::crack_in(set, view.test), "") << view.test.eye.x;
    }
}

TEST_P(AnyFirstLevel, AWholeStoreIsWalkedAsTheOthersAreWithinTheirRoundings) {
    const TileCache cache(patches()), other_cache(patchy_store(12));
    const StoreTiles tiles(cache, Placement{}), other(other_cache, Placement{});
    for (const SegmentView& view : testing::patchy_views()) {
        ASSERT_EQ(testing::crack_in(tiles, view.test), "");
        const std::size_t triangles = refine_planet(tiles, view.test).triangles.size(),
                          others = refine_planet(other, view.test).triangles.size();
        EXPECT_NEAR(static_cast<double>(triangles), static_cast<double>(others), 0.12 * static_cast<double>(others));
    }
}

TEST_P(AnyFirstLevel, SegmentsThatAreUpdatedAreThoseMadeAnew) {
    const TileCache cache(patches());
    const StoreTiles tiles(cache, Placement{});
    Segments updated, anew;
    for (SegmentView view : testing::patchy_views()) {
        view.morph = true;
        updated.update(tiles, view);
        anew.build(tiles, view);
        ASSERT_EQ(updated.hash(), anew.hash());
        ASSERT_LE(anew.ratio_max(), 1);
    }
}

// What a tile knows of the roots below must never say "leaf" where the tile below says "split": that would be a crack.
TEST_P(AnyFirstLevel, BoundsOfChildrenPassWhateverTheChildPasses) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const double exaggeration : {1.0, 5.0}) {
        const TileCache cache(patches());
        const StoreTiles tiles(cache, Placement{wgs84, exaggeration});
        const std::vector<LocationCode> roots = patches().tiles();
        std::size_t known = 0;
        for (std::size_t t = 0; t < roots.size(); t += 1 + roots.size() / 2000) {
            if (roots[t].bisection_level() == 0) continue;
            const TileLayers layers = tiles.layers();
            const SplitRecord bound = tiles.tile(layers.above(roots[t]))->child_bound[layers.position(roots[t])];
            const SplitRecord exact = tiles.tile(roots[t])->split[1];
            if (exact.deviation == 0) continue;
            ++known;
            const glm::dvec3 m(exact.x, exact.y, exact.z);
            for (int i = 0; i < 20; ++i) {
                SplitTest test{{}, 1000 * (1 + unit(random))};
                const double reach = static_cast<double>(exact.radius) + test.K * static_cast<double>(exact.deviation);
                test.eye =
                    m + glm::normalize(glm::dvec3(unit(random), unit(random), unit(random))) * (reach * 0.9999999);
                ASSERT_TRUE(test(exact));
                ASSERT_TRUE(test(bound)) << to_string(roots[t]);
            }
        }
        EXPECT_GT(known, 10u);
    }
}

TEST_P(AnyFirstLevel, PlacedTilesKnowWhereTilesAreBelow) {
    for (const LocationCode root : patches().tiles()) {
        if (root.bisection_level() > 13) break;
        const Tile tile = *patches().read(root);
        const PlacedTile placed(tile, Placement{});
        const unsigned cells = 1u << tile.depth;
        std::vector<bool> below(std::size_t{2} * cells);
        for (unsigned i = 2 * cells - 1; i >= 1; --i) {
            below[i] = i >= cells ? tile.child_exists[i - cells] : below[2 * i] || below[2 * i + 1];
            ASSERT_EQ(placed.has_child_below(i), below[i]) << i;
        }
    }
}

// ---- the file -------------------------------------------------------------------------------------------------------

class LayersFile : public ::testing::Test {
  protected:
    void SetUp() override {
        path_ = std::filesystem::temp_directory_path() / ("octaglobe layers " + std::to_string(getpid()) + ".octa");
        BakeOptions o;
        o.finest_level = o.least_level = 6;
        o.replace = true;
        bake(BumpyField(2e6, {}, 2e6), o, path_);
    }
    void TearDown() override { std::filesystem::remove(path_); }

    void run(const std::string& sql) const {
        sqlite3* file = nullptr;
        ASSERT_EQ(sqlite3_open(path_.c_str(), &file), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(file, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(file);
        sqlite3_close(file);
    }
    // The checksum of what is there, with the one source of this field.
    void seal() const {
        sqlite3* file = nullptr;
        ASSERT_EQ(sqlite3_open(path_.c_str(), &file), SQLITE_OK);
        std::uint64_t h = 0xcbf29ce484222325u;
        const auto add = [](void* hash, int columns, char** text, char**) {
            for (int c = 0; c < columns; ++c)
                for (const char* at = text[c]; *at != 0; ++at)
                    *static_cast<std::uint64_t*>(hash) =
                        (*static_cast<std::uint64_t*>(hash) ^ static_cast<unsigned char>(*at)) * 0x100000001b3u;
            return 0;
        };
        sqlite3_exec(file,
                     "SELECT key || '=' || value || char(10) FROM metadata WHERE key NOT IN ('checksum', 'complete') "
                     "ORDER BY key",
                     add, &h, nullptr);
        sqlite3_exec(file,
                     "SELECT name || char(10) || checksum || char(10) || crs || char(10) || datum || char(10) || "
                     "'2e+06' || char(10) FROM sources",
                     add, &h, nullptr);
        sqlite3_close(file);
        std::array<char, 20> text{};
        std::snprintf(text.data(), text.size(), "%llx", static_cast<unsigned long long>(h));
        run(std::string("UPDATE metadata SET value = '") + text.data() + "' WHERE key = 'checksum'");
    }
    std::filesystem::path path_;
};

TEST_F(LayersFile, OfVersion2HasTilesAtEveryTwelfthLevel) {
    run("DELETE FROM metadata WHERE key IN ('first_tile_level', 'vertices_by_level'); PRAGMA user_version = 2");
    seal();
    const ElevationStore store = ElevationStore::open(path_);
    EXPECT_EQ(store.metadata().format_version, 2);
    EXPECT_EQ(store.metadata().layers, TileLayers{12});
    EXPECT_TRUE(store.verify().ok());
}

TEST_F(LayersFile, MustSayWhereTilesBegin) {
    for (const char* value : {"0", "13", "x"}) {
        run(std::string("UPDATE metadata SET value = '") + value + "' WHERE key = 'first_tile_level'");
        seal();
        EXPECT_THROW(ElevationStore::open(path_), Error) << value;
    }
    run("DELETE FROM metadata WHERE key = 'first_tile_level'");
    seal();
    EXPECT_THROW(ElevationStore::open(path_), Error);
}

}  // namespace
}  // namespace planet
