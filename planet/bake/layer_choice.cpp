#include "planet/bake/layer_choice.h"

#include <array>
#include <limits>

#include "planet/octahedron/octahedron_map.h"

namespace planet {

namespace {

// What a tile costs beside its vertices, in vertices: its row and header in bytes, its setting up in time.
constexpr double tile_cost = 100;
// An inner tile stores all its deviations: so many times the bytes of a leaf of that size.
constexpr double inner_cost = 3;

/// How many cells there are by their level and by the level that the field asks for in them, if it is finer.
class CellCensus {
  public:
    CellCensus(const ElevationField& field, const CoverageLimits& limits) : field_(field), limits_(limits) {
        for (int face = 0; face < face_count; ++face) {
            const Corners c = face_corners(face);
            count(0, c, finest_level_in(c, field_, limits_), 1);
        }
    }

    /// Of the tiles that begin at these layers, padding apart.
    double cost(TileLayers layers) const {
        double sum = 0;
        for (int level = 0; level < max_bisection_level; level = level == 0 ? layers.first : level + tile_levels) {
            const int deepest = layers.depth(level);
            for (int finest = level + 1; finest <= max_bisection_level; ++finest) {
                const bool inner = finest > level + deepest;
                const auto depth = static_cast<std::size_t>(inner ? deepest : finest - level);
                const double vertices = tile_layout().vertex_count[depth];
                sum += at(level, finest) * (tile_cost + (inner ? inner_cost : 1) * vertices);
            }
        }
        return sum;
    }

  private:
    double& at(int level, int finest) { return cells_[static_cast<std::size_t>(level * stride + finest)]; }
    double at(int level, int finest) const { return cells_[static_cast<std::size_t>(level * stride + finest)]; }

    // Of a field too large to be looked at whole, halves that ask for the same are taken to be alike from some level on:
    // what is visited then grows with the borders of sources, not with their area.
    void count(int level, const Corners& c, int finest, double weight) {
        if (finest <= level) return;
        if (finest - level <= tile_levels) {  // alike from here on
            for (double cells = weight; level < finest; ++level, cells *= 2) at(level, finest) += cells;
            return;
        }
        at(level, finest) += weight;
        const glm::dvec3 m = split_vertex(c);
        const std::array half{child_corners(c, m, 0), child_corners(c, m, 1)};
        const std::array asked{finest_level_in(half[0], field_, limits_), finest_level_in(half[1], field_, limits_)};
        if (++visited_ > most_visited && level >= sampled_level && asked[0] == asked[1])
            return count(level + 1, half[static_cast<std::size_t>(level % 2)], asked[0], 2 * weight);
        for (std::size_t i = 0; i < 2; ++i) count(level + 1, half[i], asked[i], weight);
    }

    static constexpr int sampled_level = 11;              // 16,384 cells, 250 km on Earth
    static constexpr std::size_t most_visited = 1 << 20;  // a second at worst
    static constexpr int stride = max_bisection_level + 1;

    const ElevationField& field_;
    const CoverageLimits& limits_;
    std::array<double, stride * stride> cells_{};
    std::size_t visited_ = 0;
};

}  // namespace

TileLayers cheapest_layers(const ElevationField& field, const CoverageLimits& limits) {
    const CellCensus census(field, limits);
    TileLayers cheapest;
    double least = std::numeric_limits<double>::infinity();
    for (int first = tile_levels; first > 0; --first) {
        const double cost = census.cost({first});
        if (cost >= least) continue;
        least = cost;
        cheapest = {first};
    }
    return cheapest;
}

}  // namespace planet
