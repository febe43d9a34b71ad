#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "patchy_store.h"
#include "planet/mesh/surface_check.h"
#include "planet/store/tile_sides.h"
#include "planet/streaming/resident_set.h"

namespace planet {
namespace {

using testing::crack_in;
using testing::patchy_store;
using testing::patchy_views;

std::unique_ptr<PlacedTile> placed(LocationCode root, double exaggeration = 1) {
    return std::make_unique<PlacedTile>(*patchy_store().read(root), Placement{wgs84, exaggeration});
}

bool same(const SplitRecord& a, const SplitRecord& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// ---- tiles placed for drawing ---------------------------------------------------------------------------------------

TEST(PlacedTile, PlacedAnewIsTheSameAsPlacedAtOnce) {
    for (const LocationCode root : patchy_store().tiles()) {
        const PlacedTile once(*patchy_store().read(root), Placement{wgs84, 3}),
            flat(*patchy_store().read(root), Placement{});
        const PlacedTile there(flat, Placement{wgs84, 3}), back(there, Placement{});
        for (unsigned i = 1; i < 1u << once.depth; ++i) {
            ASSERT_TRUE(same(once.split[i], there.split[i]));
            ASSERT_TRUE(same(flat.split[i], back.split[i]));
        }
        EXPECT_EQ(once.position, there.position);
        EXPECT_EQ(flat.position, back.position);
        EXPECT_EQ(once.height, there.height);
        for (unsigned k = 0; k < tile_cells; ++k) {
            ASSERT_TRUE(same(once.child_bound[k], there.child_bound[k]));
            ASSERT_TRUE(same(flat.child_bound[k], back.child_bound[k]));
        }
    }
}

TEST(PlacedTile, KnowsWhereTilesAreBelow) {
    for (const LocationCode root : patchy_store().tiles()) {
        const Tile tile = *patchy_store().read(root);
        const PlacedTile p(tile, Placement{});
        EXPECT_EQ(p.child_bound.empty(), tile.child_exists.none());
        for (unsigned k = 0; k < tile_cells; ++k) ASSERT_EQ(p.child_bound.has(k), tile.child_exists[k]);
        const unsigned cells = 1u << tile.depth;
        std::vector<bool> below(std::size_t{2} * cells);
        for (unsigned i = 2 * cells - 1; i >= 1; --i) {
            below[i] = i >= cells ? tile.child_exists[i - cells] : below[2 * i] || below[2 * i + 1];
            ASSERT_EQ(p.has_child_below(i), below[i]) << i;
        }
    }
}

ResidentTile& insert(ResidentSet& set, LocationCode root, int open_depth = tile_levels) {
    std::unique_ptr<PlacedTile> tile = placed(root);
    const int depth = tile->depth;
    tile->close();
    ResidentTile& resident = set.insert(std::move(tile), tile_support(root, depth));
    set.open(resident, open_depth);
    return resident;
}

// ---- the set of tiles in memory -------------------------------------------------------------------------------------

/// The rule as it is written, without any memory.
class Existence {
  public:
    explicit Existence(ResidentSet& set) : set_(set) {}
    bool of(LocationCode cell) {
        const LocationCode name = diamond(cell);
        const auto known = known_.find(name);
        if (known != known_.end()) return known->second;
        bool exists = true;
        for (const LocationCode half : {cell, neighbor(cell)}) {
            const auto [root, local] = cell_in_tile(half, set_.layers());
            const ResidentTile* tile = set_.find(root);
            exists = exists && tile && !(local >> tile->open_depth) && tile->tile->is_stored(local);
        }
        if (exists && cell.bisection_level() > 0) exists = of(cell.parent()) && of(neighbor(cell).parent());
        return known_[name] = exists;
    }

  private:
    ResidentSet& set_;
    std::map<LocationCode, bool> known_;
};

void expect_rule(ResidentSet& set) {
    Existence existence(set);
    for (const ResidentTile* t : set.all())
        for (unsigned i = 1; i < 1u << t->tile->depth; ++i)
            ASSERT_EQ(t->tile->is_open(i), existence.of(cell_code(t->root, i))) << to_string(t->root) << " " << i;
}

/// Adds, opens or takes out tiles at random, keeping parents. @return whether anything was done
bool change_at_random(ResidentSet& set, std::mt19937& random) {
    const std::vector<LocationCode> roots = patchy_store().tiles();
    const LocationCode root = roots[random() % roots.size()];
    const int depth = static_cast<int>(random() % (tile_levels + 1));
    if (ResidentTile* const there = set.find(root)) {
        if (random() % 4 == 0) {
            set.open(*there, depth);
            return true;
        }
        if (there->children > 0 || root.bisection_level() == 0) return false;
        set.erase(root);
        return true;
    }
    if (root.bisection_level() > 0 && !set.find(root.ancestor(root.bisection_level() - tile_levels))) return false;
    insert(set, root, depth);
    return true;
}

TEST(ResidentSet, TheRuleHoldsAfterAnyChanges) {
    std::mt19937 random(1);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    set.settle();
    expect_rule(set);
    for (int step = 0; step < 40; ++step) {
        for (int changes = 0; changes < 1 + step;) changes += change_at_random(set, random);
        set.settle();
        expect_rule(set);
    }
}

TEST(ResidentSet, EveryDiamondIsOpenWhereAllTilesAreThere) {
    ResidentSet set;
    for (const LocationCode root : patchy_store().tiles()) insert(set, root);
    set.settle();
    for (const ResidentTile* t : set.all())
        for (unsigned i = 1; i < 1u << t->tile->depth; ++i) ASSERT_EQ(t->tile->is_open(i), t->tile->is_stored(i));
    for (const LocationCode root : patchy_store().tiles()) EXPECT_EQ(set.tile(root)->root, root);
    EXPECT_EQ(set.size(), patchy_store().tiles().size());
}

TEST(ResidentSet, NoWalkMeetsACrackWhicheverTilesAreThere) {
    std::mt19937 random(2);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    std::size_t triangles = 0;
    for (int step = 0; step < 24; ++step) {
        for (int changes = 0; changes < 40;) changes += change_at_random(set, random);
        set.settle();
        const SplitTest test = patchy_views()[static_cast<std::size_t>(step)].test;
        ASSERT_EQ(crack_in(set, test), "") << step;
        const SurfaceCheck c = check(refine_planet(set, test));
        ASSERT_TRUE(c.closed()) << c.summary();
        triangles += c.triangles;
    }
    EXPECT_GT(triangles, 50000u);
}

// What take_changes() does not name must be the same mesh as before.
TEST(ResidentSet, ChangesNameEveryCellThatIsSplitOtherwise) {
    std::mt19937 random(3);
    ResidentSet set;
    for (int face = 0; face < face_count; ++face) insert(set, LocationCode::face_root(face));
    set.settle();
    set.take_changes();
    const auto open_cells = [&set] {
        std::set<LocationCode> open;
        for (const ResidentTile* t : set.all())
            for (unsigned i = 1; i < 1u << t->tile->depth; ++i)
                if (t->tile->is_open(i)) open.insert(cell_code(t->root, i));
        return open;
    };
    std::set<LocationCode> before = open_cells();
    std::size_t flips = 0;
    for (int step = 0; step < 30; ++step) {
        for (int changes = 0; changes < 40;) changes += change_at_random(set, random);
        set.settle();
        const std::set<LocationCode> after = open_cells();
        const std::vector<LocationCode> changed = set.take_changes();
        for (std::size_t k = 1; k < changed.size(); ++k) ASSERT_FALSE(changed[k - 1].contains(changed[k]));
        std::vector<LocationCode> flipped;
        std::set_symmetric_difference(before.begin(), before.end(), after.begin(), after.end(),
                                      std::back_inserter(flipped));
        for (const LocationCode cell : flipped)
            ASSERT_TRUE(std::any_of(changed.begin(), changed.end(), [&](LocationCode c) { return c.contains(cell); }))
                << to_string(cell);
        flips += flipped.size();
        before = after;
    }
    EXPECT_GT(flips, 200u);
    EXPECT_TRUE(set.take_changes().empty());
}

TEST(ResidentSet, ATileAndItsSupportOpenAllItsDiamonds) {
    std::mt19937 random(4);
    const std::vector<LocationCode> roots = patchy_store().tiles();
    std::size_t most = 0;
    for (int trial = 0; trial < 30; ++trial) {
        ResidentSet set;
        const LocationCode root = roots[random() % roots.size()];
        const std::function<void(LocationCode)> add = [&](LocationCode r) {
            if (set.find(r)) return;
            if (r.bisection_level() > 0) add(r.ancestor(r.bisection_level() - tile_levels));
            if (!patchy_store().read(r)) return;
            const std::size_t supporting = insert(set, r).support.size();
            if (r.bisection_level() > 0) most = std::max(most, supporting);
        };
        // The tile, those above all of its support with theirs, and so on up.
        std::vector<LocationCode> level{root};
        while (!level.empty()) {
            std::set<LocationCode> above;
            for (const LocationCode r : level) {
                const auto tile = patchy_store().read(r);
                if (!tile) continue;
                add(r);
                for (const LocationCode s : tile_support(r, tile->depth)) {
                    add(s);
                    if (s.bisection_level() > 0) above.insert(s.ancestor(s.bisection_level() - tile_levels));
                }
            }
            level.assign(above.begin(), above.end());
        }
        set.settle();
        const PlacedTile& t = *set.tile(root);
        for (unsigned i = 1; i < 1u << t.depth; ++i) ASSERT_EQ(t.is_open(i), t.is_stored(i)) << to_string(root);
    }
    EXPECT_GE(most, 11u);  // 12 to 16 tiles refine one
    EXPECT_LE(most, 16u);
}

}  // namespace
}  // namespace planet
