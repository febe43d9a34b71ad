// Rasters on patches: deviations against a slow reference, least meshes, clipping, holes, strips.

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "planet/error.h"
#include "planet/mesh/surface_check.h"
#include "planet/patches/patch_measure.h"

namespace planet {
namespace {

Raster bumpy(int width, int height, std::uint32_t seed, double void_share = 0) {
    std::mt19937 random(seed);
    Raster r;
    r.width = width;
    r.height = height;
    r.name = "bumpy";
    std::vector<std::int16_t> samples(r.count());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double h = 300 * std::sin(x * 0.11) * std::cos(y * 0.07) + 40 * std::sin(x * 0.9 + y * 0.7);
            const bool hole = static_cast<double>(random() % 10000) < 10000 * void_share;
            samples[static_cast<std::size_t>(y * width + x)] =
                hole ? void_sample : static_cast<std::int16_t>(h + static_cast<double>(random() % 9));
        }
    r.samples = samples;
    return r;
}

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

// |plane - sample| at a sample in a triangle, sides included; std::nullopt outside or where void.
std::optional<double> distance(const PatchRaster& raster, const std::array<LatticeVertex, 3>& t, glm::ivec2 at,
                               bool even_void = false) {
    const glm::dvec2 a(t[0].at), b(t[1].at), c(t[2].at), p(at);
    const double area = cross(b - a, c - a);
    const double wa = cross(b - p, c - p) / area, wb = cross(c - p, a - p) / area, wc = cross(a - p, b - p) / area;
    const double h = static_cast<double>(raster.at(at));
    if (wa < 0 || wb < 0 || wc < 0) return std::nullopt;
    if (even_void) return 0;
    if (!raster.inside(at) || std::isnan(h)) return std::nullopt;
    return std::abs(wa * t[0].height + wb * t[1].height + wc * t[2].height - h);
}

std::array<LatticeVertex, 3> cell_triangle(const PatchRaster& raster, const LatticeCorners& c) {
    return {{{c.left, static_cast<double>(raster.at(c.left))},
             {c.right, static_cast<double>(raster.at(c.right))},
             {c.apex, static_cast<double>(raster.at(c.apex))}}};
}

template <class OnSample>
void for_each_sample_in(const std::array<LatticeVertex, 3>& t, OnSample&& on_sample) {
    const glm::ivec2 low = glm::min(t[0].at, glm::min(t[1].at, t[2].at)),
                     high = glm::max(t[0].at, glm::max(t[1].at, t[2].at));
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) on_sample(glm::ivec2(x, y));
}

TEST(PatchDeviation, EveryCellAgainstEverySample) {
    for (const auto& [w, h, void_share] : {std::tuple{33, 33, 0.0},
                                           {65, 17, 0.0},
                                           {40, 23, 0.0},
                                           {2, 2, 0.0},
                                           {5, 2, 0.0},
                                           {130, 41, 0.0},
                                           {40, 23, 0.003},
                                           {33, 33, 0.1}}) {
        const PatchRaster raster(bumpy(w, h, 1, void_share));
        const auto deviation = patch_deviations(raster);
        const PatchGrid& grid = raster.grid();
        for (int level = 0; level < deviation.levels(); ++level) {
            const auto cells = deviation.level(level);
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const auto t =
                    cell_triangle(raster, raster.lattice().corners((CellCode{1} << (grid.root_bits() + level)) + i));
                double worst = 0;
                bool any_void = false;
                for_each_sample_in(t, [&](glm::ivec2 p) {
                    any_void |= std::isnan(raster.at(p)) &&
                                distance(raster, {{{t[0].at, 0}, {t[1].at, 0}, {t[2].at, 0}}}, p, true);
                });
                if (any_void) {
                    ASSERT_TRUE(cells[i] == 0 || cells[i] == mixed_with_void);
                    continue;
                }
                if (!raster.outside({t[0].at, t[1].at, t[2].at}))
                    for_each_sample_in(
                        t, [&](glm::ivec2 p) { worst = std::max(worst, distance(raster, t, p).value_or(0)); });
                ASSERT_NEAR(static_cast<double>(cells[i]), worst, 1e-4) << w << 'x' << h << " level " << level;
                ASSERT_GE(static_cast<double>(cells[i]), worst - 1e-12);
            }
        }
    }
}

// Every side has at most two triangles, one each way; no vertex lies in the middle of another triangle's side.
void expect_conforming(const PatchMesh& mesh, const PatchRaster& raster, bool whole) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
    std::set<std::pair<int, int>> places;
    for (const LatticeVertex& v : mesh.vertices) {
        ASSERT_TRUE(raster.inside(v.at));
        ASSERT_TRUE(places.insert({v.at.x, v.at.y}).second) << "vertex twice";
    }
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const glm::dvec2 a(mesh.vertices[t[0]].at), b(mesh.vertices[t[1]].at), c(mesh.vertices[t[2]].at);
        ASSERT_GT(cross(b - a, c - a), 0);
        area += cross(b - a, c - a) / 2;
        for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ((++directed[{t[k], t[(k + 1) % 3]}]), 1);
    }
    if (whole) {
        EXPECT_EQ(area, static_cast<double>(raster.width() - 1) * (raster.height() - 1));
    }
    for (const auto& [side, count] : directed) {
        if (directed.contains({side.second, side.first})) continue;
        // An open side: of a whole mesh it lies on the border; and no vertex in its middle.
        const glm::ivec2 a = mesh.vertices[side.first].at, b = mesh.vertices[side.second].at, d = b - a;
        const glm::ivec2 last(raster.width() - 1, raster.height() - 1);
        if (whole) {
            ASSERT_TRUE((a.x == b.x && (a.x == 0 || a.x == last.x)) || (a.y == b.y && (a.y == 0 || a.y == last.y)));
        }
        const int n = std::max(std::abs(d.x), std::abs(d.y));
        for (int i = 1; i < n; ++i) ASSERT_FALSE(places.contains({a.x + d.x / n * i, a.y + d.y / n * i}));
    }
}

// As a surface of its own: sides, winding, strips.
void expect_sound(const PatchMesh& mesh) {
    SurfaceMesh surface;
    for (const LatticeVertex& v : mesh.vertices) surface.vertices.emplace_back(glm::dvec2(v.at), v.height);
    surface.triangles = mesh.triangles;
    surface.strip = mesh.strip;
    const SurfaceCheck c = check(surface, MeshFrame::source);
    EXPECT_TRUE(c.ok()) << c.summary();
    turn_strips(surface.strip);
    for (auto& t : surface.triangles) std::swap(t[0], t[1]);
    EXPECT_TRUE(check(surface, MeshFrame::source).strips_match);
}

double worst_deviation(const PatchMesh& mesh, const PatchRaster& raster) {
    double worst = 0;
    for (const auto& t : mesh.triangles) {
        const std::array<LatticeVertex, 3> corners{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
        for_each_sample_in(corners,
                           [&](glm::ivec2 p) { worst = std::max(worst, distance(raster, corners, p).value_or(0)); });
    }
    return worst;
}

TEST(PatchMesh, KeepsTheBoundAtEverySampleOfEverySize) {
    for (const auto& [w, h] : {std::pair{33, 33}, {65, 17}, {40, 23}, {23, 40}, {2, 2}, {7, 2}, {3, 50}, {100, 61}})
        for (const double tolerance : {0.0, 5.0, 30.0, 1e6}) {
            const PatchRaster raster(bumpy(w, h, 2));
            const auto deviation = patch_deviations(raster);
            PatchTriangulation mesh = coarsest(raster);
            refine_to_tolerance(mesh, deviation, tolerance);
            ASSERT_FALSE(mesh.check());
            const PatchMesh out = extract(mesh, raster);
            expect_conforming(out, raster, true);
            expect_sound(out);
            EXPECT_LE(worst_deviation(out, raster), tolerance + 1e-9);
        }
}

TEST(PatchMesh, IsTheLeast) {
    const PatchRaster raster(bumpy(33, 33, 3));
    const auto deviation = patch_deviations(raster);
    PatchTriangulation mesh = coarsest(raster);
    refine_to_tolerance(mesh, deviation, 20);
    // Removing any vertex with its domain leaves a triangle that is too far, or was forced by closure of one.
    for (int level = 0; level < mesh.levels(); ++level)
        for (std::size_t i = 0; i < deviation.level(level).size(); ++i) {
            const CellCode cell = (CellCode{1} << (raster.grid().root_bits() + level)) + i;
            if (!mesh.is_split(cell)) continue;
            PatchTriangulation less = mesh;
            less.remove(cell);
            double worst = 0;
            less.for_each_leaf([&](CellCode leaf) {
                if (less.level_of(leaf) < less.levels()) worst = std::max(worst, static_cast<double>(deviation[leaf]));
            });
            ASSERT_GT(worst, 20.0);
        }
}

TEST(PatchMesh, BudgetIsNeverExceededAndItsStateIsLeast) {
    for (const auto& [w, h] : {std::pair{33, 33}, {40, 23}, {23, 40}}) {
        const PatchRaster raster(bumpy(w, h, 4));
        const auto deviation = patch_deviations(raster);
        for (const std::size_t budget : {8u, 50u, 333u, 100000u}) {
            PatchTriangulation mesh = coarsest(raster);
            ASSERT_TRUE(refine_to_budget(mesh, raster, deviation, budget));
            ASSERT_FALSE(mesh.check());
            const PatchMesh out = extract(mesh, raster);
            EXPECT_LE(out.triangles.size(), budget);
            PatchTriangulation least = coarsest(raster);
            const double achieved = worst_deviation(out, raster);
            refine_to_tolerance(least, deviation, achieved + 1e-9);
            EXPECT_EQ(extract(least, raster).triangles.size(), out.triangles.size()) << budget;
        }
        PatchTriangulation mesh = coarsest(raster);
        EXPECT_FALSE(refine_to_budget(mesh, raster, deviation, 1));
    }
}

TEST(PatchMesh, HolesAreLeftOutAndNothingElse) {
    for (const auto& [w, h] : {std::pair{33, 33}, {50, 21}}) {
        const PatchRaster raster(bumpy(w, h, 5, 0.02));
        const auto deviation = patch_deviations(raster);
        PatchTriangulation mesh = coarsest(raster);
        refine_to_tolerance(mesh, deviation, 15);
        const PatchMesh out = extract(mesh, raster);
        expect_conforming(out, raster, false);
        expect_sound(out);
        EXPECT_LE(worst_deviation(out, raster), 15 + 1e-9);
        // No triangle over a void sample, and none missing where all three corners of a unit cell are valid.
        std::set<std::pair<int, int>> covered;
        for (const auto& t : out.triangles) {
            const std::array<LatticeVertex, 3> corners{out.vertices[t[0]], out.vertices[t[1]], out.vertices[t[2]]};
            for_each_sample_in(corners, [&](glm::ivec2 p) {
                if (distance(raster, corners, p)) covered.insert({p.x, p.y});
            });
        }
        std::size_t uncovered = raster.valid_samples() - covered.size();
        EXPECT_LT(uncovered, raster.valid_samples() / 50);
    }
}

TEST(PatchMesh, UniformLevelsAndKeptSamples) {
    const PatchRaster raster(bumpy(65, 33, 6));
    for (int level = 0; level <= raster.lattice().bisection_levels(); ++level) {
        PatchTriangulation mesh = coarsest(raster);
        refine_to_level(mesh, level);
        const PatchMesh out = extract(mesh, raster);
        EXPECT_EQ(out.triangles.size(), 4u << level);
        expect_conforming(out, raster, true);
        expect_sound(out);
        EXPECT_LE(static_cast<double>(out.strip.size()), 5.05 / 3 * static_cast<double>(out.triangles.size()) + 12);
    }
    PatchTriangulation mesh = coarsest(raster);
    const glm::ivec2 kept[] = {{1, 1}, {63, 2}, {32, 16}, {0, 7}, {64, 31}, {31, 32}};
    for (const glm::ivec2 p : kept) keep_sample(mesh, raster.lattice(), p);
    const PatchMesh out = extract(mesh, raster);
    expect_conforming(out, raster, true);
    for (const glm::ivec2 p : kept)
        EXPECT_EQ(std::count_if(out.vertices.begin(), out.vertices.end(), [&](const auto& v) { return v.at == p; }), 1);
}

// Max and rms of a written mesh, each sample once, against all samples and all triangles.
TEST(PatchMeasure, CountsEverySampleOnce) {
    for (const auto& [w, h, void_share] : {std::tuple{33, 33, 0.0},
                                           {40, 23, 0.0},
                                           {23, 40, 0.0},
                                           {65, 17, 0.0},
                                           {7, 2, 0.0},
                                           {40, 23, 0.02},
                                           {33, 33, 0.1}}) {
        const auto source = std::make_shared<Raster>(bumpy(w, h, 8, void_share));
        source->plain = true;
        source->grid = {{500000.5, 4100000}, {30, 0.25}, {0.5, -29}};
        const PatchRaster raster(*source);
        const auto deviation = patch_deviations(raster);
        PatchTriangulation mesh = coarsest(raster);
        refine_to_tolerance(mesh, deviation, 25);
        const PatchMesh out = extract(mesh, raster);
        std::map<std::pair<int, int>, double> squares;
        for (const auto& t : out.triangles) {
            const std::array<LatticeVertex, 3> corners{out.vertices[t[0]], out.vertices[t[1]], out.vertices[t[2]]};
            for_each_sample_in(corners, [&](glm::ivec2 p) {
                if (const auto d = distance(raster, corners, p)) squares[{p.x, p.y}] = *d * *d;
            });
        }
        double sum = 0;
        for (const auto& [at, square] : squares) sum += square;
        const RasterFrame frame(source, MeshFrame::source, VerticalDatum::egm96, nullptr);
        const std::vector<glm::dvec3> written = place_vertices(out, frame);
        const AchievedDeviation achieved = measure(out, written, raster, frame, nullptr);
        EXPECT_EQ(achieved.samples, squares.size()) << w << 'x' << h;
        EXPECT_EQ(achieved.uncovered, raster.valid_samples() - squares.size());
        EXPECT_NEAR(achieved.max, worst_deviation(out, raster), 1e-6);
        EXPECT_NEAR(achieved.rms, std::sqrt(sum / static_cast<double>(squares.size())), 1e-6);
    }
}

TEST(PatchRaster, RefusesWhatHasNoArea) {
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 9}, {9, 1}}) EXPECT_THROW(PatchRaster(bumpy(w, h, 7)), Error);
    EXPECT_THROW(PatchRaster(bumpy(9, 9, 7, 1.0)), Error);
    EXPECT_THROW(PatchRaster(bumpy(100, 100, 7), 5000), Error);
}

}  // namespace
}  // namespace planet
