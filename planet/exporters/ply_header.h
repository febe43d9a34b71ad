#pragma once
// The header of a PLY file: Turk, "The PLY Polygon File Format" (1994).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "planet/mesh/surface_mesh.h"

namespace planet {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Bytes of a scalar in a binary file.
std::size_t size_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type{};
    bool is_list = false;
    PlyType count_type{};  ///< of a list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// Of one element, in bytes or characters.
    std::size_t least_size(bool ascii) const;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
    PlyEncoding encoding{};
    std::vector<PlyElement> elements;
    MeshReference reference;  ///< from the comments
};

/// Takes the header off the front of the file. Throws MalformedBytes.
PlyHeader take_ply_header(std::string_view& file);

}  // namespace planet
