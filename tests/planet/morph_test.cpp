// Morphing meshes: exact at both ends, without cracks and without pops, on patches and on the octahedron.

#include "planet/mesh/morph.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "planet/octahedron/octahedron_map.h"
#include "planet/patches/decimation.h"
#include "planet/patches/triangle_rows.h"

namespace planet {
namespace {

using PlanetMesh = Triangulation<OctahedronTopology, SparseSplitSet>;

// Some number of a diamond in 0..1.
double number_of(CellCode diamond) {
    return static_cast<double>((diamond * 0x9e3779b97f4a7c15u) >> 40) / (1 << 24);
}

// Up to seven more levels than `mesh`, in places.
template <class Mesh>
Mesh finer(Mesh mesh, unsigned seed, int splits) {
    std::mt19937 random(seed);
    for (int i = 0; i < splits; ++i) {
        const int level = std::min(mesh.levels() - 1, 7);
        const auto root = static_cast<int>(random() % static_cast<unsigned>(mesh.topology().root_count()));
        mesh.split(mesh.topology().root(root) << level | (random() & ((1u << level) - 1)));
    }
    return mesh;
}

// A hilly planet, not round: places by diamond, from the corners of its cell.
std::vector<glm::dvec3> planet_places(const MorphOrder& order) {
    std::vector<glm::dvec3> normals(order.sides.size()), places;
    for (std::uint32_t v = 0; v < order.sides.size(); ++v) {
        const auto [a, b] = order.sides[v];
        if (a != v)
            normals[v] = glm::normalize(normals[a] + normals[b]);
        else if (v < 4)
            normals[v] = {v == 0 ? 1 : v == 2 ? -1 : 0, v == 1 ? 1 : v == 3 ? -1 : 0, 0};
        else
            normals[v] = {0, 0, v == 4 ? 1 : -1};
        places.push_back(normals[v] * (6371000.0 + 5000 * number_of(order.diamonds[v])));
    }
    return places;
}

TEST(Morph, FractionIsMonotoneContinuousAndExactAtItsEnds) {
    EXPECT_EQ(morph_fraction(1), 0);
    EXPECT_EQ(morph_fraction(-3), 0);
    EXPECT_EQ(morph_fraction(2), 1);
    EXPECT_EQ(morph_fraction(std::numeric_limits<double>::infinity()), 1);
    EXPECT_EQ(morph_fraction(std::numeric_limits<double>::quiet_NaN()), 0);
    EXPECT_EQ(morph_fraction(1.5), 0.5);
    EXPECT_EQ(morph_fraction(4, 4), 1);
    EXPECT_LT(morph_fraction(3.999, 4), 1);
    double before = 0;
    const double step = 1.0 / 65536;
    for (double s = 0.9; s < 2.1; s += step) {
        const double f = morph_fraction(s);
        EXPECT_GE(f, before) << s;
        EXPECT_LE(f - before, 1.5 * step + 1e-15) << s;
        before = f;
    }
}

TEST(Morph, AVertexMovesStraightAndExactlyToItsEnds) {
    const glm::dvec3 a(1e6 / 3, -2, 0.1), b(7, 1e-3, 0.3), place(1e6, 5.1, -0.7);
    EXPECT_EQ(morphed(a, b, place, 0), (a + b) / 2.0);
    EXPECT_EQ(morphed(a, b, place, 1), place);
    glm::dvec3 before = morphed(a, b, place, 0);
    for (int i = 1; i <= 1000; ++i) {
        const glm::dvec3 at = morphed(a, b, place, i / 1000.0);
        EXPECT_EQ(at, morphed(b, a, place, i / 1000.0));
        for (int k = 0; k < 3; ++k) EXPECT_GE((at[k] - before[k]) * (place[k] - before[k]), 0) << i;
        before = at;
    }
}

// Every side of every triangle, with how often it is walked each way.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<int, 2>> sides_of(const MorphOrder& order) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<int, 2>> count;
    for (const auto& t : order.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t p = t[k], q = t[(k + 1) % 3];
            ++count[std::minmax(p, q)][p < q ? 0 : 1];
        }
    return count;
}

TEST(Morph, VerticesOfThePlanetAreUniqueAndComeAfterTheEndsOfTheirSides) {
    const PlanetMesh mesh = finer(PlanetMesh({}, 12), 1, 200);
    const MorphOrder order = morph_order(mesh);
    std::set<std::uint32_t> used;
    for (const auto& t : order.triangles) used.insert(t.begin(), t.end());
    const auto sides = sides_of(order);
    for (const auto& [side, count] : sides) EXPECT_TRUE(count[0] == 1 && count[1] == 1);
    EXPECT_EQ(used.size() + order.triangles.size() - sides.size(), 2u);
    EXPECT_EQ(used.size(), order.sides.size());
    for (std::uint32_t v = 6; v < order.sides.size(); ++v) {
        EXPECT_LT(order.sides[v].a, v);
        EXPECT_LT(order.sides[v].b, v);
        EXPECT_NE(order.sides[v].a, order.sides[v].b);
    }
}

TEST(Morph, VerticesOfPatchesAreUnique) {
    const Triangulation<PatchGrid, DenseSplitSet> mesh =
        finer(Triangulation<PatchGrid, DenseSplitSet>(PatchGrid(3, 2), 8), 1, 100);
    const MorphOrder order = morph_order(mesh);
    const auto sides = sides_of(order);
    for (const auto& [side, count] : sides) EXPECT_TRUE(count[0] <= 1 && count[1] <= 1);
    EXPECT_EQ(order.sides.size() + order.triangles.size() - sides.size(), 1u);  // a disc
}

// Each cell for itself, from the places of its own corners: what a renderer does that builds segments apart.
struct ApartWalk {
    const PlanetMesh& mesh;
    const std::map<CellCode, glm::dvec3>& place;
    std::map<CellCode, glm::dvec3> morphed_at{};

    void cell(CellCode code, const glm::dvec3& left, const glm::dvec3& right, const glm::dvec3& apex) {
        if (mesh.level_of(code) == mesh.levels() || !mesh.is_split(code)) return;
        const CellCode name = diamond(mesh.topology(), code);
        const glm::dvec3 middle = morphed(left, right, place.at(name), number_of(name));
        const auto [at, is_new] = morphed_at.try_emplace(name, middle);
        if (!is_new) {
            EXPECT_EQ(at->second, middle);
        }
        cell(code << 1, left, apex, middle);
        cell(code << 1 | 1, apex, right, middle);
    }
};

TEST(Morph, CellsApartComputeTheSameBits) {
    const PlanetMesh mesh = finer(PlanetMesh({}, 12), 2, 200);
    const MorphOrder order = morph_order(mesh);
    std::vector<glm::dvec3> places = planet_places(order);
    std::map<CellCode, glm::dvec3> by_diamond;
    for (std::size_t v = 0; v < places.size(); ++v) by_diamond[order.diamonds[v]] = places[v];
    ApartWalk apart{mesh, by_diamond};
    for (int rank = 0; rank < 8; ++rank) {
        const CellCode root = mesh.topology().root(rank);
        const auto [l, r, a] = root_corner_numbers(mesh.topology(), root);
        apart.cell(root, places[l], places[r], places[a]);
        // The numbers name the corners of the face.
        const Corners c = corners(LocationCode(root));
        for (const auto& [v, normal] : {std::pair(l, c.left), std::pair(r, c.right), std::pair(a, c.apex)})
            EXPECT_LT(glm::length(glm::normalize(places[v]) - normal), 1e-12) << rank;
    }
    morph<glm::dvec3>(places, order.sides, [&](std::uint32_t v) { return number_of(order.diamonds[v]); });
    for (std::size_t v = 6; v < places.size(); ++v) EXPECT_EQ(places[v], apart.morphed_at.at(order.diamonds[v]));
}

// At 0 every finer vertex lies on the coarser triangle that holds it, several levels up; at 1 nothing has moved.
struct FlatWalk {
    const PlanetMesh &coarse, &fine;
    const std::map<CellCode, glm::dvec3>& place;
    int checked = 0;

    void cell(CellCode code, const glm::dvec3& left, const glm::dvec3& right, const glm::dvec3& apex, bool above) {
        if (fine.level_of(code) == fine.levels() || !fine.is_split(code)) return;
        const bool kept = above && coarse.is_split(code);
        const glm::dvec3 at = place.at(diamond(fine.topology(), code));
        const glm::dvec3 middle = kept ? at : 0.5 * left + 0.5 * right;
        if (!kept) {
            EXPECT_LT(glm::distance(at, middle), 1e-8);
            ++checked;
        }
        cell(code << 1, left, apex, middle, kept);
        cell(code << 1 | 1, apex, right, middle, kept);
    }
};

TEST(Morph, IsTheCoarserPlanetAtZeroAndTheFinerOneAtOne) {
    const PlanetMesh coarse = finer(PlanetMesh({}, 12), 3, 30), fine = finer(coarse, 4, 300);
    const MorphOrder order = morph_order(fine);
    const std::vector<glm::dvec3> places = planet_places(order);
    const auto morphed_to = [&](double f) {
        std::vector<glm::dvec3> at = places;
        morph<glm::dvec3>(at, order.sides, [&](std::uint32_t v) { return coarse.is_split(order.diamonds[v]) ? 1 : f; });
        return at;
    };
    EXPECT_EQ(morphed_to(1), places);
    const std::vector<glm::dvec3> flat = morphed_to(0);
    std::map<CellCode, glm::dvec3> by_diamond;
    for (std::size_t v = 0; v < places.size(); ++v) by_diamond[order.diamonds[v]] = flat[v];
    FlatWalk walk{coarse, fine, by_diamond};
    for (int rank = 0; rank < 8; ++rank) {
        const CellCode root = coarse.topology().root(rank);
        const auto [l, r, a] = root_corner_numbers(coarse.topology(), root);
        walk.cell(root, places[l], places[r], places[a], true);
    }
    EXPECT_GT(walk.checked, 300);
}

Raster hills(int width, int height, unsigned seed) {
    Raster r;
    r.width = width;
    r.height = height;
    std::vector<float> heights;
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            heights.push_back(static_cast<float>(std::round(200 * std::sin(x * 0.21) * std::cos(y * 0.13 + x * 0.05))) +
                              static_cast<float>(random() % 16));
    r.samples = heights;
    return r;
}

struct MorphingPatches {
    explicit MorphingPatches(const Raster& source)
        : raster(source), saturated_m(saturated(raster.grid(), patch_deviations(raster))) {}

    PatchTriangulation mesh(double tolerance) const {
        PatchTriangulation t = coarsest(raster);
        for (int level = 0; level < t.levels(); ++level) {
            const CellCode base = CellCode{1} << (raster.grid().root_bits() + level);
            for (std::size_t i = 0; i < saturated_m.level(level).size(); ++i)
                if (static_cast<double>(saturated_m.level(level)[i]) > tolerance) t.split_cells().insert(base + i);
        }
        return t;
    }
    double fraction(CellCode diamond, double tolerance) const {
        return morph_fraction(static_cast<double>(saturated_m[diamond]) / tolerance);
    }

    // The height of a mesh over every sample of the lattice, its vertices morphed.
    template <class Fraction>
    std::vector<double> surface(const PatchTriangulation& mesh, Fraction&& fraction) const {
        const PatchLattice& lattice = raster.lattice();
        const MorphOrder order = morph_order(mesh);
        std::vector<glm::ivec2> at(order.sides.size());
        for (std::uint32_t v = 0; v < at.size(); ++v) {
            const auto [a, b] = order.sides[v];
            const int columns = raster.grid().columns() + 1, i = static_cast<int>(v);
            at[v] = a != v ? (at[a] + at[b]) / 2 : glm::ivec2(i % columns, i / columns) * lattice.patch_size();
        }
        std::vector<double> heights;
        for (const glm::ivec2 p : at) heights.push_back(static_cast<double>(raster.at(p)));
        morph<double>(heights, order.sides, [&](std::uint32_t v) { return fraction(order.diamonds[v]); });
        std::vector<double> surface(static_cast<std::size_t>(lattice.width() * lattice.height()));
        for (const auto& t : order.triangles) {
            const glm::dvec2 a = at[t[0]], u = glm::dvec2(at[t[1]]) - a, v = glm::dvec2(at[t[2]]) - a;
            const TriangleRows rows({at[t[0]], at[t[1]], at[t[2]]});
            for (int y = rows.bottom(); y <= rows.top(); ++y)
                for (int x = rows.at(y).first; x <= rows.at(y).last; ++x) {
                    const glm::dvec2 d = glm::dvec2(x, y) - a;
                    const double area = u.x * v.y - u.y * v.x;
                    const double right = (d.x * v.y - d.y * v.x) / area, apex = (u.x * d.y - u.y * d.x) / area;
                    surface[static_cast<std::size_t>(y * lattice.width() + x)] =
                        heights[t[0]] + right * (heights[t[1]] - heights[t[0]]) +
                        apex * (heights[t[2]] - heights[t[0]]);
                }
        }
        return surface;
    }

    PatchRaster raster;
    DenseQuadtree<float> saturated_m;
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

TEST(Morph, IsExactlyTheCoarserPatchesAtZero) {
    const MorphingPatches patches(hills(60, 23, 1));
    const PatchTriangulation coarse = patches.mesh(80), fine = patches.mesh(0);
    const auto coarse_surface = patches.surface(coarse, [](CellCode) { return 1.0; });
    const auto at = [&](double f) {
        return patches.surface(fine, [&](CellCode d) { return coarse.is_split(d) ? 1.0 : f; });
    };
    EXPECT_EQ(at(0), coarse_surface);
    EXPECT_EQ(at(1), patches.surface(fine, [](CellCode) { return 1.0; }));
    EXPECT_GT(largest_difference(at(0.5), coarse_surface), 10);
}

// As the tolerance passes each value at which vertices go, the surface stays.
TEST(Morph, NothingPopsAsTheToleranceGrows) {
    const MorphingPatches patches(hills(60, 23, 2));
    std::set<float> values;
    for (int level = 0; level < patches.saturated_m.levels(); ++level)
        for (const float s : patches.saturated_m.level(level))
            if (s > 4) values.insert(s);
    ASSERT_GT(values.size(), 100u);
    double largest_pop = 0;
    for (const float value : values) {
        const double below = static_cast<double>(value) * (1 - 1e-9), above = static_cast<double>(value) * (1 + 1e-9);
        const auto fraction_at = [&](double t) { return [&patches, t](CellCode d) { return patches.fraction(d, t); }; };
        const PatchTriangulation before = patches.mesh(below), after = patches.mesh(above);
        EXPECT_LT(
            largest_difference(patches.surface(before, fraction_at(below)), patches.surface(after, fraction_at(above))),
            1e-4)
            << value;
        const auto whole = [](CellCode) { return 1.0; };
        largest_pop =
            std::max(largest_pop, largest_difference(patches.surface(before, whole), patches.surface(after, whole)));
    }
    EXPECT_GT(largest_pop, 10);  // without a morph
}

}  // namespace
}  // namespace planet
