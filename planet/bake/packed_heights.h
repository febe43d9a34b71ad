#pragma once
// Heights of a tile that waits: whole quanta, so 16 bits hold all but the tallest tiles' exactly.

#include <cstdint>
#include <span>
#include <vector>

namespace planet {

class PackedHeights {
  public:
    PackedHeights() = default;
    /// @param heights metres, multiples of the quantum, a power of two, by at most 2^23
    PackedHeights(std::span<const float> heights, double quantum_m);

    /// The same bits again.
    void unpack(std::vector<float>& heights) const;
    std::size_t size() const { return steps_.size() + whole_.size(); }
    std::size_t bytes() const { return steps_.size() * sizeof steps_[0] + whole_.size() * sizeof whole_[0]; }

  private:
    float least_ = 0, quantum_ = 1;
    std::vector<std::uint16_t> steps_;
    std::vector<float> whole_;  // where a step takes more than 16 bits
};

}  // namespace planet
