#pragma once
// Where tiles in memory come from.

#include <memory>

#include "planet/mesh/tile.h"

namespace planet {

class TileReader {
  public:
    virtual ~TileReader() = default;
    /// nullptr if there is none.
    virtual std::shared_ptr<const Tile> tile(LocationCode root) const = 0;
};

}  // namespace planet
