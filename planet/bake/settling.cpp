#include "planet/bake/settling.h"

#include <algorithm>
#include <bit>

#include "planet/store/ladder.h"

namespace planet {

namespace {

constexpr std::uint16_t none = 0xffff;

struct VertexLayout {
    std::array<std::array<std::uint16_t, 2>, tile_vertices> cells{};  ///< by vertex index: those it splits
    /// By vertex index, the split vertices of the diamond's parents in the tile; 0 (a corner): there is none.
    std::array<std::array<std::uint16_t, 2>, tile_vertices> parents{};
    std::array<std::uint16_t, tile_vertices> side{};  ///< by vertex index: the side cell, or none
    std::array<std::uint16_t, 189> side_vertex{};     ///< by side cell
};

VertexLayout make_layout() {
    const TileLayout& t = tile_layout();
    VertexLayout l;
    l.side.fill(none);
    for (unsigned i = tile_cells - 1; i > 0; --i) {
        auto& cells = l.cells[t.split_vertex[i]];
        cells = {static_cast<std::uint16_t>(i), cells[0] == 0 ? static_cast<std::uint16_t>(i) : cells[0]};
    }
    for (unsigned i = 2; i < tile_cells; ++i) {
        const std::uint16_t parent = t.split_vertex[i >> 1];
        auto& p = l.parents[t.split_vertex[i]];
        (p[0] == 0 || p[0] == parent ? p[0] : p[1]) = parent;
    }
    const auto sides = side_cells(tile_levels);
    for (std::size_t k = 0; k < sides.size(); ++k) {
        l.side_vertex[k] = t.split_vertex[sides[k].cell];
        l.side[l.side_vertex[k]] = static_cast<std::uint16_t>(k);
    }
    return l;
}

const VertexLayout& vertex_layout() {
    static const VertexLayout layout = make_layout();
    return layout;
}

SideSteps steps_of(float deviation, float radius) {
    return {static_cast<std::uint16_t>(deviation_code(deviation)), static_cast<std::uint16_t>(radius_code(radius))};
}

SideSteps larger(SideSteps a, SideSteps b) {
    return {std::max(a.deviation, b.deviation), std::max(a.radius, b.radius)};
}

bool operator==(SideSteps a, SideSteps b) {
    return a.deviation == b.deviation && a.radius == b.radius;
}

// Vertices whose record has risen, the finest first.
class Risen {
  public:
    void insert(std::size_t v) { bits_[v / 64] |= std::uint64_t{1} << v % 64; }
    /// Calls visit(v) for each, and for those it inserts; these must be below v.
    template <class Visit>
    void drain(Visit visit) {
        for (std::size_t w = bits_.size(); w-- > 0;)
            while (bits_[w] != 0) {
                const auto top = static_cast<std::size_t>(std::bit_width(bits_[w]) - 1);
                bits_[w] &= ~(std::uint64_t{1} << top);
                visit(w * 64 + top);
            }
    }

  private:
    std::array<std::uint64_t, tile_vertices / 64 + 1> bits_{};
};

}  // namespace

const std::array<std::uint16_t, 189>& side_cells_across() {
    static const auto table = [] {
        const auto sides = side_cells(tile_levels);
        std::array<std::uint16_t, 189> across{};
        for (std::size_t k = 0; k < across.size(); ++k) {
            const unsigned i = sides[k].cell, beyond = i ^ ((1u << relative_level(i)) - 1);
            const auto at =
                std::partition_point(sides.begin(), sides.end(), [&](const SideCell& s) { return s.cell < beyond; });
            across[k] = static_cast<std::uint16_t>(at - sides.begin());
        }
        return across;
    }();
    return table;
}

void TileRecords::set_own(std::span<const float> own_deviations, std::span<const float> own_radii,
                          std::span<const std::uint8_t> exists) {
    const VertexLayout& layout = vertex_layout();
    const std::size_t end = tile_layout().vertex_count[static_cast<std::size_t>(depth)];
    for (std::size_t v = 3; v < end; ++v) {
        const auto [i, j] = layout.cells[v];
        const bool is_there = exists[i] != 0;
        deviation[v] = is_there ? std::max(own_deviations[i], own_deviations[j]) : 0.0f;
        radius[v] = is_there ? std::max(own_radii[i], own_radii[j]) : 0.0f;
    }
}

void TileRecords::settle(std::span<const SideSteps> theirs, std::span<SideSteps> mine) {
    const VertexLayout& layout = vertex_layout();
    const auto& counts = tile_layout().vertex_count;
    const std::size_t end = counts[static_cast<std::size_t>(depth)];
    for (std::size_t v = end; v-- > 3;) {
        if (deviation[v] == 0) continue;
        if (inner) {
            deviation[v] = deviation_from_code(deviation_code(deviation[v]));
            if (v >= counts[static_cast<std::size_t>(depth) - 1]) radius[v] = radius_from_code(radius_code(radius[v]));
        }
        if (const std::size_t k = layout.side[v]; k != none) {
            mine[k] = steps_of(deviation[v], radius[v]);
            const SideSteps settled = larger(mine[k], theirs[k]);
            deviation[v] = deviation_from_code(settled.deviation);
            radius[v] = radius_from_code(settled.radius);
        }
        for (const std::size_t p : layout.parents[v]) {
            if (p == 0) continue;
            deviation[p] = std::max(deviation[p], deviation[v]);
            radius[p] = std::max(radius[p], certified_radius(radius_over(position[p], position[v], radius[v])));
        }
    }
}

void TileRecords::rise(std::span<const SideSteps> theirs, std::span<SideSteps> mine) {
    const VertexLayout& layout = vertex_layout();
    Risen risen;
    const auto set = [&](std::size_t v, float d, float r) {
        if (d <= deviation[v] && r <= radius[v]) return;
        deviation[v] = std::max(deviation[v], d);
        radius[v] = std::max(radius[v], r);
        risen.insert(v);
    };
    const auto set_side = [&](std::size_t v, std::size_t k) {
        const SideSteps settled = larger(mine[k], theirs[k]);
        set(v, deviation_from_code(settled.deviation), radius_from_code(settled.radius));
    };
    for (std::size_t k = 0; k < theirs.size(); ++k)
        if (!(larger(mine[k], theirs[k]) == mine[k])) set_side(layout.side_vertex[k], k);
    risen.drain([&](std::size_t v) {
        for (const std::size_t p : layout.parents[v]) {
            if (p == 0) continue;
            const float r = certified_radius(radius_over(position[p], position[v], radius[v]));
            if (const std::size_t k = layout.side[p]; k == none) {
                set(p, deviation[v], r);
            } else if (const SideSteps steps = larger(mine[k], steps_of(deviation[v], r)); !(steps == mine[k])) {
                mine[k] = steps;
                set_side(p, k);
            }
        }
    });
}

}  // namespace planet
