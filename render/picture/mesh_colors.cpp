// Colours of bisection levels and of merging steps. Both ramps darken or lighten all the way, so their order shows to
// every eye and in grey; all of them are light enough for dark lines.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "render/picture/mesh_figure.h"

namespace render {
namespace {

using Ramp = std::array<Color, 8>;
constexpr Ramp level_ramp = {{{253, 246, 221},
                              {226, 238, 188},
                              {180, 222, 180},
                              {125, 200, 184},
                              {86, 171, 192},
                              {88, 139, 194},
                              {120, 112, 188},
                              {142, 88, 166}}};
constexpr Ramp step_ramp = {{{203, 72, 62},
                             {219, 98, 66},
                             {233, 124, 72},
                             {243, 151, 83},
                             {249, 177, 100},
                             {252, 201, 122},
                             {253, 222, 148},
                             {254, 239, 178}}};
constexpr Color stays{240, 241, 242, 110};
constexpr double most_apart = 1.0 / 6;  ///< of two neighbouring values, parts of the ramp

Color at(const Ramp& ramp, double t) {
    const double x = std::clamp(t, 0.0, 1.0) * static_cast<double>(ramp.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(x), ramp.size() - 2);
    const double f = x - static_cast<double>(i);
    const auto mix = [&](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + f * (b - a) + 0.5); };
    const Color &a = ramp[i], &b = ramp[i + 1];
    return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue), 255};
}

}  // namespace

MeshColors::MeshColors(const MeshPicture& picture) : steps_(!picture.step.empty()) {
    const auto [low, high] = std::ranges::minmax(steps_ ? picture.step : picture.level);
    first_ = steps_ ? 1 : low;
    last_ = high;
}

Color MeshColors::of(int value) const {
    if (steps_ && value == 0) return stays;
    const double steps = last_ - first_, apart = steps > 0 ? std::min(1 / steps, most_apart) : 0;
    // A few levels leave out the palest; the first step is the strongest colour in any case.
    const double start = steps_ ? 0 : std::min(most_apart, 1 - steps * apart);
    return at(steps_ ? step_ramp : level_ramp, start + (value - first_) * apart);
}

}  // namespace render
