#pragma once
// Lines on the ellipsoid as they are kept: vertices as geodetic normals, sides between them geodesics. What a view needs
// of them is found by balls around runs of vertices, so a million of them cost no more than those in sight.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace render {

class GeodesicLines {
  public:
    /// @param longitude_latitude in degrees, at least one vertex; z is not looked at. Neighbours that are the same place
    /// count once. One vertex alone is a point.
    void add(std::span<const glm::dvec3> longitude_latitude);

    /// A run of vertices of one line; the last is the first of the next run.
    struct Run {
        std::uint32_t first = 0, count = 0;
        bool begins = false;   ///< a line
        glm::dvec3 centre{0};  ///< ecef, m: of a ball about the run on the ellipsoid
        double radius = 0;
    };
    std::span<const Run> runs() const { return runs_; }
    std::span<const glm::dvec3> vertices(const Run& run) const {
        return std::span(normals_).subspan(run.first, run.count);
    }
    std::size_t vertex_count() const { return normals_.size(); }

    /// The line that begins at a run, whole.
    std::span<const glm::dvec3> line(std::size_t first_run) const;

  private:
    std::vector<glm::dvec3> normals_;
    std::vector<Run> runs_;
};

/// The middle of the shortest line between two normals. Near by a great circle is as good, within 0.05 m.
glm::dvec3 middle_of_side(const glm::dvec3& from, const glm::dvec3& to);

}  // namespace render
