#include "planet/mesh/tile_layout.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace planet {

namespace {

TileLayout make() {
    TileLayout t;
    t.lattice[0] = {64, 0};
    t.lattice[1] = {0, 64};
    t.lattice[2] = {0, 0};
    t.corners[1] = {0, 1, 2};
    // A split vertex is known by its lattice position, doubled: at relative level 11 it is still a whole number.
    std::vector<std::int32_t> vertex_at(65 * 65, -1);
    std::vector<std::uint16_t> first_cell(tile_vertices, 0);
    int vertices = 3;
    t.vertex_count[0] = 3;
    for (unsigned i = 1; i < tile_cells; ++i) {
        const auto [l, r, a] = t.corners[i];
        const int u = (t.lattice[l][0] + t.lattice[r][0]) / 2, v = (t.lattice[l][1] + t.lattice[r][1]) / 2;
        std::int32_t& m = vertex_at[static_cast<std::size_t>(u * 65 + v)];
        if (m < 0) {
            m = vertices++;
            const auto k = static_cast<std::size_t>(m);
            t.lattice[k] = {static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v)};
            t.ends[k] = {std::min(l, r), std::max(l, r)};
            first_cell[k] = static_cast<std::uint16_t>(i);
        } else {
            const std::uint16_t other = first_cell[static_cast<std::size_t>(m)];
            t.split_neighbor[i] = other;
            t.split_neighbor[other] = static_cast<std::uint16_t>(i);
        }
        const auto mid = static_cast<std::uint16_t>(m);
        t.split_vertex[i] = mid;
        t.corners[2 * i] = {l, a, mid};
        t.corners[2 * i + 1] = {a, r, mid};
        if ((i & (i + 1)) == 0)
            t.vertex_count[static_cast<std::size_t>(std::bit_width(i))] = static_cast<std::uint16_t>(vertices);
    }
    return t;
}

}  // namespace

const TileLayout& tile_layout() {
    static const TileLayout table = make();
    return table;
}

}  // namespace planet
