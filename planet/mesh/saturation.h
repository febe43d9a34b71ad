#pragma once
// Saturation of a tile's records, a level at a time and many cells at once: a record becomes at least those of its child
// diamonds, and both cells of a diamond get the larger one. The same bits for any vector width.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/mesh/deviation.h"

namespace planet {

/// Made to be used again and again: start() keeps the memory.
class TileSaturation {
  public:
    /// @param depth 1..12 @param rounded by vertex index: m of the split test (TileLattice::rounded)
    void start(int depth, std::span<const glm::vec3> rounded);

    /// Saturates the records of one level; those of the finer ones are done. Records of the tile's last level start
    /// from nothing here: what lies in other tiles is up to the caller, before this call.
    /// @param level relative, 0..depth-1 @param exists by local index; a record that does not exist becomes 0
    /// @param deviation, radius by local index: in, each cell's own deviation, and its corner_distance() rounded up
    /// where it lacks a child diamond, else 0
    void level(int level, std::span<const std::uint8_t> exists, std::span<float> deviation,
               std::span<float> radius) const;

  private:
    void raise(unsigned first, float* deviation, float* radius) const;

    int depth_ = 0;
    std::vector<float> x_, y_, z_;  // of the split vertex, by local index
};

}  // namespace planet
