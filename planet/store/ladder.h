#pragma once
// The steps to which deviations and radii are rounded up where a tile stores them, so that two tiles which share a side
// hold the same bits.
//
//   deviation   code 0: 0 (does not exist); code c >= 1: 1 cm * 2^((c - 1) / 12), twelve steps an octave: up to 5.9 %
//   radius      the upper 16 bits of the float, seven bits of mantissa: up to 0.8 %
//
// The tables are made of literal constants and exact operations: the same on every machine.

#include <array>
#include <bit>
#include <cstdint>

namespace planet {

inline constexpr int deviation_codes = 512;  ///< the last is 6e10 m: no planet needs it

inline constexpr unsigned radius_codes = 0x7f80;  ///< finite ones

/// By code, metres.
const std::array<float, deviation_codes>& deviation_steps();

/// The least code whose step is at least `deviation`, metres >= 0; the last one for all above it.
unsigned deviation_code(float deviation);
inline float deviation_from_code(unsigned code) {
    return deviation_steps()[code];
}

/// The least code whose radius is at least `radius`, metres >= 0.
inline unsigned radius_code(float radius) {
    return (std::bit_cast<std::uint32_t>(radius) + 0xffffu) >> 16;
}
inline float radius_from_code(unsigned code) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(code) << 16);
}

}  // namespace planet
