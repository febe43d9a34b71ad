#pragma once
// The typeface: DejaVu Sans where it is, else another that is there, else Dear ImGui's own.

struct ImFont;

namespace render {

struct Fonts {
    ImFont *text = nullptr, *small = nullptr, *title = nullptr;  ///< 14, 12 and 17 units high
};

/// OCTAGLOBE_FONT names another TrueType file; one that is none plays a machine without fonts.
Fonts load_fonts(float scale);

}  // namespace render
