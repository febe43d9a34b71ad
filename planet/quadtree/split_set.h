#pragma once
// Pointerless quadtrees of split cells. A conforming triangulation is the set of its split cells, and nothing else: no
// pointer, no index of a child or a parent, for a code is its own address.
//
//     DenseSplitSet    one bit for every cell that could be split, at its code: 1 bit a cell
//     SparseSplitSet   a hash of chunks: six levels below a cell, 63 cells in one word: 16 bytes a chunk
//
// Both keep the cells of a diamond apart, so that asking is one look-up and never needs the neighbour.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planet/quadtree/topology.h"

namespace planet {

/// One bit a cell. Fastest where most of the tree is used, or is small.
class DenseSplitSet {
  public:
    /// Nothing split. @param levels cells of bisection levels 0 .. levels - 1 can be split; root_bits + levels <= 40
    DenseSplitSet(int root_bits, int levels);

    bool contains(CellCode cell) const { return words_[cell >> 6] >> (cell & 63) & 1; }
    /// @param cell of a level below `levels`
    void insert(CellCode cell) { words_[cell >> 6] |= std::uint64_t{1} << (cell & 63); }
    /// Takes out a split cell and everything below it: a range of codes a level, wiped level by level while there is
    /// anything. @return how many cells were split there
    std::size_t drop(CellCode cell);
    /// Splits everything below a cell, itself included, to the last level.
    void fill(CellCode cell);

    int levels() const { return levels_; }
    std::size_t bytes() const { return words_.size() * sizeof words_[0]; }

  private:
    int root_bits_, levels_;
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
    void insert(CellCode cell) {
        const Place p = place(cell);
        std::size_t i = slot(p.root);
        if (chunks_[i].root != p.root) i = add_chunk(p.root, i);
        chunks_[i].split |= std::uint64_t{1} << p.index;
    }
    std::size_t drop(CellCode cell);

    int levels() const { return levels_; }
    std::size_t bytes() const { return chunks_.size() * sizeof chunks_[0]; }

  private:
    static constexpr int chunk_levels = 6;
    struct Chunk {
        CellCode root = 0;        ///< its level is a multiple of six; 0: free
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
    // Where the chunk is, or the free slot where it would be.
    std::size_t slot(CellCode root) const {
        std::size_t i = static_cast<std::size_t>((root * 0x9e3779b97f4a7c15u) >> shift_);
        while (chunks_[i].root != root && chunks_[i].root != 0) i = (i + 1) & (chunks_.size() - 1);
        return i;
    }
    std::size_t add_chunk(CellCode root, std::size_t slot);
    void grow();

    int levels_;
    int shift_;
    std::size_t used_ = 0;
    std::array<std::uint8_t, 65> depth_of_width_{};  ///< bisection level modulo 6, by the width of the code
    std::vector<Chunk> chunks_;                      ///< open addressing; a power of two
};

}  // namespace planet
