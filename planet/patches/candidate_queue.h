#pragma once
// A priority queue of millions of candidates: a heap that fits the processor's cache, and lists of ever dearer candidates
// in no order, halved when their turn comes. A heap of all of them would miss the cache at every step down.

#include <algorithm>
#include <queue>
#include <vector>

#include "planet/quadtree/topology.h"

namespace planet {

/// Of removal. Ordered by cost, then finest first, then by code.
struct Candidate {
    float cost;
    CellCode cell;  ///< names its diamond
    friend bool operator<(const Candidate& a, const Candidate& b) {
        return a.cost != b.cost ? a.cost < b.cost : a.cell > b.cell;
    }
    friend bool operator>(const Candidate& a, const Candidate& b) { return b < a; }
};

/// Least first. What comes out does not depend on heap_size.
class CandidateQueue {
  public:
    /// @param heap_size at least 1: lists longer than that are halved rather than made a heap
    explicit CandidateQueue(std::vector<Candidate> all = {}, std::size_t heap_size = std::size_t{1} << 16)
        : heap_size_(heap_size) {
        lists_.push_back({{}, std::move(all)});
        refill();
    }

    bool empty() const { return heap_.empty(); }
    const Candidate& top() const { return heap_.top(); }
    void pop() {
        heap_.pop();
        if (heap_.empty()) refill();
    }
    void push(const Candidate& c) {
        auto list = lists_.rbegin();
        if (list == lists_.rend() || c < list->least) {
            heap_.push(c);
            return;
        }
        while (list + 1 != lists_.rend() && !(c < (list + 1)->least)) ++list;
        list->candidates.push_back(c);
    }

  private:
    struct List {
        Candidate least;  ///< none is less, and all before are
        std::vector<Candidate> candidates;
    };

    void refill() {
        while (heap_.empty() && !lists_.empty()) {
            List& last = lists_.back();
            if (last.candidates.size() <= heap_size_) {
                heap_ = Heap(std::greater<>(), std::move(last.candidates));
                lists_.pop_back();
                continue;
            }
            // The dearer half stays, with the least of it at its end.
            const auto end = last.candidates.begin() + static_cast<std::ptrdiff_t>(last.candidates.size() / 2);
            std::nth_element(last.candidates.begin(), end - 1, last.candidates.end(), std::greater<>());
            List cheaper{last.least, {end, last.candidates.end()}};
            last.candidates.erase(end, last.candidates.end());
            last.least = last.candidates.back();
            lists_.push_back(std::move(cheaper));
        }
    }

    using Heap = std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>;

    std::size_t heap_size_;
    Heap heap_;
    std::vector<List> lists_;  ///< dearest first; the heap holds what is less than the last one's least
};

}  // namespace planet
