#pragma once
// Which diamonds exist, by the plan alone: one exists iff both its cells have a record and both its parents exist.

#include <cstdint>
#include <span>
#include <unordered_map>

#include "planet/bake/coverage.h"

namespace planet {

/// One thread's. The plan must outlive it; marks on it may change.
class Existence {
  public:
    explicit Existence(const TilePlan& plan) : plan_(plan) {}

    /// Whether the diamond of the cell's split side exists.
    bool operator()(LocationCode cell);
    /// Of all cells of a tile: 1 where the diamond of a cell exists. @param exists by local index, 2^depth of them
    void of_tile(LocationCode root, std::span<std::uint8_t> exists);

  private:
    bool find(LocationCode cell, LocationCode beyond);

    const TilePlan& plan_;
    std::unordered_map<std::uint64_t, bool> known_;  // by the diamond's lesser cell
};

}  // namespace planet
