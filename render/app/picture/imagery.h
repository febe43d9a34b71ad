#pragma once
// The pictures that are draped on the globe, as cube maps: made once from the shipped files (or the user's), then kept
// decoded in the user's cache folder.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "render/app/picture/earth.h"
#include "render/gl/texture.h"

namespace render {

/// What the globe looks like from afar. Spans point into a mapped file or into memory that this owns.
class Imagery {
  public:
    struct Cube {
        int side = 0;
        std::vector<std::span<const std::byte>> levels;  ///< finest first, six faces each, RGBA8
    };
    Cube day;     ///< sRGB colour, alpha the part that is water
    Cube night;   ///< sRGB lights
    Cube relief;  ///< SNORM8, see relief_cube()

    /// Size of a texel of the day picture, metres at the middle of a face on a sphere of that radius.
    double texel_m(double radius) const;

    std::shared_ptr<const void> storage;
};

/// @param pictures whole-globe equirectangular pictures, later ones on top; empty: the shipped day picture
/// @param heights the drawn surface, asked for only if the cubes have to be made
/// Throws planet::Error(bad_data) for a picture that cannot be read or is not twice as wide as high.
Imagery open_imagery(const std::vector<std::filesystem::path>& pictures, const EarthSources& earth,
                     ChecksumIndex& index,
                     const std::function<std::shared_ptr<const planet::ElevationField>()>& heights, unsigned threads,
                     const std::function<void(std::string_view, double)>& progress);

/// Uploads a cube. @param internal_format GL_SRGB8_ALPHA8 or GL_RGBA8_SNORM
Texture upload_cube(const Imagery::Cube& cube, GLenum internal_format);

}  // namespace render
