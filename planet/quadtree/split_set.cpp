#include "planet/quadtree/split_set.h"

#include <algorithm>

namespace planet {

namespace {

constexpr std::size_t least_chunks = 16;

// Of `count` bits from `first`, those in word w. Fewer than 64 never straddle words, and more are whole words.
std::uint64_t bits_in_word(unsigned w, unsigned first, unsigned count) {
    if (count >= 64) return w >= first / 64 && w < (first + count) / 64 ? ~std::uint64_t{0} : 0;
    return w == first / 64 ? ((std::uint64_t{1} << count) - 1) << (first % 64) : 0;
}

}  // namespace

DenseSplitSet::DenseSplitSet(int root_bits, int levels)
    : levels_(levels), end_(CellCode{1} << (root_bits + levels)), words_((std::size_t{end_} + 63) / 64) {
    assert(levels >= 0 && root_bits + levels <= 40);
}

void DenseSplitSet::wipe_grandchildren(CellCode cell) {
    int k = 2;
    for (; k < 6 && cell << k < end_; ++k) {
        const std::uint64_t range = ((std::uint64_t{1} << (1u << k)) - 1) << (cell << k & 63);
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
    for (; k < 6 && cell << k < end_; ++k)
        words_[cell << k >> 6] |= ((std::uint64_t{1} << (1u << k)) - 1) << (cell << k & 63);
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
      first_bottom_(CellCode{1} << (root_bits + std::max(levels - chunk_levels, 0))),
      end_(CellCode{1} << (root_bits + levels)) {
    assert(levels >= 0 && root_bits + levels <= max_code_bits);
    for (int level = 0; root_bits + level <= max_code_bits; ++level)
        depth_of_width_[static_cast<std::size_t>(root_bits + level + 1)] =
            static_cast<std::uint8_t>(level < top_levels_ ? level : (level - top_levels_) % chunk_levels);
    rehash();
}

void SparseSplitSet::drop_grandchildren(Chunk& chunk, unsigned index) {
    for (unsigned first = 4 * index, count = 4; first < Chunk::cells; first *= 2, count *= 2) {
        std::uint64_t gone = 0;
        for (unsigned w = first / 64; w <= (first + count - 1) / 64; ++w) {
            const std::uint64_t range = bits_in_word(w, first, count);
            gone |= chunk.split[w] & range;
            chunk.split[w] &= ~range;
        }
        if (gone == 0) return;
    }
}

// Only below a split cell of the last local level are there chunks.
unsigned SparseSplitSet::drop_with_chunks_below(Chunk& chunk, unsigned index) {
    const int levels = levels_of_chunk(chunk.root);
    const unsigned end = 1u << levels;
    unsigned children = 0;
    for (unsigned first = index, count = 1; first < end; first *= 2, count *= 2)
        for (unsigned w = first / 64; w <= (first + count - 1) / 64; ++w) {
            std::uint64_t gone = chunk.split[w] & bits_in_word(w, first, count);
            chunk.split[w] ^= gone;
            if (count == 2) children = static_cast<unsigned>(gone >> (first & 63)) & 3;
            if (2 * first < end) continue;
            for (; gone != 0; gone &= gone - 1) {
                const unsigned last = 64 * w + static_cast<unsigned>(std::countr_zero(gone));
                const CellCode below = chunk.root << levels | (2 * last - end);
                const unsigned roots = drop_chunk(below) | drop_chunk(below + 1) << 1;
                if (count == 1) children = roots;
            }
        }
    return children;
}

unsigned SparseSplitSet::drop_chunk(CellCode root) {
    Chunk& chunk = chunks_[slot(root)];
    if (chunk.root != root || !chunk.contains(1)) return 0;
    if (root < first_bottom_) drop_with_chunks_below(chunk, 1);
    chunk.split = {};
    return 1;
}

void SparseSplitSet::fill(CellCode cell) {
    assert(cell < end_);
    const Place p = place(cell);
    Chunk& chunk = chunk_of(p.root);
    const unsigned end = 1u << levels_of_chunk(p.root);
    for (unsigned first = p.index, count = 1; first < end; first *= 2, count *= 2)
        for (unsigned w = first / 64; w <= (first + count - 1) / 64; ++w)
            chunk.split[w] |= bits_in_word(w, first, count);
    int below = levels_of_chunk(p.root) + 1 - static_cast<int>(std::bit_width(p.index));
    for (; cell << below < end_; below += chunk_levels)
        for (CellCode root = cell << below; root < (cell + 1) << below; ++root) {
            Chunk& whole = chunk_of(root);
            whole.split.fill(~std::uint64_t{0});
            whole.split[0] = ~std::uint64_t{1};
        }
}

std::size_t SparseSplitSet::count() const {
    std::size_t n = 0;
    for (const Chunk& chunk : chunks_)
        for (const std::uint64_t word : chunk.split) n += static_cast<std::size_t>(std::popcount(word));
    return n;
}

SparseSplitSet::Chunk& SparseSplitSet::add_chunk(CellCode root) {
    if (2 * ++used_ > chunks_.size()) {
        rehash();
        recent_ = slot(root);
    }
    chunks_[recent_].root = root;
    return chunks_[recent_];
}

// Chunks in which nothing is split any more are left behind. At most half of the slots are ever used.
void SparseSplitSet::rehash() {
    const auto is_alive = [](const Chunk& chunk) {
        return std::any_of(chunk.split.begin(), chunk.split.end(), [](std::uint64_t word) { return word != 0; });
    };
    const auto alive = static_cast<std::size_t>(std::count_if(chunks_.begin(), chunks_.end(), is_alive));
    std::vector<Chunk> old(std::max(std::bit_ceil(3 * alive), least_chunks));
    old.swap(chunks_);
    shift_ = 65 - static_cast<int>(std::bit_width(chunks_.size()));
    used_ = 1;  // the chunk to come
    for (const Chunk& chunk : old) {
        if (!is_alive(chunk)) continue;
        chunks_[slot(chunk.root)] = chunk;
        ++used_;
    }
}

}  // namespace planet
