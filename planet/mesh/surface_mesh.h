#pragma once
// A triangulation of terrain or of a planet as plain arrays, in the frame in which it is written.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace planet {

/// The frame of a written mesh.
enum class MeshFrame {
    source,  ///< x, y in the source's CRS (its units), z the height in metres as the source gives it
    utm,     ///< easting, northing and height in metres
    enu,     ///< metres east, north and up of an origin on the ellipsoid
    ecef,    ///< metres, Earth-centred (frames.h)
};

/// Between two strips that follow each other in one array of indices.
inline constexpr std::uint32_t strip_restart = 0xffffffffu;

struct SurfaceMesh {
    std::vector<glm::dvec3> vertices;                     ///< unique, all used
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above, in strip order
    std::vector<std::uint8_t> level;                      ///< bisection level, by triangle
    /// Generalized triangle strips over all triangles in the same order, strip_restart between them. A triangle with
    /// two equal indices only turns the strip; every second triangle of a strip is wound the other way round.
    std::vector<std::uint32_t> strip;
};

/// What a file says of its coordinates.
struct MeshReference {
    MeshFrame frame = MeshFrame::source;
    std::string crs;             ///< "EPSG:4326", WKT, or empty: none
    std::string vertical_datum;  ///< "EGM96", "ellipsoid", or empty: unknown
    /// Of an enu frame: the ecef place of its origin and the axes east, north, up (columns). Files with a scene graph use them.
    glm::dvec3 origin{0};
    glm::dmat3 ecef_from_enu{1};
    bool geographic = false;  ///< x and y are degrees of longitude and latitude
};

}  // namespace planet
