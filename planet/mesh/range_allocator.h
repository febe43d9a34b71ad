#pragma once
// Places in an array for pieces that come and go, while those that stay keep theirs.

#include <cstdint>
#include <map>
#include <set>
#include <utility>

namespace planet {

/// Elements first .. first + count - 1 of an array.
struct Range {
    std::uint32_t first = 0, count = 0;
    friend bool operator==(const Range&, const Range&) = default;
};

/// Takes the smallest free range that is large enough, and of equal ones the first; else the array grows. Free neighbours
/// become one. Not safe to use from several threads.
class RangeAllocator {
  public:
    Range allocate(std::uint32_t count);
    /// @param range as it was allocated
    void free(Range range);
    void clear();

    /// Elements in use and free ones between them: how long the array must be.
    std::uint32_t size() const { return size_; }

  private:
    void add(Range range);
    void remove(Range range);

    std::uint32_t size_ = 0;
    std::map<std::uint32_t, std::uint32_t> free_;                   // count by first
    std::set<std::pair<std::uint32_t, std::uint32_t>> free_count_;  // (count, first)
};

}  // namespace planet
