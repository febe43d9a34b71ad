#pragma once
// The letters of a TrueType font as fields of distances, which are sharp at any size and give a rim for nothing. Drawn by
// FreeType, in a module of its own that is opened when a label is wanted.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace render {

/// All lengths are pixels at glyph_size.
struct Glyph {
    int width = 0, height = 0;              ///< of the field; both 0 for a blank
    float left = 0, top = 0;                ///< of its corner: right of the pen, above the baseline
    float advance = 0;                      ///< of the pen
    std::vector<std::uint8_t> distances{};  ///< top row first: 128 on the outline, 16 more for each pixel further in
};

inline constexpr int glyph_size = 36;    ///< pixels in an em
inline constexpr float glyph_step = 16;  ///< of a distance, for each pixel

class GlyphSource {
  public:
    virtual ~GlyphSource() = default;
    /// The font's own sign for what it does not have.
    virtual Glyph glyph(char32_t character) const = 0;
};

/// The typeface of labels: DejaVu Sans where it is, else another that is there; OCTAGLOBE_FONT names another file.
/// Throws planet::Error(bad_data) where there is no font or no module.
std::unique_ptr<GlyphSource> open_glyphs();

/// Its characters; what is no UTF-8 becomes U+FFFD.
std::u32string characters_of(const std::string& utf8);

}  // namespace render
