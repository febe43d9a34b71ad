#pragma once
// How good a picture may be while it moves: what a frame is measured to take decides its resolution and its triangles.

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace render {

class FramePace {
  public:
    /// @param software whether a processor draws @param most_triangles that the user allows
    FramePace(bool software, std::size_t most_triangles)
        : target_s_(software ? 1.0 / 24 : 1.0 / 75),
          most_triangles_(std::min<std::size_t>(software ? 200'000 : 2'000'000, most_triangles)),
          triangles_(most_triangles_),
          step_(software ? 2 : 0) {}

    /// Of the full width and height: 2^(-step/2), 1 to 1/4.
    double scale() const { return std::exp2(-0.5 * step_); }
    std::size_t max_triangles() const { return triangles_; }

    /// @param seconds that drawing the last frame took. Coarser after two slow frames, finer after eight quick ones: no
    /// going back and forth, for what is finer takes at most twice as long
    void after_frame(double seconds) {
        slow_ = seconds > 1.25 * target_s_ ? slow_ + 1 : 0;
        quick_ = seconds < 0.45 * target_s_ ? quick_ + 1 : 0;
        if (slow_ >= 2) coarser();
        if (quick_ >= 8) finer();
    }

  private:
    static constexpr int most_steps = 4;
    static constexpr std::size_t fewest_triangles = 25'000;

    void coarser() {
        slow_ = 0;
        if (step_ < most_steps)
            ++step_;
        else
            triangles_ = std::max(triangles_ / 2, std::min(fewest_triangles, most_triangles_));
    }
    void finer() {
        quick_ = 0;
        if (triangles_ < most_triangles_)
            triangles_ = std::min(2 * triangles_, most_triangles_);
        else if (step_ > 0)
            --step_;
    }

    double target_s_;
    std::size_t most_triangles_, triangles_;
    int step_, slow_ = 0, quick_ = 0;
};

}  // namespace render
