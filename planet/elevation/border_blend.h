#pragma once
// Leads a coarse field up to the border of a finer one, outside it.
//
// Known at points of the border: by how much the finer field is above the coarser one there. Around them the difference
// is interpolated with the weights of Franke and Little, w = ((D - r)+ / (D r))² (in Franke, "Scattered data
// interpolation: tests of some methods", Math. Comp. 38, 1982), D the reach and r the distance as a chord, and fades
// out by a smooth step of the least r / D. So it takes the border's own value at the border, is 0 beyond the reach, and
// stays between the least and the greatest difference and 0. Clusters of points that appear under less than 1/4 count
// as one.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace planet {

/// What a finer field has to say at a place outside of its border.
struct BorderShare {
    double weight = 0;       ///< 0..1: of the height there; the rest is the coarser field's
    std::uint32_t file = 0;  ///< Point::file of the nearest point, by distance / reach
};

class BorderBlend {
  public:
    struct Point {
        glm::dvec3 normal;       ///< unit
        double difference;       ///< m
        double reach;            ///< > 0, chord on the unit sphere
        float count = 1;         ///< how many points it stands for
        std::uint32_t file = 0;  ///< that the finer field's height is from (HeightOrigin)
    };

    BorderBlend() = default;
    /// @param clearance  chord; nearer than this to a point counts as at the border: half the gaps between points
    BorderBlend(std::vector<Point> points, double clearance);

    /// Metres to add to the coarser field at a unit normal. 0 beyond the reach of every point.
    double operator()(const glm::dvec3& normal) const;
    /// Adds to each correction, in metres, that at a unit normal: the same bits, and much faster where neighbours in the
    /// span are so on the ground. Spans of the same size.
    /// @param shares  filled in within reach, left alone elsewhere; may be empty
    void add(std::span<const glm::dvec3> normals, std::span<double> corrections,
             std::span<BorderShare> shares = {}) const;

    std::size_t bytes() const { return sizeof *this + points_.size() * sizeof(Point) + nodes_.size() * sizeof(Node); }

  private:
    struct Node {
        glm::dvec3 centre;                 // mean of its points
        double radius = 0;                 // all of them are within
        double difference = 0, reach = 0;  // means
        double max_reach = 0, weight = 0;  // the sum of their counts
        int first = 0, count = 0;          // its points
        int right = 0;                     // second child; the first follows its parent. 0: a leaf
    };

    struct Places;  // some, one a lane

    void build(int first, int count);
    bool may_reach(std::size_t node, const glm::dvec3& centre, double radius) const;
    void add_some(std::span<const glm::dvec3> normals, std::span<double> corrections,
                  std::span<BorderShare> shares) const;
    void find_nearest(std::size_t node, Places& places) const;
    void gather(std::size_t node, Places& places) const;

    std::vector<Point> points_;
    std::vector<Node> nodes_;
    double clearance_ = 0;
};

}  // namespace planet
