#pragma once
// Three topologies, one set of algorithms: a square patch, a grid of patches, the octahedron. A topology names its root
// cells and says what lies across a cell's split side; everything else (parents, children, levels, order, subtrees) is
// arithmetic on codes, the same for all.
//
//     code = 1 | root: root_bits | path: one bit a bisection          0 where there is no cell
//
// A square patch has two roots, with the same child rule as a face (location_code.h):
//
//     NW ---- NE      root 0 = (SW, NE, NW)     left, right, apex: counter-clockwise with y up
//      | 0  / |       root 1 = (NE, SW, SE)
//      |  /   |
//      |/   1 |       The curve runs SW -> NE through root 0 and back through root 1: a closed loop in every patch.
//     SW ---- SE      Sides of patches are glued where patches of a grid meet; all are cut along the same diagonal.

#include <bit>
#include <cassert>
#include <concepts>
#include <cstdint>

#include "planet/octahedron/location_code.h"

namespace planet {

/// A cell of any topology; 0: none.
using CellCode = std::uint64_t;

/// Most path bits and root bits together.
inline constexpr int max_code_bits = 63;

/// `root_bits` of the code, `root_count` roots in the order of the curve by rank, and the cell of the same level across a
/// split side, 0 at a border.
template <class T>
concept Topology = requires(const T t, CellCode c, int rank) {
    { t.root_bits() } -> std::convertible_to<int>;
    { t.root_count() } -> std::convertible_to<int>;
    { t.root(rank) } -> std::convertible_to<CellCode>;
    { t.neighbor(c) } -> std::convertible_to<CellCode>;
};

constexpr int bisection_level_of(CellCode cell, int root_bits) {
    return static_cast<int>(std::bit_width(cell)) - 1 - root_bits;
}

/// The planet: eight faces, closed. Codes are those of LocationCode.
struct OctahedronTopology {
    static constexpr int root_bits() { return 3; }
    static constexpr int root_count() { return face_count; }
    static constexpr CellCode root(int rank) { return LocationCode::face_root(face_at_loop_rank(rank)).bits(); }
    static constexpr CellCode neighbor(CellCode cell) { return planet::neighbor(LocationCode(cell)).bits(); }
};

/// columns x rows square patches, two roots each, their sides glued; 1 x 1 is the square patch. Root number =
/// 2 (row columns + column) + half.
class PatchGrid {
  public:
    /// @param columns, rows at least 1; at most 2^30 patches
    constexpr PatchGrid(int columns, int rows)
        : columns_(columns), rows_(rows), root_bits_(static_cast<int>(std::bit_width(2 * patch_count() - 1))) {
        assert(columns >= 1 && rows >= 1 && patch_count() <= (std::uint64_t{1} << 30));
    }

    constexpr int columns() const { return columns_; }
    constexpr int rows() const { return rows_; }
    constexpr std::uint64_t patch_count() const {
        return static_cast<std::uint64_t>(columns_) * static_cast<std::uint64_t>(rows_);
    }
    constexpr int root_bits() const { return root_bits_; }
    constexpr int root_count() const { return static_cast<int>(2 * patch_count()); }
    constexpr CellCode root(int rank) const { return CellCode{1} << root_bits_ | static_cast<unsigned>(rank); }
    constexpr CellCode root_of_patch(int column, int row, int half) const {
        return root(2 * (row * columns_ + column) + half);
    }

    constexpr CellCode neighbor(CellCode cell) const {
        const CellCode inside = neighbor_within_root(cell, root_bits_);
        if (inside != 0) [[likely]]
            return inside;
        return neighbor_across_border(cell);
    }

  private:
    // Rare, and out of line: inlined everywhere it nearly doubles the time of the ten instructions of the other way.
    [[gnu::noinline]] constexpr CellCode neighbor_across_border(CellCode cell) const {
        const int d = bisection_level_of(cell, root_bits_);
        if ((d & 1) == 0) return cell ^ ((CellCode{2} << d) - 1);  // the diagonal: the other half, path reversed
        // A side of the patch: half 0 lies at the west (top path bit 0) and the north (1), half 1 at the east and the
        // south. Across it the half changes, the top bit stays, and the rest of the path is reversed.
        const bool lower = (cell >> d & 1) != 0, across_rows = (cell >> (d - 1) & 1) != 0;
        const auto patch = static_cast<int>((cell >> d & ((CellCode{1} << root_bits_) - 1)) >> 1);
        const int step = across_rows == lower ? -1 : 1;
        if (across_rows) {
            const int row = patch / columns_ + step;
            if (row < 0 || row >= rows_) return 0;
        } else {
            const int column = patch % columns_ + step;
            if (column < 0 || column >= columns_) return 0;
        }
        const int other = patch + (across_rows ? step * columns_ : step);
        const CellCode path = (cell ^ ((CellCode{1} << (d - 1)) - 1)) & ((CellCode{1} << d) - 1);
        return root(2 * other + !lower) << d | path;
    }

    int columns_, rows_, root_bits_;
};

/// The neighbour across a leg: the sibling, or it follows from the parent's neighbour. 0 at a border.
/// @param cell below a root
template <Topology T>
constexpr CellCode leg_neighbor(const T& topology, CellCode cell, Side leg) {
    assert(leg != Side::split && bisection_level_of(cell, topology.root_bits()) > 0);
    if ((leg == Side::right_leg) == ((cell & 1) == 0)) return cell ^ 1;
    const CellCode outer = topology.neighbor(cell >> 1);
    return outer == 0 ? 0 : outer << 1 | (~cell & 1);
}

/// The diamond that a cell's split side belongs to, named by the lesser of its cells; it names the split vertex too.
template <Topology T>
constexpr CellCode diamond(const T& topology, CellCode cell) {
    const CellCode n = topology.neighbor(cell);
    return n != 0 && n < cell ? n : cell;
}

}  // namespace planet
