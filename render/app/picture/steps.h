#pragma once
// Steps of a picture: their times, and work beside the calling thread.

#include <algorithm>
#include <chrono>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace render {

/// Adds up the time of steps, also of those that run side by side: their sum can exceed the time of the whole.
class Steps {
  public:
    template <class Work>
    auto time(std::string_view name, Work&& work) {
        struct Stop {
            Steps& steps;
            std::string_view name;
            std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
            ~Stop() {
                steps.add(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
            }
        } const stop{*this, name};
        return work();
    }
    /// Sorted by name: which of two came first is chance.
    std::vector<std::pair<std::string, double>> list() const {
        const std::lock_guard lock(mutex_);
        auto sorted = list_;
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }

  private:
    void add(std::string_view name, double seconds) {
        const std::lock_guard lock(mutex_);
        const auto found =
            std::find_if(list_.begin(), list_.end(), [&](const auto& step) { return step.first == name; });
        if (found == list_.end())
            list_.emplace_back(name, seconds);
        else
            found->second += seconds;
    }

    mutable std::mutex mutex_;
    std::vector<std::pair<std::string, double>> list_;
};

/// Starts work beside the calling thread, or with one thread only leaves it until it is asked for. What it throws comes
/// out of get(); the future's end waits for it, so what it refers to must be declared before the future.
template <class Work>
auto beside(unsigned threads, Work work) {
    return std::async(threads > 1 ? std::launch::async : std::launch::deferred, std::move(work));
}

}  // namespace render
