#pragma once
// A Delaunay triangulation of a rectangle of integer points, that points go into and out of one at a time, in arrays of
// half-edges. Coordinates are integers, so every orientation and in-circle test is exact and no input is degenerate:
// grids, collinear and cocircular points are as good as any. It knows nothing of what its points stand for.
//
//               c                     half-edges of triangle t: 3t, 3t + 1, 3t + 2, counter-clockwise (x right, y up)
//              / \                    origin(e): the vertex where e begins
//       3t+2  /   \  3t+1             twin(e): the half-edge of the triangle beyond, none at the border
//            /  t  \                                                                                    .
//           a-------b
//              3t
//
// Insertion (Bowyer and Watson): triangles whose circle holds the point go, and the point is joined to what surrounds
// the cavity. Removal: the star of a vertex goes, and ears whose circle holds no corner of the polygon are cut off
// until it is filled. Both are planned first and done on request, so that a caller can look at the triangles that would
// be.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace planet {

__extension__ typedef __int128 Int128;

/// Twice the area of a triangle: > 0 counter-clockwise, 0 on a line.
inline std::int64_t orientation(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c) {
    const std::int64_t abx = b.x - a.x, aby = b.y - a.y, acx = c.x - a.x, acy = c.y - a.y;
    return abx * acy - aby * acx;
}

/// Whether p lies strictly within the circle through a, b, c (counter-clockwise).
inline bool in_circle(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c, glm::ivec2 p) {
    const std::int64_t ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y, cx = c.x - p.x, cy = c.y - p.y;
    const std::int64_t aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    if ((aa | bb | cc) < 1 << 29)  // three products below 2^59
        return aa * (bx * cy - by * cx) + bb * (cx * ay - cy * ax) + cc * (ax * by - ay * bx) > 0;
    return Int128(aa) * (bx * cy - by * cx) + Int128(bb) * (cx * ay - cy * ax) + Int128(cc) * (ax * by - ay * bx) > 0;
}

class Delaunay {
  public:
    using Index = std::uint32_t;
    static constexpr Index none = 0xffffffffu;
    /// Coordinates are from -max_coordinate to max_coordinate.
    static constexpr int max_coordinate = 1 << 28;

    /// Where a point lies.
    struct Location {
        Index triangle;       ///< that holds it, its sides included
        Index side = none;    ///< half-edge of that triangle on which it lies, if on one
        Index vertex = none;  ///< at which it lies, if at one
    };

    /// The triangulation of a grid of points: at least two columns and two rows, ascending. Vertex (i, j) has the index
    /// j * columns + i; cell (i, j) the triangles 2 * (j * (columns - 1) + i) and the one after it.
    Delaunay(std::span<const int> columns, std::span<const int> rows);
    /// Two triangles.
    Delaunay(glm::ivec2 low, glm::ivec2 high);
    /// Triangles of any shape as a whole, holes too, in their order: points can go in at locate_in(). Sides that are not
    /// Delaunay become constrained. @param triangles counter-clockwise, no side twice the same way; all points used
    Delaunay(std::vector<glm::ivec2> points, std::span<const std::array<Index, 3>> triangles);

    /// Slots: some may be unused after removals.
    std::size_t vertex_slots() const { return point_.size(); }
    std::size_t triangle_slots() const { return origin_.size() / 3; }
    std::size_t vertex_count() const { return point_.size() - free_vertices_.size(); }
    std::size_t triangle_count() const { return triangle_slots() - free_triangles_.size(); }
    bool alive(Index triangle) const { return origin_[3 * triangle] != none; }
    bool vertex_alive(Index v) const { return out_[v] != none; }

    glm::ivec2 point(Index v) const { return point_[v]; }
    Index origin(Index e) const { return origin_[e]; }
    Index twin(Index e) const { return twin_[e]; }
    static Index next(Index e) { return e % 3 == 2 ? e - 2 : e + 1; }
    static Index previous(Index e) { return e % 3 == 0 ? e + 2 : e - 1; }
    /// A half-edge that begins at a vertex: where it is on the border, the one after which (counter-clockwise about it)
    /// come all others is not promised.
    Index out(Index v) const { return out_[v]; }
    std::array<Index, 3> vertices(Index triangle) const {
        return {origin_[3 * triangle], origin_[3 * triangle + 1], origin_[3 * triangle + 2]};
    }
    std::array<glm::ivec2, 3> corners(Index triangle) const {
        return {point_[origin_[3 * triangle]], point_[origin_[3 * triangle + 1]], point_[origin_[3 * triangle + 2]]};
    }

    /// Walks to a point from a triangle nearby. @param p within the rectangle
    Location locate(glm::ivec2 p, Index from) const;
    /// From the triangle last changed.
    Location locate(glm::ivec2 p) const { return locate(p, recent_); }
    /// The same for a triangle known to hold the point.
    Location locate_in(glm::ivec2 p, Index triangle) const;

    // ---- insertion ----

    /// Finds the triangles that a point would make. @param at where it lies, at no vertex
    void plan_insertion(glm::ivec2 p, const Location& at);
    /// Their other corners, in order about the point: triangle i would be (point, ring()[i], ring()[i + 1]), the last
    /// one back to ring()[0] unless the point is on the border (open_ring()).
    std::span<const Index> ring() const { return ring_; }
    bool open_ring() const { return open_; }
    /// Triangles that would go: they hold what the new ones hold.
    std::span<const Index> cavity() const { return cavity_; }
    /// Does what was planned. @return the vertex; changed() has its triangles, of which the point is the third corner
    Index insert_planned();
    /// Both. A point at a vertex gives that vertex, and nothing is changed.
    Index insert(glm::ivec2 p, const Location& at);
    Index insert(glm::ivec2 p) { return insert(p, locate(p)); }

    // ---- removal ----

    /// Finds the triangles that would fill the star of a vertex. @return false if it is on the border, ends or lies on
    /// a constrained side, or constrained sides about it leave no Delaunay filling
    bool plan_removal(Index v) {
        return plan_removal(v, [](const std::array<Index, 3>&) { return true; });
    }
    /// The same with accept(triangle) called for each of them as it is found: returning false gives up.
    template <class Accept>
    bool plan_removal(Index v, Accept&& accept) {
        if (!begin_removal(v)) return false;
        while (cut_ear())
            if (!accept(filling_.back())) return false;
        return left_.size() == 2;
    }
    /// Triangles that would be.
    std::span<const std::array<Index, 3>> filling() const { return filling_; }
    /// Does what was planned; changed() has the filling, in the same order.
    void remove_planned();

    /// Of the last insertion, removal or constraint.
    std::span<const Index> changed() const { return changed_; }

    // ---- constrained sides ----

    /// Makes the straight line between two vertices sides of the triangulation that stay; vertices on the way divide
    /// it.
    /// @return false, and nothing changes, if it crosses a constrained side: crossed() has both its ends
    bool constrain(Index a, Index b);
    std::array<Index, 2> crossed() const { return crossed_; }
    /// Makes a side that is there one that stays.
    void hold(Index e);
    /// Makes a constrained side one like any other.
    void release(Index e);
    bool constrained(Index e) const { return !constrained_.empty() && constrained_[e] != 0; }
    bool has_constraints() const { return !constrained_.empty(); }
    /// Whether a side joins two vertices. @return a half-edge from a to b, or none
    Index side_between(Index a, Index b) const;

    /// The same triangulation without unused slots: vertices in their present order. Which diagonals cocircular points
    /// have may differ.
    Delaunay compacted() const;

    /// Room for so many triangles.
    void reserve(std::size_t triangles);

    /// Empty if all links fit, every triangle turns left, every side that is not constrained is Delaunay and the whole
    /// is a disc without holes; else the first thing that is wrong.
    std::string check() const;

  private:
    struct Boundary {
        Index outer;  ///< half-edge beyond, or none
        bool constrained;
    };

    Index new_triangle();
    void set_triangle(Index t, Index a, Index b, Index c);
    void link(Index e, Index f) {
        twin_[e] = f;
        if (f != none) twin_[f] = e;
    }
    void set_constrained(Index e);
    void link_twins();
    bool collect_star(Index v);
    bool begin_removal(Index v);
    bool cut_ear();
    bool is_ear(std::span<const Index> polygon, std::size_t i) const;
    void flip(Index e);
    void force_side(Index from, Index to, std::span<const Index> sides);
    void make_delaunay(std::vector<Index>& ends);

    std::vector<glm::ivec2> point_;
    std::vector<Index> out_;                 ///< by vertex: a half-edge that begins there
    std::vector<Index> origin_, twin_;       ///< by half-edge
    std::vector<std::uint8_t> constrained_;  ///< by half-edge; empty if none is
    std::vector<Index> free_triangles_, free_vertices_;
    Index recent_ = 0;

    // What is planned, and room for planning.
    glm::ivec2 planned_point_{0};
    Index planned_vertex_ = none;
    Index split_ends_[2] = {none, none};  ///< ends of the constrained side that the planned point divides
    bool open_ = false;
    std::vector<Index> ring_, cavity_, changed_, stack_;
    std::vector<Boundary> boundary_;
    std::vector<std::array<Index, 3>> filling_;
    std::vector<std::array<std::uint32_t, 3>> ears_;  ///< places in the ring
    std::vector<std::uint32_t> left_;                 ///< places in the ring that are not cut off yet
    std::size_t ear_ = 0;                             ///< place in left_ where the next ear is looked for
    std::array<Index, 2> crossed_{none, none};
};

}  // namespace planet
