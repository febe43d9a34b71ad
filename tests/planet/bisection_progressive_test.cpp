// The progressive form: prefixes, closed subsets, morphs, point location, files.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "bisection_meshes.h"
#include "planet/bisection/progressive_file.h"
#include "planet/error.h"

namespace planet {
namespace {

using Index = Progressive::Index;

constexpr BisectionRule rules[] = {BisectionRule::modified, BisectionRule::plain};

Bisection refined(const PlainMesh& base, BisectionRule rule, std::size_t triangles, unsigned seed, bool at_random) {
    Bisection mesh(base, {rule});
    std::mt19937 random(seed);
    if (at_random)
        while (mesh.triangle_count() < triangles)
            mesh.split(static_cast<std::uint32_t>(random() % mesh.triangle_count()));
    RefineGoal goal;
    goal.max_triangles = std::max(triangles, mesh.triangle_count());
    mesh.refine(goal);
    return mesh;
}

// Two triangles each, in which one side of the first is of an obtuse, an acute or a (2)-triangle, and a random mesh.
std::vector<std::pair<const char*, PlainMesh>> shapes() {
    const auto pair_of = [](double x, double y) {
        PlainMesh mesh = one_triangle(x, y);
        mesh.vertices.emplace_back(0.55, -0.4, 0);
        mesh.triangles.push_back({1, 0, 3});
        return mesh;
    };
    return {{"obtuse", pair_of(0.6, 0.2)},      {"acute", pair_of(0.9, 0.3)}, {"(2)", pair_of(0.6, 0.6)},
            {"squares", halved_squares(2, 2)},  {"hexagon", hexagon()},       {"octahedron", octahedron()},
            {"random", random_mesh(20, 5, 200)}};
}

using Corners = std::array<std::array<double, 3>, 3>;
std::vector<Corners> sorted_triangles(const PlainMesh& mesh) {
    std::vector<Corners> out;
    for (const auto& t : mesh.triangles) {
        Corners c;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 p = mesh.vertices[t[k]];
            c[k] = {p.x, p.y, p.z};
        }
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        out.push_back(c);
    }
    std::sort(out.begin(), out.end());
    return out;
}

TEST(BisectionProgressive, TheWholeIsTheBisection) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : shapes())
            for (const bool at_random : {false, true}) {
                SCOPED_TRACE(name);
                const Bisection mesh = refined(base, rule, 600, 3, at_random);
                const Progressive whole = mesh.progressive();
                EXPECT_EQ(whole.split_count(), mesh.vertex_count() - mesh.base_vertex_count());
                const PlainMesh direct = mesh.mesh();
                const PlainMesh through = whole.prefix(whole.split_count());
                EXPECT_EQ(direct.vertices, through.vertices);
                EXPECT_EQ(sorted_triangles(direct), sorted_triangles(through));
            }
}

TEST(BisectionProgressive, EveryPrefixIsTheMeshOfThatTime) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : shapes()) {
            SCOPED_TRACE(name);
            Bisection mesh(base, {rule});
            std::mt19937 random(9);
            std::map<Index, PlainMesh> states;
            while (mesh.triangle_count() < 200) {
                mesh.split(static_cast<std::uint32_t>(random() % mesh.triangle_count()));
                states[static_cast<Index>(mesh.vertex_count() - mesh.base_vertex_count())] = mesh.mesh();
            }
            const Progressive whole = mesh.progressive();
            for (Index n = 0; n <= whole.split_count(); ++n) {
                const PlainMesh prefix = whole.prefix(n);
                ASSERT_EQ(conforming(prefix, base), "") << n;
                if (states.contains(n)) {
                    ASSERT_EQ(sorted_triangles(prefix), sorted_triangles(states[n]));
                }
            }
        }
}

TEST(BisectionProgressive, AnyClosedSubsetIsConforming) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : shapes()) {
            SCOPED_TRACE(name);
            const Progressive whole = refined(base, rule, 400, 4, true).progressive();
            std::mt19937 random(5);
            const double total = area(base);
            for (int round = 0; round < 100; ++round) {
                Selection selection(whole);
                const auto wanted = random() % 30;
                for (unsigned i = 0; i < wanted; ++i)
                    selection.insert(whole.base_vertex_count() + static_cast<Index>(random() % whole.split_count()));
                const PlainMesh mesh = selection.mesh();
                ASSERT_EQ(conforming(mesh, base), "");
                ASSERT_NEAR(area(mesh), total, 1e-9 * total);
                std::set<Index> used;
                for (const auto& t : mesh.triangles) used.insert(t.begin(), t.end());
                ASSERT_EQ(used.size(), selection.vertex_count()) << "every vertex that is in is a corner";
            }
        }
}

TEST(BisectionProgressive, AVertexDependsOnTwoAtMostAndEachOfThemIsNeeded) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : shapes()) {
            SCOPED_TRACE(name);
            const Progressive whole = refined(base, rule, 300, 6, true).progressive();
            for (Index v = whole.base_vertex_count(); v < whole.vertex_count(); ++v) {
                const auto [a, b] = whole.ends(v);
                ASSERT_LT(std::max(a, b), v);
                for (const Index needed : whole.dependencies(v)) {
                    if (needed == Progressive::none) continue;
                    ASSERT_LT(needed, v);
                    const auto back = whole.dependents(needed);
                    ASSERT_NE(std::find(back.begin(), back.end(), v), back.end());
                }
            }
        }
}

TEST(BisectionProgressive, RemovalUndoesInsertion) {
    for (const BisectionRule rule : rules)
        for (const auto& [name, base] : shapes()) {
            SCOPED_TRACE(name);
            const Progressive whole = refined(base, rule, 500, 8, false).progressive();
            Selection selection(whole);
            std::mt19937 random(2);
            for (int i = 0; i < 300; ++i) {
                const Index v = whole.base_vertex_count() + static_cast<Index>(random() % whole.split_count());
                const std::size_t before = selection.vertex_count();
                if (random() % 2 == 0) {
                    const std::size_t inserted = selection.insert(v);
                    ASSERT_EQ(inserted, selection.vertex_count() - before);
                    ASSERT_TRUE(selection.contains(v));
                } else {
                    const std::size_t removed = selection.remove(v);
                    ASSERT_EQ(removed, before - selection.vertex_count());
                    ASSERT_FALSE(selection.contains(v));
                }
                for (Index u = whole.base_vertex_count(); u < whole.vertex_count(); ++u)
                    for (const Index needed : whole.dependencies(u))
                        ASSERT_TRUE(!selection.contains(u) || needed == Progressive::none ||
                                    selection.contains(needed));
                if (i % 20 == 0) {
                    ASSERT_EQ(conforming(selection.mesh(), base), "");
                }
            }
        }
}

// The paper lets the middle of a longest side depend on the corner opposite to it.
TEST(BisectionProgressive, TheRuleInThePaperMissesTheTriangleThatIsSplit) {
    const Progressive whole = refined(random_mesh(20, 5, 0), BisectionRule::plain, 400, 4, true).progressive();
    // By any vertex: corners across its side, unless they are of the base.
    const auto printed = [&](Index v) {
        std::vector<Index> out;
        const SplitRecord r = whole.record(v - whole.base_vertex_count());
        for (const Index side : {r.first, r.second}) {
            if (side == SplitRecord::no_side) continue;
            const auto half = whole.halves(side / 3);
            const Index apex = half[0].corners[2];
            if (apex >= whole.base_vertex_count()) out.push_back(apex);
        }
        return out;
    };
    std::size_t missing = 0;
    for (Index v = whole.base_vertex_count(); v < whole.vertex_count(); ++v) {
        std::set<Index> closed = {v};
        for (bool grown = true; grown;) {
            grown = false;
            for (const Index u : std::set<Index>(closed))
                for (const Index needed : printed(u)) grown |= closed.insert(needed).second;
        }
        for (const Index u : closed)
            for (const Index needed : whole.dependencies(u))
                missing += needed != Progressive::none && !closed.contains(needed);
    }
    EXPECT_GT(missing, 0u);
}

TEST(BisectionProgressive, SelectionIsTheLeastThatHoldsWhatIsWanted) {
    const Progressive whole = refined(random_mesh(50, 6, 100), BisectionRule::modified, 3000, 1, false).progressive();
    const auto wanted = [&](Index v) { return length(glm::dvec2(whole.place(v)) - glm::dvec2(3e5, 4e5)) < 1e5; };
    Selection selection(whole);
    selection.select(wanted);
    EXPECT_EQ(conforming(selection.mesh(), whole.base()), "");
    // Whatever is in is wanted, or something that is wanted needs it.
    for (Index v = whole.base_vertex_count(); v < whole.vertex_count(); ++v) {
        if (wanted(v)) {
            EXPECT_TRUE(selection.contains(v));
        }
        if (!selection.contains(v) || wanted(v)) continue;
        bool needed = false;
        for (const Index u : whole.dependents(v)) needed |= selection.contains(u);
        EXPECT_TRUE(needed);
    }
    EXPECT_LT(selection.vertex_count(), whole.vertex_count() / 2);
}

TEST(BisectionProgressive, ChildrenPartitionTheirParent) {
    for (const BisectionRule rule : rules) {
        const Progressive whole = refined(random_mesh(10, 3, 0), rule, 3000, 2, true).progressive();
        const auto area_of = [&](const std::array<Index, 3>& c) {
            return cross(whole.place(c[1]) - whole.place(c[0]), whole.place(c[2]) - whole.place(c[0])).z;
        };
        Selection all(whole);
        all.set_prefix(whole.split_count());
        std::vector<Progressive::Child> stack;
        for (Index t = 0; t < whole.base().triangles.size(); ++t) stack.push_back({t, whole.base_corners(t)});
        std::size_t fours = 0;
        while (!stack.empty()) {
            const auto top = stack.back();
            stack.pop_back();
            const auto below = all.children(top.name);
            if (below.count == 0) continue;
            fours += below.count == 4;
            double sum = 0;
            for (int i = 0; i < below.count; ++i) {
                const auto& child = below.child[static_cast<std::size_t>(i)];
                const double a = area_of(child.corners);
                ASSERT_GT(a, 0);
                ASSERT_NEAR(a, area_of(top.corners) / below.count, 1e-6 * area_of(top.corners));
                sum += a;
                stack.push_back(child);
            }
            ASSERT_NEAR(sum, area_of(top.corners), 1e-9 * sum);
        }
        EXPECT_EQ(fours > 0, rule == BisectionRule::modified);
    }
}

TEST(BisectionProgressive, PointsAreFoundInLogarithmicTime) {
    for (const BisectionRule rule : rules) {
        std::vector<double> mean;
        for (const int size : {1, 16, 256}) {  // 16 times the triangles each time, in the base and below it
            const Bisection mesh =
                refined(random_mesh(20 * size, 3, 0), rule, 800u * static_cast<unsigned>(size), 1, false);
            const Progressive whole = mesh.progressive();
            Selection all(whole);
            all.set_prefix(whole.split_count());
            const PointLocator locator(whole);
            std::mt19937 random(4);
            std::uniform_real_distribution<double> in(0, 1 << 20);
            double sum = 0;
            for (int i = 0; i < 500; ++i) {
                const glm::dvec2 p(in(random), in(random));
                const auto found = locator.locate(all, p);
                ASSERT_TRUE(found);
                for (std::size_t k = 0; k < 3; ++k) {
                    const glm::dvec2 a(whole.place(found->corners[k])), b(whole.place(found->corners[(k + 1) % 3]));
                    ASSERT_GE((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x), -1e-3);
                }
                sum += found->comparisons;
            }
            mean.push_back(sum / 500);
            EXPECT_FALSE(locator.locate(all, {-5, 3}));
        }
        EXPECT_LT(mean[0], 60);
        EXPECT_LT(mean[2] - mean[1], 1.5 * (mean[1] - mean[0]) + 8) << "as much more for 16 times as many again";
    }
}

TEST(BisectionProgressive, MorphGoesFromTheCoarseMeshToTheFine) {
    const PlainMesh base = halved_squares(2, 2, 10);
    BisectionOptions options;
    options.sides = SideGeometry::plan;
    options.place = [](const glm::dvec3& a, const glm::dvec3& b) {
        const glm::dvec3 p = (a + b) * 0.5;
        return glm::dvec3(p.x, p.y, std::sin(p.x) * std::cos(p.y));
    };
    Bisection mesh(base, options);
    for (int i = 0; i < 4; ++i) mesh.step();
    const Progressive whole = mesh.progressive();
    Selection all(whole);
    all.set_prefix(whole.split_count());
    const PlainMesh at_start = all.mesh([](Index) { return 0.0; });
    for (const glm::dvec3& p : at_start.vertices) EXPECT_EQ(p.z, 0);
    EXPECT_EQ(all.mesh([](Index) { return 1.0; }).vertices, all.mesh().vertices);
    double before = 0;
    for (const double s : {0.2, 0.5, 0.8, 1.0}) {
        const PlainMesh now = all.mesh([&](Index) { return morph_fraction(1 + s); });
        double highest = 0;
        for (const glm::dvec3& p : now.vertices) highest = std::max(highest, std::abs(p.z));
        EXPECT_GT(highest, before);
        before = highest;
    }
}

TEST(BisectionProgressive, AttributesAreMeansOfTheEnds) {
    PlainMesh base = random_mesh(30, 2, 50);
    base.attribute_width = 2;
    for (const glm::dvec3& p : base.vertices) {
        base.attributes.push_back(static_cast<float>(p.x));
        base.attributes.push_back(static_cast<float>(p.y));
    }
    const Bisection mesh = refined(base, BisectionRule::modified, 2000, 1, false);
    for (const PlainMesh& m : {mesh.mesh(), mesh.progressive().prefix(500)}) {
        ASSERT_EQ(m.attributes.size(), 2 * m.vertices.size());
        for (std::size_t v = 0; v < m.vertices.size(); ++v) {
            EXPECT_NEAR(m.attributes[2 * v], m.vertices[v].x, 1);
            EXPECT_NEAR(m.attributes[2 * v + 1], m.vertices[v].y, 1);
        }
    }
}

// ---- files ----

Progressive hilly(SideGeometry sides, BisectionRule rule = BisectionRule::modified) {
    PlainMesh base = random_mesh(40, 3, 0);
    base.attribute_width = 3;
    base.attributes.resize(3 * base.vertices.size(), 0.5f);
    BisectionOptions options{rule, sides, {}};
    options.place = [&](const glm::dvec3& a, const glm::dvec3& b) {
        const glm::dvec3 p = (a + b) * 0.5;
        return sides == SideGeometry::plan ? glm::dvec3(p.x, p.y, 100 * std::sin(p.x * 1e-5))
                                           : p + glm::dvec3(1.5, -2.5, 100 * std::sin(p.x * 1e-5));
    };
    Bisection mesh(base, options);
    RefineGoal goal;
    goal.max_triangles = 40'000;
    mesh.refine(goal);
    Progressive out = mesh.progressive();
    out.set_note("crs EPSG:32613");
    return out;
}

TEST(BisectionFile, ReadsBackWhatWasWritten) {
    for (const SideGeometry sides : {SideGeometry::plan, SideGeometry::space})
        for (const BisectionRule rule : rules) {
            const Progressive mesh = hilly(sides, rule);
            const auto bytes = encode_progressive(mesh);
            const Progressive back = decode_progressive(bytes, "x.oprog");
            EXPECT_EQ(back.rule(), rule);
            EXPECT_EQ(back.sides(), sides);
            EXPECT_EQ(back.note(), "crs EPSG:32613");
            EXPECT_EQ(back.base().attributes, mesh.base().attributes);
            EXPECT_TRUE(std::equal(mesh.places().begin(), mesh.places().end(), back.places().begin()));
            EXPECT_EQ(back.prefix(back.split_count()).triangles, mesh.prefix(mesh.split_count()).triangles);
            const Progressive part = decode_progressive(bytes, "x.oprog", 0.35);
            EXPECT_EQ(part.split_count(), std::llround(0.35 * mesh.split_count()));
            EXPECT_EQ(part.prefix(part.split_count()).triangles, mesh.prefix(part.split_count()).triangles);
        }
}

TEST(BisectionFile, IsCompact) {
    const auto bytes_a_vertex = [](const Progressive& mesh, double quantum) {
        const auto with = encode_progressive(mesh, {quantum});
        const double base =
            48 + 24. * mesh.base_vertex_count() + 12. * static_cast<double>(mesh.base().triangles.size());
        return (static_cast<double>(with.size()) - base) / mesh.split_count();
    };
    const Progressive flat = refined(random_mesh(50, 2, 0), BisectionRule::modified, 60'000, 1, false).progressive();
    EXPECT_LT(bytes_a_vertex(flat, 0), 5.5);
    EXPECT_LT(bytes_a_vertex(hilly(SideGeometry::plan), 1. / 256), 8.5);
}

TEST(BisectionFile, RoundsPlacesToTheQuantum) {
    for (const SideGeometry sides : {SideGeometry::plan, SideGeometry::space}) {
        const Progressive mesh = hilly(sides);
        const Progressive back = decode_progressive(encode_progressive(mesh, {1. / 64}), "x.oprog");
        double most = 0;
        for (Index v = 0; v < mesh.vertex_count(); ++v) {
            const glm::dvec3 d = glm::abs(mesh.place(v) - back.place(v));
            most = std::max({most, d.x, d.y, d.z});
        }
        EXPECT_LE(most, 1. / 128 + 1e-9);
        EXPECT_GT(most, 1. / 300);
    }
    EXPECT_THROW((void)encode_progressive(hilly(SideGeometry::plan), {0.3}), Error);
    EXPECT_THROW((void)encode_progressive(hilly(SideGeometry::plan), {-1}), Error);
    EXPECT_THROW((void)encode_progressive(hilly(SideGeometry::space), {0x1p-80}), Error);
}

TEST(BisectionFile, RefusesDamage) {
    const Progressive mesh = refined(random_mesh(20, 2, 30), BisectionRule::modified, 300, 1, true).progressive();
    const auto bytes = encode_progressive(mesh);
    EXPECT_NO_THROW((void)decode_progressive(bytes, "x"));
    for (std::size_t size = 0; size < bytes.size(); size += size < 100 ? 1 : 13)
        EXPECT_THROW((void)decode_progressive(std::span(bytes).first(size), "x"), Error) << size;
    auto longer = bytes;
    longer.push_back(0);
    EXPECT_THROW((void)decode_progressive(longer, "x"), Error);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        auto damaged = bytes;
        damaged[i] ^= static_cast<std::uint8_t>(1u << (i % 8));
        EXPECT_THROW((void)decode_progressive(damaged, "x"), Error) << "byte " << i;
    }
    EXPECT_THROW((void)decode_progressive(bytes, "x", -0.1), Error);
    EXPECT_THROW((void)decode_progressive(bytes, "x", NAN), Error);
    EXPECT_THROW((void)read_progressive("/no/such/file.oprog"), Error);
    EXPECT_THROW((void)read_progressive("/"), Error);
}

// As RefusesDamage, with checksums that are right: what is left is refused, or is some mesh.
TEST(BisectionFile, LyingRecordsNeitherCrashNorGrow) {
    const Progressive mesh = refined(random_mesh(20, 2, 30), BisectionRule::modified, 300, 1, true).progressive();
    std::mt19937 random(3);
    std::size_t accepted = 0;
    for (int round = 0; round < 3000; ++round) {
        Progressive other(mesh.base(), mesh.rule(), mesh.sides());
        for (Index i = 0; i < mesh.split_count(); ++i) {
            SplitRecord r = mesh.record(i);
            if (random() % 20 == 0) r.first = static_cast<Index>(random() % (3 * other.name_count() + 5));
            if (random() % 20 == 0) r.second = static_cast<Index>(random() % (3 * other.name_count() + 5));
            if (random() % 20 == 0) r.second = SplitRecord::no_side;
            if (random() % 10 == 0) r.flags = static_cast<std::uint8_t>(random() % 16);
            if (!other.append(r)) break;
            ++accepted;
        }
        const PlainMesh some = other.prefix(other.split_count());
        for (const auto& t : some.triangles)
            for (const Index v : t) ASSERT_LT(v, some.vertices.size());
        Selection selection(other);
        for (Index v = other.base_vertex_count(); v < other.vertex_count(); ++v) selection.insert(v);
    }
    EXPECT_GT(accepted, 3000u);
}

}  // namespace
}  // namespace planet
