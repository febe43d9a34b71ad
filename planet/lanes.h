#pragma once
// As many doubles at a time as a register holds, for loops that take most of the time. Elementwise, so the
// same bits for any width. For .cpp files: these types are no part of an interface.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace planet {

#if defined(__AVX512F__)
inline constexpr std::size_t lane_count = 8;
#elif defined(__AVX__)
inline constexpr std::size_t lane_count = 4;
#else
inline constexpr std::size_t lane_count = 2;
#endif

typedef double Lanes __attribute__((vector_size(lane_count * sizeof(double))));
typedef std::int64_t WholeLanes __attribute__((vector_size(lane_count * sizeof(double))));
typedef float NarrowLanes __attribute__((vector_size(lane_count * sizeof(float))));
typedef std::int32_t WholeNarrowLanes __attribute__((vector_size(lane_count * sizeof(float))));

inline Lanes absolute(Lanes v) {
    return reinterpret_cast<Lanes>(reinterpret_cast<WholeLanes>(v) & INT64_MAX);
}

/// The larger one; the second if either is NaN.
inline Lanes larger(Lanes a, Lanes b) {
    return a > b ? a : b;
}

inline Lanes smaller(Lanes a, Lanes b) {
    return a < b ? a : b;
}

inline Lanes square_root(Lanes v) {
    double each[lane_count];
    std::memcpy(each, &v, sizeof v);
    for (double& x : each) x = std::sqrt(x);
    std::memcpy(&v, each, sizeof v);
    return v;
}

/// Whether a comparison holds in any lane.
inline bool any(WholeLanes mask) {
    typedef std::int64_t Pair __attribute__((vector_size(2 * sizeof(std::int64_t))));
    Pair pairs[lane_count / 2];
    std::memcpy(pairs, &mask, sizeof mask);
    for (std::size_t k = 1; k < lane_count / 2; ++k) pairs[0] |= pairs[k];
    return (pairs[0][0] | pairs[0][1]) != 0;
}

inline Lanes load_lanes(const double* from) {
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

inline void store_lanes(const Lanes& v, double* to) {
    std::memcpy(to, &v, sizeof v);
}

inline Lanes widened_lanes(const float* from) {
    NarrowLanes v;
    std::memcpy(&v, from, sizeof v);
    return __builtin_convertvector(v, Lanes);
}

/// 0, 1, 2, ...
inline WholeLanes lane_numbers() {
    WholeLanes v;
    for (std::size_t w = 0; w < lane_count; ++w) v[w] = static_cast<std::int64_t>(w);
    return v;
}

inline double least_lane(Lanes v) {
    double least = v[0];
    for (std::size_t w = 1; w < lane_count; ++w) least = v[w] < least ? v[w] : least;
    return least;
}

/// Lane w is at(w).
template <class At>
inline Lanes gather_lanes(At at) {
    if constexpr (lane_count == 8)
        return Lanes{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
    else if constexpr (lane_count == 4)
        return Lanes{at(0), at(1), at(2), at(3)};
    else
        return Lanes{at(0), at(1)};
}

/// Of numbers of which none is NaN, at least one.
inline std::pair<float, float> least_and_most(std::span<const float> numbers) {
    constexpr std::size_t width = 2 * lane_count;
    typedef float Wide __attribute__((vector_size(width * sizeof(float))));
    float least = numbers[0], most = numbers[0];
    std::size_t i = 0;
    if (numbers.size() >= width) {
        Wide low, high;
        std::memcpy(&low, numbers.data(), sizeof low);
        high = low;
        for (i = width; i + width <= numbers.size(); i += width) {
            Wide next;
            std::memcpy(&next, numbers.data() + i, sizeof next);
            low = next < low ? next : low;
            high = next > high ? next : high;
        }
        for (std::size_t w = 0; w < width; ++w) {
            least = std::min(least, low[w]);
            most = std::max(most, high[w]);
        }
    }
    for (; i < numbers.size(); ++i) {
        least = std::min(least, numbers[i]);
        most = std::max(most, numbers[i]);
    }
    return {least, most};
}

}  // namespace planet
