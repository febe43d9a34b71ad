#pragma once
// Where a typeface is.

#include <string>

namespace render {

/// DejaVu Sans where it is, else another that is there; empty if there is none. OCTAGLOBE_FONT names another TrueType
/// file; one that is none plays a machine without fonts.
std::string find_font();

}  // namespace render
