// Whole-domain properties of addresses: every code to quadtree level 8 (bisection level 16), faces and seams included.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "planet/frames.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {
namespace {

constexpr int whole_level = 16;

template <class Visit>
void for_every_cell(int last_level, Visit visit) {
    struct Recursion {
        int last;
        Visit& visit;
        void operator()(LocationCode cell, const Corners& c) {
            visit(cell, c);
            if (cell.bisection_level() == last) return;
            const glm::dvec3 m = split_vertex(c);
            for (int i = 0; i < 2; ++i) (*this)(cell.child(i), child_corners(c, m, i));
        }
    } recursion{last_level, visit};
    for (int f = 0; f < face_count; ++f) recursion(LocationCode::face_root(f), face_corners(f));
}

int shared_corners(const Corners& a, const Corners& b) {
    int n = 0;
    for (const auto& p : {a.left, a.right, a.apex}) n += p == b.left || p == b.right || p == b.apex;
    return n;
}

TEST(LocationCode, AddressArithmeticIsConsistentForEveryCode) {
    std::size_t count = 0;
    for_every_cell(whole_level, [&](LocationCode cell, const Corners&) {
        ++count;
        const int d = cell.bisection_level();
        ASSERT_EQ(LocationCode::from_path(cell.face(), d, cell.path()), cell);
        ASSERT_EQ(parse_code(to_string(cell)), cell);
        ASSERT_EQ(cell.level(), d / 2);
        if (d == 0) return;
        ASSERT_EQ(cell.parent().child(cell.child_index()), cell);
        ASSERT_EQ(cell.sibling().sibling(), cell);
        ASSERT_TRUE(cell.parent().contains(cell));
        ASSERT_FALSE(cell.contains(cell.parent()));
        ASSERT_EQ(cell.ancestor(0), LocationCode::face_root(cell.face()));
        ASSERT_LE(cell.parent().first_at(d), cell.bits());
        ASSERT_LT(cell.bits(), cell.parent().end_at(d));
    });
    EXPECT_EQ(count, 8u * ((1u << 17) - 1));
}

TEST(LocationCode, NeighborSharesTheSplitSideBitForBit) {
    for_every_cell(whole_level, [](LocationCode cell, const Corners& c) {
        const LocationCode n = neighbor(cell);
        ASSERT_NE(n, cell);
        ASSERT_EQ(n.bisection_level(), cell.bisection_level());
        ASSERT_EQ(neighbor(n), cell) << to_string(cell);
        ASSERT_EQ(diamond(n), diamond(cell));
        const Corners k = corners(n);
        ASSERT_TRUE(k.left == c.right && k.right == c.left && k.apex != c.apex) << to_string(cell);
        ASSERT_EQ(split_vertex(k), split_vertex(c));
    });
}

TEST(LocationCode, LegNeighborsShareTheirLegAndPointBack) {
    for_every_cell(12, [](LocationCode cell, const Corners& c) {
        const LocationCode l = neighbor(cell, Side::left_leg), r = neighbor(cell, Side::right_leg);
        const Corners kl = corners(l), kr = corners(r);
        ASSERT_EQ(shared_corners(c, kl), 2) << to_string(cell);
        ASSERT_EQ(shared_corners(c, kr), 2) << to_string(cell);
        ASSERT_EQ(kl.apex, c.apex);
        ASSERT_EQ(kl.right, c.left);
        ASSERT_EQ(kr.apex, c.apex);
        ASSERT_EQ(kr.left, c.right);
        ASSERT_EQ(neighbor(l, Side::right_leg), cell);
        ASSERT_EQ(neighbor(r, Side::left_leg), cell);
    });
}

TEST(LocationCode, DeepNeighborsAgreeWithGeometry) {
    std::mt19937_64 random(7);
    for (int i = 0; i < 20000; ++i) {
        const int d = 17 + static_cast<int>(random() % 36);
        const auto cell = LocationCode::from_path(static_cast<int>(random() % 8), d, random() & ((1ull << d) - 1));
        const Corners c = corners(cell), k = corners(neighbor(cell));
        ASSERT_TRUE(k.left == c.right && k.right == c.left) << to_string(cell);
    }
}

TEST(SierpinskiOrder, IsOneClosedLoopAtEveryLevel) {
    for (int d = 0; d <= 13; ++d) {
        LocationCode cell = LocationCode::from_path(0, d, 0);
        const LocationCode start = cell;
        std::size_t steps = 0;
        do {
            const LocationCode next = next_on_loop(cell);
            ASSERT_GE(shared_corners(corners(cell), corners(next)), 2) << to_string(cell) << " " << to_string(next);
            cell = next;
            ++steps;
        } while (cell != start && steps <= (8u << d));
        EXPECT_EQ(steps, 8u << d);
    }
}

TEST(OctahedronMap, CellAtFindsEveryCell) {
    for_every_cell(whole_level, [](LocationCode cell, const Corners& c) {
        ASSERT_EQ(cell_at(c.left + c.right + c.apex, cell.bisection_level()), cell) << to_string(cell);
        ASSERT_GT(glm::dot(glm::cross(c.left, c.right), c.apex) * (is_counter_clockwise(cell) ? 1 : -1), 0);
    });
}

// A direction on a seam belongs to one of the cells that touch it, the same one however its zeros are signed.
TEST(OctahedronMap, SeamsPolesAndSignedZeros) {
    const double pi = std::numbers::pi;
    std::vector<glm::dvec3> seams;
    for (int i = 0; i < 4; ++i) {
        for (double t = -90; t <= 90; t += 7.5) seams.push_back(normal_from_geodetic(t * degrees, i * pi / 2));
        for (double t = 0; t < 90; t += 3.75) seams.push_back(normal_from_geodetic(0, i * pi / 2 + t * degrees));
    }
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0),
                                  glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)})
        seams.push_back(axis);
    for (const glm::dvec3& n : seams)
        for (int d : {0, 1, 2, 11, 12, 24, 40}) {
            const LocationCode cell = cell_at(n, d);
            const Corners c = corners(cell);
            // Inside or on the border: on the inner side of all three side planes, to rounding.
            const double sign = is_counter_clockwise(cell) ? 1 : -1;
            const double tolerance = -4e-16;
            EXPECT_GE(sign * glm::dot(glm::cross(c.left, c.right), n), tolerance);
            EXPECT_GE(sign * glm::dot(glm::cross(c.right, c.apex), n), tolerance);
            EXPECT_GE(sign * glm::dot(glm::cross(c.apex, c.left), n), tolerance);
        }
    EXPECT_EQ(cell_at({1, -0.0, -0.0}, 30), cell_at({1, 0.0, 0.0}, 30));
    EXPECT_EQ(cell_at({-0.0, -0.0, 1}, 30), cell_at({0.0, 0.0, 1}, 30));
    EXPECT_EQ(cell_at(normal_from_geodetic(0.3, pi), 20),
              cell_at({-std::cos(0.3), std::sin(pi) * std::cos(0.3), std::sin(0.3)}, 20));
}

TEST(OctahedronMap, NaNEndsInSomeCell) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cell_at({nan, nan, nan}, 20).bisection_level(), 20);
}

TEST(CellMetrics, MatchGeometryAndStatedFigures) {
    for_every_cell(14, [](LocationCode cell, const Corners& c) {
        const CellMetrics& m = cell_metrics(cell.bisection_level());
        const double split = glm::distance(c.left, c.right);
        ASSERT_GE(split, m.split_min - 1e-15);
        ASSERT_LE(split, m.split_max + 1e-15);
        ASSERT_LE(glm::distance(c.left, c.apex), m.side_max + 1e-15);
        ASSERT_GE(glm::distance(c.apex, c.right), m.side_min - 1e-15);
    });
    const double R = 6371008.8;
    EXPECT_NEAR(cell_metrics(0).vertex_spacing * R, 11292e3 * std::sqrt(4.0 / 6), 40e3);  // 6 vertices, not 4
    EXPECT_NEAR(cell_metrics(20).vertex_spacing * R, 11292e3 / 1024, 12);
    EXPECT_NEAR(cell_metrics(56).side_max * R, 0.084, 0.001);
    EXPECT_EQ(level_for_spacing(9260, R), 21);
    // How uneven the planet is: split sides part by up to 2.25 at even levels (1.48 at odd ones), areas by 1.54.
    EXPECT_NEAR(cell_metrics(14).split_max / cell_metrics(14).split_min, 2.243, 0.002);
    EXPECT_NEAR(cell_metrics(15).split_max / cell_metrics(15).split_min, 1.474, 0.002);
    EXPECT_NEAR(cell_metrics(15).area_max / cell_metrics(15).area_min, 1.540, 0.002);
    EXPECT_NEAR(cell_metrics(15).angle_min / degrees, 18.44, 0.01);
}

}  // namespace
}  // namespace planet
