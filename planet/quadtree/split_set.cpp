#include "planet/quadtree/split_set.h"

#include <algorithm>

namespace planet {

namespace {

constexpr std::size_t least_chunks = 64;

std::uint64_t low_bits(unsigned n) {
    return n < 64 ? (std::uint64_t{1} << n) - 1 : ~std::uint64_t{0};
}

}  // namespace

DenseSplitSet::DenseSplitSet(int root_bits, int levels)
    : levels_(levels), end_(CellCode{1} << (root_bits + levels)), words_((std::size_t{end_} + 63) / 64) {
    assert(levels >= 0 && root_bits + levels <= 40);
}

void DenseSplitSet::wipe_grandchildren(CellCode cell) {
    int k = 2;
    for (; k < 6 && cell << k < end_; ++k) {
        const std::uint64_t range = low_bits(1u << k) << (cell << k & 63);
        std::uint64_t& word = words_[cell << k >> 6];
        if ((word & range) == 0) return;
        word &= ~range;
    }
    for (; cell << k < end_; ++k) {
        const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(cell << (k - 6));
        const auto end = begin + (std::ptrdiff_t{1} << (k - 6));
        std::uint64_t any = 0;
        for (auto w = begin; w != end; ++w) any |= *w;
        if (any == 0) return;
        std::fill(begin, end, 0);
    }
}

void DenseSplitSet::fill(CellCode cell) {
    assert(cell < end_);
    int k = 0;
    for (; k < 6 && cell << k < end_; ++k) words_[cell << k >> 6] |= low_bits(1u << k) << (cell << k & 63);
    for (; cell << k < end_; ++k) {
        const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(cell << (k - 6));
        std::fill(begin, begin + (std::ptrdiff_t{1} << (k - 6)), ~std::uint64_t{0});
    }
}

std::size_t DenseSplitSet::count() const {
    std::size_t n = 0;
    for (const std::uint64_t word : words_) n += static_cast<std::size_t>(std::popcount(word));
    return n;
}

SparseSplitSet::SparseSplitSet(int root_bits, int levels)
    : levels_(levels),
      top_levels_(levels % chunk_levels == 0 ? chunk_levels : levels % chunk_levels),
      first_below_top_(CellCode{1} << (root_bits + top_levels_)),
      first_bottom_(CellCode{1} << (root_bits + levels) >> (levels < chunk_levels ? top_levels_ : chunk_levels)),
      end_(CellCode{1} << (root_bits + levels)) {
    assert(levels >= 0 && root_bits + levels <= max_code_bits);
    for (int level = 0; root_bits + level <= max_code_bits; ++level)
        depth_of_width_[static_cast<std::size_t>(root_bits + level + 1)] =
            static_cast<std::uint8_t>(level < top_levels_ ? level : (level - top_levels_) % chunk_levels);
    rehash();
}

unsigned SparseSplitSet::drop_chunk(CellCode root) {
    Chunk& chunk = chunks_[slot(root)];
    if (chunk.root != root || chunk.split == 0) return 0;
    const std::uint64_t gone = chunk.split;
    chunk.split = 0;
    if (root < first_bottom_) drop_chunks_below({root, 1}, gone);
    return gone >> 1 & 1;
}

// Only below a split cell of the last local level are there chunks.
unsigned SparseSplitSet::drop_chunks_below(Place p, std::uint64_t gone) {
    const int levels = levels_of_chunk(p.root);
    const unsigned first = 1u << (levels - 1);
    unsigned children = 0;
    for (std::uint64_t last = gone >> first; last != 0; last &= last - 1) {
        const CellCode below = p.root << levels | static_cast<unsigned>(2 * std::countr_zero(last));
        children = drop_chunk(below) | drop_chunk(below + 1) << 1;
    }
    return p.index >= first ? children : 0;
}

void SparseSplitSet::fill(CellCode cell) {
    assert(cell < end_);
    const Place p = place(cell);
    const int levels = levels_of_chunk(p.root);
    chunk_of(p.root).split |= detail::subtree_in_chunk[p.index] & low_bits(1u << levels);
    int below = levels + 1 - static_cast<int>(std::bit_width(p.index));
    for (; cell << below < end_; below += chunk_levels)
        for (CellCode root = cell << below; root < (cell + 1) << below; ++root)
            chunk_of(root).split = low_bits(1u << chunk_levels) & ~std::uint64_t{1};
}

std::size_t SparseSplitSet::count() const {
    std::size_t n = 0;
    for (const Chunk& c : chunks_) n += static_cast<std::size_t>(std::popcount(c.split));
    return n;
}

SparseSplitSet::Chunk& SparseSplitSet::add_chunk(CellCode root, std::size_t at) {
    if (2 * ++used_ > chunks_.size()) {
        rehash();
        at = slot(root);
    }
    chunks_[at].root = root;
    return chunks_[at];
}

// Chunks in which nothing is split any more are left behind. At most half of the slots are ever used.
void SparseSplitSet::rehash() {
    const auto alive = static_cast<std::size_t>(
        std::count_if(chunks_.begin(), chunks_.end(), [](const Chunk& c) { return c.split != 0; }));
    std::vector<Chunk> old(std::max(std::bit_ceil(3 * alive), least_chunks));
    old.swap(chunks_);
    shift_ = 67 - static_cast<int>(std::bit_width(chunks_.size()));
    used_ = 1;  // the chunk to come
    for (const Chunk& c : old) {
        if (c.split == 0) continue;
        chunks_[slot(c.root)] = c;
        ++used_;
    }
}

}  // namespace planet
