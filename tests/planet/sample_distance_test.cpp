#include "planet/bake/sample_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "planet/store/tile_sides.h"

namespace planet {
namespace {

// A tile with relief, some of whose diamonds may be missing, and samples in and around it.
struct SampledTile {
    SampledTile(const char* name, int depth, bool whole, double relief, unsigned seed) : random(seed) {
        tile.root = *parse_code(name);
        tile.depth = depth;
        lattice.set_normals(corners(tile.root), depth);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (std::size_t v = 0; v < lattice.size(); ++v) {
            tile.height.push_back(static_cast<float>(relief * uniform(random)));
            tile.undulation.push_back({30 + uniform(random)});
        }
        exists.assign(std::size_t{1} << depth, 1);
        const TileLayout& layout = tile_layout();
        for (unsigned i = 2; !whole && i < exists.size(); ++i) {
            const unsigned beyond = layout.split_neighbor[i];
            exists[i] = exists[i >> 1] && (beyond == 0 ? i % 7 != 3 : exists[beyond >> 1] != 0);
        }
        lattice.set_positions(placement, tile.height, tile.undulation, exists);
    }

    // Directions in the cap around the root, half of them outside; heights near 0, and one far off.
    void add_samples(std::size_t count, float far_off) {
        std::normal_distribution<double> normal;
        const Corners c = corners(tile.root);
        const glm::dvec3 middle = glm::normalize(c.left + c.right);
        for (std::size_t s = 0; s < count; ++s) {
            const glm::dvec3 aside(normal(random), normal(random), normal(random));
            normals.push_back(glm::normalize(middle + 0.4 * glm::distance(c.left, c.right) * aside));
            heights.push_back(static_cast<float>(20 * normal(random)));
        }
        heights[count / 2] = far_off;
    }

    std::mt19937 random;
    Placement placement;
    Tile tile;
    std::vector<std::uint8_t> exists, covered;
    TileLattice lattice;
    std::vector<glm::dvec3> normals;
    std::vector<float> heights;
};

double triple(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(a, glm::cross(b, c));
}

// Whether the cell with these corners holds a direction. On sides both cells do.
bool holds(const glm::dvec3& l, const glm::dvec3& r, const glm::dvec3& a, const glm::dvec3& n) {
    const double sense = triple(l, r, a) > 0 ? 1 : -1;
    const double least = std::min({sense * triple(n, l, r), sense * triple(n, r, a), sense * triple(n, a, l)});
    return least >= -1e-15 && glm::dot(n, l + r + a) > 0;
}

// Every sample against every cell that is not split, with the height that the tile's plane has there.
double by_every_cell(const SampledTile& t) {
    double largest = 0;
    for (unsigned i = 1; i < 2u << t.tile.depth; ++i) {
        if (i < t.exists.size() && t.exists[i]) continue;
        if (i > 1 && !t.exists[i >> 1]) continue;
        if (i >= tile_cells && !t.covered.empty() && t.covered[i - tile_cells]) continue;
        const auto& c = tile_layout().corners[i];
        const glm::dvec3 l = t.lattice.normal(c[0]), r = t.lattice.normal(c[1]), a = t.lattice.normal(c[2]);
        const CellPlane plane(t.lattice.position(c[0]), t.lattice.position(c[1]), t.lattice.position(c[2]));
        for (std::size_t s = 0; s < t.normals.size(); ++s) {
            const glm::dvec3& n = t.normals[s];
            if (std::isnan(t.heights[s]) || !holds(l, r, a, n)) continue;
            const double x = triple(n, r, a), y = triple(n, a, l), z = triple(n, l, r);
            const double N =
                (x * t.tile.undulation[c[0]].m + y * t.tile.undulation[c[1]].m + z * t.tile.undulation[c[2]].m) /
                (x + y + z);
            const double h = plane.above(t.placement.ecef(n, 0, {}), n);
            largest = std::max(largest, std::abs(static_cast<double>(t.heights[s]) - (h - N)));
        }
    }
    return largest;
}

float found(const SampledTile& t, std::size_t piece, std::size_t* exact = nullptr) {
    SampleDistance distance;
    distance.start(t.placement, t.tile, t.lattice, t.exists, t.covered);
    for (std::size_t s = 0; s < t.normals.size(); s += piece) {
        const std::size_t n = std::min(piece, t.normals.size() - s);
        distance.add(std::span(t.normals).subspan(s, n), std::span(t.heights).subspan(s, n));
    }
    if (exact) *exact = distance.measured_exactly();
    return distance.largest();
}

void expect_exact(const SampledTile& t) {
    const double expected = by_every_cell(t);
    const float largest = found(t, 64);
    EXPECT_GE(static_cast<double>(largest), expected * (1 - 1e-9));
    EXPECT_FLOAT_EQ(largest, static_cast<float>(expected));
    for (const std::size_t piece : {1u, 3u, 8u, 65u, 1000u}) EXPECT_EQ(found(t, piece), largest) << piece;
}

TEST(SampleDistance, IsThatOfEverySampleFromEveryCell) {
    unsigned seed = 0;
    for (const char* name : {"N0.100110101011010010111010", "S1.010110100101", "N3.001011100101"})
        for (const int depth : {1, 2, 5, 8, 11, 12})
            for (const bool whole : {true, false}) {
                SCOPED_TRACE(std::string(name) + " " + std::to_string(depth) + (whole ? " whole" : ""));
                SampledTile t(name, depth, whole, 800, ++seed);
                t.add_samples(300, 12000);
                expect_exact(t);
            }
}

TEST(SampleDistance, OfAFaceIsExactToo) {
    SampledTile t("S2", 7, false, 3000, 5);
    t.add_samples(400, 1e5f);
    expect_exact(t);
}

TEST(SampleDistance, CoveredCellsBelongToTheTilesBelow) {
    SampledTile t("N2.110100101101", 12, true, 500, 6);
    t.add_samples(500, 50);
    const float uncovered = found(t, 64);
    t.covered.assign(tile_cells, 0);
    EXPECT_EQ(found(t, 64), uncovered);
    for (std::size_t k = 0; k < tile_cells; k += 3) t.covered[k] = 1;
    expect_exact(t);
    t.covered.assign(tile_cells, 1);
    EXPECT_EQ(found(t, 64), 0.0f);
}

TEST(SampleDistance, AtVerticesAndOnSidesASampleCounts) {
    for (const bool whole : {true, false}) {
        SampledTile t("S0.011010010110", 6, whole, 300, 7);
        for (unsigned i = 1; i < t.exists.size(); ++i) {
            if (!t.exists[i]) continue;
            const std::size_t v = tile_layout().split_vertex[i];
            t.normals.push_back(t.lattice.normal(v));
            t.heights.push_back(t.tile.height[v]);
        }
        EXPECT_LT(found(t, 64), 1e-6f);  // the surface goes through its vertices
        for (std::size_t k = 0; k < t.normals.size(); ++k) {
            SampledTile one = t;
            one.heights[k] += 70;
            EXPECT_NEAR(found(one, 64), 70, 1e-4) << k;
        }
    }
}

TEST(SampleDistance, VoidsAndSamplesElsewhereDoNotCount) {
    SampledTile t("N1.101001011010", 9, true, 100, 8);
    const glm::dvec3 inside = t.lattice.normal(20);
    t.normals = {inside, -inside, glm::dvec3(0, 0, -1), t.lattice.normal(0) - 1e-9 * (inside - t.lattice.normal(0))};
    t.heights = {std::numeric_limits<float>::quiet_NaN(), 1e4f, 1e4f, 1e4f};
    EXPECT_EQ(found(t, 64), 0.0f);
    t.heights[0] = 1e3f;
    EXPECT_GT(found(t, 64), 800.0f);
    t.exists.assign(t.exists.size(), 0);  // no surface of its own
    EXPECT_EQ(found(t, 64), 0.0f);
}

TEST(SampleDistance, FewSamplesAreMeasuredExactly) {
    SampledTile t("N0.100110101011010010111010", 11, true, 2, 9);
    t.add_samples(20000, 300);
    std::size_t exact = 0;
    found(t, 64, &exact);
    EXPECT_GT(exact, 0u);
    EXPECT_LT(exact, 400u);
}

}  // namespace
}  // namespace planet
