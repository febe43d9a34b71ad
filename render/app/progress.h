#pragma once
// Progress on a terminal; nothing in a pipe.

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "render/app/time_left.h"

namespace render {

/// One line on standard error that is rewritten at most 20 times a second and gone in the end: what is being done, how
/// much of it, and how long it will go on. Does nothing where standard error is not a terminal. Thread-safe.
class Progress {
  public:
    Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress();

    /// @param step     what is being done, e.g. "bake"
    /// @param fraction 0..1, even in time where the estimate is to be good; NaN where it is not known
    void update(std::string_view step, double fraction);
    /// Takes the line away, for what is printed next.
    void clear();

  private:
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_{};
    std::string step_;
    TimeLeft left_;
    std::mutex mutex_;
};

}  // namespace render
