// The module octaglobe_text: letters through FreeType.

#include <ft2build.h>
#include FT_FREETYPE_H

#include "planet/error.h"
#include "render/layers/glyphs.h"

namespace render {
namespace {

class FreeTypeGlyphs final : public GlyphSource {
  public:
    explicit FreeTypeGlyphs(const char* file) {
        if (FT_Init_FreeType(&library_) != 0 || FT_New_Face(library_, file, 0, &face_) != 0 ||
            FT_Set_Pixel_Sizes(face_, 0, glyph_size) != 0) {
            FT_Done_FreeType(library_);
            throw planet::Error(planet::Fault::bad_data, file, "cannot be read as a font", "a TrueType font");
        }
    }
    FreeTypeGlyphs(const FreeTypeGlyphs&) = delete;
    FreeTypeGlyphs& operator=(const FreeTypeGlyphs&) = delete;
    ~FreeTypeGlyphs() override {
        FT_Done_Face(face_);
        FT_Done_FreeType(library_);
    }

    Glyph glyph(char32_t character) const override {
        Glyph glyph;
        // Hinting would fit letters to the pixels of one size.
        if (FT_Load_Char(face_, character, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP) != 0) return glyph;
        glyph.advance = static_cast<float>(face_->glyph->linearHoriAdvance) / 65536;
        const FT_GlyphSlot slot = face_->glyph;
        if (slot->outline.n_points == 0 || FT_Render_Glyph(slot, FT_RENDER_MODE_SDF) != 0) return glyph;
        glyph.width = static_cast<int>(slot->bitmap.width);
        glyph.height = static_cast<int>(slot->bitmap.rows);
        glyph.left = static_cast<float>(slot->bitmap_left);
        glyph.top = static_cast<float>(slot->bitmap_top);
        for (int y = 0; y < glyph.height; ++y) {
            const unsigned char* row = slot->bitmap.buffer + y * slot->bitmap.pitch;
            glyph.distances.insert(glyph.distances.end(), row, row + glyph.width);
        }
        return glyph;
    }

  private:
    FT_Library library_ = nullptr;
    FT_Face face_ = nullptr;
};

}  // namespace
}  // namespace render

extern "C" __attribute__((visibility("default"))) render::GlyphSource* octaglobe_text_1(const char* file) {
    return new render::FreeTypeGlyphs(file);
}
