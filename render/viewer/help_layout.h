#pragma once
// The keys of the help in columns, as they fit into a window.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "render/viewer/panels.h"

namespace render {

/// Sizes in the panels' units.
struct HelpDensity {
    float font, row_gap, group_gap, key_gap, column_gap;
};
inline constexpr HelpDensity help_densities[] = {{14, 4, 8, 16, 32}, {12, 2, 6, 12, 24}};

struct HelpLayout {
    struct Column {
        std::span<const HelpGroup> groups;
        float keys = 0, width = 0;  ///< units: of its keys alone, of all of it
    };
    int density = 0;  ///< of help_densities
    std::vector<Column> columns;
    float width = 0, height = 0;  ///< units
};

/// The first that fits of two columns, three, and the same in small letters; else two columns of those, which are too high.
/// @param width_of a text in units at a size of the font @param room units
HelpLayout lay_out_help(std::span<const HelpGroup> groups,
                        const std::function<float(const std::string&, float font)>& width_of, float room_width,
                        float room_height);

}  // namespace render
