#include "planet/terrain/viewshed.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>

#include "planet/error.h"
#include "planet/geodesy/geodesic.h"
#include "planet/parallel.h"

namespace planet {

namespace {

constexpr double pi = std::numbers::pi;

// A SightTriangle in 40 bytes: 4 mm at 65 km, and the same for every line.
struct PackedTriangle {
    float p[3][3];
    float bound;

    explicit PackedTriangle(const SightTriangle& t) : bound(static_cast<float>(t.bound)) {
        for (std::size_t k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis) p[k][axis] = static_cast<float>(t.p[k][axis]);
    }
    SightTriangle unpacked() const {
        SightTriangle t;
        for (std::size_t k = 0; k < 3; ++k)
            t.p[k] = {static_cast<double>(p[k][0]), static_cast<double>(p[k][1]), static_cast<double>(p[k][2])};
        t.bound = static_cast<double>(bound);
        return t;
    }
};

// The cells of the ground around the eye, or of a part of it.
class RegionVisitor {
  public:
    /// @param all counts the cells of all parts
    RegionVisitor(const SightFrame& frame, const Ellipsoid& e, const glm::dvec3& eye, double radius,
                  std::atomic<std::size_t>& all)
        : frame_(frame), e_(e), eye_(eye), chord_(1.01 * radius / e.b), all_(all) {}

    bool enter(const Corners& corners) const {
        const CellReach reach(corners);
        return glm::length(reach.centre - eye_) <= reach.chord + chord_;
    }
    void leave() const {}
    bool halve(const GroundCell& cell) const {
        const Corners& c = cell.normal;
        const double longest =
            std::max({glm::length(c.left - c.right), glm::length(c.right - c.apex), glm::length(c.apex - c.left)});
        return longest * e_.a > sight_side_m;
    }
    void visit(const GroundCell& cell) {
        triangles.emplace_back(sight_triangle(frame_, e_, cell));
        if (++all_ > viewshed_ground_max)
            throw Error(Fault::bad_usage, "radius",
                        "holds more than " + std::to_string(viewshed_ground_max) + " cells of the ground",
                        "a smaller radius, or a store that is less fine");
    }

    std::vector<PackedTriangle> triangles;

  private:
    const SightFrame& frame_;
    const Ellipsoid& e_;
    glm::dvec3 eye_;
    double chord_;
    std::atomic<std::size_t>& all_;
};

// In the order of one walk, whatever the number of threads. @param progress is told the share
std::vector<PackedTriangle> gather(const TileReader& tiles, const RegionVisitor& region, unsigned threads,
                                   const std::function<void(double)>& progress) {
    constexpr std::size_t pieces = 512;
    RegionVisitor visitor = region;
    const std::vector<GroundPart> parts = GroundWalk(tiles, visitor).parts(pieces);
    std::vector<std::vector<PackedTriangle>> found(parts.size());
    std::atomic<std::size_t> done = 0;
    parallel_for(parts.size(), threads, [&](std::size_t i) {
        RegionVisitor of_part = region;
        GroundWalk(tiles, of_part).part(parts[i]);
        found[i] = std::move(of_part.triangles);
        if (progress) progress(static_cast<double>(++done) / static_cast<double>(parts.size()));
    });
    std::size_t count = 0;
    for (const auto& part : found) count += part.size();
    std::vector<PackedTriangle> triangles;
    triangles.reserve(count);
    for (auto& part : found) {
        triangles.insert(triangles.end(), part.begin(), part.end());
        part = {};
    }
    return triangles;
}

// What a sector knows of a triangle without looking at it.
struct Entry {
    std::uint32_t triangle;
    float nearest, farthest;  // horizontally; bounds
    float slope;              // no line that touches it is steeper
};

// Distances and the slope, rounded outward. The z of a piece lies at most 4/3 of the bulge of a side above the plane.
Entry entry_of(const PackedTriangle& t, std::uint32_t index, double bulge) {
    const SightTriangle u = t.unpacked();
    double side2 = 0, top = -1e30, nearest = 1e30, farthest = 0, reach = 0;
    const glm::dvec2 middle = glm::dvec2(u.p[0] + u.p[1] + u.p[2]) / 3.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 at(u.p[k]), side = at - glm::dvec2(u.p[(k + 1) % 3]);
        side2 = std::max(side2, glm::dot(side, side));
        top = std::max(top, u.p[k].z);
        farthest = std::max(farthest, glm::length(at));
        reach = std::max(reach, glm::length(at - middle));
    }
    nearest = std::max(glm::length(middle) - reach, 0.0);
    top += bulge * side2 / 3;
    const double d = top > 0 ? nearest : farthest;
    const double slope = d > 0 ? top / d : (top > 0 ? 1e30 : 0.0);
    return {index, static_cast<float>(nearest * (1 - 1e-6)), static_cast<float>(farthest * (1 + 1e-6)),
            static_cast<float>(slope + 1e-6 * std::abs(slope))};
}

class Sectors {
  public:
    Sectors(const std::vector<PackedTriangle>& triangles, double bulge, std::size_t count, unsigned threads)
        : triangles_(triangles), bulge_(bulge), count_(count) {
        std::vector<Entry> entries(triangles.size());
        std::vector<Reach> reaches(triangles.size());
        parallel_for(chunks(entries.size()), threads, [&](std::size_t chunk) {
            for (std::size_t i = chunk * chunk_size; i < std::min((chunk + 1) * chunk_size, entries.size()); ++i) {
                entries[i] = entry_of(triangles[i], static_cast<std::uint32_t>(i), bulge);
                reaches[i] = reach_of(entries[i]);
            }
        });
        fill(entries, reaches);
        parallel_for(count_, threads, [&](std::size_t sector) {
            sort(sector);
            bound_blocks(sector);
        });
    }

    /// Whether a target is seen. @param foot of the target on the ground @param top of it, in the frame
    bool sees(const glm::dvec3& foot, const glm::dvec3& top) const {
        const double d_foot = glm::length(glm::dvec2(foot)), d = std::max(d_foot, glm::length(glm::dvec2(top)));
        const glm::dvec2 u = glm::dvec2(foot) / d_foot;
        const std::size_t sector = sector_of(std::atan2(foot.x, foot.y));
        const std::size_t first = start_[sector];
        const auto end = static_cast<std::size_t>(
            std::partition_point(entries_.begin() + static_cast<std::ptrdiff_t>(first),
                                 entries_.begin() + static_cast<std::ptrdiff_t>(start_[sector + 1]),
                                 [&](const Entry& e) { return static_cast<double>(e.nearest) < d; }) -
            entries_.begin());
        const double z = top.z + shift_to_ground(u, d_foot, foot.z, first, end);
        const double limit = (z + sight_tolerance_m) / d;
        for (std::size_t i = first; i < end;) {
            if ((i - first) % block == 0 &&
                static_cast<double>(block_slope_[block_start_[sector] + (i - first) / block]) <= limit) {
                i += block;
                continue;
            }
            const Entry& e = entries_[i++];
            if (static_cast<double>(e.slope) <= limit) continue;
            const auto piece = cut(triangles_[e.triangle].unpacked(), u, bulge_);
            if (piece && piece->d0 < d && steepest(*piece, d, bulge_).slope > limit) return false;
        }
        return true;
    }

  private:
    static constexpr std::size_t block = 32, chunk_size = 4096;
    static std::size_t chunks(std::size_t n) { return (n + chunk_size - 1) / chunk_size; }

    std::size_t sector_of(double azimuth) const {
        const double turn = azimuth / (2 * pi) + 0.5;
        return std::min(static_cast<std::size_t>(turn * static_cast<double>(count_)), count_ - 1);
    }

    // The sectors that a triangle reaches into, the last one perhaps beyond the end.
    struct Reach {
        std::uint32_t first, last;
    };
    Reach reach_of(const Entry& e) const {
        const PackedTriangle& t = triangles_[e.triangle];
        const auto all = static_cast<std::uint32_t>(count_ - 1);
        if (!(e.nearest > 0)) return {0, all};
        double azimuth[3], low = 0, high = 0;
        for (int k = 0; k < 3; ++k) {
            azimuth[k] = std::atan2(static_cast<double>(t.p[k][0]), static_cast<double>(t.p[k][1]));
            const double turn = std::remainder(azimuth[k] - azimuth[0], 2 * pi);
            low = std::min(low, turn);
            high = std::max(high, turn);
        }
        if (high - low >= pi - 1e-9) return {0, all};
        const double width = 2 * pi / static_cast<double>(count_);
        const double west = azimuth[0] + low - 1e-7 * width;
        const auto first = static_cast<std::uint32_t>(sector_of(west < -pi ? west + 2 * pi : west));
        const auto more = static_cast<std::uint32_t>((high - low) / width * (1 + 1e-6)) + 1;
        return {first, first + std::min(more, all)};
    }

    void fill(const std::vector<Entry>& entries, const std::vector<Reach>& reaches) {
        start_.assign(count_ + 1, 0);
        for (auto [s, last] : reaches)
            for (; s <= last; ++s) ++start_[s % count_ + 1];
        for (std::size_t s = 0; s < count_; ++s) start_[s + 1] += start_[s];
        entries_.resize(start_.back());
        std::vector<std::size_t> at(start_.begin(), start_.end() - 1);
        for (std::size_t i = 0; i < entries.size(); ++i)
            for (auto [s, last] = reaches[i]; s <= last; ++s) entries_[at[s % count_]++] = entries[i];
        block_start_.assign(count_ + 1, 0);
        for (std::size_t s = 0; s < count_; ++s)
            block_start_[s + 1] = block_start_[s] + (start_[s + 1] - start_[s] + block - 1) / block;
        block_slope_.resize(block_start_.back());
    }

    void sort(std::size_t sector) {
        std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(start_[sector]),
                  entries_.begin() + static_cast<std::ptrdiff_t>(start_[sector + 1]),
                  [](const Entry& a, const Entry& b) {
                      return a.nearest != b.nearest ? a.nearest < b.nearest : a.triangle < b.triangle;
                  });
    }

    void bound_blocks(std::size_t sector) {
        for (std::size_t i = start_[sector]; i < start_[sector + 1]; ++i) {
            const std::size_t offset = i - start_[sector];
            float& most = block_slope_[block_start_[sector] + offset / block];
            most = offset % block == 0 ? entries_[i].slope : std::max(most, entries_[i].slope);
        }
    }

    // From where the ground is said to be to where the pieces have it, so that it does not hide itself.
    double shift_to_ground(glm::dvec2 u, double d, double z, std::size_t first, std::size_t end) const {
        for (std::size_t i = end; i-- > first;) {
            const Entry& e = entries_[i];
            if (static_cast<double>(e.farthest) < d || static_cast<double>(e.nearest) > d) continue;
            const auto piece = cut(triangles_[e.triangle].unpacked(), u, bulge_);
            if (piece && piece->d0 <= d && d <= piece->d1) return piece->z_at(d, bulge_) - z;
        }
        return 0;
    }

    const std::vector<PackedTriangle>& triangles_;
    double bulge_;
    std::size_t count_;
    std::vector<Entry> entries_;      // by sector, the nearest first
    std::vector<std::size_t> start_;  // into entries_, by sector
    std::vector<float> block_slope_;  // the largest of each block of entries
    std::vector<std::size_t> block_start_;
};

struct RowCount {
    std::size_t visible = 0, inside = 0;
    double area = 0;
};

void check(const ViewshedOptions& o) {
    check(static_cast<const SightOptions&>(o));
    if (!(o.radius >= 10 && o.radius <= viewshed_radius_max_m))
        throw Error(Fault::bad_usage, "radius", std::to_string(o.radius) + " m is out of range", "10 m to 500 km");
    if (!(o.cell >= 0 && (o.cell == 0 || 2 * o.radius / o.cell <= viewshed_side_max - 2)))
        throw Error(Fault::bad_usage, "cell", std::to_string(o.cell) + " m makes too many cells",
                    "at most " + std::to_string(viewshed_side_max) + " a side");
}

}  // namespace

Viewshed viewshed(const StoreField& field, const Geodetic& eye, const ViewshedOptions& o) {
    check(o);
    const Ellipsoid& e = field.store().metadata().ellipsoid;
    const Geodesics geodesics(e);
    const glm::dvec3 n_eye = normal_from_geodetic(eye.latitude, eye.longitude);
    SurfaceCursor cursor = field.cursor();
    const SightFrame frame(e, n_eye, {ground_at(cursor, n_eye).h().m + o.eye_height}, o.refraction);

    Viewshed view;
    view.cell = o.cell > 0 ? o.cell : o.radius / 400;
    const int half = static_cast<int>(o.radius / view.cell);
    view.side = 2 * half + 1;
    const auto side = static_cast<std::size_t>(view.side);
    view.cells.assign(side * side, Viewshed::outside);
    view.heights.assign(side * side, std::numeric_limits<float>::quiet_NaN());

    // Of the time, about so much goes into gathering.
    constexpr double gathering = 0.3;
    const auto tell = [&](double share) {
        if (o.progress) o.progress(share);
    };
    std::atomic<std::size_t> ground_cells = 0;
    const std::vector<PackedTriangle> triangles =
        gather(field.cache(), {frame, e, n_eye, o.radius + sight_height_max_m * o.radius / e.b, ground_cells},
               o.threads, [&](double share) { tell(gathering * share); });
    view.ground_cells = triangles.size();
    for (const PackedTriangle& t : triangles) view.bound = std::max(view.bound, static_cast<double>(t.bound));
    const auto count = static_cast<std::size_t>(std::clamp(2 * pi * o.radius / view.cell, 64.0, 20000.0));
    const Sectors sectors(triangles, frame.bulge(), count, o.threads);

    std::vector<RowCount> counts(side);
    std::atomic<std::size_t> rows = 0;
    const double R = curvature_radii(e, n_eye).mean();
    parallel_for(side, o.threads, [&](std::size_t row) {
        SurfaceCursor at = field.cursor();
        RowCount& counted = counts[row];
        for (int column = 0; column < view.side; ++column) {
            const glm::dvec2 p = view.middle(column, static_cast<int>(row));
            const double distance = glm::length(p);
            if (distance > o.radius) continue;
            const GeodesicPoint place = geodesics.direct(eye, std::atan2(p.x, p.y), distance);
            const glm::dvec3 n = normal_from_geodetic(place.latitude, place.longitude);
            const Ground ground = ground_at(at, n);
            const glm::dvec3 foot = frame.lifted(ecef_of(e, n, ground));
            const glm::dvec3 top = frame.lifted(ecef_from_normal(e, n, {ground.h().m + o.target_height}));
            const bool sees = distance < 0.01 || sectors.sees(foot, top);
            const std::size_t i = row * side + static_cast<std::size_t>(column);
            view.cells[i] = sees ? Viewshed::visible : Viewshed::hidden;
            view.heights[i] = static_cast<float>(ground.h().m);
            ++counted.inside;
            if (!sees) continue;
            ++counted.visible;
            // The projection keeps lengths along the line from the eye and stretches across it.
            const double angle = distance / R;
            counted.area += view.cell * view.cell * (angle > 1e-9 ? std::sin(angle) / angle : 1);
        }
        tell(gathering + (1 - gathering) * static_cast<double>(++rows) / static_cast<double>(side));
    });
    for (const RowCount& row : counts) {
        view.count += row.inside;
        view.visible_count += row.visible;
        view.visible_area += row.area;
    }
    return view;
}

}  // namespace planet
