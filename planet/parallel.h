#pragma once
// Work in pieces on all processors.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace planet {

/// Calls work(i) once for every i below `count`, in any order, on up to `threads` threads (0: one for each processor).
/// An exception ends the loop early; of several, that of the lowest i met is thrown on.
template <class Work>
void parallel_for(std::size_t count, unsigned threads, Work&& work) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    std::size_t failed = count;
    const auto run = [&] {
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) try {
                work(i);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (i < failed) {
                    failed = i;
                    failure = std::current_exception();
                }
                next.store(count, std::memory_order_relaxed);
            }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t t = 1; t < std::min<std::size_t>(threads, count); ++t) others.emplace_back(run);
        run();
    }
    if (failure) std::rethrow_exception(failure);
}

/// The same. @param progress told from any thread which part of them is done, if there is one
template <class Work>
void parallel_for(std::size_t count, unsigned threads, const std::function<void(double)>& progress, Work&& work) {
    std::atomic<std::size_t> done = 0;
    parallel_for(count, threads, [&](std::size_t i) {
        work(i);
        if (progress) progress(static_cast<double>(++done) / static_cast<double>(count));
    });
}

}  // namespace planet
