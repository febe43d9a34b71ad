#pragma once
// Strips fall out of the walk. The Sierpinski curve runs through every leaf of a conforming triangulation once; each
// step crosses a side, the *gate*, and the gate after it keeps one of the two ends. The sides that are never crossed
// form two trees, one left and one right of the curve, and the curve walks around each as an Euler tour. So the next
// vertex of a leaf is either new (the tour goes down: push) or the one below the top of its stack (it goes back up:
// pop), and unique vertices and one generalized strip come without a hash and without a reorder pass.
//
// Which it is needs no look-up: push iff the neighbour across the leaf's uncrossed side comes later on the curve. That,
// the side through which the curve enters and leaves, and the winding are six bits that a child inherits by arithmetic:
//
//            apex                curve left -> right, child 0 first; m the split vertex
//            /|\                 entry of child 0: the parent's left leg becomes its split side, and the reverse
//   left leg/ | \right leg       entry of child 1: always its left leg (apex, m); exit of child 0: its right leg (m,
//   apex)
//          / 0|1 \               .
//         /___|___\              exit of child 1: the parent's right leg becomes its split side, and the reverse
//      left   m   right

#include <array>
#include <cstdint>

#include "planet/mesh/growing_array.h"
#include "planet/octahedron/location_code.h"

namespace planet {

/// What the walk knows of a cell. "Visited": the neighbour across that side comes earlier on the curve.
struct StripState {
    static constexpr unsigned entry_split = 1, exit_split = 2, split_visited = 4, left_visited = 8, right_visited = 16,
                              clockwise = 32;
    static constexpr unsigned count = 64;
};

namespace detail {
constexpr std::array<std::array<std::uint8_t, 2>, StripState::count> make_child_states() {
    std::array<std::array<std::uint8_t, 2>, StripState::count> next{};
    using S = StripState;
    for (unsigned s = 0; s < S::count; ++s) {
        const unsigned winding = (s ^ S::clockwise) & S::clockwise;
        const unsigned outer = s & S::split_visited;
        unsigned c0 = winding, c1 = winding | S::left_visited;
        if (!(s & S::entry_split)) c0 |= S::entry_split;
        if (s & S::left_visited) c0 |= S::split_visited;
        if (outer) c0 |= S::left_visited;
        if (!(s & S::exit_split)) c1 |= S::exit_split;
        if (s & S::right_visited) c1 |= S::split_visited;
        if (outer) c1 |= S::right_visited;
        next[s] = {static_cast<std::uint8_t>(c0), static_cast<std::uint8_t>(c1)};
    }
    return next;
}
}  // namespace detail

/// The states of both children of a cell with state s.
inline constexpr auto strip_child_states = detail::make_child_states();

/// State of a face on the closed loop N0 N1 N2 N3 S3 S2 S1 S0.
constexpr unsigned strip_state_of_face(int face) {
    using S = StripState;
    const int rank = loop_rank_of_face(face);
    const LocationCode cell = LocationCode::face_root(face);
    const auto earlier = [&](Side side) { return loop_rank_of_face(neighbor(cell, side).face()) < rank; };
    return ((rank & 3) == 0 ? S::entry_split : 0) | ((rank & 3) == 3 ? S::exit_split : 0) |
           (earlier(Side::split) ? S::split_visited : 0) | (earlier(Side::left_leg) ? S::left_visited : 0) |
           (earlier(Side::right_leg) ? S::right_visited : 0);
}

/// State of a cell as the root of a strip of its own: nothing outside it counts as visited.
constexpr unsigned strip_state_of_segment(LocationCode root) {
    unsigned s = strip_state_of_face(root.face());
    for (int i = root.bisection_level() - 1; i >= 0; --i) s = strip_child_states[s][root.bits() >> i & 1];
    return s & ~(StripState::split_visited | StripState::left_visited | StripState::right_visited);
}

/// One step of the curve through a leaf: which corner comes next, on which side of the curve, new or from the stack.
struct StripStep {
    std::uint8_t corner;  ///< 1 right, 2 apex (the index into TileLayout::corners)
    bool left_side;       ///< the left end of the gate moves; else the right one
    bool pop;
};

namespace detail {
constexpr std::array<StripStep, StripState::count> make_strip_steps() {
    using S = StripState;
    std::array<StripStep, S::count> steps{};
    for (unsigned s = 0; s < S::count; ++s) {
        const bool cw = (s & S::clockwise) != 0;
        if (s & S::entry_split)
            steps[s] = {2, !cw, (s & S::left_visited) != 0};
        else if (s & S::exit_split)
            steps[s] = {1, !cw, (s & S::right_visited) != 0};
        else
            steps[s] = {1, cw, (s & S::split_visited) != 0};
    }
    return steps;
}
}  // namespace detail
inline constexpr auto strip_steps = detail::make_strip_steps();

/// The corners of the gate through which the curve enters the first leaf: {left end, right end} as corner indices.
constexpr std::array<std::uint8_t, 2> strip_first_gate(unsigned state) {
    const bool split = (state & StripState::entry_split) != 0, cw = (state & StripState::clockwise) != 0;
    const std::uint8_t other = split ? 1 : 2;  // beside corner 0, left
    if (split != cw) return {0, other};
    return {other, 0};
}

/// Writes strips. Room is made in steps (reserve), so that a leaf costs no check.
class StripWriter {
  public:
    /// Room for that many more leaves.
    void reserve(std::size_t leaves) {
        left_.reserve_more(leaves + 2);  // one beyond the top is scratch
        right_.reserve_more(leaves + 2);
        indices_.reserve_more(2 * leaves + 2);
    }

    /// Starts a strip at a gate.
    void begin(std::uint32_t left, std::uint32_t right) {
        left_.clear();
        right_.clear();
        left_.push(left);
        right_.push(right);
        indices_.push(left);
        indices_.push(right);
        last_left_ = false;
        begun_ = true;
    }

    std::uint32_t gate_left() const { return left_.back(); }
    std::uint32_t gate_right() const { return right_.back(); }

    /// Moves one end of the gate and returns its new vertex. @param make_vertex called for a new vertex, returns its
    /// index
    template <class MakeVertex>
    std::uint32_t step(StripStep step, MakeVertex&& make_vertex) {
        GrowingArray<std::uint32_t>& moving = step.left_side ? left_ : right_;
        if (step.left_side == last_left_)  // two steps on one side: repeat the pivot, the other end
            indices_.push(step.left_side ? right_.back() : left_.back());
        if (step.pop)
            moving.pop();
        else
            moving.push(make_vertex());
        last_left_ = step.left_side;
        indices_.push(moving.back());
        return moving.back();
    }

    /// The next leaf begins a strip of its own.
    void end() { begun_ = false; }
    bool begun() const { return begun_; }

    /// Steps through a leaf; the first one of a strip enters through its gate. @param add_corner makes a vertex of corner
    /// 0..2 (left, right, apex) of the leaf and returns its index
    template <class AddCorner>
    std::uint32_t leaf(unsigned state, AddCorner&& add_corner) {
        if (!begun_) {
            const auto [l, r] = strip_first_gate(state);
            const std::uint32_t left = add_corner(l);
            begin(left, add_corner(r));
        }
        const StripStep s = strip_steps[state];
        return step(s, [&] { return add_corner(s.corner); });
    }

    /// Steps through `count` leaves at once, without a branch a leaf. New vertices are numbered from `next` on, in the
    /// order of the pushes; returns the number after the last. Room must have been made for `count` leaves.
    std::uint32_t run(const StripStep* steps, unsigned count, std::uint32_t next) {
        std::uint32_t *left = left_.end() - 1, *right = right_.end() - 1, *out = indices_.end();
        bool last_left = last_left_;
        for (const StripStep* s = steps; s != steps + count; ++s) {
            std::uint32_t* moving = s->left_side ? left : right;
            const std::uint32_t* pivot = s->left_side ? right : left;
            *out = *pivot;  // kept only if the side is the same as before
            out += s->left_side == last_left;
            moving[1] = next;  // kept only by a push
            moving += s->pop ? -1 : 1;
            next += !s->pop;
            *out++ = *moving;
            left = s->left_side ? moving : left;
            right = s->left_side ? right : moving;
            last_left = s->left_side;
        }
        left_.set_end(left + 1);
        right_.set_end(right + 1);
        indices_.set_end(out);
        last_left_ = last_left;
        return next;
    }

    /// All strips so far, one behind the other.
    const GrowingArray<std::uint32_t>& indices() const { return indices_; }
    void clear() {
        indices_.clear();
        end();
    }

  private:
    GrowingArray<std::uint32_t> left_, right_, indices_;
    bool last_left_ = false, begun_ = false;
};

}  // namespace planet
