#pragma once
// Pointerless quadtrees of split cells. A conforming triangulation is the set of its split cells, and nothing else: no
// pointer, no index of a child or a parent, for a code is its own address.
//
//     DenseSplitSet    one bit for every cell that could be split, at its code: 1 bit a cell
//     SparseSplitSet   a hash of chunks: six levels below a cell, 63 cells in one word: 16 bytes a chunk
//
// Both keep the cells of a diamond apart, so that asking is one look-up and never needs the neighbour. A cell too deep
// to be split is never contained, and neither is 0.

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planet/quadtree/topology.h"

namespace planet {

/// What insert() found.
struct Insertion {
    bool is_new;        ///< the cell was not split before
    bool parent_split;  ///< its parent is; false for a root
};

namespace detail {
// By local index in a chunk: the cells of its subtree.
inline constexpr auto subtree_in_chunk = [] {
    std::array<std::uint64_t, 64> mask{};
    for (unsigned i = 63; i >= 1; --i) mask[i] = std::uint64_t{1} << i | (i < 32 ? mask[2 * i] | mask[2 * i + 1] : 0);
    return mask;
}();
}  // namespace detail

/// One bit a cell. Fastest where most of the tree is used, or is small.
class DenseSplitSet {
  public:
    /// Nothing split. @param levels cells of bisection levels 0 .. levels - 1 can be split; root_bits + levels <= 40
    DenseSplitSet(int root_bits, int levels);

    bool contains(CellCode cell) const { return cell < end_ && (words_[cell >> 6] >> (cell & 63) & 1) != 0; }
    /// @param cell of a level below `levels`
    Insertion insert(CellCode cell) {
        assert(cell < end_);
        std::uint64_t& word = words_[cell >> 6];
        const std::uint64_t bit = std::uint64_t{1} << (cell & 63), before = word;
        word |= bit;
        return {(before & bit) == 0, contains(cell >> 1)};
    }
    /// Takes out a cell and everything below it: a range of codes a level, wiped level by level while there is anything.
    /// @return which of its children were split: bit 0, bit 1
    unsigned drop(CellCode cell) {
        assert(cell < end_);
        words_[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
        if (2 * cell >= end_) return 0;
        std::uint64_t& word = words_[cell >> 5];
        const auto children = static_cast<unsigned>(word >> (2 * cell & 63) & 3);
        word &= ~(std::uint64_t{3} << (2 * cell & 63));
        if (children != 0) wipe_grandchildren(cell);
        return children;
    }
    /// Splits everything below a cell, itself included, to the last level.
    void fill(CellCode cell);

    int levels() const { return levels_; }
    std::size_t count() const;  ///< split cells, wherever they are
    std::size_t bytes() const { return words_.size() * sizeof words_[0]; }

  private:
    void wipe_grandchildren(CellCode cell);

    int levels_;
    CellCode end_;                      ///< one past the last code that could be split
    std::vector<std::uint64_t> words_;  ///< bit by code
};

/// For few cells anywhere in a deep tree: regions of interest, feature lines, edits.
class SparseSplitSet {
  public:
    /// @param levels as above; root_bits + levels <= max_code_bits
    SparseSplitSet(int root_bits, int levels);

    bool contains(CellCode cell) const {
        const Place p = place(cell);
        const Chunk& chunk = chunks_[slot(p.root)];
        return chunk.root == p.root && (chunk.split >> p.index & 1) != 0;
    }
    Insertion insert(CellCode cell) {
        assert(cell < end_);
        const Place p = place(cell);
        Chunk& chunk = chunk_of(p.root);
        const std::uint64_t bit = std::uint64_t{1} << p.index, before = chunk.split;
        chunk.split = before | bit;
        return {(before & bit) == 0, p.index > 1 ? (before >> (p.index / 2) & 1) != 0 : contains(cell >> 1)};
    }
    /// As above; 63 cells at a time.
    unsigned drop(CellCode cell) {
        assert(cell < end_);
        const Place p = place(cell);
        Chunk& chunk = chunks_[slot(p.root)];
        if (chunk.root != p.root) return 0;
        const std::uint64_t gone = chunk.split & detail::subtree_in_chunk[p.index];
        chunk.split ^= gone;
        const auto children = static_cast<unsigned>(p.index < 32 ? gone >> (2 * p.index) & 3 : 0);
        return p.root < first_bottom_ ? children | drop_chunks_below(p, gone) : children;
    }
    void fill(CellCode cell);

    int levels() const { return levels_; }
    std::size_t count() const;
    std::size_t bytes() const { return chunks_.size() * sizeof chunks_[0]; }

  private:
    // Chunks end at the last level, so that a deep tree's many finest cells fill theirs. The topmost chunks, those of
    // the roots, have what levels remain.
    static constexpr int chunk_levels = 6;
    struct Chunk {
        CellCode root = 0;        ///< 0: free
        std::uint64_t split = 0;  ///< by local index 1..63, a heap: children of i at 2i and 2i + 1
    };
    struct Place {
        CellCode root;
        unsigned index;
    };

    Place place(CellCode cell) const {
        const int depth = depth_of_width_[static_cast<std::size_t>(std::bit_width(cell))];
        return {cell >> depth, 1u << depth | (static_cast<unsigned>(cell) & ((1u << depth) - 1))};
    }
    int levels_of_chunk(CellCode root) const { return root < first_below_top_ ? top_levels_ : chunk_levels; }
    // Where the chunk is, or the free slot where it would be. Four siblings share a cache line.
    std::size_t slot(CellCode root) const {
        std::size_t i = static_cast<std::size_t>(((root >> 2) * 0x9e3779b97f4a7c15u) >> shift_) << 2 | (root & 3);
        while (chunks_[i].root != root && chunks_[i].root != 0) i = (i + 1) & (chunks_.size() - 1);
        return i;
    }
    Chunk& chunk_of(CellCode root) {  // added if need be
        const std::size_t i = slot(root);
        return chunks_[i].root == root ? chunks_[i] : add_chunk(root, i);
    }
    Chunk& add_chunk(CellCode root, std::size_t slot);
    void rehash();
    unsigned drop_chunk(CellCode root);                       // @return whether its root was split
    unsigned drop_chunks_below(Place p, std::uint64_t gone);  // @return which of p's children, if they root chunks

    int levels_;
    int top_levels_;            ///< of the chunks of the roots, 1..6
    CellCode first_below_top_;  ///< least code below them
    CellCode first_bottom_;     ///< least root of the chunks at the last level
    CellCode end_;              ///< one past the last code that could be split
    int shift_ = 0;
    std::size_t used_ = 0;
    std::array<std::uint8_t, 65> depth_of_width_{};  ///< levels below the chunk's root, by the width of the code
    std::vector<Chunk> chunks_;                      ///< open addressing; a power of two
};

}  // namespace planet
