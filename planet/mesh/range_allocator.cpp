#include "planet/mesh/range_allocator.h"

#include <cassert>
#include <iterator>
#include <limits>

#include "planet/error.h"

namespace planet {

Range RangeAllocator::allocate(std::uint32_t count) {
    if (count == 0) return {};
    const auto found = free_count_.lower_bound({count, 0});
    if (found == free_count_.end()) {
        if (count > std::numeric_limits<std::uint32_t>::max() - size_)
            throw Error(Fault::bad_usage, "segments", "the mesh has more than 2^32 vertices or indices",
                        "a larger --max-pixel-deviation");
        size_ += count;
        return {size_ - count, count};
    }
    const Range hole{found->second, found->first};
    remove(hole);
    if (hole.count > count) add({hole.first + count, hole.count - count});
    return {hole.first, count};
}

void RangeAllocator::free(Range range) {
    if (range.count == 0) return;
    const auto next = free_.lower_bound(range.first);
    assert(next == free_.end() || range.first + range.count <= next->first);
    Range before, behind;
    if (next != free_.end() && next->first == range.first + range.count) behind = {next->first, next->second};
    if (next != free_.begin()) {
        const auto previous = std::prev(next);
        assert(previous->first + previous->second <= range.first);
        if (previous->first + previous->second == range.first) before = {previous->first, previous->second};
    }
    for (const Range& joined : {before, behind})
        if (joined.count > 0) remove(joined);
    range = {before.count > 0 ? before.first : range.first, before.count + range.count + behind.count};
    if (range.first + range.count == size_)
        size_ = range.first;
    else
        add(range);
}

void RangeAllocator::clear() {
    size_ = 0;
    free_.clear();
    free_count_.clear();
}

void RangeAllocator::add(Range range) {
    free_.emplace(range.first, range.count);
    free_count_.emplace(range.count, range.first);
}

void RangeAllocator::remove(Range range) {
    free_.erase(range.first);
    free_count_.erase({range.count, range.first});
}

}  // namespace planet
