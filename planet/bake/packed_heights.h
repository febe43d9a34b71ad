#pragma once
// Heights of a tile that waits: whole quanta, so 16 bits hold all but the tallest tiles' exactly.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace planet {

class PackedHeights {
  public:
    PackedHeights() = default;
    /// @param heights metres, multiples of the quantum, a power of two, by at most 2^23
    PackedHeights(std::span<const float> heights, double quantum_m) : quantum_(static_cast<float>(quantum_m)) {
        const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
        if (heights.empty() || (*most - *least) / quantum_ > 65535.0f) {
            whole_.assign(heights.begin(), heights.end());
            return;
        }
        least_ = *least;
        steps_.reserve(heights.size());
        for (const float h : heights) steps_.push_back(static_cast<std::uint16_t>((h - least_) / quantum_));
    }

    /// The same bits again.
    void unpack(std::vector<float>& heights) const {
        heights = whole_;
        heights.reserve(size());
        for (const std::uint16_t s : steps_) heights.push_back(least_ + static_cast<float>(s) * quantum_);
    }
    std::size_t size() const { return steps_.size() + whole_.size(); }
    std::size_t bytes() const { return steps_.size() * sizeof steps_[0] + whole_.size() * sizeof whole_[0]; }

  private:
    float least_ = 0, quantum_ = 1;
    std::vector<std::uint16_t> steps_;
    std::vector<float> whole_;  // where a step takes more than 16 bits
};

}  // namespace planet
