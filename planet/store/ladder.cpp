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

namespace {

// By the sign, exponent and four bits of mantissa of a float, the code of the least float that has these.
constexpr int kept_bits = 13, dropped_bits = 32 - kept_bits;

std::array<std::uint16_t, 1 << (kept_bits - 1)> make_first_codes() {
    std::array<std::uint16_t, 1 << (kept_bits - 1)> first{};
    const auto& steps = deviation_steps();
    for (std::uint32_t k = 0; k < first.size(); ++k) {
        const float least = std::bit_cast<float>(k << dropped_bits);
        first[k] = static_cast<std::uint16_t>(std::lower_bound(steps.begin(), steps.end() - 1, least) - steps.begin());
    }
    return first;
}

}  // namespace

unsigned deviation_code(float deviation) {
    static const auto first = make_first_codes();
    const auto& steps = deviation_steps();
    unsigned code = first[std::bit_cast<std::uint32_t>(deviation) >> dropped_bits];
    while (code < deviation_codes - 1 && steps[code] < deviation) ++code;  // at most twice
    return code;
}

}  // namespace planet
