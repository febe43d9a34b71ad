#pragma once
// The Sierpinski bitree (SBT) of Valle Martinez, "A Sierpinski Space-filling Curve based Modeling of Height Fields", as
// printed: one two-dimensional array of triangles a level, copied four-fold from level l - 2, with no codes inside. An
// independent reference for codes of the square patch.
//
// Where the paper leaves a choice, or errs:
//
//   - It draws the patterns of levels 0 to 3 but gives no coordinates. A neighbour must be one row or column away, which
//     leaves these (rows from the north; a triangle of an even level is named by the corner of its square where its
//     right angle is, one of an odd level by the side of its square that is its hypotenuse):
//
//         level 0   NW SE     level 1   W N     level 2   SW NE NW SE     level 3   W N  N E
//                                       S E               NW SE SW NE               S E  W S
//                                                                                   N E  W N
//                                                                                   W S  S E
//
//     Level 3 is not four copies of level 1: then W and the E of the next square would not be neighbours. That is why
//     four patterns are fixed and not two.
//   - "from level 1, 1 > 3" is "from level l, l > 3".
//   - Children are updated triangle by triangle: those of the original, moved by the quadrant. Parents are updated once
//     the level is complete, from the children of the level above: level 3 being no copy of level 1, the originals'
//     parents would be wrong in level 4.
//   - The left child is the one that the curve enters first; of which corner vertex 1 is nothing is said. Here, as in
//     the RTIN that it follows, vertex 3 is at the right angle: the 3-neighbour lies across the hypotenuse.
//   - Algorithm 4 has size = ROWS(M) div 2^(level/2) with ROWS(M) = 2^n + 1, one too many at levels 0 and 1: 2^n is
//     meant. Its walk is called post-order; triangles being drawn at one level only, it is pre-order as well. It starts
//     at each triangle of level 0.
//   - Four bytes for a child's coordinates are two of 16 bits: n <= 15.

#include <array>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace planet::testing {

class SierpinskiBitree {
  public:
    struct Position {
        std::uint16_t row = 0, column = 0;
        friend bool operator==(const Position&, const Position&) = default;
    };
    /// By orientation: right angle of even levels, hypotenuse of odd ones.
    enum Type : unsigned { north_west, south_east, south_west, north_east, west, north, south, east };
    /// The paper's 12 bytes and 9 bits.
    struct Triangle {
        Position left, right, parent;
        std::uint16_t type : 3 = 0;
        std::uint16_t neighbors : 6 =
            0;  ///< two bits each: op, the coordinate that changes (0 row), and n, the sign (1 minus)
    };
    static constexpr double bytes_of_triangle = 12 + 9. / 8;

    /// @param n 2..15: (2^n + 1)^2 samples, levels 0..2n
    explicit SierpinskiBitree(int n) : n_(n), levels_(static_cast<std::size_t>(2 * n + 1)) {  // algorithm 1
        assert(n >= 2 && n <= 15);
        fix_pattern(0, 1, "NWE SEW", {north_west, south_east}, {{{0, 0}, {0, 1}}, {{1, 1}, {1, 0}}});
        fix_pattern(1, 2, "SEW WSN ENS NWE", {west, north, south, east},
                    {{{1, 0}, {0, 0}}, {{0, 1}, {0, 2}}, {{1, 2}, {1, 1}}, {{0, 3}, {1, 3}}});
        fix_pattern(2, 2, "WSE ENW NWE SEW NWE SEW WSE ENW",
                    {south_west, north_east, north_west, south_east, north_west, south_east, south_west, north_east},
                    {{{1, 0}, {0, 0}},
                     {{0, 1}, {1, 1}},
                     {{1, 2}, {0, 2}},
                     {{0, 3}, {1, 3}},
                     {{3, 0}, {2, 0}},
                     {{2, 1}, {3, 1}},
                     {{3, 2}, {2, 2}},
                     {{2, 3}, {3, 3}}});
        fix_pattern(
            3, 4, "SEW WSN SEN WSE ENS NWE ENW NWS SEN WSE SEW WSN ENW NWS ENS NWE",
            {west, north, north, east, south, east, west, south, north, east, west, north, west, south, south, east},
            {{{1, 0}, {0, 0}},
             {{0, 1}, {0, 2}},
             {{0, 5}, {0, 6}},
             {{0, 7}, {1, 7}},
             {{1, 2}, {1, 1}},
             {{0, 3}, {1, 3}},
             {{1, 4}, {0, 4}},
             {{1, 6}, {1, 5}},
             {{2, 1}, {2, 2}},
             {{2, 3}, {3, 3}},
             {{3, 4}, {2, 4}},
             {{2, 5}, {2, 6}},
             {{3, 0}, {2, 0}},
             {{3, 2}, {3, 1}},
             {{3, 6}, {3, 5}},
             {{2, 7}, {3, 7}}});
        for (int level = 1; level <= 3; ++level) set_parents(level);
        for (int level = 4; level <= 2 * n; ++level) replicate_pattern(level - 2, level);
    }

    int last_level() const { return 2 * n_; }
    int rows(int level) const { return static_cast<int>(levels_[static_cast<std::size_t>(level)].rows); }
    int columns(int level) const { return static_cast<int>(levels_[static_cast<std::size_t>(level)].columns); }
    const Triangle& at(int level, Position p) const {
        const Level& l = levels_[static_cast<std::size_t>(level)];
        return l.triangles[p.row * l.columns + p.column];
    }

    /// Algorithm 3: the triangle of the same size that does not share vertex i; std::nullopt at the border.
    /// @param i 1..3, counter-clockwise; 3 is the vertex at the right angle
    std::optional<Position> neighbor(int i, int level, Position p) const {
        const unsigned bits = at(level, p).neighbors >> (2 * (i - 1));
        const int op = static_cast<int>(bits & 1), n = static_cast<int>(bits >> 1 & 1);
        const int row = p.row + (op ^ 1) * (1 - 2 * n), column = p.column + (op & 1) * (1 - 2 * n);
        if (row < 0 || column < 0 || row >= rows(level) || column >= columns(level)) return std::nullopt;
        return Position{static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column)};
    }

    /// Algorithm 4: calls draw(position) for each triangle of a level below the one given, along the curve.
    template <class Draw>
    void walk(int level, Position p, int draw_level, Draw&& draw) const {
        if (level < draw_level) {
            walk(level + 1, at(level, p).left, draw_level, draw);
            walk(level + 1, at(level, p).right, draw_level, draw);
        } else {
            draw(p);
        }
    }

    /// Vertices 1, 2, 3 in samples, x to the right, y up, from the place in the array, the type and the size alone.
    std::array<glm::ivec2, 3> vertices(int level, Position p) const {
        const int size = 1 << n_ >> (level / 2), row = level % 2 == 0 ? p.row : p.row / 2, column = p.column / 2;
        const glm::ivec2 sw(column * size, (1 << n_) - (row + 1) * size), ne = sw + size;
        const glm::ivec2 nw(sw.x, ne.y), se(ne.x, sw.y), centre = (sw + ne) / 2;
        switch (at(level, p).type) {
            case north_west:
                return {sw, ne, nw};
            case south_east:
                return {ne, sw, se};
            case south_west:
                return {se, nw, sw};
            case north_east:
                return {nw, se, ne};
            case west:
                return {nw, sw, centre};
            case north:
                return {ne, nw, centre};
            case south:
                return {sw, se, centre};
            default:
                return {se, ne, centre};
        }
    }

  private:
    struct Level {
        std::size_t rows = 0, columns = 0;
        std::vector<Triangle> triangles;
    };
    struct Children {
        Position left, right;
    };

    static unsigned bits_of_move(char direction) {  // north is the row above
        switch (direction) {
            case 'N':
                return 2;
            case 'S':
                return 0;
            case 'W':
                return 3;
            default:
                return 1;
        }
    }
    void fix_pattern(int level, std::size_t rows, std::string_view moves, const std::vector<Type>& types,
                     const std::vector<Children>& children) {
        Level& l = levels_[static_cast<std::size_t>(level)];
        l = {rows, types.size() / rows, std::vector<Triangle>(types.size())};
        for (std::size_t i = 0; i < types.size(); ++i) {
            Triangle& t = l.triangles[i];
            t.left = children[i].left;
            t.right = children[i].right;
            t.type = types[i] & 7u;
            t.neighbors = (bits_of_move(moves[4 * i]) | bits_of_move(moves[4 * i + 1]) << 2 |
                           bits_of_move(moves[4 * i + 2]) << 4) &
                          63u;
        }
    }
    void replicate_pattern(int source, int target) {  // algorithm 2
        const Level& from = levels_[static_cast<std::size_t>(source)];
        // The level below the target will be four copies of the one below the source.
        const Level& below = levels_[static_cast<std::size_t>(source + 1)];
        Level& to = levels_[static_cast<std::size_t>(target)];
        to = {2 * from.rows, 2 * from.columns, std::vector<Triangle>(4 * from.triangles.size())};
        for (std::size_t row = 0; row < to.rows; ++row)
            for (std::size_t column = 0; column < to.columns; ++column) {
                Triangle t = from.triangles[row % from.rows * from.columns + column % from.columns];
                for (Position* child : {&t.left, &t.right}) {
                    child->row = static_cast<std::uint16_t>(child->row + row / from.rows * below.rows);
                    child->column = static_cast<std::uint16_t>(child->column + column / from.columns * below.columns);
                }
                to.triangles[row * to.columns + column] = t;
            }
        set_parents(target);
    }
    void set_parents(int level) {
        const Level& above = levels_[static_cast<std::size_t>(level - 1)];
        Level& l = levels_[static_cast<std::size_t>(level)];
        for (std::size_t i = 0; i < above.triangles.size(); ++i)
            for (const Position child : {above.triangles[i].left, above.triangles[i].right})
                l.triangles[child.row * l.columns + child.column].parent = {
                    static_cast<std::uint16_t>(i / above.columns), static_cast<std::uint16_t>(i % above.columns)};
    }

    int n_;
    std::vector<Level> levels_;
};

}  // namespace planet::testing
