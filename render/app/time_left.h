#pragma once
// How long a task will go on, from how far it has come.

#include <optional>
#include <string>

namespace render {

/// The recent pace decides, older ones are forgotten over a tenth of the time passed; what is told runs down with the
/// clock and is led to a new estimate over some seconds, so that it does not jump. One task each; a fraction below the
/// last one begins another.
class TimeLeft {
  public:
    /// @param seconds  on any clock, not falling
    /// @param fraction of the task that is done, 0..1. A resumed task may begin at any.
    /// @return seconds left; nothing in the first two seconds, and while nothing has been done since the first call
    std::optional<double> update(double seconds, double fraction);

  private:
    bool begun_ = false;
    double start_ = 0, start_fraction_ = 0;
    double last_ = 0, last_fraction_ = 0;
    double pace_ = 0;  ///< of the fraction, a second
    double told_ = -1, told_at_ = 0;
};

/// "45 s", "12 min", "3 h 20 min": as coarse as an estimate is.
std::string duration_text(double seconds);

}  // namespace render
