#include "render/viewer/help_layout.h"

#include <algorithm>

namespace render {

namespace {

using Groups = std::span<const HelpGroup>;

float height_of(Groups groups, const HelpDensity& d) {
    float height = 0;
    for (const HelpGroup& group : groups)
        height += d.group_gap + static_cast<float>(group.lines.size() + 1) * (d.font + d.row_gap);
    return height;
}

/// Columns whose tallest is as low as it can be, in the order given.
std::vector<Groups> even_columns(Groups groups, std::size_t count, const HelpDensity& d) {
    const auto tallest = [&](const std::vector<Groups>& columns) {
        float height = 0;
        for (const Groups column : columns) height = std::max(height, height_of(column, d));
        return height;
    };
    std::vector<Groups> best{groups};
    for (std::size_t first = 1; count > 1 && first < groups.size(); ++first) {
        std::vector<Groups> columns = even_columns(groups.subspan(first), count - 1, d);
        columns.insert(columns.begin(), groups.first(first));
        if (tallest(columns) < tallest(best)) best = std::move(columns);
    }
    return best;
}

}  // namespace

HelpLayout lay_out_help(Groups groups, const std::function<float(const std::string&, float font)>& width_of,
                        float room_width, float room_height) {
    const auto lay_out = [&](int density, std::size_t count) {
        const HelpDensity& d = help_densities[density];
        HelpLayout layout;
        layout.density = density;
        for (const Groups column : even_columns(groups, count, d)) {
            float keys = 0, what = 0;
            for (const HelpGroup& group : column)
                for (const HelpLine& line : group.lines) {
                    keys = std::max(keys, width_of(line.keys, d.font));
                    what = std::max(what, width_of(line.what, d.font));
                }
            if (!layout.columns.empty()) layout.width += d.column_gap;
            layout.columns.push_back({column, keys, keys + d.key_gap + what});
            layout.width += layout.columns.back().width;
            layout.height = std::max(layout.height, height_of(column, d));
        }
        return layout;
    };
    for (int density = 0; density < static_cast<int>(std::size(help_densities)); ++density)
        for (const std::size_t count : {2u, 3u}) {
            HelpLayout layout = lay_out(density, count);
            if (layout.width <= room_width && layout.height <= room_height) return layout;
        }
    return lay_out(static_cast<int>(std::size(help_densities)) - 1, 2);
}

}  // namespace render
