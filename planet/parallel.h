#pragma once
// Work in pieces on all processors.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace planet {

/// Calls work(i) once for every i in [0, pieces), in any order, on `threads` threads (0: one a processor), and waits.
/// `work` must not throw.
template <class Work>
void parallel_for(std::size_t pieces, unsigned threads, Work&& work) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < pieces;) work(i);
    };
    std::vector<std::jthread> others;
    for (unsigned t = 1; t < threads && t < pieces; ++t) others.emplace_back(run);
    run();
}

}  // namespace planet
