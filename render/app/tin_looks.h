#pragma once
// What the .glb of a TIN shows: normals, texture coordinates, a draped picture.

#include <filesystem>
#include <optional>

#include "planet/elevation/image.h"
#include "planet/exporters/mesh_file.h"
#include "planet/patches/raster_frame.h"
#include "planet/tin/height_grid.h"

namespace render {

/// Of unit length, by vertex: those of the triangles around it, by their areas.
std::vector<glm::vec3> normals_of(const planet::SurfaceMesh& mesh);

/// Of the ground at samples, from those up to ground_reach away: the same bits from any window that has them.
/// @param frame of the grid's window
std::vector<glm::vec3> ground_normals(const planet::HeightGrid& grid, const planet::RasterFrame& frame,
                                      const std::vector<glm::ivec2>& samples);

/// How far away samples tell ground_normals().
inline constexpr int ground_reach = 8;

/// Where samples lie in a picture that covers a raster from edge to edge of its outer pixels, north (or what has the larger
/// y) up: in shares of its width and height from the top left.
class DrapeMap {
  public:
    explicit DrapeMap(const planet::RasterHeader& raster);
    glm::dvec2 at(glm::dvec2 sample) const;

  private:
    glm::dvec2 size_;
    bool columns_run_west_, rows_run_north_;
};

/// A picture over a raster.
class Drape {
  public:
    /// Throws planet::Error(bad_data) if it is no picture.
    explicit Drape(std::filesystem::path path);

    /// A PNG or JPEG file: as it is if it is one of these, else anew: a JPEG, or a PNG if it has an alpha channel.
    std::string whole() const;
    /// A part that covers a box, with a pixel or two beside it, and where it lies: in shares of the whole.
    struct Part {
        std::string bytes;
        glm::dvec2 low{0}, high{1};
    };
    Part part(glm::dvec2 low, glm::dvec2 high) const;

  private:
    std::string encoded(const planet::Image& image) const;

    std::filesystem::path path_;
    bool png_ = false, jpeg_ = false;
    planet::Image image_;
};

/// Texture coordinates of samples in a part of the picture. @param first of the window whose samples these are
std::vector<glm::vec2> texture_coordinates(const std::vector<glm::ivec2>& samples, glm::ivec2 first,
                                           const DrapeMap& map, const Drape::Part& part = {});

}  // namespace render
