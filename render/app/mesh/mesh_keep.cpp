#include "render/app/mesh/mesh_keep.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace render {
namespace {

class Collector {
  public:
    Collector(const planet::SampleGrid& grid, const planet::PatchRaster& patches) : grid_(grid), patches_(patches) {}

    void point(const glm::dvec3& p) { kept_.outside += !add(sample_of(p)); }
    void line(const std::vector<glm::dvec3>& line) {
        for (std::size_t i = 1; i < line.size(); ++i)
            kept_.outside += !add_between(sample_of(line[i - 1]), sample_of(line[i]));
    }
    KeptSamples take() {
        auto& list = kept_.samples;
        std::ranges::sort(list, {}, [](glm::ivec2 p) { return std::tuple(p.y, p.x); });
        list.erase(std::unique(list.begin(), list.end()), list.end());
        return std::move(kept_);
    }

  private:
    glm::dvec2 sample_of(const glm::dvec3& feature) const {
        const glm::dvec2 d = glm::dvec2(feature) - grid_.origin;
        return glm::dvec2(d.x * grid_.per_row.y - d.y * grid_.per_row.x,
                          grid_.per_column.x * d.y - grid_.per_column.y * d.x) /
               grid_.determinant();
    }

    // The sample nearest to a place. @return false where there is none, or a void one
    bool add(const glm::dvec2& at) {
        const glm::dvec2 nearest = glm::round(at);
        if (!(nearest.x >= 0 && nearest.y >= 0 && nearest.x < patches_.width() && nearest.y < patches_.height()))
            return false;
        const glm::ivec2 sample(nearest);
        if (std::isnan(patches_.at(sample))) return false;
        if (kept_.samples.empty() || kept_.samples.back() != sample) kept_.samples.push_back(sample);
        return true;
    }

    // Every sample that a piece of a line passes. @return whether it is wholly on the raster
    bool add_between(glm::dvec2 a, glm::dvec2 b) {
        const glm::dvec2 d = b - a;
        double from = 0, to = 1;  // the part within the raster
        for (int axis = 0; axis < 2; ++axis) {
            const double last = (axis == 0 ? patches_.width() : patches_.height()) - 0.5;
            if (d[axis] == 0) {
                if (a[axis] < -0.5 || a[axis] > last) return false;
                continue;
            }
            const double s = (-0.5 - a[axis]) / d[axis], t = (last - a[axis]) / d[axis];
            from = std::max(from, std::min(s, t));
            to = std::min(to, std::max(s, t));
        }
        if (from > to) return false;
        const double length = std::max(std::abs(d.x), std::abs(d.y)) * (to - from);
        const auto steps = static_cast<long>(std::ceil(length)) + 1;
        for (long i = 0; i <= steps; ++i)
            add(a + d * (from + (to - from) * static_cast<double>(i) / static_cast<double>(steps)));
        return from == 0 && to == 1;
    }

    const planet::SampleGrid& grid_;
    const planet::PatchRaster& patches_;
    KeptSamples kept_;
};

}  // namespace

KeptSamples samples_on(const planet::Features& features, const planet::Raster& raster,
                       const planet::PatchRaster& patches) {
    Collector collector(raster.grid, patches);
    for (const glm::dvec3& p : features.points) collector.point(p);
    for (const auto& line : features.lines) collector.line(line);
    for (const auto& polygon : features.polygons) {
        collector.line(polygon.outer);
        for (const auto& hole : polygon.holes) collector.line(hole);
    }
    return collector.take();
}

std::vector<glm::ivec2> samples_at_poles(const planet::Raster& raster) {
    std::vector<glm::ivec2> samples;
    if (!raster.geographic()) return samples;
    const auto at_pole = [&](int column, int row) {
        return std::abs(raster.grid.crs_from_sample({column, row}).y) > 90 - 1e-9;
    };
    for (const int row : {0, raster.height - 1})
        if (at_pole(0, row) && at_pole(raster.width - 1, row))
            for (int column = 0; column < raster.width; ++column) samples.emplace_back(column, row);
    return samples;
}

}  // namespace render
