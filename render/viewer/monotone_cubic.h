#pragma once
// A smooth curve through points that never leaves the values between two neighbours: piecewise cubic, continuous in its
// slope, after Fritsch and Carlson, "Monotone piecewise cubic interpolation" (1980), with the slopes of Fritsch and Butland.

#include <vector>

namespace render {

class MonotoneCubic {
  public:
    MonotoneCubic() = default;
    enum class Ends { free, at_rest };
    /// @param x ascending, each above the one before @param y as many, at least one
    MonotoneCubic(std::vector<double> x, std::vector<double> y, Ends ends);

    /// Before the first and behind the last point: their values.
    double at(double x) const;

  private:
    std::vector<double> x_, y_, slopes_;
};

/// The slope at a point between two pieces: 0 if they turn there, else their weighted harmonic mean.
/// @param before, after slopes @param length_before, length_after of the pieces
double monotone_slope(double before, double after, double length_before, double length_after);

}  // namespace render
