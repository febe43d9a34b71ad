#pragma once
// Leaves, longest longest side first: exactly, though leaves wait in buckets of 1/128 of an octave of the squared length,
// and only the bucket whose turn it is gets sorted. That works because a split makes no side longer than its own. A bucket
// keeps four bytes a leaf; lengths are fetched together when its turn comes, which brings the leaves into the cache for the
// splits that follow.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "planet/bisection/leaf_mesh.h"

namespace planet {

class LengthQueue {
  public:
    using Index = LeafMesh::Index;

    /// Takes leaves whose squared longest side is greater than `shortest`. @param longest of all that will come
    LengthQueue(const LeafMesh& mesh, double longest, double shortest)
        : mesh_(mesh), shortest_(shortest), top_(place_of(longest)) {
        buckets_.resize(static_cast<std::size_t>(top_ - std::min(top_, place_of(shortest))) + 1);
        current_ = buckets_.size();
    }

    void push(Index leaf) {
        const double squared = mesh_[leaf].squared[0];
        if (!(squared > shortest_)) return;
        const auto bucket = static_cast<std::size_t>(top_ - std::min(top_, place_of(squared)));
        if (current_ != buckets_.size() && bucket <= current_) {
            late_.push_back({squared, leaf});
            std::push_heap(late_.begin(), late_.end());
        } else {
            buckets_[bucket].push_back(leaf);
        }
    }

    /// The leaf with the longest longest side, or LeafMesh::none. It stays until that is split.
    Index top() {
        for (;;) {
            while (next_ < sorted_.size() && stale(sorted_[next_])) ++next_;
            while (!late_.empty() && stale(late_.front())) {
                std::pop_heap(late_.begin(), late_.end());
                late_.pop_back();
            }
            if (next_ < sorted_.size()) {
                prefetch();
                return late_.empty() || late_.front() < sorted_[next_] ? sorted_[next_].leaf : late_.front().leaf;
            }
            if (!late_.empty()) return late_.front().leaf;
            if (!advance()) return LeafMesh::none;
        }
    }

    std::size_t bytes() const {
        std::size_t sum = buckets_.capacity() * sizeof buckets_[0] +
                          (unsorted_.capacity() + sorted_.capacity() + late_.capacity()) * sizeof(Entry);
        for (const auto& b : buckets_) sum += b.capacity() * sizeof(Index);
        return sum;
    }

  private:
    struct Entry {
        double squared;
        Index leaf;
        bool operator<(const Entry& o) const { return squared != o.squared ? squared < o.squared : leaf > o.leaf; }
    };

    // Exponent and seven bits of the mantissa.
    static std::uint32_t place_of(double squared) {
        return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(squared) >> 45);
    }
    bool stale(const Entry& e) const { return mesh_[e.leaf].squared[0] != e.squared; }
    // Memory answers after as long as a few splits take.
    void prefetch() {
        const auto ahead = [&](std::size_t& done, std::size_t distance, auto&& fetch) {
            for (const std::size_t end = std::min(next_ + distance, sorted_.size()); done < end; ++done)
                fetch(sorted_[done].leaf);
        };
        ahead(fetched_[0], 32, [&](Index t) { mesh_.prefetch_leaf(t); });
        ahead(fetched_[1], 24, [&](Index t) { mesh_.prefetch_around(t); });
        ahead(fetched_[2], 16, [&](Index t) { mesh_.prefetch_beyond(t); });
        ahead(fetched_[3], 8, [&](Index t) { mesh_.prefetch_flip_beyond(t); });
    }

    // Sorts the next bucket in which anything is left.
    bool advance() {
        sorted_.clear();
        next_ = 0;
        fetched_ = {};
        for (std::size_t b = current_ == buckets_.size() ? 0 : current_ + 1; b < buckets_.size(); ++b) {
            if (buckets_[b].empty()) continue;
            current_ = b;
            collect(buckets_[b]);
            std::vector<Index>().swap(buckets_[b]);
            sort();
            if (!sorted_.empty()) return true;
        }
        current_ = buckets_.size() - 1;
        return false;
    }
    // What is still in the bucket. One of two leaves that share their longest sides is enough.
    void collect(const std::vector<Index>& bucket) {
        unsorted_.clear();
        for (std::size_t i = 0; i < bucket.size(); ++i) {
            if (i + 16 < bucket.size()) mesh_.prefetch_leaf(bucket[i + 16]);
            const Index t = bucket[i];
            const Leaf& leaf = mesh_[t];
            if (top_ - place_of(leaf.squared[0]) != current_) continue;
            const Index n = leaf.beyond[0];
            if (n == LeafMesh::none || n > t || !LeafMesh::mutual(leaf, mesh_[n]))
                unsorted_.push_back({leaf.squared[0], t});
        }
    }
    // By the next bits of the mantissa first, of which each value has few entries.
    void sort() {
        const auto rank = [](const Entry& e) { return ~(std::bit_cast<std::uint64_t>(e.squared) >> 35) & 1023; };
        std::array<std::uint32_t, 1025> end{};
        for (const Entry& e : unsorted_) ++end[rank(e) + 1];
        for (std::size_t i = 1; i < end.size(); ++i) end[i] += end[i - 1];
        sorted_.resize(unsorted_.size());
        for (const Entry& e : unsorted_) sorted_[end[rank(e)]++] = e;
        for (std::size_t i = 0, begin = 0; i + 1 < end.size(); begin = end[i++])
            if (end[i] - begin > 1)
                std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(begin), sorted_.begin() + end[i],
                          [](const Entry& x, const Entry& y) { return y < x; });
    }

    const LeafMesh& mesh_;
    double shortest_;
    std::uint32_t top_;                        ///< place of the longest
    std::vector<std::vector<Index>> buckets_;  ///< longest first
    std::size_t current_;                      ///< bucket that is sorted; their number before the first
    std::vector<Entry> unsorted_, sorted_;     ///< of that bucket, the longest first
    std::size_t next_ = 0;
    std::array<std::size_t, 4> fetched_{};  ///< leaves of the sorted ones for which each prefetch was done
    std::vector<Entry> late_;               ///< a heap: those that came when their bucket was sorted already
};

}  // namespace planet
