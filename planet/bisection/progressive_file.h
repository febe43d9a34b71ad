#pragma once
// A progressive mesh as a file: .oprog.
//
//     "OPROG" 1 13 10                 the version is the sixth byte
//     rule, sides, places, 0          a byte each; places: 0 midpoints, 1 multiples of the quantum from them, 2 doubles
//     attribute width, vertices, triangles, records, note bytes     32 bits each, of the base mesh
//     quantum                         a double
//     note, vertices (3 doubles), triangles (3 x 32 bits), attributes (floats), checksum
//     blocks of 16,384 records, the last one shorter:
//         payload bytes               32 bits
//         bits of the records         flags (3), border (1), first side (w), second side (w, none at the border);
//                                     w bits hold 3 times the number of names that the block ends with
//         places of the records       of z in plan, of x, y and z in space: varints or doubles
//         checksum
//
// Little-endian. A record takes 2 w + 4 bits: 6 bytes in a mesh of a million triangles. Checksums are FNV-1a over words of 64 bits, the last one
// filled up with zeros: a change of any one word changes it.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "planet/bisection/progressive.h"

namespace planet {

struct ProgressiveFormat {
    /// 0: places as they are, in doubles, or nothing if they are midpoints. Else new vertices are rounded to multiples of
    /// this from the midpoint of the side that they split, which takes one to three bytes a coordinate; a power of two, metres.
    double quantum = 0;
};

/// The bytes of a file. Throws Error(bad_usage) for a quantum that is no power of two or too small for the places.
std::vector<std::uint8_t> encode_progressive(const Progressive& mesh, const ProgressiveFormat& format = {});

/// @param where    names the file in errors
/// @param fraction of the records to read, 0..1, rounded to the nearest count; what comes after is not looked at
/// Throws Error(bad_data) for bytes that are no such file, cut short, damaged, or say what cannot be. Memory stays within
/// 200 times their number.
Progressive decode_progressive(std::span<const std::uint8_t> bytes, const std::string& where, double fraction = 1);

/// Reads a file. Throws Error(bad_data), also for a file that is not there.
Progressive read_progressive(const std::string& path, double fraction = 1);

}  // namespace planet
