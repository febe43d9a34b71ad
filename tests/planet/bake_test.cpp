#include "planet/bake/bake.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "bumpy_field.h"
#include "planet/bake/coverage.h"
#include "planet/error.h"
#include "planet/mesh/deviation.h"
#include "planet/mesh/view.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/tile_cache.h"
#include "planet/store/tile_codec.h"
#include "planet/store/tile_sides.h"

namespace planet {
namespace {

using testing::BumpyField;

// Four levels of tiles' worth of depth over a mountain-sized patch at E_0's corner, where three kinds of seams meet:
// the equator, a meridian side and a point of valence four.
BumpyField patch_at_a_corner() {
    return {4e5, {glm::normalize(glm::dvec3(1, 0.0004, -0.0003)), 2e-4}, 150};
}

BakeOptions with_geoid() {
    BakeOptions o;
    o.undulation = testing::bumpy_undulation;
    o.undulation_name = "made up";
    o.first_tile_level = 12;
    return o;
}

const ElevationStore& patch_store() {
    static const ElevationStore store = bake_in_memory(patch_at_a_corner(), with_geoid());
    return store;
}

// All tiles of a store by code.
std::map<LocationCode, Tile> all_tiles(const ElevationStore& store) {
    std::map<LocationCode, Tile> tiles;
    for (const LocationCode root : store.tiles()) tiles.emplace(root, *store.read(root));
    return tiles;
}

struct Record {
    const Tile* tile;
    unsigned local;
    float deviation() const { return tile->deviation[local]; }
    float radius() const { return tile->radius[local]; }
};

std::optional<Record> record(const std::map<LocationCode, Tile>& tiles, LocationCode cell) {
    const auto [root, local] = cell_in_tile(cell, {});
    const auto found = tiles.find(root);
    if (found == tiles.end() || local >> found->second.depth) return std::nullopt;
    return Record{&found->second, local};
}

glm::dvec3 place(const Tile& t, std::size_t v, const glm::dvec3& n) {
    return Placement{}.ecef(n, static_cast<double>(t.height[v]), t.undulation[v]);
}

TEST(Bake, VerifiesWithAllItsLevels) {
    const StoreCheck check = patch_store().verify();
    EXPECT_TRUE(check.ok()) << check.first_problems.front();
    EXPECT_EQ(check.tiles, patch_store().metadata().tiles);
    EXPECT_GT(check.side_records, 5000u);
    EXPECT_EQ(patch_store().metadata().finest_level, 33);  // 11,292 km / 2^16.5 = 122 m <= 150 m
    std::map<int, int> tiles_at;
    for (const LocationCode root : patch_store().tiles()) ++tiles_at[root.bisection_level()];
    EXPECT_EQ(tiles_at[0], 8);
    EXPECT_GE(tiles_at[12], 4);
    EXPECT_GE(tiles_at[24], 12);
}

TEST(Bake, WantedTilesCanBeRefinedFully) {
    const auto tiles = all_tiles(patch_store());
    int wanted = 0;
    for (const auto& [root, tile] : tiles) {
        const Cap cap = cap_of(root);
        if (root.bisection_level() != 24 || patch_at_a_corner().spacing(cap) > 200) continue;
        ++wanted;
        EXPECT_EQ(tile.depth, 9);
        for (unsigned i = 1; i < 1u << tile.depth; ++i) ASSERT_GT(tile.deviation[i], 0) << to_string(root) << " " << i;
    }
    EXPECT_GE(wanted, 4);
}

TEST(Bake, ADiamondExistsIfBothCellsHaveRecordsAndBothParentsExist) {
    const auto tiles = all_tiles(patch_store());
    std::size_t existing = 0, absent = 0;
    for (const auto& [root, tile] : tiles) {
        for (unsigned i = 1; i < 1u << tile.depth; ++i) {
            const LocationCode cell = cell_code(root, i), beyond = neighbor(cell);
            bool exists = record(tiles, beyond).has_value();
            if (cell.bisection_level() > 0)
                for (const LocationCode c : {cell, beyond}) {
                    const auto parent = record(tiles, c.parent());
                    exists = exists && parent && parent->deviation() > 0;
                }
            ASSERT_EQ(tile.deviation[i] > 0, exists) << to_string(cell);
            ++(exists ? existing : absent);
        }
    }
    EXPECT_GT(existing, 30000u);
    EXPECT_GT(absent, 1000u);
}

// Brute force over every finest vertex: gathers, for every cell above a leaf cell, the largest distance along the
// normal.
class BruteForce {
  public:
    explicit BruteForce(const std::map<LocationCode, Tile>& tiles) : tiles_(tiles) {
        for (int f = 0; f < face_count; ++f) {
            path_.clear();
            visit(LocationCode::face_root(f), face_corners(f), tiles.at(LocationCode::face_root(f)), 1);
        }
    }
    std::map<LocationCode, double> worst;

  private:
    struct Above {
        LocationCode cell;
        CellPlane plane;
    };
    void visit(LocationCode cell, const Corners& c, const Tile& tile, unsigned local) {
        const auto own = record(tiles_, cell);
        if (!own || own->deviation() == 0) return test(c, tile, local);
        const auto& vertex = tile_layout().corners[own->local];
        path_.push_back({cell, CellPlane(place(*own->tile, vertex[0], c.left), place(*own->tile, vertex[1], c.right),
                                         place(*own->tile, vertex[2], c.apex))});
        const glm::dvec3 m = split_vertex(c);
        for (int i = 0; i < 2; ++i)
            visit(cell.child(i), child_corners(c, m, i), *own->tile, 2 * own->local + static_cast<unsigned>(i));
        path_.pop_back();
    }
    void test(const Corners& c, const Tile& tile, unsigned local) {
        const auto& vertex = tile_layout().corners[local];
        const glm::dvec3 normal[3] = {c.left, c.right, c.apex};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p = place(tile, vertex[k], normal[k]);
            for (const Above& a : path_) {
                double& w = worst[a.cell];
                w = std::max(w, std::abs(a.plane.above(p, normal[k])));
            }
        }
    }
    const std::map<LocationCode, Tile>& tiles_;
    std::vector<Above> path_;
};

TEST(Bake, DeviationsAreExactAndSaturated) {
    const auto tiles = all_tiles(patch_store());
    const BruteForce brute(tiles);
    std::size_t exact = 0, cells = 0;
    for (const auto& [cell, worst] : brute.worst) {
        const Record r = *record(tiles, cell);
        ASSERT_GE(r.deviation(), worst) << to_string(cell);
        // What is stored can be larger only by saturation and by the steps of the ladder.
        double largest = std::max(worst, brute.worst.at(neighbor(cell)));
        bool saturated = false;
        for (const LocationCode c : {cell, neighbor(cell)})
            for (int i = 0; i < 2; ++i)
                if (const auto below =
                        c.bisection_level() < max_bisection_level ? record(tiles, c.child(i)) : std::nullopt)
                    saturated = saturated || static_cast<double>(below->deviation()) > largest;
        ++cells;
        if (saturated) continue;
        ++exact;
        const bool stepped = r.tile->child_exists.any() || record(tiles, neighbor(cell))->tile != r.tile;
        ASSERT_LE(static_cast<double>(r.deviation()),
                  std::max(largest * (stepped ? 1.0595 : 1 + 2e-7) + 1e-7, stepped ? 0.01000001 : 0.0))
            << to_string(cell);
    }
    EXPECT_GT(exact, cells / 2);
    EXPECT_GT(cells, 20000u);
}

TEST(Bake, NoDiamondPassesTheTestWhoseParentsFail) {
    const auto tiles = all_tiles(patch_store());
    std::map<LocationCode, PlacedTile> placed;
    for (const auto& [root, tile] : tiles) placed.emplace(root, PlacedTile(tile, Placement{}));
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::size_t passed = 0, failed = 0;
    for (int view = 0; view < 120; ++view) {
        const double up = std::pow(10.0, 1 + 6 * (view % 20) / 20.0);
        const glm::dvec3 n = glm::normalize(glm::dvec3(1, 4e-4 * uniform(random), 4e-4 * uniform(random)));
        const SplitTest test{Placement{}.ecef(n, up, {}), std::pow(10.0, 1.5 + uniform(random))};
        for (const auto& [root, tile] : placed) {
            for (unsigned i = 1; i < 1u << tile.depth; ++i) {
                if (!test(tile.split[i])) {
                    ++failed;
                    continue;
                }
                ++passed;
                const LocationCode cell = cell_code(root, i);
                if (cell.bisection_level() == 0) continue;
                for (const LocationCode parent : {cell.parent(), neighbor(cell).parent()}) {
                    const auto [above, local] = cell_in_tile(parent, {});
                    ASSERT_TRUE(test(placed.at(above).split[local])) << to_string(cell) << " " << to_string(parent);
                }
            }
        }
    }
    EXPECT_GT(passed, 100000u);
    EXPECT_GT(failed, 100000u);
}

TEST(Bake, RadiiHoldEveryVertexBelow) {
    const auto tiles = all_tiles(patch_store());
    for (const auto& [root, tile] : tiles) {
        TileLattice lattice;
        lattice.set_normals(corners(root), tile.depth);
        lattice.set_positions(Placement{}, tile.height, tile.undulation, {});
        for (unsigned i = 1; i < 1u << tile.depth; ++i) {
            if (tile.deviation[i] == 0) continue;
            const glm::dvec3 m(lattice.rounded()[tile_layout().split_vertex[i]]);
            for (unsigned first = i, end = i + 1; first < 2u << tile.depth; first *= 2, end *= 2)
                for (unsigned c = first; c < end; ++c) {
                    if (c != i && !(tile.deviation[c >> 1] > 0)) continue;
                    for (const std::uint16_t v : tile_layout().corners[c])
                        ASSERT_LE(glm::length(lattice.position(v) - m), static_cast<double>(tile.radius[i]));
                }
        }
    }
}

TEST(Bake, CoarseHeightsAreTheFineOnes) {
    const auto tiles = all_tiles(patch_store());
    const double quantum = patch_store().metadata().quantum_m;
    EXPECT_EQ(quantum, 0.25);
    for (const auto& [root, tile] : tiles) {
        const auto normals = tile_normals(root, tile.depth);
        for (std::size_t v = 0; v < normals.size(); ++v) {
            ASSERT_LE(std::abs(static_cast<double>(tile.height[v]) - BumpyField::exact(normals[v])),
                      quantum / 2 + 1e-3);
            ASSERT_EQ(std::fmod(tile.height[v], 0.25f), 0.0f);
            GeoidUndulation N;
            testing::bumpy_undulation({&normals[v], 1}, {&N, 1});
            ASSERT_NEAR(tile.undulation[v].m, N.m, 0.5 * undulation_quantum_m + 1e-3);
        }
    }
}

TEST(Bake, HeightRangesCoverWhatIsBelow) {
    const auto tiles = all_tiles(patch_store());
    for (const auto& [root, tile] : tiles) {
        EXPECT_LE(tile.min_height, tile.height[3]);
        EXPECT_GE(tile.max_height, tile.height[3]);
        if (root.bisection_level() == 0) continue;
        const Tile& above = tiles.at(root.ancestor(root.bisection_level() - tile_levels));
        EXPECT_LE(above.min_height, tile.min_height);
        EXPECT_GE(above.max_height, tile.max_height);
    }
}

TEST(Bake, RefusesWhatNeedsTooMuchMemory) {
    BakeOptions o;
    o.memory_bytes = 1 << 20;
    try {
        bake_in_memory(BumpyField(2e4, {}, 1), o);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_usage);
        EXPECT_NE(std::string(e.what()).find("1 MiB"), std::string::npos) << e.what();
    }
    o.memory_bytes = std::size_t{8} << 20;
    EXPECT_THROW(bake_in_memory(BumpyField(0, {}, 0), o), Error);  // "as fine as you like"
}

TEST(Bake, RefusesOptionsOutOfRange) {
    const BumpyField field(1e6, {}, 1e6);
    for (const auto& spoil : std::initializer_list<void (*)(BakeOptions&)>{
             [](BakeOptions& o) { o.least_level = 0; }, [](BakeOptions& o) { o.finest_level = 61; },
             [](BakeOptions& o) { o.finest_level = o.least_level - 1; }, [](BakeOptions& o) { o.quantum_m = 0.3; },
             [](BakeOptions& o) { o.quantum_m = 1e9; }, [](BakeOptions& o) { o.quantum_m = std::nan(""); }}) {
        BakeOptions o;
        spoil(o);
        EXPECT_THROW(bake_in_memory(field, o), Error);
    }
}

// A field that is not there at all, one that is nowhere finite, and one that is too high.
class OddField final : public ElevationField {
  public:
    explicit OddField(float height) : height_(height) {}
    VerticalDatum datum() const override { return VerticalDatum::ellipsoid; }
    void heights(std::span<const glm::dvec3>, std::span<float> out) const override {
        std::fill(out.begin(), out.end(), height_);
    }
    double spacing(const Cap&) const override { return std::numeric_limits<double>::infinity(); }
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override { return {}; }

  private:
    float height_;
};

TEST(Bake, NoAnswerIsHeightZeroAndTooHighIsRefused) {
    BakeOptions o;
    o.least_level = 5;
    const ElevationStore store = bake_in_memory(OddField(std::nanf("")), o);
    EXPECT_TRUE(store.verify().ok());
    EXPECT_EQ(store.metadata().finest_level, 5);
    for (const LocationCode root : store.tiles()) {
        const std::optional<Tile> tile = store.read(root);
        for (const float h : tile->height) EXPECT_EQ(h, 0.0f);
    }
    EXPECT_THROW(bake_in_memory(OddField(1e9f), o), Error);
    EXPECT_THROW(bake_in_memory(OddField(std::numeric_limits<float>::infinity()), o), Error);
}

TEST(Bake, ResamplingIsCertifiedAgainstEverySample) {
    BumpyField field = patch_at_a_corner();
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 300; ++i) {
        const double wide = i % 2 ? 1.0 : 3e-4;
        field.extra_samples.push_back(
            glm::normalize(glm::dvec3(1, 0, 0) + wide * glm::dvec3(normal(random), normal(random), normal(random))));
    }
    BakeReport report;
    const ElevationStore store = bake_in_memory(field, with_geoid(), &report);
    EXPECT_GT(report.resampling_max_m, 10.0);
    EXPECT_EQ(report.resampling_max_m, store.metadata().resampling_max_m);
    double largest = 0;
    for (const LocationCode root : store.tiles())
        largest = std::max(largest, static_cast<double>(store.read(root)->resampling));
    EXPECT_EQ(largest, report.resampling_max_m);
    EXPECT_EQ(patch_store().metadata().resampling_max_m, 0.0);  // no samples, nothing to certify
}

}  // namespace
}  // namespace planet
