#pragma once
// Names over the picture, with a dark rim so that they read over any ground.

#include <map>

#include "render/gl/buffer.h"
#include "render/gl/shader.h"
#include "render/gl/texture.h"
#include "render/layers/glyphs.h"
#include "render/layers/placed_labels.h"

namespace render {

class LabelPass {
  public:
    /// With the context that is current. Throws planet::Error where there is no font.
    LabelPass();

    /// Over what is bound. All parts of a picture have the same labels. @param pixel_scale see LayerPass::View
    void draw(std::span<const Layer* const> layers, const Camera& camera, const PicturePart& part,
              const DrapeGround& ground, double pixel_scale);

  private:
    struct Place {
        Glyph glyph;
        int x = 0, y = 0;  ///< in the atlas
    };
    struct Quad {
        glm::vec4 box;  ///< left, top, right, bottom, pixels of the whole picture
        glm::vec4 texels;
    };
    const Place& place_of(char32_t character);
    double width_of(const std::string& text, double size);
    void add(const PlacedLabel& label, double size, std::vector<Quad>& quads);

    std::unique_ptr<GlyphSource> glyphs_;
    Program program_;
    Texture atlas_;
    std::map<char32_t, Place> places_;
    int pen_x_ = 0, pen_y_ = 0, row_height_ = 0;
};

}  // namespace render
