#pragma once
// Polygons as triangles.

#include <array>
#include <cstdint>
#include <vector>

namespace planet {

/// Takes the corners of a polygon one by one and appends its triangles, a fan about the first corner.
class PolygonFan {
  public:
    explicit PolygonFan(std::vector<std::array<std::uint32_t, 3>>& triangles) : triangles_(triangles) {}

    void add(std::uint32_t vertex) {
        if (corners_ >= 2) triangles_.push_back({first_, last_, vertex});
        if (corners_ == 0) first_ = vertex;
        last_ = vertex;
        ++corners_;
    }

  private:
    std::vector<std::array<std::uint32_t, 3>>& triangles_;
    std::size_t corners_ = 0;
    std::uint32_t first_ = 0, last_ = 0;
};

}  // namespace planet
