#pragma once
// Text of strokes: small letters, digits, comma, full stop, hyphen. Round letters on circles, drawn at any size.

#include <string_view>
#include <vector>

#include "render/picture/mesh_figure.h"

namespace render {

/// Width of a line of text, pixels. @param size height of the digits, pixels
double text_width(std::string_view text, double size);

/// Adds a line of text. Other characters than the above are blanks.
/// @param left, baseline where it starts, pixels @param size height of the digits, pixels
void add_text(std::vector<Stroke>& strokes, std::string_view text, double left, double baseline, double size,
              Color color);

}  // namespace render
