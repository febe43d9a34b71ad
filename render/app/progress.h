#pragma once
// Progress on a terminal; nothing in a pipe.

#include <chrono>
#include <mutex>
#include <string_view>

namespace render {

/// One line on standard error that is rewritten at most 20 times a second and gone in the end. Does nothing where
/// standard error is not a terminal. Thread-safe.
class Progress {
  public:
    Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress();

    /// @param step     what is being done, e.g. "bake"
    /// @param fraction 0..1; NaN where it is not known
    void update(std::string_view step, double fraction);

  private:
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_{};
    std::mutex mutex_;
};

}  // namespace render
