#include "render/app/store/store_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace render {
namespace {

using planet::degrees;
using planet::LocationCode;
using Codes = std::vector<LocationCode>;  // ascending, all of one level

/// Which degrees of longitude an area takes up, and where it ends within them.
class Longitudes {
  public:
    /// Adds the short way between two, each -180..180.
    void add(double from, double to) {
        if (to < from) std::swap(from, to);
        if (to - from > 180) from = std::exchange(to, from + 360);
        for (int k = static_cast<int>(std::floor(from)); k <= to; ++k) {
            const int turn = k >= 180 ? 360 : 0;
            Bin& bin = bins_[static_cast<std::size_t>(k - turn + 180)];
            bin.west = std::min(bin.west, std::max<double>(from, k) - turn);
            bin.east = std::max(bin.east, std::min<double>(to, k + 1) - turn);
        }
    }
    /// West and east: the ends of the longest gap.
    std::pair<double, double> ends() const {
        std::size_t longest = 0, after = 0;
        for (std::size_t start = 0; start < bins_.size(); ++start) {
            std::size_t length = 0;
            while (length < bins_.size() && at(start + length).west > 180) ++length;
            if (length > longest) longest = length, after = start + length;
        }
        if (longest == 0 || longest == bins_.size()) return {-180, 180};
        return {at(after).west, at(after + bins_.size() - longest - 1).east};
    }

  private:
    struct Bin {
        double west = 1e9, east = -1e9;
    };
    const Bin& at(std::size_t index) const { return bins_[index % bins_.size()]; }
    std::array<Bin, 360> bins_;  // from -180 on
};

class AreaBox {
  public:
    void add(LocationCode tile) {
        const planet::Corners c = planet::corners(tile);
        std::array<double, 3> longitude{};
        std::size_t known = 0;
        for (const glm::dvec3& n : {c.left, c.right, c.apex}) {
            const planet::Geodetic g = planet::geodetic_from_normal(n);
            south_ = std::min(south_, g.latitude / degrees);
            north_ = std::max(north_, g.latitude / degrees);
            if (std::hypot(n.x, n.y) > 1e-12) longitude[known++] = g.longitude / degrees;  // a pole has none
        }
        for (std::size_t i = 1; i < known; ++i) longitudes_.add(longitude[i - 1], longitude[i]);
        ++tiles_;
    }
    StoreArea area(int level) const {
        const auto [west, east] = longitudes_.ends();
        return {level, tiles_, south_, west, north_, east};
    }

  private:
    double south_ = 90, north_ = -90;
    Longitudes longitudes_;
    std::uint64_t tiles_ = 0;
};

/// Tiles hang together where the cells some levels above them share a side: a gap of less than such a cell is none.
std::vector<StoreArea> areas_of(const Codes& tiles) {
    const int level = tiles.front().bisection_level(), coarse = std::max(level - 6, 0);
    Codes cells;
    for (const LocationCode tile : tiles)
        if (cells.empty() || cells.back() != tile.ancestor(coarse)) cells.push_back(tile.ancestor(coarse));
    std::vector<bool> seen(cells.size());
    std::vector<StoreArea> areas;
    for (std::size_t first = 0; first < cells.size(); ++first) {
        if (seen[first]) continue;
        AreaBox box;
        std::vector<std::size_t> open{first};
        seen[first] = true;
        while (!open.empty()) {
            const LocationCode cell = cells[open.back()];
            open.pop_back();
            for (auto t = std::lower_bound(tiles.begin(), tiles.end(), LocationCode(cell.first_at(level)));
                 t != tiles.end() && cell.contains(*t); ++t)
                box.add(*t);
            for (const auto side : {planet::Side::split, planet::Side::left_leg, planet::Side::right_leg}) {
                const auto beside = std::lower_bound(cells.begin(), cells.end(), planet::neighbor(cell, side));
                if (beside == cells.end() || *beside != planet::neighbor(cell, side)) continue;
                const auto index = static_cast<std::size_t>(beside - cells.begin());
                if (!seen[index]) open.push_back(index);
                seen[index] = true;
            }
        }
        areas.push_back(box.area(level));
    }
    std::stable_sort(areas.begin(), areas.end(), [](const auto& p, const auto& q) { return p.tiles > q.tiles; });
    return areas;
}

}  // namespace

StoreSummary summarize(const planet::ElevationStore& store) {
    std::map<int, Codes> by_level;
    const std::map<int, std::uint64_t>& vertices = store.metadata().vertices_by_level;
    StoreSummary summary;
    for (const LocationCode tile : store.tiles()) by_level[tile.bisection_level()].push_back(tile);
    for (const auto& [level, tiles] : by_level) {
        summary.levels.push_back({level, tiles.size()});
        if (const auto counted = vertices.find(level); store.metadata().complete && counted != vertices.end())
            summary.levels.back().vertices = counted->second;
        summary.tiles += tiles.size();
        const bool whole_planet = tiles.size() == std::uint64_t{planet::face_count} << level;
        if (level == 0 || whole_planet) continue;
        const auto areas = areas_of(tiles);
        summary.areas.insert(summary.areas.begin(), areas.begin(), areas.end());
    }
    const std::uint64_t planned = store.metadata().tiles;
    if (!store.metadata().complete)
        summary.done = planned > 0 ? static_cast<double>(summary.tiles) / static_cast<double>(planned) : 0;
    for (int face = 0; face < planet::face_count; ++face) {
        const auto tile = store.read(LocationCode::face_root(face));
        if (!tile) continue;
        summary.least_m = std::min(summary.least_m, static_cast<double>(tile->min_height));
        summary.most_m = std::max(summary.most_m, static_cast<double>(tile->max_height));
    }
    return summary;
}

double spacing_of_level(const planet::Ellipsoid& ellipsoid, int bisection_level) {
    return planet::cell_metrics(bisection_level).vertex_spacing * ellipsoid.mean_radius();
}

}  // namespace render
