#pragma once
// A priority queue of triangles in no strict order: sixteen buckets an octave of the key, last in first out within each.

#include <bit>
#include <cstdint>
#include <vector>

namespace planet {

/// An element may be pushed again with another key: whoever takes elements out checks that its key still is what it was.
class BucketQueue {
  public:
    static constexpr std::uint16_t none = 0xffff;  ///< no bucket

    /// @param key not negative
    static std::uint16_t bucket_of(float key) {
        return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(key) >> 19);
    }

    void push(std::uint32_t element, std::uint16_t bucket) {
        if (bucket > top_) top_ = bucket;
        buckets_[bucket].push_back(element);
    }
    bool empty() {
        while (top_ > 0 && buckets_[top_].empty()) --top_;
        return buckets_[top_].empty();
    }
    /// The bucket of the next one. The queue is not empty, as empty() has just said.
    std::uint16_t top_bucket() const { return static_cast<std::uint16_t>(top_); }
    std::uint32_t pop() {
        const std::uint32_t element = buckets_[top_].back();
        buckets_[top_].pop_back();
        return element;
    }

  private:
    std::vector<std::vector<std::uint32_t>> buckets_{1 << 12};
    std::size_t top_ = 0;
};

}  // namespace planet
