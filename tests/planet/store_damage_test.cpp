// A tile that cannot be read: named once, never drawn, and the tile above stands in for it without a crack.

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "patchy_store.h"
#include "planet/mesh/segments.h"
#include "planet/mesh/surface_check.h"
#include "planet/streaming/resident_tiles.h"
#include "planet/streaming/store_tiles.h"

namespace planet {
namespace {

using testing::crack_in;
using testing::hash_of;

LocationCode root_at(const glm::dvec3& towards, int bisection_level) {
    return cell_at(glm::normalize(towards), bisection_level);
}

class DamagedTiles : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = std::filesystem::temp_directory_path() / ("octaglobe's damaged tiles " + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        bake(testing::PatchyField(), testing::patchy_options(), folder_ / "whole.octa");
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

    static ElevationStore whole() { return ElevationStore::open(folder_ / "whole.octa"); }

    /// With one byte of each of these tiles changed.
    static ElevationStore damaged(std::initializer_list<LocationCode> roots) {
        const auto path = folder_ / "damaged.octa";
        std::filesystem::copy_file(folder_ / "whole.octa", path, std::filesystem::copy_options::overwrite_existing);
        sqlite3* db = nullptr;
        EXPECT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
        for (const LocationCode root : roots) {
            const std::string statement =
                "UPDATE tiles SET data = CAST(substr(data, 1, 99) || CASE substr(data, 100, 1) WHEN x'00' THEN x'01' "
                "ELSE x'00' END || substr(data, 101) AS BLOB) WHERE code = " +
                std::to_string(root.bits());
            EXPECT_EQ(sqlite3_exec(db, statement.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
            EXPECT_EQ(sqlite3_changes(db), 1) << to_string(root);
        }
        sqlite3_close(db);
        return ElevationStore::open(path);
    }

  private:
    static inline std::filesystem::path folder_;
};

SegmentView view_over(LocationCode root, double height, double K) {
    const Corners c = corners(root);
    SegmentView view;
    view.test = {ecef_from_normal(wgs84, glm::normalize(c.left + c.right + c.apex), {height}), K};
    view.culling.eye = view.test.eye;
    return view;
}

std::size_t cells_below(const TriangleMesh& mesh, LocationCode root) {
    return static_cast<std::size_t>(std::count_if(
        mesh.cells.begin(), mesh.cells.end(), [&](LocationCode cell) { return cell != root && root.contains(cell); }));
}

struct NamedTile {
    const char* name;
    LocationCode root;
};

std::vector<NamedTile> tiles_to_damage() {
    const glm::dvec3 e0 = testing::PatchyField::patches[0].cap.centre;
    return {{"a leaf tile inside a face", root_at({1, 1, 1}, 12)},
            {"an inner tile at E_0, with tiles below", root_at(e0, 12)},
            {"a leaf tile below two others", root_at(e0, 24)},
            {"a leaf tile at the equator, across a seam", root_at({1, 0.0003, -1e-9}, 24)},
            {"a leaf tile at a pole", root_at({1e-5, 2e-5, 1}, 12)}};
}

TEST_F(DamagedTiles, TheTileAboveStandsInWithoutACrack) {
    for (const NamedTile& bad : tiles_to_damage()) {
        const ElevationStore store = damaged({bad.root}), sound = whole();
        for (const double height : {3e3, 1e5}) {
            const SegmentView view = view_over(bad.root, height, bad.root.bisection_level() == 24 ? 2e4 : 1e3);
            const TileCache sound_cache(sound);
            ASSERT_GT(cells_below(refine_planet(StoreTiles(sound_cache, {}), view.test), bad.root), 0u) << bad.name;
            for (const double exaggeration : {1.0, 5.0}) {
                const TileCache cache(store);
                ResidentTiles tiles(cache, {wgs84, exaggeration}, 2);
                tiles.settle(view);
                EXPECT_EQ(crack_in(tiles, view.test), "") << bad.name;
                const TriangleMesh mesh = refine_planet(tiles, view.test);
                const SurfaceCheck c = check(mesh);
                EXPECT_TRUE(c.closed()) << bad.name << ": " << c.summary();
                EXPECT_EQ(cells_below(mesh, bad.root), 0u) << bad.name;
                EXPECT_EQ(tiles.tile(bad.root), nullptr);
                EXPECT_EQ(tiles.residency().pending, 0u);
                EXPECT_EQ(tiles.residency().damaged, 1u) << bad.name;
            }
        }
    }
}

// With tiles that StoreTiles takes as they stand in, the neighbours split the side they share: why it is not enough.
TEST_F(DamagedTiles, AStandInAloneWouldLeaveACrack) {
    const LocationCode bad = tiles_to_damage()[0].root;
    const ElevationStore store = damaged({bad});
    const TileCache cache(store);
    const StoreTiles tiles(cache, {});
    EXPECT_NE(crack_in(tiles, view_over(bad, 3e3, 1000).test), "");
}

TEST_F(DamagedTiles, AreNamedOnce) {
    const LocationCode bad = tiles_to_damage()[0].root;
    const ElevationStore store = damaged({bad});
    const TileCache cache(store, 1);  // nothing stays: every view would read it again
    ResidentTiles tiles(cache, {}, 2);
    for (const double height : {3e3, 1e5, 3e3, 1e7, 4e3}) tiles.settle(view_over(bad, height, 1000));
    ASSERT_EQ(cache.damage().size(), 1u);
    EXPECT_NE(cache.damage()[0].find("tile " + to_string(bad) + " is damaged"), std::string::npos);
    EXPECT_EQ(tiles.residency().damaged, 1u);
    tiles.settle(view_over(root_at({-1, -1, -1}, 12), 1e5, 10));  // not in need of it
    EXPECT_EQ(tiles.residency().damaged, 0u);
    EXPECT_EQ(tiles.residency().hidden_ratio, 0);
}

TEST_F(DamagedTiles, TheCertificateSaysWhatTheTileAboveKnows) {
    const LocationCode bad = tiles_to_damage()[0].root;
    const ElevationStore store = damaged({bad}), sound = whole();
    const TileCache cache(store);
    ResidentTiles tiles(cache, {}, 2);
    const SegmentView view = view_over(bad, 1e6, 5000);
    tiles.settle(view);
    const Tile above = *sound.read(bad.ancestor(bad.bisection_level() - tile_levels));
    const double known = static_cast<double>(above.child_deviation[bad.bits() & (tile_cells - 1)]);
    EXPECT_GE(tiles.residency().hidden_deviation_m, known);
    EXPECT_LE(tiles.residency().hidden_deviation_m, known * 1.001);
    EXPECT_GE(known, static_cast<double>(sound.read(bad)->deviation[1]));
    // From 1,000 km the tile is at most some 1,100 km away and no nearer than 800 km: what one pixel bound is exceeded by.
    EXPECT_GT(tiles.residency().hidden_ratio, 5000 * known / 1.1e6);
    EXPECT_LT(tiles.residency().hidden_ratio, 5000 * known / 5e5);
}

TEST_F(DamagedTiles, TheMeshIsTheSameWhateverWasThereBefore) {
    const std::vector<NamedTile> bad = tiles_to_damage();
    const ElevationStore store = damaged({bad[0].root, bad[2].root, bad[4].root});
    const TileCache cache(store, 3'000'000);
    ResidentTiles flying(cache, {}, 3);
    for (int round = 0; round < 2; ++round)
        for (const NamedTile& b : bad)
            for (const double height : {2e3, 3e5}) {
                const SegmentView view = view_over(b.root, height, 700);
                ResidentTiles fresh(cache, {}, 1);
                fresh.settle(view);
                flying.settle(view);
                EXPECT_EQ(hash_of(fresh, view.test), hash_of(flying, view.test)) << b.name << " " << height;
                EXPECT_EQ(fresh.residency().damaged, flying.residency().damaged);
                EXPECT_EQ(fresh.residency().hidden_ratio, flying.residency().hidden_ratio);
            }
}

TEST_F(DamagedTiles, AFaceIsFlatBetweenItsCorners) {
    for (const int face : {0, 6}) {
        const LocationCode bad = LocationCode::face_root(face);
        const ElevationStore store = damaged({bad});
        const TileCache cache(store);
        ResidentTiles tiles(cache, {}, 2);
        const SegmentView view = view_over(bad, 1e6, 1000);
        tiles.settle(view);
        EXPECT_EQ(crack_in(tiles, view.test), "") << face;
        const TriangleMesh mesh = refine_planet(tiles, view.test);
        EXPECT_TRUE(check(mesh).closed()) << check(mesh).summary();
        EXPECT_EQ(cells_below(mesh, bad), 0u);
        EXPECT_GT(mesh.triangles.size(), 100u);
        EXPECT_EQ(tiles.residency().damaged, 1u);
        EXPECT_TRUE(std::isinf(tiles.residency().hidden_ratio));
        EXPECT_EQ(cache.damage().size(), 1u);
        Segments segments;
        segments.build(tiles, view);
        EXPECT_GT(segments.segments().size(), 1u);
        // Out of view it is nobody's concern.
        SegmentView away = view_over(LocationCode::face_root(face ^ 6), 1e5, 100);
        away.culling.occluder_radius = 6.33e6;
        tiles.settle(away);
        EXPECT_EQ(tiles.residency().damaged, 0u);
    }
}

TEST_F(DamagedTiles, AllFacesDamagedIsAnOctahedron) {
    std::vector<LocationCode> f;
    for (int face = 0; face < face_count; ++face) f.push_back(LocationCode::face_root(face));
    const ElevationStore store = damaged({f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7]});
    const TileCache cache(store);
    ResidentTiles tiles(cache, {}, 3);
    const SegmentView view = view_over(f[0], 1e6, 1000);
    tiles.settle(view);
    const TriangleMesh mesh = refine_planet(tiles, view.test);
    EXPECT_EQ(mesh.triangles.size(), 8u);
    EXPECT_TRUE(check(mesh).closed());
    EXPECT_EQ(cache.damage().size(), 8u);
}

}  // namespace
}  // namespace planet
