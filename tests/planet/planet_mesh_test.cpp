#include "planet/store/planet_mesh.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <random>
#include <set>

#include "pedestrian_planet.h"
#include "planet/bake/bake.h"
#include "planet/error.h"
#include "planet/mesh/surface_check.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/store_field.h"
#include "planet/store/tile_sides.h"

namespace planet {
namespace {

using namespace pedestrian;

// Closed, one strip, levels and corners as the cells say.
void expect_sound(const PlanetMesh& made) {
    const SurfaceCheck c = check(made.mesh, MeshFrame::ecef);
    EXPECT_TRUE(c.closed()) << c.summary();
    EXPECT_EQ(2 * c.sides, 3 * c.triangles);
    ASSERT_EQ(made.mesh.level.size(), made.mesh.triangles.size());
    ASSERT_EQ(made.cells.size(), made.mesh.triangles.size());
    for (std::size_t i = 0; i < made.cells.size(); ++i) ASSERT_EQ(made.mesh.level[i], made.cells[i].bisection_level());
}

class PlanetMeshAt : public ::testing::TestWithParam<std::size_t> {
  protected:
    const ElevationStore& store() const { return store_of(GetParam()); }
    const Surface& surface() const { return surface_of(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Places, PlanetMeshAt, ::testing::Range(std::size_t{0}, std::size(places)),
                         [](const auto& place) { return places[place.param].name; });

constexpr double tolerances[] = {3e6, 4e5, 60000, 9000, 5000, 3000, 2000, 1200, 600, 150, 20, 1, 0};

PlanetMesh within(PlanetLattice& lattice, double max_deviation) {
    PlanetMeshOptions options;
    options.max_deviation = max_deviation;
    return planet_mesh(lattice, options);
}

void expect_own_deviations(const ElevationStore& store, const Surface& surface) {
    PlanetLattice lattice(store);
    for (const auto& [cell, s] : surface.splits) {
        const auto [root, local] = cell_in_tile(cell, store.metadata().layers);
        const double own = static_cast<double>(lattice.own_deviation(*lattice.tile(root), local));
        ASSERT_GE(own, s.own) << to_string(cell);
        ASSERT_LE(own, s.own * (1 + 3e-7) + 2e-8) << to_string(cell);
    }
}

TEST_P(PlanetMeshAt, OwnDeviationsAreExact) {
    expect_own_deviations(store(), surface());
}

// A flat planet with one needle of a mountain, finely sampled: its top lies tiles below tiles.
class Needle final : public ElevationField {
  public:
    VerticalDatum datum() const override { return VerticalDatum::ellipsoid; }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override {
        for (std::size_t i = 0; i < normals.size(); ++i)
            out[i] = static_cast<float>(9e6 * std::exp(-std::pow(glm::distance(normals[i], top) / 3e-4, 2)));
    }
    double spacing(const Cap& cap) const override {
        return glm::distance(cap.centre, top) < cap.angle + 5e-4 ? 1500 : 2e6;
    }
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override { return {}; }
    const glm::dvec3 top = glm::normalize(glm::dvec3(0.3, -0.5, 0.7));
};

TEST(PlanetMesh, SeesWhatIsTilesBelowTiles) {
    BakeOptions options;
    options.least_level = 8;
    options.quantum_m = 4;
    const ElevationStore store = bake_in_memory(Needle(), options);
    const Surface surface(store);
    const LocationCode face = cell_at(Needle().top, 0);
    EXPECT_GT(surface.splits.rbegin()->first.bisection_level(), 24);
    EXPECT_GT(surface.splits.at(face).own, 6e6);
    expect_own_deviations(store, surface);
    for (const double tolerance : {8e6, 4e6, 1e6, 5e4}) {
        PlanetLattice lattice(store);
        EXPECT_EQ(sorted(within(lattice, tolerance).cells), leaves_of(least_splits(surface, tolerance)));
    }
}

TEST_P(PlanetMeshAt, IsTheLeastMeshWithinTheDeviation) {
    std::size_t fewer = 0;
    for (const double tolerance : tolerances) {
        PlanetLattice lattice(store());
        const PlanetMesh made = within(lattice, tolerance);
        const std::vector<LocationCode> least = leaves_of(least_splits(surface(), tolerance));
        ASSERT_EQ(sorted(made.cells), least) << tolerance;
        EXPECT_EQ(made.tolerance, tolerance);
        std::size_t saturated = face_count;
        for (const auto& [cell, s] : surface().splits) saturated += static_cast<double>(s.saturated) > tolerance;
        EXPECT_LE(least.size(), saturated);
        fewer += least.size() < saturated;
    }
    EXPECT_GE(fewer, 3u);
}

TEST_P(PlanetMeshAt, IsClosed) {
    PlanetLattice lattice(store());
    for (const double tolerance : tolerances) expect_sound(within(lattice, tolerance));
}

TEST_P(PlanetMeshAt, KeepsTheDeviationAtEveryFinestVertex) {
    PlanetLattice lattice(store());
    for (const double tolerance : tolerances) {
        const PlanetMesh made = within(lattice, tolerance);
        const DeviationReport fast = measure(lattice, made, made.mesh.vertices);
        const DeviationReport slow = measure_slowly(surface(), made, made.mesh.vertices);
        EXPECT_LE(fast.maximum, tolerance + 2e-9);  // the octahedron's corners round
        EXPECT_NEAR(fast.maximum, slow.maximum, 1e-8);
        EXPECT_NEAR(fast.rms, slow.rms, 1e-7 + 1e-9 * slow.rms);
        EXPECT_EQ(fast.samples, slow.samples);
        EXPECT_EQ(fast.samples, surface().triangles() / 2 + 2);
        EXPECT_EQ(fast.resampling, store().metadata().resampling_max_m);
    }
}

TEST_P(PlanetMeshAt, FinestMeshIsTheStoresSurface) {
    PlanetLattice lattice(store());
    const PlanetMesh made = within(lattice, 0);
    EXPECT_EQ(made.cells.size(), surface().triangles());
    const auto less = [](const glm::dvec3& a, const glm::dvec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::vector<glm::dvec3> have = made.mesh.vertices, want;
    for (const Surface::Vertex& v : surface().vertices()) want.push_back(v.place);
    std::sort(have.begin(), have.end(), less);
    std::sort(want.begin(), want.end(), less);
    EXPECT_EQ(have, want);  // the same bits
}

// Vertices moved: by rounding, or one of them pulled out.
TEST_P(PlanetMeshAt, MeasuresTheVerticesThatItIsGiven) {
    PlanetLattice lattice(store());
    for (const double tolerance : {3000.0, 100.0}) {
        const PlanetMesh made = within(lattice, tolerance);
        std::vector<glm::dvec3> moved = made.mesh.vertices;
        for (glm::dvec3& v : moved) v = 64.0 * glm::round(v / 64.0);
        const DeviationReport rounded = measure(lattice, made, moved);
        const DeviationReport slow = measure_slowly(surface(), made, moved);
        EXPECT_GE(rounded.maximum, slow.maximum - 1e-8);  // it looks at the mesh's own vertices too
        EXPECT_GT(rounded.maximum, 10);
        EXPECT_NEAR(rounded.rms, slow.rms, 56);
        for (const std::size_t v : {std::size_t{0}, moved.size() / 2, moved.size() - 1}) {
            moved = made.mesh.vertices;
            moved[v] *= 1.01;
            EXPECT_GT(measure(lattice, made, moved).maximum, 0.009 * glm::length(moved[v]));
        }
    }
}

TEST_P(PlanetMeshAt, KeepsTheDeviationAfterRounding) {
    constexpr double step = 64, rounding = 56;  // half the diagonal of a cube of 64 m
    std::size_t more = 0, beyond = 0;
    for (const double tolerance : {9000.0, 3000.0, 1500.0, 700.0, 400.0}) {
        PlanetLattice lattice(store());
        PlanetMeshOptions options;
        options.max_deviation = tolerance;
        const PlanetMesh exact = planet_mesh(lattice, options);
        options.rounding = rounding;
        const PlanetMesh made = planet_mesh(lattice, options);
        const auto after = [&](const PlanetMesh& mesh) {
            std::vector<glm::dvec3> v = mesh.mesh.vertices;
            for (glm::dvec3& p : v) p = step * glm::round(p / step);
            return measure(lattice, mesh, v).maximum;
        };
        EXPECT_LE(after(made), tolerance);
        expect_sound(made);
        more += made.cells.size() > exact.cells.size();
        beyond += after(exact) > tolerance;
    }
    EXPECT_GE(more, 3u);
    EXPECT_GE(beyond, 1u);  // the slack is needed
}

TEST_P(PlanetMeshAt, LimitOfTrianglesGivesTheSmallestDeviation) {
    PlanetLattice lattice(store());
    for (const std::size_t most : {8u, 9u, 10u, 33u, 100u, 1001u, 2500u, 6000u}) {
        PlanetMeshOptions options;
        options.max_triangles = most;
        const PlanetMesh made = planet_mesh(lattice, options);
        ASSERT_LE(made.cells.size(), most);
        expect_sound(made);
        EXPECT_LE(measure(lattice, made, made.mesh.vertices).maximum, made.tolerance);
        PlanetLattice afresh(store());
        EXPECT_EQ(within(afresh, made.tolerance).cells, made.cells);
        if (made.tolerance > 0) {
            EXPECT_GT(within(afresh, made.tolerance * (1 - 1e-7)).cells.size(), most);
        }
    }
}

TEST_P(PlanetMeshAt, AmpleLimitChangesNothing) {
    PlanetLattice lattice(store());
    for (const double tolerance : {5000.0, 300.0, 0.0}) {
        PlanetMeshOptions options;
        options.max_deviation = tolerance;
        options.max_triangles = surface().triangles();
        const PlanetMesh made = planet_mesh(lattice, options);
        EXPECT_EQ(made.cells, within(lattice, tolerance).cells);
        EXPECT_EQ(made.tolerance, tolerance);
    }
}

// Just inside finest cells, at the middles of legs beyond which the cells are finer.
std::vector<glm::dvec3> beside_finer_cells(const Surface& surface, std::size_t most) {
    std::vector<glm::dvec3> found;
    for (const auto& [cell, split] : surface.splits)
        for (const Side leg : {Side::left_leg, Side::right_leg}) {
            const LocationCode beside = neighbor(cell, leg);
            if (surface.splits.count(beside) || !surface.splits.count(beside.parent())) continue;
            const auto& [left, right, apex] = split.corner;
            const Corners c = corners(beside);
            const glm::dvec3 middle = (leg == Side::left_leg ? left : right).normal + apex.normal;
            found.push_back(glm::normalize(middle) + 0.002 * (c.left + c.right + c.apex));
        }
    std::shuffle(found.begin(), found.end(), std::mt19937_64(5));
    found.resize(std::min(found.size(), most));
    return found;
}

TEST_P(PlanetMeshAt, KeptDirectionsHaveTheirNearestFinestVertex) {
    const std::vector<Surface::Vertex> finest = surface().vertices();
    std::mt19937_64 random(GetParam());
    std::uniform_real_distribution<double> unit(-1, 1);
    PlanetMeshOptions options;
    options.max_deviation = 1e7;
    options.keep = {{0, 0, 1}, {0, 0, -1}, {0, 3, 0}, {-1, 0, 0}, {-1, 1e-9, 0.3}, {-1, -1e-9, 0.3}};
    const glm::dvec3 patch = glm::normalize(places[GetParam()].direction);
    for (int i = 0; i < 400; ++i) {
        const glm::dvec3 offset(unit(random), unit(random), unit(random));
        options.keep.push_back(i % 2 == 0 ? offset : patch + 1.3 * places[GetParam()].angle * offset);
    }
    for (const glm::dvec3& n : beside_finer_cells(surface(), 40)) options.keep.push_back(n);
    PlanetLattice lattice(store());
    const PlanetMesh all = planet_mesh(lattice, options);
    expect_sound(all);
    EXPECT_LT(all.cells.size(), surface().triangles());
    const std::vector<glm::dvec3> keep = options.keep;
    for (std::size_t k = 0; k < keep.size(); ++k) {
        const glm::dvec3 n = glm::normalize(keep[k]);
        const auto distance = [&](const Surface::Vertex& v) { return glm::dot(v.normal - n, v.normal - n); };
        const auto nearest = std::min_element(finest.begin(), finest.end(),
                                              [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
        options.keep = {keep[k]};
        const PlanetMesh one = planet_mesh(lattice, options);
        const auto& have = one.mesh.vertices;
        ASSERT_NE(std::find(have.begin(), have.end(), nearest->place), have.end()) << k;
        ASSERT_LT(one.cells.size(), 600u);
        if (k % 50 == 0) {
            EXPECT_NE(std::find(all.mesh.vertices.begin(), all.mesh.vertices.end(), nearest->place),
                      all.mesh.vertices.end());
            expect_sound(one);
        }
    }
}

TEST_P(PlanetMeshAt, KeepAndDeviationHoldTogether) {
    PlanetLattice lattice(store());
    PlanetMeshOptions options;
    options.max_deviation = 2000;
    options.keep = {places[GetParam()].direction, {0.3, -0.2, 0.9}};
    const PlanetMesh made = planet_mesh(lattice, options);
    expect_sound(made);
    EXPECT_LE(measure(lattice, made, made.mesh.vertices).maximum, 2000);
    EXPECT_GT(made.cells.size(), within(lattice, 2000).cells.size());
    options.max_triangles = made.cells.size() - 2;
    const PlanetMesh limited = planet_mesh(lattice, options);
    EXPECT_LE(limited.cells.size(), options.max_triangles);
    EXPECT_GT(limited.tolerance, 2000);
    EXPECT_LE(measure(lattice, limited, limited.mesh.vertices).maximum, limited.tolerance);
}

TEST_P(PlanetMeshAt, UniformMeshesHaveEveryCellOfTheirLevel) {
    PlanetLattice lattice(store());
    const auto field = StoreField(std::make_shared<const ElevationStore>(bake_place(places[GetParam()])));
    const Placement placement{store().metadata().ellipsoid, 1.0};
    for (int level = 0; level <= 14; ++level) {
        const PlanetMesh made = uniform_planet_mesh(lattice, level);
        ASSERT_EQ(made.cells.size(), std::size_t{8} << level);
        expect_sound(made);
        for (const std::uint8_t l : made.mesh.level) ASSERT_EQ(l, level);
        if (level % 4 != 2) continue;
        // Beyond the store's end too, vertices lie on its surface.
        for (std::size_t i = 0; i < made.cells.size(); i += 97) {
            const Corners c = corners(made.cells[i]);
            double nearest = 1e300;
            const double h = field.height_at(c.apex);
            GeoidUndulation N;
            if (placement.ellipsoid == wgs84) testing::bumpy_undulation({&c.apex, 1}, {&N, 1});
            for (const std::uint32_t v : made.mesh.triangles[i])
                nearest = std::min(nearest, glm::distance(made.mesh.vertices[v], placement.ecef(c.apex, h, N)));
            // Where the store has no vertex the geoid is linear between its cell's corners there, and h is rounded.
            ASSERT_LT(nearest, 10) << level << " " << to_string(made.cells[i]);
        }
        const DeviationReport fast = measure(lattice, made, made.mesh.vertices);
        const DeviationReport slow = measure_slowly(surface(), made, made.mesh.vertices);
        EXPECT_NEAR(fast.maximum, slow.maximum, 1e-6);
        EXPECT_NEAR(fast.rms, slow.rms, 1e-6);
        EXPECT_EQ(fast.samples, slow.samples);
    }
}

TEST(PlanetMesh, ThreadsChangeNothing) {
    PlanetLattice one(store_of(0), 1), three(store_of(0), 3);
    PlanetMeshOptions options;
    options.max_triangles = 3000;
    const PlanetMesh a = planet_mesh(one, options), b = planet_mesh(three, options);
    EXPECT_EQ(a.cells, b.cells);
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
    EXPECT_EQ(a.mesh.strip, b.mesh.strip);
    const DeviationReport x = measure(one, a, a.mesh.vertices), y = measure(three, b, b.mesh.vertices);
    EXPECT_EQ(x.maximum, y.maximum);
    EXPECT_EQ(x.rms, y.rms);
}

TEST(PlanetMesh, LoadsOnlyTheTilesThatItNeeds) {
    const std::size_t all = store_of(0).tiles().size();
    PlanetLattice lattice(store_of(0));
    within(lattice, 20000);
    EXPECT_EQ(lattice.tile_count(), 8u);
    within(lattice, 0);
    EXPECT_EQ(lattice.tile_count(), all);
    EXPECT_GT(all, 12u);
}

Fault fault_of(const auto& make) {
    try {
        make();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.fault();
    }
    return Fault::check_failed;
}

TEST(PlanetMesh, RefusesOptionsOutOfRange) {
    PlanetLattice lattice(store_of(0));
    const auto fault = [&](const PlanetMeshOptions& o) { return fault_of([&] { planet_mesh(lattice, o); }); };
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {-1.0, nan, infinity}) {
        EXPECT_EQ(fault({.max_deviation = bad}), Fault::bad_usage);
        EXPECT_EQ(fault({.rounding = bad}), Fault::bad_usage);
        EXPECT_EQ(fault({.keep = {{bad == -1 ? 0 : bad, 0, 0}}}), Fault::bad_usage);
    }
    EXPECT_EQ(fault({.max_triangles = 7}), Fault::bad_usage);
    EXPECT_EQ(fault({.max_triangles = 20, .keep = {{1, 2, 3}}}), Fault::bad_usage);
    EXPECT_EQ(fault_of([&] { uniform_planet_mesh(lattice, -1); }), Fault::bad_usage);
    EXPECT_EQ(fault_of([&] { uniform_planet_mesh(lattice, finest_uniform_level + 1); }), Fault::bad_usage);
}

class DamagedStore : public ::testing::Test {
  protected:
    void SetUp() override {
        path_ =
            std::filesystem::temp_directory_path() / ("octaglobe planet mesh " + std::to_string(getpid()) + ".octa");
        BakeOptions options;
        options.least_level = 8;
        bake(BumpyField(2e6, {{0, 0, 1}, 0.003}, 8000), options, path_);
    }
    void TearDown() override { std::filesystem::remove(path_); }
    void sql(const char* statement) const {
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(path_.c_str(), &db), SQLITE_OK);
        EXPECT_EQ(sqlite3_exec(db, statement, nullptr, nullptr, nullptr), SQLITE_OK);
        sqlite3_close(db);
    }
    std::filesystem::path path_;
};

TEST_F(DamagedStore, IsRefusedRatherThanDrawnCoarsely) {
    sql("UPDATE tiles SET data = zeroblob(40) WHERE code = (SELECT max(code) FROM tiles)");
    const ElevationStore store = ElevationStore::open(path_);
    PlanetLattice lattice(store);
    const PlanetMesh coarse = within(lattice, 50000);  // does not come to it
    EXPECT_EQ(fault_of([&] { within(lattice, 0); }), Fault::bad_data);
    EXPECT_EQ(fault_of([&] { measure(lattice, coarse, coarse.mesh.vertices); }), Fault::bad_data);
}

}  // namespace
}  // namespace planet
