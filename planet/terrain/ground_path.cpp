#include "planet/terrain/ground_path.h"

#include <algorithm>
#include <cassert>

namespace planet {

namespace {

// Chords of the planet no longer than this are shorter than their arcs by less than 3e-8 of themselves.
constexpr double chord_m = 5000;
// A side of a cell is found to this.
constexpr double crossing_m = 1e-3;

class PathMeter {
  public:
    PathMeter(const StoreField& field, const GeodesicPath& path)
        : ellipsoid_(field.store().metadata().ellipsoid), path_(path), cursor_(field.cursor()) {}

    PathTotals measure(const std::function<void(double)>& progress) {
        Place from = place(0);
        totals_.lowest = totals_.highest = from.height;
        note(from);
        for (std::size_t leg = 0; leg < path_.legs(); ++leg) {
            const double start = path_.leg_start(leg), end = path_.leg_start(leg + 1);
            const auto steps = static_cast<std::size_t>(std::ceil((end - start) / chord_m));
            for (std::size_t i = 1; i <= steps; ++i) {
                const Place to = place(start + (end - start) * static_cast<double>(i) / static_cast<double>(steps));
                refine(from, to);
                from = to;
                if (progress && path_.length() > 0) progress(to.s / path_.length());
            }
        }
        return totals_;
    }

  private:
    struct Place {
        double s;
        LocationCode cell;
        double height, bound;
        glm::dvec3 ecef;
    };

    Place place(double s) {
        const glm::dvec3 n = path_.normal_at(s);
        const Ground ground = ground_at(cursor_, n);
        return {s, cursor_.cell(), ground.height, ground.bound, ecef_of(ellipsoid_, n, ground)};
    }

    // Cells are convex: what begins and ends in one is in it.
    void refine(const Place& from, const Place& to) {
        if (from.cell == to.cell || to.s - from.s < crossing_m) {
            add(from, to);
            return;
        }
        const Place middle = place(0.5 * (from.s + to.s));
        refine(from, middle);
        refine(middle, to);
    }

    void add(const Place& from, const Place& to) {
        ++totals_.pieces;
        totals_.length += glm::length(to.ecef - from.ecef);
        const double rise = to.height - from.height;
        (rise > 0 ? totals_.ascent : totals_.descent) += std::abs(rise);
        note(to);
    }

    void note(const Place& p) {
        totals_.bound = std::max(totals_.bound, p.bound);
        if (p.height < totals_.lowest) totals_.lowest = p.height, totals_.lowest_at = p.s;
        if (p.height > totals_.highest) totals_.highest = p.height, totals_.highest_at = p.s;
    }

    Ellipsoid ellipsoid_;
    const GeodesicPath& path_;
    SurfaceCursor cursor_;
    PathTotals totals_;
};

}  // namespace

std::vector<PathSample> sample_path(const StoreField& field, const GeodesicPath& path, std::size_t count) {
    assert(count >= 2);
    std::vector<PathSample> samples(count);
    SurfaceCursor cursor = field.cursor();
    for (std::size_t i = 0; i < count; ++i) {
        PathSample& s = samples[i];
        s.distance = path.length() * static_cast<double>(i) / static_cast<double>(count - 1);
        s.place = path.at(s.distance);
        s.ground = ground_at(cursor, normal_from_geodetic(s.place.latitude, s.place.longitude));
    }
    return samples;
}

PathTotals measure_path(const StoreField& field, const GeodesicPath& path,
                        const std::function<void(double)>& progress) {
    return PathMeter(field, path).measure(progress);
}

}  // namespace planet
