#include "render/app/time_left.h"

#include <algorithm>
#include <cmath>

namespace render {
namespace {

constexpr double silent_s = 2;          // before the first estimate
constexpr double least_sample_s = 0.2;  // between two paces
constexpr double lead_s = 5;            // in which what is told follows the estimate

}  // namespace

std::optional<double> TimeLeft::update(double seconds, double fraction) {
    if (!begun_ || fraction < last_fraction_) {
        *this = {};
        begun_ = true;
        start_ = last_ = seconds;
        start_fraction_ = last_fraction_ = fraction;
        return {};
    }
    const double passed = seconds - last_, elapsed = seconds - start_;
    if (passed >= least_sample_s) {
        const double now = (fraction - last_fraction_) / passed, average = (fraction - start_fraction_) / elapsed;
        const double memory = std::max(2.0, elapsed / 10);
        pace_ = pace_ > 0 ? pace_ + (1 - std::exp(-passed / memory)) * (now - pace_) : average;
        last_ = seconds;
        last_fraction_ = fraction;
    }
    if (elapsed < silent_s || !(pace_ > 0)) return {};
    const double left = (1 - fraction) / pace_;
    if (told_ < 0) {
        told_ = left;
    } else {
        const double since = seconds - told_at_;
        told_ = std::max(0.0, told_ - since);
        told_ += (1 - std::exp(-since / lead_s)) * (left - told_);
    }
    told_at_ = seconds;
    return told_;
}

std::string duration_text(double seconds) {
    const auto whole = [](double value) { return std::to_string(std::llround(value)); };
    if (seconds < 10) return whole(std::max(1.0, std::ceil(seconds))) + " s";
    if (seconds < 57.5) return whole(std::round(seconds / 5) * 5) + " s";
    const auto minutes = static_cast<long long>(std::round(seconds / 60));
    if (minutes < 60) return std::to_string(minutes) + " min";
    if (minutes >= 48 * 60) return std::to_string(minutes / (24 * 60)) + " days";
    const auto tens = minutes % 60 / 10 * 10;
    return std::to_string(minutes / 60) + " h" + (tens > 0 ? " " + std::to_string(tens) + " min" : "");
}

}  // namespace render
