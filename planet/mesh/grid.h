#pragma once
// The planet-fixed grid: a vertex has the same bits wherever it is drawn, so seams cannot open.
//
// A coordinate is a whole number q of 2^-18 m (3.8 micrometres) in 42 bits: it spans +-8,388 km, Earth and 2,000 km
// above.
//
//     word x, y, z:  q >> 10           32 bits, 1/256 m        low:  00 zzzzzzzzzz yyyyyyyyyy xxxxxxxxxx
//
// The vertex shader splits q into halves of 21 bits, subtracts the eye's halves in integers, converts both exactly and
// adds once: hi * 8 m + lo * 2^-18 m. One rounding, whatever the distance. The 32-bit words are never subtracted:
// across the planet they wrap.

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace planet {

struct GridPosition {
    std::uint32_t x = 0, y = 0, z = 0;  ///< two's complement, 1/256 m
    std::uint32_t low = 0;              ///< ten further bits of each

    friend bool operator==(const GridPosition&, const GridPosition&) = default;
};
static_assert(sizeof(GridPosition) == 16);

inline constexpr double grid_unit_m = 1.0 / 262144.0;         ///< 2^-18 m
inline constexpr double grid_limit_m = 8388607.0;             ///< largest |coordinate|
inline constexpr double grid_rounding_m = grid_unit_m * 0.5;  ///< worst error of one coordinate

/// The nearest grid position of an ecef position in metres; coordinates must lie within +-grid_limit_m.
inline GridPosition grid_from_ecef(const glm::dvec3& p) {
    const auto quantize = [](double v) { return static_cast<std::int64_t>(std::nearbyint(v * 262144.0)); };
    const std::int64_t x = quantize(p.x), y = quantize(p.y), z = quantize(p.z);
    return {static_cast<std::uint32_t>(x >> 10), static_cast<std::uint32_t>(y >> 10),
            static_cast<std::uint32_t>(z >> 10),
            static_cast<std::uint32_t>((x & 1023) | (y & 1023) << 10 | (z & 1023) << 20)};
}

/// One coordinate as a whole number of grid units. @param axis 0..2
inline std::int64_t grid_coordinate(const GridPosition& g, int axis) {
    const std::uint32_t word = axis == 0 ? g.x : axis == 1 ? g.y : g.z;
    return static_cast<std::int64_t>(static_cast<std::int32_t>(word)) * 1024 +
           static_cast<std::int64_t>(g.low >> (10 * axis) & 1023);
}

/// Exact: 42 bits fit a double.
inline glm::dvec3 ecef_from_grid(const GridPosition& g) {
    return {static_cast<double>(grid_coordinate(g, 0)) * grid_unit_m,
            static_cast<double>(grid_coordinate(g, 1)) * grid_unit_m,
            static_cast<double>(grid_coordinate(g, 2)) * grid_unit_m};
}

/// The eye as the shader wants it: hi in units of 8 m, lo in units of 2^-18 m, 0 <= lo < 2^21. Any distance up to
/// 2^27 m keeps every difference exact in a 32-bit float.
struct GridEye {
    glm::ivec3 hi{0};
    glm::ivec3 lo{0};
};

inline GridEye grid_eye(const glm::dvec3& eye) {
    GridEye e;
    for (int i = 0; i < 3; ++i) {
        const auto q = static_cast<std::int64_t>(std::nearbyint(eye[i] * 262144.0));
        e.hi[i] = static_cast<int>(q >> 21);
        e.lo[i] = static_cast<int>(q & 0x1fffff);
    }
    return e;
}

/// Where the shader believes the eye is: what matrices and tests must use too. Exact.
inline glm::dvec3 ecef_from_grid_eye(const GridEye& e) {
    return glm::dvec3(e.hi) * 8.0 + glm::dvec3(e.lo) * grid_unit_m;
}

/// The vertex shader's arithmetic, for tests and for picking: position relative to the eye, one rounding a coordinate.
inline glm::vec3 relative_from_grid(const GridPosition& g, const GridEye& e) {
    glm::vec3 r;
    for (int i = 0; i < 3; ++i) {
        const auto q = grid_coordinate(g, i);
        const int hi = static_cast<int>(q >> 21) - e.hi[i], lo = static_cast<int>(q & 0x1fffff) - e.lo[i];
        r[i] = static_cast<float>(hi) * 8.0f + static_cast<float>(lo) * 0x1p-18f;
    }
    return r;
}

}  // namespace planet
