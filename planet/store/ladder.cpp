#include "planet/store/ladder.h"

#include <algorithm>
#include <cmath>

namespace planet {

const std::array<float, deviation_codes>& deviation_steps() {
    static const auto table = [] {
        // 2^(k/12)
        constexpr double step[12] = {1.0,
                                     1.0594630943592953,
                                     1.122462048309373,
                                     1.189207115002721,
                                     1.2599210498948732,
                                     1.3348398541700344,
                                     1.4142135623730951,
                                     1.4983070768766815,
                                     1.5874010519681994,
                                     1.681792830507429,
                                     1.7817974362806785,
                                     1.8877486253633868};
        std::array<float, deviation_codes> t{};
        for (int c = 1; c < deviation_codes; ++c)
            t[static_cast<std::size_t>(c)] = static_cast<float>(std::ldexp(0.01 * step[(c - 1) % 12], (c - 1) / 12));
        return t;
    }();
    return table;
}

unsigned deviation_code(float deviation) {
    const auto& steps = deviation_steps();
    const auto found = std::lower_bound(steps.begin(), steps.end() - 1, deviation);
    return static_cast<unsigned>(found - steps.begin());
}

}  // namespace planet
