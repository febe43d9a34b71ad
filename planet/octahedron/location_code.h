#pragma once
// Addresses: one 64-bit code for a triangle, an elevation tile, a GPU batch, a row in the store and a place on the
// curve.
//
//     code = 1 | face:3 | path          a leading one bit, three face bits, one bit a bisection, at most 60
//
// A cell has corners left, right, apex. Its split side runs left-right. Bisecting it at the midpoint m of that side
// gives
//
//              apex
//              /|\               child 0 = (left, apex, m)      code*2
//             / | \              child 1 = (apex, right, m)     code*2 + 1
//            / 0|1 \             .
//           /___|___\            The Sierpinski curve runs through a cell from its left corner to its right one,
//        left   m   right        through child 0 first: ascending codes are its order.
//
// Faces, with E_i on the equator at longitude 90 i degrees and the poles N and S:
//
//     N_i = (E_i, E_i+1, N)  faces 0..3        S_i = (E_i+1, E_i, S)  faces 4..7
//
// Two bisections are one quadtree level: each face is a pointerless quadtree, and a subtree is one range of codes.
// The scheme is that of Balmelli, Kovacevic and Vetterli's linear quadtrees, and the order that of the Sierpinski
// bitree (Valle Martinez); the constant-time neighbour across faces is our own, checked against geometry in the tests.

#include <bit>
#include <cassert>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace planet {

inline constexpr int face_count = 8;
inline constexpr int max_bisection_level = 60;

/// The side of a cell: split = left-right, left_leg = left-apex, right_leg = apex-right.
enum class Side { split, left_leg, right_leg };

/// A cell of the bisection hierarchy. Ordered by the bits: at one level that is the Sierpinski order within a face.
class LocationCode {
  public:
    constexpr LocationCode() = default;  ///< the face N_0
    constexpr explicit LocationCode(std::uint64_t bits) : bits_(bits) { assert(is_valid(bits)); }

    /// A whole face. @param f 0..7
    static constexpr LocationCode face_root(int f) { return LocationCode(8u | static_cast<unsigned>(f)); }
    /// The cell of a face with the given path of `level` bits.
    static constexpr LocationCode from_path(int f, int level, std::uint64_t path) {
        return LocationCode(((std::uint64_t{8} | static_cast<unsigned>(f)) << level) | path);
    }
    static constexpr bool is_valid(std::uint64_t bits) { return bits >= 8; }

    constexpr std::uint64_t bits() const { return bits_; }
    /// 0..60: how many bisections below its face.
    constexpr int bisection_level() const { return static_cast<int>(std::bit_width(bits_)) - 4; }
    /// Quadtree level: two bisections each.
    constexpr int level() const { return bisection_level() / 2; }
    constexpr int face() const { return static_cast<int>(bits_ >> bisection_level()) & 7; }
    constexpr std::uint64_t path() const { return bits_ & ((std::uint64_t{1} << bisection_level()) - 1); }

    constexpr LocationCode parent() const { return LocationCode(bits_ >> 1); }
    /// @param i 0 or 1. The level must be below max_bisection_level.
    constexpr LocationCode child(int i) const { return LocationCode(bits_ << 1 | static_cast<unsigned>(i)); }
    constexpr LocationCode sibling() const { return LocationCode(bits_ ^ 1); }
    constexpr int child_index() const { return static_cast<int>(bits_ & 1); }
    /// The cell itself or the one above it at a bisection level not below its own.
    constexpr LocationCode ancestor(int bisection_level_above) const {
        return LocationCode(bits_ >> (bisection_level() - bisection_level_above));
    }
    constexpr bool contains(LocationCode c) const {
        const int d = c.bisection_level() - bisection_level();
        return d >= 0 && (c.bits_ >> d) == bits_;
    }
    /// First and one-past-last bits of the codes at a deeper level that lie in this cell: its subtree as one range.
    constexpr std::uint64_t first_at(int deeper_level) const { return bits_ << (deeper_level - bisection_level()); }
    constexpr std::uint64_t end_at(int deeper_level) const { return (bits_ + 1) << (deeper_level - bisection_level()); }

    friend constexpr auto operator<=>(LocationCode, LocationCode) = default;

  private:
    std::uint64_t bits_ = 8;
};

/// The neighbour across a split side within one root of a topology with `root_bits`, or 0 if that side lies on the root's
/// own border.
///
/// With p the path, the lowest set bit of (p ^ p >> 1) at an even place finds the nearest ancestor, an even number of
/// levels up, whose split-side halves meet inside it. It is inside the path iff it is below bit 2 floor(d / 2), d the
/// bisection level, and so iff 2^(root_bits + 2) times it does not pass the code: one comparison, without d.
constexpr std::uint64_t neighbor_within_root(std::uint64_t code, int root_bits) {
    const std::uint64_t t = (code ^ (code >> 1)) & 0x5555555555555555u;
    const std::uint64_t low = t & (0 - t);
    return (low << (root_bits + 2)) - 1 < code ? code ^ ((low << 2) - 1) : 0;
}

namespace detail {
// The path is complemented and the face changes: the other hemisphere for an even level, whose side is the face's own
// split side; the face beside it for an odd one, whose side is a leg.
constexpr LocationCode neighbor_on_other_face(LocationCode cell) {
    const std::uint64_t code = cell.bits();
    const int d = cell.bisection_level();
    const std::uint64_t path_mask = (std::uint64_t{1} << d) - 1;
    if ((d & 1) == 0) return LocationCode(code ^ path_mask ^ (std::uint64_t{4} << d));
    const unsigned f = static_cast<unsigned>(code >> d) & 7u;
    const bool top = (code >> (d - 1) & 1) != 0;
    const bool south = (f & 4u) != 0;
    const unsigned step = top != south ? 1u : 3u;
    const unsigned g = (f & 4u) | ((f + step) & 3u);
    return LocationCode(((code & path_mask) ^ path_mask) | std::uint64_t{8u | g} << d);
}
}  // namespace detail

/// The cell of the same level across the split side. Constant time, faces included.
constexpr LocationCode neighbor(LocationCode cell) {
    const std::uint64_t inside = neighbor_within_root(cell.bits(), 3);
    return inside != 0 ? LocationCode(inside) : detail::neighbor_on_other_face(cell);
}

/// The cell of the same level across any side. Constant time: a leg's neighbour is the sibling (inside the parent) or
/// follows from the neighbour of the parent.
constexpr LocationCode neighbor(LocationCode cell, Side side) {
    if (side == Side::split) return neighbor(cell);
    const bool inner = (side == Side::right_leg) == (cell.child_index() == 0);
    if (cell.bisection_level() == 0) {  // between faces: N_i's right leg is N_i+1's left leg, S_i's is S_i-1's
        const int f = cell.face();
        const int step = (side == Side::right_leg) == (f < 4) ? 1 : 3;
        return LocationCode::face_root((f & 4) | ((f + step) & 3));
    }
    if (inner) return cell.sibling();
    return LocationCode(neighbor(cell.parent()).bits() << 1 | static_cast<unsigned>(cell.child_index() ^ 1));
}

/// The diamond a cell's split side belongs to, named by the lesser of its two cells. It names the split vertex too.
constexpr LocationCode diamond(LocationCode cell) {
    const LocationCode n = neighbor(cell);
    return n < cell ? n : cell;
}

/// Position of a face in the closed loop N0 N1 N2 N3 S3 S2 S1 S0, and back.
constexpr int loop_rank_of_face(int f) {
    return f < 4 ? f : 11 - f;
}
constexpr int face_at_loop_rank(int rank) {
    return rank < 4 ? rank : 11 - rank;
}

/// The cell of the same level that follows on the closed Sierpinski loop over the planet; it shares a side.
constexpr LocationCode next_on_loop(LocationCode cell) {
    const int d = cell.bisection_level();
    const LocationCode next(cell.bits() + 1 < (std::uint64_t{16} << d) ? cell.bits() + 1 : std::uint64_t{8} << d);
    if (next.face() == cell.face() && next > cell) return next;
    return LocationCode::from_path(face_at_loop_rank((loop_rank_of_face(cell.face()) + 1) & 7), d, 0);
}

/// "N0", "S3.0110": the face and the path. The inverse of parse_code.
std::string to_string(LocationCode cell);
/// std::nullopt if the text is not a code.
std::optional<LocationCode> parse_code(std::string_view text);

}  // namespace planet
