#pragma once
// What a ray meets of the triangles that are drawn.

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "planet/mesh/segments.h"

namespace render {

class GroundPick {
  public:
    /// The mesh that is drawn now. Must stay as it is until the next call; costs nothing before something is picked.
    void follow(const planet::Segments& segments) {
        segments_ = &segments;
        spheres_.clear();
    }
    /// The nearest point of a triangle that faces the origin, ecef. @param direction unit
    std::optional<glm::dvec3> first_hit(const glm::dvec3& origin, const glm::dvec3& direction);

  private:
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    void measure();

    const planet::Segments* segments_ = nullptr;
    std::vector<Ball> spheres_;  // by segment, once asked for
};

}  // namespace render
