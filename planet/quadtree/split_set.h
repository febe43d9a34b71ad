#pragma once
// Pointerless quadtrees of split cells. A conforming triangulation is the set of its split cells, and nothing else: no
// pointer, no index of a child or a parent, for a code is its own address.
//
//     DenseSplitSet    one bit for every cell that could be split, at its code: 1 bit a cell
//     SparseSplitSet   a hash of chunks: eight levels from a cell down, 255 cells in four words: 40 bytes a chunk
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
        return chunk.root == p.root && chunk.contains(p.index);
    }
    Insertion insert(CellCode cell) {
        assert(cell < end_);
        const Place p = place(cell);
        Chunk& chunk = chunk_of(p.root);
        std::uint64_t& word = chunk.split[p.index >> 6];
        const std::uint64_t bit = std::uint64_t{1} << (p.index & 63), before = word;
        word |= bit;
        return {(before & bit) == 0, p.index > 1 ? chunk.contains(p.index >> 1) : contains(cell >> 1)};
    }
    /// As above; whole chunks below the cell's own.
    unsigned drop(CellCode cell) {
        assert(cell < end_);
        const Place p = place(cell);
        Chunk& chunk = chunks_[slot(p.root)];
        if (chunk.root != p.root) return 0;
        if (p.root < first_bottom_) return drop_with_chunks_below(chunk, p.index);
        chunk.split[p.index >> 6] &= ~(std::uint64_t{1} << (p.index & 63));
        if (2 * p.index >= Chunk::cells) return 0;
        std::uint64_t& word = chunk.split[p.index >> 5];
        const auto children = static_cast<unsigned>(word >> (2 * p.index & 63) & 3);
        word &= ~(std::uint64_t{3} << (2 * p.index & 63));
        if (children != 0) drop_grandchildren(chunk, p.index);
        return children;
    }
    void fill(CellCode cell);

    int levels() const { return levels_; }
    std::size_t count() const;
    std::size_t bytes() const { return chunks_.size() * sizeof chunks_[0]; }

  private:
    // Eight levels to a chunk measured best of six to nine. Chunks end at the last level, so that a deep tree's many
    // finest cells fill theirs; the topmost chunks, those of the roots, have what levels remain.
    static constexpr int chunk_levels = 8;
    struct Chunk {
        static constexpr unsigned cells = 1u << chunk_levels;
        CellCode root = 0;                              ///< 0: free
        std::array<std::uint64_t, cells / 64> split{};  ///< by local index from 1, a heap: children of i at 2i, 2i + 1

        bool contains(unsigned index) const { return (split[index >> 6] >> (index & 63) & 1) != 0; }
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
    // Where the chunk is, or the free slot where it would be.
    std::size_t slot(CellCode root) const {
        std::size_t i = static_cast<std::size_t>((root * 0x9e3779b97f4a7c15u) >> shift_);
        while (chunks_[i].root != root && chunks_[i].root != 0) i = (i + 1) & (chunks_.size() - 1);
        return i;
    }
    Chunk& chunk_of(CellCode root) {  // added if need be
        if (chunks_[recent_].root == root) return chunks_[recent_];
        recent_ = slot(root);
        return chunks_[recent_].root == root ? chunks_[recent_] : add_chunk(root);
    }
    Chunk& add_chunk(CellCode root);  // at recent_
    void rehash();
    static void drop_grandchildren(Chunk& chunk, unsigned index);
    unsigned drop_with_chunks_below(Chunk& chunk, unsigned index);  // @return as drop()
    unsigned drop_chunk(CellCode root);                             // @return 1 if its root was split

    int levels_;
    int top_levels_;            ///< of the chunks of the roots, 1..chunk_levels
    CellCode first_below_top_;  ///< least code below them
    CellCode first_bottom_;     ///< least root of the chunks at the last level
    CellCode end_;              ///< one past the last code that could be split
    int shift_ = 0;
    std::size_t used_ = 0;
    std::size_t recent_ = 0;  ///< slot of the chunk of the last insertion: the next one mostly goes there too
    std::array<std::uint8_t, 65> depth_of_width_{};  ///< levels below the chunk's root, by the width of the code
    std::vector<Chunk> chunks_;                      ///< open addressing; a power of two
};

}  // namespace planet
