// What a bisection has come to, and whether it is sound.

#include <numeric>
#include <string>

#include "planet/bisection/bisection_state.h"

namespace planet {

namespace {

using Index = Bisection::Index;

// Shapes are alike if the ratios of their sides are, to 6 digits, mirror images included.
struct Shape {
    Index base;
    double middle, least;  ///< of the longest side
};
constexpr double alike = 1e-6;

std::vector<Shape> shapes_of(const LeafMesh& mesh) {
    std::vector<Shape> shapes;
    shapes.reserve(mesh.size());
    for (Index t = 0; t < mesh.size(); ++t) {
        const auto& s = mesh[t].squared;
        shapes.push_back(
            {mesh[t].base, std::sqrt(std::max(s[1], s[2]) / s[0]), std::sqrt(std::min(s[1], s[2]) / s[0])});
    }
    return shapes;
}

// Counts clusters: sorted by one ratio, then within runs of that by the other.
std::size_t count_classes(std::span<Shape> shapes) {
    std::sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) { return a.middle < b.middle; });
    std::size_t classes = 0;
    for (std::size_t begin = 0, end; begin < shapes.size(); begin = end) {
        for (end = begin + 1; end < shapes.size() && shapes[end].middle - shapes[end - 1].middle < alike;) ++end;
        const std::span run = shapes.subspan(begin, end - begin);
        std::sort(run.begin(), run.end(), [](const Shape& a, const Shape& b) { return a.least < b.least; });
        ++classes;
        for (std::size_t i = 1; i < run.size(); ++i) classes += run[i].least - run[i - 1].least >= alike;
    }
    return classes;
}

void count_shapes(const LeafMesh& mesh, BisectionReport& report) {
    std::vector<Shape> shapes = shapes_of(mesh);
    std::sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) { return a.base < b.base; });
    for (std::size_t begin = 0, end; begin < shapes.size(); begin = end) {
        for (end = begin + 1; end < shapes.size() && shapes[end].base == shapes[begin].base;) ++end;
        const std::size_t classes = count_classes(std::span(shapes).subspan(begin, end - begin));
        report.similarity_classes_max = std::max(report.similarity_classes_max, classes);
    }
    report.similarity_classes = count_classes(shapes);
}

void measure_angles(const Bisection::State& state, BisectionReport& report) {
    const LeafMesh& mesh = state.mesh;
    double all = 4, complete = 4;
    for (Index t = 0; t < mesh.size(); ++t) {
        const auto& c = mesh[t].corner;
        const double angle = smallest_angle(mesh.judged(c[0]), mesh.judged(c[1]), mesh.judged(c[2]));
        const double ratio = angle / state.base_angle[mesh[t].base];
        all = std::min(all, angle);
        if (mesh[t].kind == LeafKind::complete) {
            complete = std::min(complete, angle);
            report.angle_ratio_min = std::min(report.angle_ratio_min, ratio);
        } else {
            ++report.pending_triangles;
            report.angle_ratio_min_pending = std::min(report.angle_ratio_min_pending, ratio);
        }
        report.side_max = std::max(report.side_max, mesh[t].squared[0]);
        report.side_max_placed = std::max(report.side_max_placed, state.longest_squared(t));
    }
    report.angle_min = all;
    report.angle_min_complete = complete <= 3.2 ? complete : all;
    report.side_max = std::sqrt(report.side_max);
    report.side_max_placed = std::sqrt(report.side_max_placed);
}

glm::dvec3 doubled_area(const LeafMesh& mesh, const Leaf& t) {
    const glm::dvec3 a = mesh.judged(t.corner[0]);
    return cross(mesh.judged(t.corner[1]) - a, mesh.judged(t.corner[2]) - a);
}

std::string check_leaf(const LeafMesh& mesh, Index t) {
    const Leaf& leaf = mesh[t];
    const std::string name = "leaf " + std::to_string(t) + ": ";
    if (leaf.squared[0] < leaf.squared[1] || leaf.squared[0] < leaf.squared[2])
        return name + "side 0 is not its longest";
    for (std::size_t k = 0; k < 3; ++k) {
        const Index a = leaf.corner[k], b = leaf.corner[(k + 1) % 3], n = leaf.beyond[k];
        if (a == b || a >= mesh.vertex_count()) return name + "its corners are no triangle";
        const glm::dvec3 d = mesh.judged(b) - mesh.judged(a);
        if (!(std::abs(std::sqrt(leaf.squared[k]) - length(d)) <= 1e-6 * std::sqrt(leaf.squared[0])))
            return name + "side " + std::to_string(k) + " is not as long as it says";
        if (n == LeafMesh::none) continue;
        if (n >= mesh.size()) return name + "it is linked to nothing";
        const Leaf& other = mesh[n];
        bool found = false;
        for (std::size_t j = 0; j < 3; ++j)
            if (other.corner[j] == b && other.corner[(j + 1) % 3] == a) {
                found = true;
                if (other.beyond[j] != t) return name + "a link goes one way only";
                if (other.squared[j] != leaf.squared[k]) return name + "its side has two lengths";
            }
        if (!found) return name + "what is beyond a side does not share it";
    }
    return {};
}

// Areas of the leaves of each base triangle, which all turn as it does.
std::string check_areas(const LeafMesh& mesh) {
    std::vector<double> sum(mesh.base_triangles(), 0);
    std::vector<glm::dvec3> total(mesh.base_triangles(), glm::dvec3(0));
    for (Index t = 0; t < mesh.size(); ++t) {
        const glm::dvec3 area = doubled_area(mesh, mesh[t]);
        sum[mesh[t].base] += length(area);
        total[mesh[t].base] += area;
    }
    for (std::size_t b = 0; b < sum.size(); ++b)
        if (!(std::abs(sum[b] - length(total[b])) <= 1e-6 * sum[b]))
            return "below base triangle " + std::to_string(b) + " a leaf is turned over";
    return {};
}

}  // namespace

std::size_t Bisection::bytes() const {
    return state_->mesh.bytes() + state_->queue_bytes + state_->base_angle.capacity() * sizeof(double);
}

BisectionReport Bisection::report() const {
    const LeafMesh& mesh = state_->mesh;
    BisectionReport report;
    report.triangles = mesh.size();
    report.vertices = mesh.vertex_count();
    report.base_triangles = mesh.base_triangles();
    report.base_vertices = mesh.base_vertices();
    report.splits = state_->splits;
    report.requests = state_->requests;
    if (report.requests != 0)
        report.propagation_mean =
            static_cast<double>(report.splits - report.requests) / static_cast<double>(report.requests);
    report.propagation_max = state_->propagated_max;
    measure_angles(*state_, report);
    count_shapes(mesh, report);
    return report;
}

std::string Bisection::check() const {
    const LeafMesh& mesh = state_->mesh;
    std::size_t border = 0;
    for (Index t = 0; t < mesh.size(); ++t) {
        const std::string wrong = check_leaf(mesh, t);
        if (!wrong.empty()) return wrong;
        for (const Index n : mesh[t].beyond) border += n == LeafMesh::none;
    }
    std::size_t expected = mesh.base_border();
    for (const SplitRecord& record : mesh.records()) expected += record.second == SplitRecord::no_side;
    if (border != expected) return "there are border sides where there should be none";
    return check_areas(mesh);
}

}  // namespace planet
