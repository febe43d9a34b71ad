#include "planet/quadtree/split_set.h"

#include <algorithm>
#include <cassert>

namespace planet {

namespace {

// By local index in a chunk: the cells of its subtree.
constexpr std::array<std::uint64_t, 64> make_subtrees() {
    std::array<std::uint64_t, 64> mask{};
    for (unsigned i = 63; i >= 1; --i) mask[i] = std::uint64_t{1} << i | (i < 32 ? mask[2 * i] | mask[2 * i + 1] : 0);
    return mask;
}
constexpr auto subtree = make_subtrees();

}  // namespace

DenseSplitSet::DenseSplitSet(int root_bits, int levels)
    : root_bits_(root_bits), levels_(levels), words_((std::size_t{1} << (root_bits + levels)) / 64 + 1) {
    assert(levels >= 0 && root_bits + levels <= 40);
}

std::size_t DenseSplitSet::drop(CellCode cell) {
    const int level = bisection_level_of(cell, root_bits_);
    std::size_t dropped = 0;
    for (int k = 0; k < levels_ - level; ++k) {
        const CellCode first = cell << k;
        std::size_t here = 0;
        if (k < 6) {
            const std::uint64_t range = (k == 0 ? 1 : (std::uint64_t{1} << (1u << k)) - 1) << (first & 63);
            std::uint64_t& word = words_[first >> 6];
            here = static_cast<std::size_t>(std::popcount(word & range));
            word &= ~range;
        } else {
            const auto begin = words_.begin() + static_cast<std::ptrdiff_t>(first >> 6);
            const auto end = begin + (std::ptrdiff_t{1} << (k - 6));
            for (auto w = begin; w != end; ++w) {
                here += static_cast<std::size_t>(std::popcount(*w));
                *w = 0;
            }
        }
        if (here == 0) break;
        dropped += here;
    }
    return dropped;
}

void DenseSplitSet::fill(CellCode cell) {
    const int level = bisection_level_of(cell, root_bits_);
    for (int k = 0; k < levels_ - level; ++k) {
        if (k < 6) {
            for (CellCode c = cell << k; c < (cell + 1) << k; ++c) insert(c);
        } else {
            const auto begin = words_.begin() + static_cast<std::ptrdiff_t>((cell << k) >> 6);
            std::fill(begin, begin + (std::ptrdiff_t{1} << (k - 6)), ~std::uint64_t{0});
        }
    }
}

SparseSplitSet::SparseSplitSet(int root_bits, int levels) : levels_(levels), shift_(64 - 6), chunks_(64) {
    assert(levels >= 0 && root_bits + levels <= max_code_bits);
    for (int d = 0; d + root_bits < max_code_bits; ++d)
        depth_of_width_[static_cast<std::size_t>(d + root_bits + 1)] = static_cast<std::uint8_t>(d % chunk_levels);
}

std::size_t SparseSplitSet::drop(CellCode cell) {
    const Place p = place(cell);
    std::size_t dropped = 0;
    std::vector<std::pair<CellCode, std::uint64_t>> pending;
    for (std::pair<CellCode, std::uint64_t> next{p.root, subtree[p.index]};;) {
        const auto [root, range] = next;
        Chunk& chunk = chunks_[slot(root)];
        if (chunk.root == root) {
            const std::uint64_t gone = chunk.split & range;
            dropped += static_cast<std::size_t>(std::popcount(gone));
            chunk.split &= ~range;
            // Below a split cell of the last local level there may be chunks.
            for (std::uint64_t last = gone >> 32; last != 0; last &= last - 1) {
                const CellCode below = root << chunk_levels | static_cast<unsigned>(2 * std::countr_zero(last));
                pending.emplace_back(below, ~std::uint64_t{0});
                pending.emplace_back(below + 1, ~std::uint64_t{0});
            }
        }
        if (pending.empty()) return dropped;
        next = pending.back();
        pending.pop_back();
    }
}

std::size_t SparseSplitSet::add_chunk(CellCode root, std::size_t at) {
    if (4 * (used_ + 1) > 3 * chunks_.size()) {
        grow();
        at = slot(root);
    }
    ++used_;
    chunks_[at].root = root;
    return at;
}

// Chunks in which nothing is split any more are left behind.
void SparseSplitSet::grow() {
    const auto alive = static_cast<std::size_t>(
        std::count_if(chunks_.begin(), chunks_.end(), [](const Chunk& c) { return c.split != 0; }));
    std::vector<Chunk> old(std::max(std::bit_ceil(2 * alive + 2), std::size_t{64}));
    old.swap(chunks_);
    shift_ = 65 - static_cast<int>(std::bit_width(chunks_.size()));
    used_ = 0;
    for (const Chunk& c : old) {
        if (c.split == 0) continue;
        chunks_[slot(c.root)] = c;
        ++used_;
    }
}

}  // namespace planet
