#include "planet/bake/existence.h"

#include <algorithm>
#include <array>

namespace planet {

bool Existence::operator()(LocationCode cell) {
    const LocationCode beyond = neighbor(cell);
    if (plan_.is_in_whole_part(cell) || plan_.is_in_whole_part(beyond)) return true;
    const std::uint64_t diamond = std::min(cell, beyond).bits();
    if (const auto found = known_.find(diamond); found != known_.end()) return found->second;
    const bool exists = find(cell, beyond);
    known_.emplace(diamond, exists);
    return exists;
}

bool Existence::find(LocationCode cell, LocationCode beyond) {
    if (!plan_.has_record(cell) || !plan_.has_record(beyond)) return false;
    return cell.bisection_level() == 0 || ((*this)(cell.parent()) && (*this)(beyond.parent()));
}

void Existence::of_tile(LocationCode root, std::span<std::uint8_t> exists) {
    if (plan_.is_whole(root)) {
        std::fill(exists.begin(), exists.end(), std::uint8_t{1});
        exists[0] = 0;
        return;
    }
    constexpr std::size_t most_known = 1 << 16;  // some MiB
    if (known_.size() > most_known) known_.clear();
    const int depth = plan_.depth(root);
    std::array<std::uint8_t, tile_cells> on_side;
    const auto sides = side_cells(depth);
    for (std::size_t k = 0; k < sides.size(); ++k) on_side[k] = (*this)(cell_code(root, sides[k].cell));
    existence_inside(depth, std::span(on_side).first(sides.size()), exists);
}

}  // namespace planet
