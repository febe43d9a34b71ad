#include "planet/tin/error_grid.h"

#include <numeric>

#include "planet/tin/triangle_scan.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

// From the plane of a triangle that holds it. Whole numbers until the division, as in ScaledDistances.
double deviation(const Delaunay& mesh, const HeightGrid& grid, Index triangle, glm::ivec2 p) {
    const auto c = mesh.corners(triangle);
    const double h = static_cast<double>(grid.at(p));
    const std::array<std::int64_t, 3> weight{orientation(c[1], c[2], p), orientation(c[2], c[0], p),
                                             orientation(c[0], c[1], p)};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        if (weight[k] != 0) sum += static_cast<double>(weight[k]) * (static_cast<double>(grid.at(c[k])) - h);
    return std::abs(sum) / static_cast<double>(weight[0] + weight[1] + weight[2]);
}

// Samples on a side belong to two triangles, of which one may be new: so each triangle is looked up in the grid.
class ErrorGridMeasure : public TinMeasure {
  public:
    ErrorGridMeasure(const HeightGrid& grid, LocateWay way) : grid_(grid), way_(way) {}

    void measure(const Delaunay& mesh, std::span<const Index> triangles, std::span<Measured> out) override {
        if (!errors_ || triangles.size() == mesh.triangle_count()) errors_ = std::make_unique<ErrorGrid>(grid_, way_);
        errors_->update(mesh, triangles);
        for (std::size_t i = 0; i < triangles.size(); ++i) out[i] = worst(sorted_triangle(mesh, grid_, triangles[i]));
    }

  private:
    Measured worst(const SortedTriangle& t) const {
        Measured worst;
        for_each_span(t, [&](int y, int first, int last) {
            const double* const row =
                errors_->deviations().data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width());
            for (int x = first; x <= last; ++x)
                if (row[x] > worst.deviation) worst = {row[x], row[x], {x, y}};
            return true;
        });
        return worst;
    }

    const HeightGrid& grid_;
    const LocateWay way_;
    std::unique_ptr<ErrorGrid> errors_;
};

}  // namespace

std::unique_ptr<TinMeasure> make_error_grid_measure(const HeightGrid& grid, LocateWay way) {
    return std::make_unique<ErrorGridMeasure>(grid, way);
}

ErrorGrid::ErrorGrid(const HeightGrid& grid, LocateWay way)
    : grid_(grid), deviation_(grid.count(), 0), by_row_(static_cast<std::size_t>(grid.height())) {
    if (way == LocateWay::naive) finder_ = make_naive_finder();
    if (way == LocateWay::cells) finder_ = make_cell_finder({0, 0}, {grid.width() - 1, grid.height() - 1});
}

void ErrorGrid::update(const Delaunay& mesh, std::span<const Index> changed) {
    if (changed.empty()) return;
    glm::ivec2 low(Delaunay::max_coordinate), high(-Delaunay::max_coordinate);
    for (const Index t : changed)
        for (const glm::ivec2 p : mesh.corners(t)) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    if (finder_) {
        finder_->update(mesh, changed);
        measure_rectangle(mesh, low, high);
    } else {
        measure_spans(mesh, changed);
    }
    for (int y = low.y; y <= high.y; ++y) {
        Largest& row = by_row_[static_cast<std::size_t>(y)];
        row = {};
        for (int x = 0; x < grid_.width(); ++x)
            if (at({x, y}) > row.deviation) row = {at({x, y}), {x, y}};
    }
}

void ErrorGrid::measure_rectangle(const Delaunay& mesh, glm::ivec2 low, glm::ivec2 high) {
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            if (!grid_.valid({x, y})) continue;
            const double d = deviation(mesh, grid_, finder_->find(mesh, {x, y}), {x, y});
            at({x, y}) = d > 0 ? d : 0;  // no triangle over voids deviates
            ++measured_;
        }
}

void ErrorGrid::measure_spans(const Delaunay& mesh, std::span<const Index> changed) {
    for (const Index t : changed) {
        const SortedTriangle s = sorted_triangle(mesh, grid_, t);
        const scan::ScaledDistances<double> distances(grid_, s);
        for_each_span(s, [&](int y, int first, int last) {
            for (int x = first; x <= last; x += scan::lanes) {
                scan::Values<double> d;
                distances.at(x, y, d);
                d /= distances.area();
                for (int i = 0; i < scan::lanes && x + i <= last; ++i) at({x + i, y}) = d[i] > 0 ? d[i] : 0;
            }
            measured_ += static_cast<std::size_t>(std::max(0, last - first + 1));
            return true;
        });
        for (const glm::ivec2 corner : mesh.corners(t)) at(corner) = 0;
    }
}

ErrorGrid::Largest ErrorGrid::largest() const {
    Largest out;
    for (const Largest& row : by_row_)
        if (row.deviation > out.deviation) out = row;
    return out;
}

std::size_t insert_by_error_grid(Delaunay& mesh, const HeightGrid& grid, double tolerance, std::size_t max_triangles,
                                 LocateWay way) {
    ErrorGrid errors(grid, way);
    std::vector<Index> all(mesh.triangle_slots());
    std::iota(all.begin(), all.end(), 0u);
    errors.update(mesh, all);
    for (;;) {
        const ErrorGrid::Largest worst = errors.largest();
        if (worst.sample.x < 0 || !(worst.deviation > tolerance)) break;
        mesh.plan_insertion(worst.sample, mesh.locate(worst.sample));
        const std::size_t fan = mesh.ring().size() - (mesh.open_ring() ? 1 : 0);
        if (mesh.triangle_count() + fan - mesh.cavity().size() > max_triangles) break;
        mesh.insert_planned();
        errors.update(mesh, mesh.changed());
    }
    return errors.measured();
}

}  // namespace planet
