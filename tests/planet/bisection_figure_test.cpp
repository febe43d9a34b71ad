// Draws figure 2 of the paper, the angle x between CA and CC' over all places of C, and one mesh refined by both rules, into the
// test's temporary folder; planet/bisection/bisection.svg is kept from it.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "bisection_meshes.h"

namespace planet {
namespace {

constexpr double bound = 0.673408;
constexpr double panel = 400, gap = 40;

// 1: four similar triangles; 2: a right or obtuse angle at C; 3: what is left. 0: not AB >= AC >= BC.
int region(glm::dvec2 c) {
    const double ac = dot(c, c), bc = dot(c - glm::dvec2(1, 0), c - glm::dvec2(1, 0));
    if (c.y <= 0 || ac > 1 || bc > ac) return 0;
    const double median = squared_median({1, bc, ac});
    if (becomes_four({1, bc, ac}, median)) return 1;
    return median <= 0.25 ? 2 : 3;
}

// The angle ACC' over the angle at A.
double angle_ratio(glm::dvec2 c) {
    const double alpha = std::atan2(c.y, c.x);
    const glm::dvec2 to_a = -c, to_middle = glm::dvec2(0.5, 0) - c;
    const double x = std::atan2(std::abs(to_a.x * to_middle.y - to_a.y * to_middle.x), dot(to_a, to_middle));
    return x / alpha;
}

TEST(BisectionFigure, TheThreeRegionsAreAsThePaperHasThem) {
    double least = 2;
    int met[4] = {};
    for (int i = 0; i <= 400; ++i)
        for (int j = 1; j <= 400; ++j) {
            const glm::dvec2 c(0.5 + i / 800., j / 400.);
            const int where = region(c);
            ++met[where];
            const double cosine = c.x / length(c);
            if (where == 2) {
                EXPECT_GE(angle_ratio(c), 1 - 1e-12);
            }
            if (where != 3) continue;
            least = std::min(least, angle_ratio(c));
            EXPECT_LT(angle_ratio(c), 1 + 1e-12);
            EXPECT_GE(cosine, 0.75 / length(c) - 1e-12) << "cos a >= 3/4 |AB| / |AC|";
        }
    for (const int i : {1, 2, 3}) EXPECT_GT(met[i], 1000);
    EXPECT_GT(least, bound);
    // The bound is that of AC = AB and cos a = 3/4.
    EXPECT_NEAR(angle_ratio({0.75, std::sqrt(7.) / 4}), bound, 1e-6);
    EXPECT_NEAR(std::atan(std::sqrt(7.) / 5) / std::acos(0.75), bound, 1e-6);
}

class Svg {
  public:
    Svg(double width, double height) {
        out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height << "\" width=\""
             << width << "\" height=\"" << height << "\" font-family=\"sans-serif\" font-size=\"13\">\n"
             << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
        out_.setf(std::ios::fixed);
        out_.precision(1);
    }
    void polygon(std::initializer_list<glm::dvec2> corners, const std::string& style) {
        out_ << "<polygon points=\"";
        for (const glm::dvec2 p : corners) out_ << p.x << ',' << p.y << ' ';
        out_ << "\" " << style << "/>\n";
    }
    void segments(const std::vector<std::pair<glm::dvec2, glm::dvec2>>& lines, const std::string& style) {
        out_ << "<path d=\"";
        glm::dvec2 last(-1);
        for (const auto& [a, b] : lines) {
            if (length(a - last) > 0.05) out_ << 'M' << a.x << ' ' << a.y;
            out_ << 'L' << b.x << ' ' << b.y;
            last = b;
        }
        out_ << "\" fill=\"none\" " << style << "/>\n";
    }
    void text(glm::dvec2 at, const std::string& words, const std::string& style = {}) {
        out_ << "<text x=\"" << at.x << "\" y=\"" << at.y << "\" " << style << '>' << words << "</text>\n";
    }
    std::string finish() {
        out_ << "</svg>\n";
        return out_.str();
    }

  private:
    std::ostringstream out_;
};

// A to the left, B to the right, and the places of C in colours, with lines of equal x / a.
void draw_regions(Svg& svg, glm::dvec2 origin) {
    const auto at = [&](glm::dvec2 c) { return origin + glm::dvec2(c.x, -c.y) * panel; };
    const char* colours[] = {"", "#cfe6cf", "#dbe4f3", "#f7dcc6"};
    constexpr int rows = 400;
    for (int j = 0; j < rows; ++j)
        for (int begin = 0, end; begin <= rows; begin = end) {
            const auto c = [&](int i) { return glm::dvec2(0.5 + 0.5 * i / rows, (j + 0.5) / rows); };
            const int where = region(c(begin));
            for (end = begin + 1; end <= rows && region(c(end)) == where;) ++end;
            if (where == 0) continue;
            const glm::dvec2 low = at({c(begin).x, j / double(rows)}), high = at({c(end).x, (j + 1) / double(rows)});
            svg.polygon({low, {high.x, low.y}, high, {low.x, high.y}},
                        std::string("shape-rendering=\"crispEdges\" fill=\"") + colours[where] + "\"");
        }
    for (const double level : {0.7, 0.8, 0.9, 1., 1.25, 1.5, 2., 3.}) {
        // Along rays from A, x / a falls or grows with the distance: one point a ray at most.
        std::vector<std::pair<glm::dvec2, glm::dvec2>> line;
        std::optional<glm::dvec2> last;
        for (int i = 1; i < 600; ++i) {
            const double alpha = i * M_PI / 3 / 600;
            std::optional<glm::dvec2> found;
            for (int k = 1; k <= 500 && !found; ++k) {
                const auto c = [&](int n) {
                    const double from = 0.5 / std::cos(alpha);
                    return glm::dvec2(std::cos(alpha), std::sin(alpha)) * (from + (1 - from) * n / 500.);
                };
                if ((angle_ratio(c(k - 1)) - level) * (angle_ratio(c(k)) - level) > 0) continue;
                const double a = angle_ratio(c(k - 1)) - level, b = angle_ratio(c(k)) - level;
                found = glm::mix(c(k - 1), c(k), a == b ? 0.5 : a / (a - b));
            }
            if (found && region(*found) == 1) found.reset();
            if (found && last) line.emplace_back(at(*last), at(*found));
            last = found;
        }
        if (line.empty()) continue;
        svg.segments(line,
                     level == 1 ? "stroke=\"#222\" stroke-width=\"1.6\"" : "stroke=\"#667\" stroke-width=\"0.8\"");
        std::ostringstream number;
        number << level;
        svg.text(line[line.size() / 2].first + glm::dvec2(3, -2), number.str(), "font-size=\"10\" fill=\"#445\"");
    }
    std::vector<std::pair<glm::dvec2, glm::dvec2>> outline;
    for (int i = 0; i < 60; ++i) {
        const auto c = [&](int n) { return at({std::cos(n * M_PI / 180), std::sin(n * M_PI / 180)}); };
        outline.emplace_back(c(i), c(i + 1));
    }
    outline.emplace_back(outline.back().second, at({0.5, 0}));
    svg.segments(outline, "stroke=\"#222\" stroke-width=\"1.2\"");
    svg.segments({{at({0, 0}), at({1, 0})}}, "stroke=\"#222\" stroke-width=\"2\"");
    svg.text(at({-0.02, -0.05}), "A");
    svg.text(at({0.99, -0.05}), "B");
    svg.text(at({0.49, -0.05}), "C'");
    svg.text(at({0.58, 0.67}), "1", "font-size=\"22\" fill=\"#373\"");
    svg.text(at({0.53, 0.05}), "2", "font-size=\"22\" fill=\"#347\"");
    svg.text(at({0.765, 0.575}), "3", "font-size=\"22\" fill=\"#a52\"");
}

void draw_mesh(Svg& svg, glm::dvec2 origin, BisectionRule rule) {
    const PlainMesh base = random_mesh(7, 13, 0);
    Bisection mesh(base, {rule});
    RefineGoal goal;
    goal.max_side = 1.25e5;
    goal.region = [](const TrianglePlaces& p) {
        return length(glm::dvec2(p[0] + p[1] + p[2]) / 3. - glm::dvec2(5.5e5, 5e5)) < 3.6e5;
    };
    mesh.refine(goal);
    std::vector<double> base_angle;
    for (const auto& t : base.triangles) base_angle.push_back(angle_of(base, t));
    const auto at = [&](const glm::dvec3& p) { return origin + glm::dvec2(p.x, -p.y) * (panel / (1 << 20)); };
    const PlainMesh fine = mesh.mesh();
    for (Bisection::Index t = 0; t < mesh.triangle_count(); ++t) {
        const double ratio = angle_of(fine, fine.triangles[t]) / base_angle[mesh.base_triangle(t)];
        const char* fill = ratio < 0.66 ? "#d9603b" : ratio < 0.8 ? "#f2b179" : ratio < 0.999 ? "#f8ddb8" : "#e8efe4";
        const auto p = mesh.places(t);
        svg.polygon(
            {at(p[0]), at(p[1]), at(p[2])},
            std::string("fill=\"") + fill + "\" stroke=\"#345\" stroke-width=\"0.6\" stroke-linejoin=\"round\"");
    }
    std::vector<std::pair<glm::dvec2, glm::dvec2>> sides;
    for (const auto& t : base.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            sides.emplace_back(at(base.vertices[t[k]]), at(base.vertices[t[(k + 1) % 3]]));
    svg.segments(sides, "stroke=\"#123\" stroke-width=\"1.6\"");
    EXPECT_EQ(mesh.check(), "");
}

TEST(BisectionFigure, IsDrawn) {
    Svg svg(3 * panel + 4 * gap, panel + 90);
    draw_regions(svg, {gap, panel + 20});
    draw_mesh(svg, {panel + 2 * gap, panel + 20}, BisectionRule::plain);
    draw_mesh(svg, {2 * panel + 3 * gap, panel + 20}, BisectionRule::modified);
    const char* style = "fill=\"#333\"";
    svg.text({gap, panel + 72}, "x / a where C is: 1 four similar triangles, 2 x >= a, 3 x > 0.6734 a", style);
    svg.text({panel + 2 * gap, panel + 72}, "plain: angles down to 1/2 of the base triangle's (red: below 2/3)", style);
    svg.text({2 * panel + 3 * gap, panel + 72}, "modified: red is left where only one half was split", style);
    const std::string path = testing::TempDir() + "bisection.svg";
    std::ofstream(path) << svg.finish();
    std::ifstream written(path, std::ios::ate);
    EXPECT_GT(written.tellg(), 20'000);
    EXPECT_LT(written.tellg(), 400'000);
}

}  // namespace
}  // namespace planet
