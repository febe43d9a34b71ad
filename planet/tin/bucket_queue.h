#pragma once
// A priority queue of triangles in no strict order: sixteen buckets an octave of the key, last in first out within
// each.

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace planet {

/// An element may be pushed again with another key: whoever takes elements out checks that its key still is what it
/// was.
class BucketQueue {
  public:
    static constexpr std::uint16_t none = 0xffff;  ///< no bucket

    /// The exponent and four bits of the mantissa. @param key not negative
    static std::uint16_t bucket_of(float key) {
        return static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(key) >> 19);
    }

    void push(std::uint32_t element, std::uint16_t bucket) {
        buckets_[bucket].push_back(element);
        filled_[bucket / 64u] |= std::uint64_t{1} << (bucket % 64);
        filled_words_ |= std::uint64_t{1} << (bucket / 64);
    }
    bool empty() const { return filled_words_ == 0; }
    /// The bucket of the next one. The queue is not empty.
    std::uint16_t top_bucket() const {
        const int word = 63 - std::countl_zero(filled_words_);
        return static_cast<std::uint16_t>(64 * word + 63 - std::countl_zero(filled_[static_cast<std::size_t>(word)]));
    }
    /// @param bucket as top_bucket() has said
    std::uint32_t pop(std::uint16_t bucket) {
        std::vector<std::uint32_t>& elements = buckets_[bucket];
        const std::uint32_t element = elements.back();
        elements.pop_back();
        if (elements.empty()) {
            std::uint64_t& word = filled_[bucket / 64u];
            word &= ~(std::uint64_t{1} << (bucket % 64));
            if (word == 0) filled_words_ &= ~(std::uint64_t{1} << (bucket / 64));
        }
        return element;
    }

  private:
    std::vector<std::vector<std::uint32_t>> buckets_{1 << 12};
    std::array<std::uint64_t, 64> filled_{};  ///< a bit for each bucket
    std::uint64_t filled_words_ = 0;          ///< a bit for each word of these
};

}  // namespace planet
