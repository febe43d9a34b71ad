#include "planet/store/tile_sides.h"

#include <algorithm>

namespace planet {

std::span<const SideCell> side_cells(int depth) {
    static const std::vector<SideCell> all = [] {
        const TileLayout& t = tile_layout();
        std::vector<SideCell> sides;
        for (unsigned i = 1; i < tile_cells; ++i)
            if (t.split_neighbor[i] == 0) sides.push_back({static_cast<std::uint16_t>(i), side_of(i)});
        return sides;
    }();
    const auto end = std::partition_point(all.begin(), all.end(), [&](SideCell s) { return s.cell < 1u << depth; });
    return {all.data(), static_cast<std::size_t>(end - all.begin())};
}

void existence_inside(int depth, std::span<const std::uint8_t> on_side, std::span<std::uint8_t> exists) {
    const TileLayout& t = tile_layout();
    std::size_t side = 0;
    exists[0] = 0;
    for (unsigned i = 1; i < 1u << depth; ++i) {
        const unsigned beyond = t.split_neighbor[i];
        exists[i] = beyond == 0 ? on_side[side++] : exists[i >> 1] & exists[beyond >> 1];
    }
}

}  // namespace planet
