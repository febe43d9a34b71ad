#include "planet/tin/tiled_tin.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <mutex>

#include "planet/error.h"
#include "planet/parallel.h"
#include "planet/tin/border_line.h"
#include "planet/tin/greedy_tin.h"
#include "planet/tin/prune.h"
#include "planet/tin/quick_insertion.h"
#include "planet/tin/triangle_scan.h"
#include "planet/tin/void_border.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

// Samples between the vertices of the start grid. Found by trial: a finer one makes more triangles, a coarser one takes
// longer.
constexpr int start_spacing = 64;

// The vertices of a straight line of samples between two corners of a tile.
std::vector<glm::ivec2> border_vertices(const HeightGrid& grid, glm::ivec2 from, glm::ivec2 to, const TinBound& bound,
                                        const std::vector<glm::ivec2>& needed) {
    const glm::ivec2 step = glm::sign(to - from);
    const int n = std::max(to.x - from.x, to.y - from.y) + 1;
    std::vector<float> line(static_cast<std::size_t>(n));
    std::vector<int> keep;
    for (int i = 0; i < n; ++i) {
        const glm::ivec2 p = from + i * step;
        line[static_cast<std::size_t>(i)] = grid.at(p);
        if (grid.has_void() && on_void_border(grid, p)) keep.push_back(i);
    }
    for (const glm::ivec2 p : needed)
        if (glm::min(p, from) == from && glm::max(p, to) == to) keep.push_back(p.x - from.x + p.y - from.y);
    std::vector<glm::ivec2> vertices;
    for (const int i : simplified_line(line, bound, keep)) vertices.push_back(from + i * step);
    return vertices;
}

class TileWork {
  public:
    TileWork(const HeightGrid& around, glm::ivec2 low, glm::ivec2 high, const TiledTinOptions& options,
             const TinTileNeeds& needs)
        : around_(around),
          low_(low),
          heights_(around, low, high),
          options_(options),
          needs_(needs),
          mesh_({0, 0}, high - low) {}

    TinTile run(glm::ivec2 offset) {
        mesh_.reserve(heights_.count() / 8);
        TinTile out;
        for (const glm::ivec2 p : void_border(heights_, {0, 0}, last())) mesh_.insert(p);
        if (!needs_.features.empty()) out.features = insert_features(mesh_, heights_, moved(needs_.features, -low_));
        for (const glm::ivec2 p : tile_border(around_, low_, low_ + last(), options_.bound(), needs_.border))
            mesh_.insert(p - low_);
        const std::size_t required = mesh_.vertex_slots();
        const bool prunes = options_.quality != TinQuality::fast && options_.least_priority == 0;
        if (options_.metric == TinMetric::local) {
            if (deserves_start_grid()) insert_start_grid();
            insert_to_tolerance(mesh_, heights_, {options_.tolerance, prunes ? 0.5f : 1.0f});
        } else {
            insert_in_order();
        }
        if (prunes) {
            const int passes = options_.quality == TinQuality::best ? 8 : 1;
            prune(mesh_, heights_, {options_.tolerance, passes, std::vector<std::uint8_t>(required, 1)});
        }
        out.mesh = triangles_over_samples(mesh_, heights_, offset + low_);
        list_border(out, offset + low_);
        return out;
    }

  private:
    glm::ivec2 last() const { return {heights_.width() - 1, heights_.height() - 1}; }

    void insert_in_order() {
        const std::unique_ptr<TinMeasure> measure = make_inner_measure(options_.metric, heights_);
        GreedyOptions how;
        how.tolerance = options_.tolerance;
        how.measure = measure.get();
        how.least_priority = options_.least_priority;
        insert_greedily(mesh_, heights_, how);
    }

    // Not where the terrain is so even that the grid would be most of the mesh: where most of its cells keep the
    // tolerance.
    bool deserves_start_grid() const {
        int cells = 0, rough = 0;
        for (int y = 0; y + start_spacing < heights_.height(); y += start_spacing)
            for (int x = 0; x + start_spacing < heights_.width(); x += start_spacing) {
                const glm::ivec2 a(x, y), b(x + start_spacing, y), c(x + start_spacing, y + start_spacing);
                const SortedTriangle half({a, b, c}, {heights_.at(a), heights_.at(b), heights_.at(c)});
                ++cells;
                rough += !within(heights_, half, static_cast<float>(options_.tolerance));
            }
        return 2 * rough > cells;
    }

    void insert_start_grid() {
        for (int y = start_spacing; y + 1 < heights_.height(); y += start_spacing)
            for (int x = start_spacing; x + 1 < heights_.width(); x += start_spacing)
                if (heights_.valid({x, y})) mesh_.insert({x, y});
    }

    static void list_border(TinTile& tile, glm::ivec2 low, glm::ivec2 high) {
        for (std::uint32_t v = 0; v < tile.mesh.vertices.size(); ++v) {
            const glm::ivec2 p = tile.mesh.vertices[v];
            if (p.y == low.y) tile.border[0].push_back(v);
            if (p.y == high.y) tile.border[1].push_back(v);
            if (p.x == low.x) tile.border[2].push_back(v);
            if (p.x == high.x) tile.border[3].push_back(v);
        }
        for (std::size_t side = 0; side < 4; ++side)
            std::sort(tile.border[side].begin(), tile.border[side].end(), [&](std::uint32_t v, std::uint32_t w) {
                const glm::ivec2 p = tile.mesh.vertices[v], q = tile.mesh.vertices[w];
                return p.x + p.y < q.x + q.y;
            });
    }
    void list_border(TinTile& tile, glm::ivec2 low) const { list_border(tile, low, low + last()); }

    const HeightGrid& around_;
    const glm::ivec2 low_;
    const HeightGrid heights_;
    const TiledTinOptions& options_;
    const TinTileNeeds& needs_;
    Delaunay mesh_;
};

int tiles_along(int samples, int step) {
    return (samples - 2) / step + 1;
}

}  // namespace

TinTiling::TinTiling(int width, int height, int step)
    : width_(width),
      height_(height),
      step_(step),
      columns_(tiles_along(width, step)),
      rows_(tiles_along(height, step)) {
    assert(width >= 2 && height >= 2 && step >= 1 && step <= max_step);
}

glm::ivec2 TinTiling::low(std::size_t tile) const {
    const auto columns = static_cast<std::size_t>(columns_);
    return {static_cast<int>(tile % columns) * step_, static_cast<int>(tile / columns) * step_};
}

glm::ivec2 TinTiling::high(std::size_t tile) const {
    return glm::min(low(tile) + step_, glm::ivec2(width_ - 1, height_ - 1));
}

std::vector<std::size_t> TinTiling::tiles_at(glm::ivec2 sample) const {
    std::vector<std::size_t> tiles;
    const glm::ivec2 first = glm::max(sample - 1, 0) / step_,
                     last = glm::min(sample / step_, {columns_ - 1, rows_ - 1});
    for (int row = first.y; row <= last.y; ++row)
        for (int column = first.x; column <= last.x; ++column)
            tiles.push_back(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(column));
    return tiles;
}

TinTile tin_tile(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high, const TiledTinOptions& options,
                 glm::ivec2 offset, const TinTileNeeds& needs) {
    return TileWork(grid, low, high, options, needs).run(offset);
}

std::vector<glm::ivec2> tile_border(const HeightGrid& grid, glm::ivec2 low, glm::ivec2 high, const TinBound& bound,
                                    const std::vector<glm::ivec2>& needed) {
    std::vector<glm::ivec2> vertices;
    for (const auto& [from, to] : {std::pair{low, glm::ivec2(high.x, low.y)},
                                   {{low.x, high.y}, high},
                                   {low, {low.x, high.y}},
                                   {{high.x, low.y}, high}})
        std::ranges::move(border_vertices(grid, from, to, bound, needed), std::back_inserter(vertices));
    return vertices;
}

void tin_tiles(const TinTiling& tiling, const WindowReader& read, const TiledTinOptions& options,
               const std::function<void(TinTile&&)>& sink) {
    std::mutex one_at_a_time;
    parallel_for(tiling.count(), options.threads, [&](std::size_t i) {
        const glm::ivec2 low = tiling.low(i), high = tiling.high(i), end(tiling.width() - 1, tiling.height() - 1);
        const glm::ivec2 first = glm::max(low - 1, glm::ivec2(0)), last = glm::min(high + 1, end);
        const HeightGrid window = read(first, last);
        assert(window.width() == last.x - first.x + 1 && window.height() == last.y - first.y + 1);
        TinTile tile = tin_tile(window, low - first, high - first, options, first);
        tile.tile = i;
        const std::lock_guard lock(one_at_a_time);
        sink(std::move(tile));
    });
}

TinMesh joined(std::vector<TinTile> tiles) {
    std::sort(tiles.begin(), tiles.end(), [](const TinTile& a, const TinTile& b) { return a.tile < b.tile; });
    std::size_t vertices = 0, triangles = 0;
    for (const TinTile& t : tiles) {
        vertices += t.mesh.vertices.size();
        triangles += t.mesh.triangles.size();
    }
    if (vertices >= Delaunay::none)
        throw Error(Fault::bad_data, "the TIN", std::to_string(vertices) + " vertices are too many for one mesh",
                    "a larger deviation, or a mesh for each tile");
    // Vertices on borders, by place.
    const auto key = [](glm::ivec2 p) {
        return std::uint64_t{static_cast<std::uint32_t>(p.y)} << 32 | static_cast<std::uint32_t>(p.x);
    };
    std::vector<std::uint64_t> places;
    for (const TinTile& t : tiles)
        for (const auto& side : t.border)
            for (const std::uint32_t v : side) places.push_back(key(t.mesh.vertices[v]));
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());

    TinMesh out;
    out.vertices.reserve(vertices);
    out.height.reserve(vertices);
    out.triangles.reserve(triangles);
    for (const std::uint64_t place : places)
        out.vertices.emplace_back(static_cast<int>(place & 0xffffffffu), static_cast<int>(place >> 32));
    out.height.resize(places.size());
    for (TinTile& t : tiles) {
        std::vector<std::uint32_t> number(t.mesh.vertices.size(), Delaunay::none);
        for (const auto& side : t.border)
            for (const std::uint32_t v : side) {
                const auto at = std::lower_bound(places.begin(), places.end(), key(t.mesh.vertices[v]));
                number[v] = static_cast<std::uint32_t>(at - places.begin());
                out.height[number[v]] = t.mesh.height[v];
            }
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] != Delaunay::none) continue;
            number[v] = static_cast<std::uint32_t>(out.vertices.size());
            out.vertices.push_back(t.mesh.vertices[v]);
            out.height.push_back(t.mesh.height[v]);
        }
        std::ranges::copy(t.mesh.held_sides, std::back_inserter(out.held_sides));
        for (const auto& [a, b, c] : t.mesh.triangles) out.triangles.push_back({number[a], number[b], number[c]});
        t = {};
    }
    return out;
}

TinMesh tiled_tin(const HeightGrid& grid, const TiledTinOptions& options, int step) {
    const TinTiling tiling(grid.width(), grid.height(), step);
    std::vector<TinTile> tiles(tiling.count());
    parallel_for(tiling.count(), options.threads, [&](std::size_t i) {
        tiles[i] = tin_tile(grid, tiling.low(i), tiling.high(i), options);
        tiles[i].tile = i;
    });
    return joined(std::move(tiles));
}

}  // namespace planet
