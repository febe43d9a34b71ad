#pragma once
// Equirectangular pictures and elevation fields as cube maps by geodetic normal: no poles, no seam, no trigonometry in
// the shader. Faces and their axes are those of OpenGL (4.6 core, table 8.19), so texture(cube, normal) just works with
// GL_TEXTURE_CUBE_MAP_SEAMLESS.
//
// Textures of the terrain shader: RGBA8 (the day picture as SRGB8_ALPHA8, whose alpha stays linear), trilinear.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/elevation/elevation_field.h"

namespace render {

/// One level: six faces one after the other (+x -x +y -y +z -z), each side x side RGBA, rows from t = 0.
struct CubeLevel {
    int side = 0;
    std::vector<std::uint8_t> texels;
};
/// Levels from the finest, side, down to 1.
struct CubeMap {
    std::vector<CubeLevel> levels;
};

/// An 8-bit picture in rows from the north, first column at longitude -180 degrees, whole planet.
struct EquirectangularImage {
    int width = 0, height = 0;  ///< 1..65535
    int channels = 0;           ///< 1..4
    std::span<const std::uint8_t> texels;
};

/// The normal through the centre of a texel (unit), or through any (s, t) in 0..1 of a face.
glm::dvec3 cube_normal(int face, double s, double t);

/// How the bytes of a picture count when they are averaged.
enum class Encoding {
    srgb,    ///< colour channels by their light, alpha as it is
    linear,  ///< every channel as it is
};

/// A cube map of a picture. Each texel averages the picture over its own area, as wide in longitude as it is there:
/// near the poles over whole rows. Grey fills rgb; a missing alpha is 255. Levels average four texels of the one
/// before, in light. Throws planet::Error (bad_data) if sizes do not fit. Same bytes for any number of threads.
/// @param side of a face, a power of two; width / 4 keeps the picture's detail   @param threads 1 or more
CubeMap cube_from_equirectangular(const EquirectangularImage& image, int side, Encoding encoding, unsigned threads = 2);

/// Puts channel 0 of one cube map into the alpha of another of the same size (water fraction beside day colour).
void set_alpha(CubeMap& into, const CubeMap& from);

/// Puts night lights into the alpha of a relief cube of the same size (SNORM: 0..127), so that one fetch gives both:
/// night = lamps(texture(relief, normal).a). Channel 0 of `lights` is sRGB, near enough to the square root of light.
void set_night_alpha(CubeMap& relief, const CubeMap& lights);

/// NASA's "Earth at night" shows lights on a moonlit blue planet. Keeps the lights, in the colour of sodium lamps, as
/// sRGB bytes; 3 bytes a texel in and out.
std::vector<std::uint8_t> lights_from_night_picture(std::span<const std::uint8_t> rgb);

/// Twice (terrain normal minus geodetic normal), ecef, SNORM8 in rgb (signed bytes; 127 is 1), clamped: slopes to 30
/// degrees, more than cells of kilometres have; alpha 127. The shader adds half of it to the geodetic normal and
/// normalizes. Heights are sampled at texel centres and differenced over one texel each way, across
/// face edges too; where the field has no answer the ground is level. Coarser levels average, so relief fades to level.
/// @param radius of the planet, m, for slopes   @param sea_floor false: below 0 m the ground is level (the sea's
/// surface)
CubeMap relief_cube(const planet::ElevationField& field, int side, double radius, bool sea_floor = false,
                    unsigned threads = 2);

}  // namespace render
