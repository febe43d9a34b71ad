#include "planet/exporters/reference_text.h"

#include <algorithm>
#include <array>

#include "planet/exporters/text_words.h"

namespace planet {
namespace {

constexpr std::array<std::string_view, 4> frame_names{"source", "utm", "enu", "ecef"};  // as in MeshFrame

void add(std::vector<std::string>& lines, std::string_view key, std::string value) {
    std::replace_if(
        value.begin(), value.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    if (!value.empty()) lines.push_back(std::string(key) + " " + value);
}

std::string triple(const glm::dvec3& v) {
    return text_of(v.x) + " " + text_of(v.y) + " " + text_of(v.z);
}

// All of them or none.
template <std::size_t count>
std::optional<std::array<double, count>> numbers_from(std::string_view text) {
    std::array<double, count> numbers;
    for (double& number : numbers) {
        const auto value = number_from<double>(take_word(text));
        if (!value) return std::nullopt;
        number = *value;
    }
    return numbers;
}

}  // namespace

std::string_view to_string(MeshFrame frame) {
    return frame_names[static_cast<std::size_t>(frame)];
}

void set_frame(MeshReference& reference, std::string_view name) {
    const auto found = std::find(frame_names.begin(), frame_names.end(), name);
    if (found != frame_names.end()) reference.frame = static_cast<MeshFrame>(found - frame_names.begin());
}

std::vector<std::string> reference_lines(const MeshReference& reference) {
    std::vector<std::string> lines{"generator Octaglobe"};
    add(lines, "frame", std::string(to_string(reference.frame)));
    add(lines, "crs", reference.crs);
    add(lines, "vertical_datum", reference.vertical_datum);
    if (reference.geographic) add(lines, "xy_unit", "degrees");
    if (reference.frame == MeshFrame::enu) {
        const glm::dmat3& axes = reference.ecef_from_enu;
        add(lines, "origin_ecef", triple(reference.origin));
        add(lines, "ecef_from_enu", triple(axes[0]) + " " + triple(axes[1]) + " " + triple(axes[2]));
    }
    return lines;
}

void read_reference_line(std::string_view line, MeshReference& reference) {
    const std::string_view key = take_word(line), value = trimmed(line);
    if (key == "frame") set_frame(reference, value);
    if (key == "crs") reference.crs = value;
    if (key == "vertical_datum") reference.vertical_datum = value;
    if (key == "xy_unit") reference.geographic = value == "degrees";
    if (key == "origin_ecef") {
        if (const auto n = numbers_from<3>(value)) reference.origin = {(*n)[0], (*n)[1], (*n)[2]};
    }
    if (key == "ecef_from_enu") {
        if (const auto n = numbers_from<9>(value))
            for (std::size_t i = 0; i < 9; ++i)
                reference.ecef_from_enu[static_cast<int>(i / 3)][static_cast<int>(i % 3)] = (*n)[i];
    }
}

}  // namespace planet
