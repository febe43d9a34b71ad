#include "planet/tin/tin_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/error.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

// Column and row from the coordinates of the grid.
class SamplePlaces {
  public:
    explicit SamplePlaces(const Raster& raster)
        : grid_(raster.grid), scale_(1 / grid_.determinant()), last_(raster.width - 1, raster.height - 1) {}
    glm::dvec2 at(const glm::dvec3& p) const {
        const glm::dvec2 d = glm::dvec2(p) - grid_.origin;
        return {(d.x * grid_.per_row.y - d.y * grid_.per_row.x) * scale_,
                (d.y * grid_.per_column.x - d.x * grid_.per_column.y) * scale_};
    }
    bool inside(glm::dvec2 p) const {
        return p.x >= -0.5 && p.y >= -0.5 && p.x <= last_.x + 0.5 && p.y <= last_.y + 0.5;
    }
    glm::ivec2 nearest(glm::dvec2 p) const { return glm::ivec2(glm::clamp(glm::round(p), glm::dvec2(0), last_)); }

    // Cuts a segment at the border (Liang and Barsky). @return false if nothing is left
    bool cut(glm::dvec2& a, glm::dvec2& b) const {
        double from = 0, to = 1;
        const glm::dvec2 d = b - a;
        for (int k = 0; k < 2; ++k)
            for (const double side : {-1.0, 1.0}) {
                const double run = side * d[k], room = side > 0 ? last_[k] + 0.5 - a[k] : a[k] + 0.5;
                if (run == 0 && room < 0) return false;
                if (run > 0) to = std::min(to, room / run);
                if (run < 0) from = std::max(from, room / run);
            }
        if (from > to) return false;
        const glm::dvec2 start = a;
        a = start + from * d;
        b = start + to * d;
        return true;
    }

  private:
    SampleGrid grid_;
    double scale_;
    glm::dvec2 last_;
};

void add_line(const std::vector<glm::dvec3>& vertices, const SamplePlaces& places, TinFeatures& out) {
    std::vector<glm::ivec2> line;
    const auto end_line = [&] {
        if (line.size() > 1)
            out.lines.push_back(line);
        else if (!line.empty())
            out.points.push_back(line.front());
        line.clear();
    };
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        glm::dvec2 a = places.at(vertices[i - 1]), b = places.at(vertices[i]);
        const bool goes_out = !places.inside(b);
        if (!places.inside(a) || goes_out) ++out.outside;
        if (!places.cut(a, b)) {
            end_line();
            continue;
        }
        for (const glm::ivec2 p : {places.nearest(a), places.nearest(b)})
            if (line.empty() || line.back() != p) line.push_back(p);
        if (goes_out) end_line();
    }
    end_line();
}

class FeatureInsertion {
  public:
    FeatureInsertion(Delaunay& mesh, const HeightGrid& grid) : mesh_(mesh), grid_(grid) {}

    void point(glm::ivec2 p) {
        if (!grid_.valid(p)) {
            ++report_.over_voids;
            return;
        }
        const Delaunay::Location at = mesh_.locate(p);
        ++(at.vertex == Delaunay::none ? report_.points : report_.duplicates);
        mesh_.insert(p, at);
    }

    void segment(glm::ivec2 a, glm::ivec2 b) {
        if (a == b) {
            if (grid_.valid(a)) mesh_.insert(a);
            return;
        }
        if (grid_.has_void() && meets_void(a, b)) {
            ++report_.around_voids;
            step_by_step(a, b);
            return;
        }
        ++report_.line_sides;
        constrain(mesh_.insert(a), mesh_.insert(b), 0);
    }

    const FeatureReport& report() const { return report_; }

  private:
    // Whether a square that the segment touches has a void corner. A little wide: all squares near a step of one column
    // or row count.
    bool meets_void(glm::ivec2 a, glm::ivec2 b) const {
        const glm::ivec2 d = b - a;
        const int steps = std::max(std::abs(d.x), std::abs(d.y));
        for (int i = 0; i <= steps; ++i) {
            const glm::ivec2 p(glm::floor(glm::dvec2(a) + glm::dvec2(d) * (double{1} * i / steps)));
            for (int y = std::max(0, p.y - 1); y <= std::min(grid_.height() - 1, p.y + 2); ++y)
                for (int x = std::max(0, p.x - 1); x <= std::min(grid_.width() - 1, p.x + 2); ++x)
                    if (!grid_.valid({x, y})) return true;
        }
        return false;
    }

    // A diagonal step through a square with a void corner would cut its two triangles.
    bool may_step(glm::ivec2 p, glm::ivec2 q) const {
        return grid_.valid(p) && grid_.valid(q) && grid_.valid({p.x, q.y}) && grid_.valid({q.x, p.y});
    }

    void step_by_step(glm::ivec2 a, glm::ivec2 b) {
        const int steps = std::max(std::abs(b.x - a.x), std::abs(b.y - a.y));
        glm::ivec2 before = a;
        for (int i = 1; i <= steps; ++i) {
            const glm::ivec2 p(glm::round(glm::dvec2(a) + glm::dvec2(b - a) * (double{1} * i / steps)));
            if (may_step(before, p)) constrain(mesh_.insert(before), mesh_.insert(p), 0);
            before = p;
        }
    }

    // Where another line is in the way, both go through the sample nearest to the crossing.
    void constrain(Index a, Index b, int depth) {
        if (a == b || mesh_.constrain(a, b)) return;
        if (depth > 60) {
            ++report_.dropped;
            return;
        }
        const auto [c, d] = mesh_.crossed();
        const glm::ivec2 at = crossing(mesh_.point(a), mesh_.point(b), mesh_.point(c), mesh_.point(d));
        if (!grid_.valid(at)) {
            ++report_.dropped;
            return;
        }
        ++report_.crossings;
        const Index side = mesh_.side_between(c, d);
        if (at != mesh_.point(c) && at != mesh_.point(d)) {
            mesh_.release(side);
            const Index v = mesh_.insert(at);
            constrain(c, v, depth + 1);
            constrain(v, d, depth + 1);
        }
        const Index v = mesh_.insert(at);
        if (v == a || v == b) {
            constrain(a, b, depth + 1);
            return;
        }
        constrain(a, v, depth + 1);
        constrain(v, b, depth + 1);
    }

    static glm::ivec2 crossing(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c, glm::ivec2 d) {
        const double from_a = static_cast<double>(orientation(c, d, a)),
                     from_b = static_cast<double>(orientation(c, d, b));
        return glm::ivec2(glm::round(glm::dvec2(a) + glm::dvec2(b - a) * (from_a / (from_a - from_b))));
    }

    Delaunay& mesh_;
    const HeightGrid& grid_;
    FeatureReport report_;
};

// Columns at which the rings of a polygon cross a row, ascending.
std::vector<double> crossings_of_row(const std::vector<std::vector<glm::dvec2>>& rings, double y) {
    std::vector<double> at;
    for (const auto& ring : rings)
        for (std::size_t i = 1; i < ring.size(); ++i) {
            const glm::dvec2 a = ring[i - 1], b = ring[i];
            if ((a.y <= y) != (b.y <= y)) at.push_back(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
        }
    std::sort(at.begin(), at.end());
    return at;
}

}  // namespace

TinFeatures moved(TinFeatures features, glm::ivec2 by) {
    for (glm::ivec2& p : features.points) p += by;
    for (auto& line : features.lines)
        for (glm::ivec2& p : line) p += by;
    return features;
}

FeatureReport& FeatureReport::operator+=(const FeatureReport& other) {
    points += other.points;
    line_sides += other.line_sides;
    duplicates += other.duplicates;
    over_voids += other.over_voids;
    around_voids += other.around_voids;
    crossings += other.crossings;
    dropped += other.dropped;
    return *this;
}

TinFeatures features_at_samples(const Features& features, const Raster& raster) {
    const SamplePlaces places(raster);
    TinFeatures out;
    for (const glm::dvec3& p : features.points) {
        const glm::dvec2 at = places.at(p);
        if (places.inside(at))
            out.points.push_back(places.nearest(at));
        else
            ++out.outside;
    }
    for (const auto& line : features.lines) add_line(line, places, out);
    for (const Polygon& polygon : features.polygons) {
        add_line(polygon.outer, places, out);
        for (const auto& hole : polygon.holes) add_line(hole, places, out);
    }
    return out;
}

FeatureReport insert_features(Delaunay& mesh, const HeightGrid& grid, const TinFeatures& features) {
    FeatureInsertion insertion(mesh, grid);
    for (const glm::ivec2 p : features.points) insertion.point(p);
    for (const auto& line : features.lines)
        for (std::size_t i = 1; i < line.size(); ++i) insertion.segment(line[i - 1], line[i]);
    return insertion.report();
}

void keep_window_within(HeightGrid& window, glm::ivec2 first, const Raster& raster,
                        const std::vector<Polygon>& polygons) {
    const SamplePlaces places(raster);
    const auto columns = static_cast<std::size_t>(window.width());
    std::vector<std::uint8_t> kept(window.count(), 0);
    for (const Polygon& polygon : polygons) {
        std::vector<std::vector<glm::dvec2>> rings(1 + polygon.holes.size());
        for (const glm::dvec3& p : polygon.outer) rings[0].push_back(places.at(p));
        for (std::size_t k = 0; k < polygon.holes.size(); ++k)
            for (const glm::dvec3& p : polygon.holes[k]) rings[k + 1].push_back(places.at(p));
        for (int y = 0; y < window.height(); ++y) {
            const std::vector<double> at = crossings_of_row(rings, static_cast<double>(first.y + y));
            for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
                const double from = std::max(0.0, std::ceil(at[i]) - first.x),
                             to = std::min(window.width() - 1.0, std::floor(at[i + 1]) - first.x);
                for (double x = from; x <= to; ++x)
                    kept[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)] = 1;
            }
        }
    }
    for (int y = 0; y < window.height(); ++y)
        for (int x = 0; x < window.width(); ++x)
            if (!kept[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)])
                window.set({x, y}, std::numeric_limits<float>::quiet_NaN());
}

void keep_within(HeightGrid& grid, const Raster& raster, const std::vector<Polygon>& polygons) {
    keep_window_within(grid, {0, 0}, raster, polygons);
    if (grid.valid_samples() == 0)
        throw Error(Fault::bad_data, raster.name, "has no valid sample within the mask", "a mask that meets it");
}

}  // namespace planet
