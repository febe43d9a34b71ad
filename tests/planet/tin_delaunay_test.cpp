// The Delaunay triangulation: every input that breaks inexact ones, removal, constrained sides.

#include "planet/tin/delaunay.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace planet {
namespace {

using Index = Delaunay::Index;

glm::ivec2 random_point(std::mt19937& random, glm::ivec2 low, glm::ivec2 high) {
    return {std::uniform_int_distribution(low.x, high.x)(random), std::uniform_int_distribution(low.y, high.y)(random)};
}

std::int64_t doubled_area(const Delaunay& mesh) {
    std::int64_t area = 0;
    for (Index t = 0; t < mesh.triangle_slots(); ++t)
        if (mesh.alive(t)) area += orientation(mesh.corners(t)[0], mesh.corners(t)[1], mesh.corners(t)[2]);
    return area;
}

// No vertex in any circle, by brute force: what check() concludes from neighbours only.
bool empty_circles(const Delaunay& mesh) {
    for (Index t = 0; t < mesh.triangle_slots(); ++t) {
        if (!mesh.alive(t)) continue;
        const auto c = mesh.corners(t);
        for (Index v = 0; v < mesh.vertex_slots(); ++v)
            if (mesh.vertex_alive(v) && in_circle(c[0], c[1], c[2], mesh.point(v))) return false;
    }
    return true;
}

TEST(TinDelaunay, StartsAsTwoTriangles) {
    const Delaunay mesh({0, 0}, {10, 7});
    EXPECT_EQ(mesh.check(), "");
    EXPECT_EQ(mesh.triangle_count(), 2u);
    EXPECT_EQ(mesh.vertex_count(), 4u);
    EXPECT_EQ(doubled_area(mesh), 140);
}

TEST(TinDelaunay, StartsAsAGrid) {
    const std::array columns{0, 3, 4, 9};
    const std::array rows{-2, 5, 6};
    const Delaunay mesh(columns, rows);
    EXPECT_EQ(mesh.check(), "");
    EXPECT_EQ(mesh.triangle_count(), 12u);
    EXPECT_EQ(mesh.point(1 * 4 + 2), glm::ivec2(4, 5));
    for (Index cell = 0; cell < 6; ++cell)
        EXPECT_EQ(mesh.corners(2 * cell)[0], glm::ivec2(columns[cell % 3], rows[cell / 3])) << cell;
}

TEST(TinDelaunay, PredicatesAreExactAtTheEndsOfTheRange) {
    const int m = Delaunay::max_coordinate;
    EXPECT_EQ(orientation({-m, -m}, {m, m}, {0, 1}), 2 * std::int64_t{m});
    EXPECT_EQ(orientation({-m, -m}, {m, m}, {m - 1, m - 1}), 0);
    EXPECT_EQ(orientation({-m, m}, {m, -m}, {-m, -m}), -4 * std::int64_t{m} * m);
    EXPECT_FALSE(in_circle({-m, -m}, {m, -m}, {m, m}, {-m, m}));  // on it
    EXPECT_TRUE(in_circle({-m, -m}, {m, -m}, {m, m}, {-m, m - 1}));
    EXPECT_TRUE(in_circle({-m, -m}, {m, -m}, {m, m}, {-m + 1, m}));
}

TEST(TinDelaunay, AFullGridInAnyOrder) {
    std::vector<glm::ivec2> points;
    for (int y = 0; y <= 12; ++y)
        for (int x = 0; x <= 15; ++x) points.emplace_back(x, y);
    for (unsigned seed = 0; seed < 5; ++seed) {
        if (seed != 0) std::shuffle(points.begin(), points.end(), std::mt19937(seed));
        Delaunay mesh({0, 0}, {15, 12});
        for (const glm::ivec2 p : points) mesh.insert(p);
        EXPECT_EQ(mesh.check(), "") << seed;
        EXPECT_EQ(mesh.triangle_count(), 2u * 15 * 12);
        EXPECT_EQ(doubled_area(mesh), 2 * 15 * 12);
    }
}

TEST(TinDelaunay, CollinearPointsOnBordersAndInside) {
    Delaunay mesh({0, 0}, {100, 100});
    for (int i = 0; i <= 100; i += 5)
        for (const glm::ivec2 p : {glm::ivec2(i, 0), {i, 100}, {0, i}, {100, i}, {i, i}, {i, 50}}) mesh.insert(p);
    EXPECT_EQ(mesh.check(), "");
    EXPECT_TRUE(empty_circles(mesh));
    EXPECT_EQ(doubled_area(mesh), 20000);
}

TEST(TinDelaunay, CocircularPoints) {
    Delaunay mesh({0, 0}, {1300, 1300});
    // Pythagorean triples about (650, 650): 36 points on one circle of radius 325.
    for (int x = -325; x <= 325; ++x)
        for (int y = -325; y <= 325; ++y)
            if (x * x + y * y == 325 * 325) mesh.insert({650 + x, 650 + y});
    EXPECT_GT(mesh.vertex_count(), 30u);
    EXPECT_EQ(mesh.check(), "");
    EXPECT_TRUE(empty_circles(mesh));
    const Delaunay::Location middle = mesh.locate({650, 650});
    mesh.insert({650, 650}, middle);
    EXPECT_EQ(mesh.changed().size(), mesh.vertex_count() - 5) << "a fan of all points on the circle";
    EXPECT_EQ(mesh.check(), "");
}

TEST(TinDelaunay, RandomPointsHaveEmptyCircles) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        std::mt19937 random(seed);
        const glm::ivec2 high = seed % 2 ? glm::ivec2(40, 25) : glm::ivec2(100000, 3);
        Delaunay mesh({0, 0}, high);
        std::set<std::pair<int, int>> points{{0, 0}, {high.x, 0}, {0, high.y}, {high.x, high.y}};
        for (int i = 0; i < 200; ++i) {
            const glm::ivec2 p = random_point(random, {0, 0}, high);
            points.insert({p.x, p.y});
            const Index v = mesh.insert(p);
            EXPECT_EQ(mesh.point(v), p);
        }
        EXPECT_EQ(mesh.vertex_count(), points.size());
        EXPECT_EQ(mesh.check(), "");
        EXPECT_TRUE(empty_circles(mesh));
    }
}

TEST(TinDelaunay, APlannedInsertionIsWhatComes) {
    std::mt19937 random(3);
    Delaunay mesh({0, 0}, {60, 60});
    for (int i = 0; i < 300; ++i) {
        const glm::ivec2 p = random_point(random, {0, 0}, {60, 60});
        const Delaunay::Location at = mesh.locate(p);
        if (at.vertex != Delaunay::none) continue;
        mesh.plan_insertion(p, at);
        const std::size_t before = mesh.triangle_count();
        const std::vector<Index> ring(mesh.ring().begin(), mesh.ring().end());
        const bool open = mesh.open_ring();
        const Index v = mesh.insert_planned();
        ASSERT_EQ(mesh.changed().size(), open ? ring.size() - 1 : ring.size());
        EXPECT_EQ(mesh.triangle_count() - before, open ? 1u : 2u);
        for (std::size_t k = 0; k < mesh.changed().size(); ++k)
            EXPECT_EQ(mesh.vertices(mesh.changed()[k]), (std::array{ring[k], ring[(k + 1) % ring.size()], v}));
    }
    EXPECT_EQ(mesh.check(), "");
}

TEST(TinDelaunay, LocatesVerticesSidesAndTheInside) {
    Delaunay mesh({0, 0}, {10, 10});
    mesh.insert({4, 4});
    EXPECT_EQ(mesh.locate({4, 4}).vertex, 4u);
    const Delaunay::Location side = mesh.locate({2, 2});
    ASSERT_NE(side.side, Delaunay::none);
    EXPECT_EQ(side.vertex, Delaunay::none);
    EXPECT_EQ(side.side / 3, side.triangle);
    EXPECT_EQ(mesh.locate({3, 5}).side, Delaunay::none);
    EXPECT_EQ(mesh.twin(mesh.locate({5, 0}).side), Delaunay::none);
}

TEST(TinDelaunay, RemovesWhatWasInserted) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        std::mt19937 random(seed);
        const int size = seed % 2 ? 12 : 400;  // crowded: most circles hold several points on them
        Delaunay mesh({0, 0}, {size, size});
        std::map<std::pair<int, int>, Index> inside;
        int refills = 50;
        for (int i = 0; i < 150; ++i) {
            const glm::ivec2 p = random_point(random, {1, 1}, {size - 1, size - 1});
            inside[{p.x, p.y}] = mesh.insert(p);
        }
        while (!inside.empty()) {
            auto chosen = inside.begin();
            std::advance(chosen, static_cast<long>(random() % inside.size()));
            ASSERT_TRUE(mesh.plan_removal(chosen->second));
            const std::vector<std::array<Index, 3>> filling(mesh.filling().begin(), mesh.filling().end());
            mesh.remove_planned();
            ASSERT_EQ(mesh.changed().size(), filling.size());
            for (std::size_t k = 0; k < filling.size(); ++k) EXPECT_EQ(mesh.vertices(mesh.changed()[k]), filling[k]);
            inside.erase(chosen);
            ASSERT_EQ(mesh.check(), "");
            if (refills > 0 && inside.size() % 3 == 0) {  // slots are used again
                --refills;
                const glm::ivec2 p = random_point(random, {1, 1}, {size - 1, size - 1});
                inside[{p.x, p.y}] = mesh.insert(p);
            }
        }
        EXPECT_EQ(mesh.triangle_count(), 2u);
        EXPECT_EQ(doubled_area(mesh), 2 * std::int64_t{size} * size);
    }
}

TEST(TinDelaunay, KeepsVerticesOfTheBorder) {
    Delaunay mesh({0, 0}, {10, 10});
    const Index v = mesh.insert({5, 0});
    EXPECT_FALSE(mesh.plan_removal(v));
    EXPECT_FALSE(mesh.plan_removal(0));
    EXPECT_EQ(mesh.check(), "");
}

// The sides along a straight line between two vertices.
bool line_is_there(const Delaunay& mesh, Index a, Index b) {
    while (a != b) {
        Index next = Delaunay::none;
        for (Index t = 0; t < mesh.triangle_slots(); ++t) {
            if (!mesh.alive(t)) continue;
            for (Index e = 3 * t; e < 3 * t + 3; ++e) {
                const Index p = mesh.origin(e), q = mesh.origin(Delaunay::next(e));
                if ((p != a && q != a) || !mesh.constrained(e)) continue;
                const Index other = p == a ? q : p;
                const glm::ivec2 u = mesh.point(b) - mesh.point(a), w = mesh.point(other) - mesh.point(a);
                if (orientation(mesh.point(a), mesh.point(b), mesh.point(other)) == 0 && u.x * w.x + u.y * w.y > 0)
                    next = other;
            }
        }
        if (next == Delaunay::none) return false;
        a = next;
    }
    return true;
}

TEST(TinDelaunay, ConstrainedSidesAreThereAndStay) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        std::mt19937 random(seed);
        const int size = seed % 2 ? 20 : 500;
        Delaunay mesh({0, 0}, {size, size});
        std::vector<Index> v;
        for (int i = 0; i < 60; ++i) v.push_back(mesh.insert(random_point(random, {0, 0}, {size, size})));
        std::vector<std::array<Index, 2>> lines;
        for (int i = 0; i < 40; ++i) {
            const Index a = v[random() % v.size()], b = v[random() % v.size()];
            if (a == b) continue;
            if (mesh.constrain(a, b))
                lines.push_back({a, b});
            else
                EXPECT_NE(mesh.side_between(mesh.crossed()[0], mesh.crossed()[1]), Delaunay::none);
            ASSERT_EQ(mesh.check(), "") << seed << " " << i;
        }
        ASSERT_GT(lines.size(), 5u);
        for (int i = 0; i < 200; ++i) mesh.insert(random_point(random, {0, 0}, {size, size}));
        EXPECT_EQ(mesh.check(), "");
        EXPECT_EQ(doubled_area(mesh), 2 * std::int64_t{size} * size);
        for (const auto& [a, b] : lines) EXPECT_TRUE(line_is_there(mesh, a, b)) << seed;
    }
}

TEST(TinDelaunay, PointsOnAConstrainedSideDivideIt) {
    Delaunay mesh({0, 0}, {12, 12});
    const Index a = mesh.insert({1, 2}), b = mesh.insert({11, 7});
    mesh.insert({6, 9});
    mesh.insert({5, 2});
    ASSERT_TRUE(mesh.constrain(a, b));
    const Index m = mesh.insert({5, 4});
    EXPECT_TRUE(mesh.constrained(mesh.side_between(a, m)));
    EXPECT_TRUE(mesh.constrained(mesh.side_between(m, b)));
    EXPECT_TRUE(line_is_there(mesh, a, b));
    EXPECT_FALSE(mesh.plan_removal(m));
    EXPECT_EQ(mesh.check(), "");
}

TEST(TinDelaunay, ACrossingIsRefused) {
    Delaunay mesh({0, 0}, {10, 10});
    const Index a = mesh.insert({2, 2}), b = mesh.insert({8, 8}), c = mesh.insert({2, 8}), d = mesh.insert({8, 2});
    ASSERT_TRUE(mesh.constrain(a, b));
    ASSERT_FALSE(mesh.constrain(c, d));
    EXPECT_EQ((std::set<Index>{mesh.crossed()[0], mesh.crossed()[1]}), (std::set<Index>{a, b}));
    EXPECT_TRUE(mesh.constrain(a, b)) << "twice is once";
    EXPECT_TRUE(line_is_there(mesh, a, b));
}

TEST(TinDelaunay, RemovalBesideConstrainedSidesKeepsThem) {
    std::mt19937 random(11);
    Delaunay mesh({0, 0}, {30, 30});
    std::vector<Index> all;
    for (int i = 0; i < 150; ++i) all.push_back(mesh.insert(random_point(random, {1, 1}, {29, 29})));
    const Index a = mesh.insert({0, 3}), b = mesh.insert({30, 26});
    ASSERT_TRUE(mesh.constrain(a, b));
    int removed = 0;
    for (const Index v : all)
        if (mesh.vertex_alive(v) && mesh.plan_removal(v)) {
            mesh.remove_planned();
            ++removed;
            ASSERT_EQ(mesh.check(), "");
        }
    EXPECT_GT(removed, 80);
    EXPECT_TRUE(line_is_there(mesh, a, b));
}

}  // namespace
}  // namespace planet
