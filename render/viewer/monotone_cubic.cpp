#include "render/viewer/monotone_cubic.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace render {

double monotone_slope(double before, double after, double length_before, double length_after) {
    if (!(before * after > 0)) return 0;
    const double w1 = 2 * length_after + length_before, w2 = length_after + 2 * length_before;
    return (w1 + w2) / (w1 / before + w2 / after);
}

MonotoneCubic::MonotoneCubic(std::vector<double> x, std::vector<double> y, Ends ends)
    : x_(std::move(x)), y_(std::move(y)), slopes_(x_.size(), 0) {
    assert(!x_.empty() && x_.size() == y_.size());
    const std::size_t n = x_.size();
    const auto length = [&](std::size_t i) { return x_[i + 1] - x_[i]; };
    const auto slope = [&](std::size_t i) { return (y_[i + 1] - y_[i]) / length(i); };
    for (std::size_t i = 1; i + 1 < n; ++i)
        slopes_[i] = monotone_slope(slope(i - 1), slope(i), length(i - 1), length(i));
    if (ends == Ends::at_rest || n < 2) return;
    // What makes the end's piece a parabola, as far as it stays monotone.
    const auto end = [](double chord, double inner) {
        const double free = 1.5 * chord - 0.5 * inner;
        return free * chord > 0 ? std::copysign(std::min(std::abs(free), 3 * std::abs(chord)), chord) : 0;
    };
    slopes_[0] = end(slope(0), n > 2 ? slopes_[1] : slope(0));
    slopes_[n - 1] = end(slope(n - 2), n > 2 ? slopes_[n - 2] : slope(n - 2));
}

double MonotoneCubic::at(double x) const {
    if (!(x > x_.front())) return y_.front();
    if (!(x < x_.back())) return y_.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
    const double length = x_[i + 1] - x_[i], t = (x - x_[i]) / length, u = 1 - t;
    const double value = u * u * (1 + 2 * t) * y_[i] + t * t * (3 - 2 * t) * y_[i + 1] +
                         length * t * u * (u * slopes_[i] - t * slopes_[i + 1]);
    // Rounding must not lead beyond, either.
    return std::clamp(value, std::min(y_[i], y_[i + 1]), std::max(y_[i], y_[i + 1]));
}

}  // namespace render
