#pragma once
// A picture draped over a raster: where it lies, and the parts of it that meshes show.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planet/elevation/image.h"
#include "planet/elevation/raster.h"

namespace render {

/// Where samples lie in a picture, in shares of its width and height from the top left: by its georeference, in whatever
/// CRS; one without a CRS is in the raster's. A picture without either, or none, covers the raster from edge to edge of its
/// outer pixels, north (or what has the larger y) up.
class DrapeMap {
  public:
    /// @param picture a file; empty: none. Throws planet::Error(bad_data) for one that has a place of which the raster's
    /// coordinates tell nothing.
    DrapeMap(const planet::Raster& raster, const std::string& picture);

    /// @param first of the window whose samples these are
    /// Throws planet::Error(bad_data) for samples that a georeferenced picture does not cover, to half its pixel.
    std::vector<glm::dvec2> at(const std::vector<glm::ivec2>& samples, glm::ivec2 first) const;

  private:
    std::vector<glm::dvec2> edge_to_edge(const std::vector<glm::ivec2>& samples, glm::ivec2 first) const;
    void to_picture_crs(std::vector<glm::dvec2>& places) const;

    const planet::Raster& raster_;
    std::string name_;
    std::optional<planet::RasterHeader> picture_;
};

/// A picture over a raster.
class Drape {
  public:
    /// Throws planet::Error(bad_data) if it is no picture.
    explicit Drape(std::filesystem::path path);

    /// A PNG or JPEG file: as it is if it is one of these, else anew: a JPEG, or a PNG if it has an alpha channel.
    std::string whole() const;
    /// A part that covers places, with a pixel or two beside them, and where it lies: in shares of the whole.
    struct Part {
        std::string bytes;
        glm::dvec2 low{0}, high{1};
    };
    Part part(const std::vector<glm::dvec2>& places) const;

  private:
    std::string encoded(const planet::Image& image) const;

    std::filesystem::path path_;
    bool png_ = false, jpeg_ = false;
    planet::Image image_;
};

/// Texture coordinates in a part of the picture. @param places in shares of the whole
std::vector<glm::vec2> texture_coordinates(const std::vector<glm::dvec2>& places, const Drape::Part& part = {});

}  // namespace render
