#include "render/app/picture/layer_options.h"

#include <charconv>
#include <cmath>
#include <set>

#include <CLI/CLI.hpp>

#include "planet/error.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/values.h"

namespace render {

namespace {

using planet::Error;
using planet::Fault;

constexpr glm::vec3 palette[] = {{1.00f, 0.80f, 0.00f}, {0.31f, 0.76f, 0.97f}, {1.00f, 0.44f, 0.26f},
                                 {0.68f, 0.84f, 0.51f}, {0.93f, 0.56f, 0.86f}, {0.96f, 0.96f, 0.96f}};

constexpr std::string_view keys[] = {"color", "width", "opacity", "fill", "label"};
constexpr std::string_view accepted = "FILE,color=#ffcc00,width=2,opacity=0.8,fill=0.2,label=NAME";
constexpr Range width_range{0.5, 16}, part_range{0, 1};

glm::vec3 parse_color(std::string_view where, std::string_view text) {
    unsigned rgb = 0;
    const char* const last = text.data() + text.size();
    if (text.size() != 7 || text.front() != '#' || std::from_chars(text.data() + 1, last, rgb, 16).ptr != last)
        throw Error(Fault::bad_usage, where, "color " + shown(text), "#rrggbb, e.g. #ffcc00");
    return glm::vec3(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255) / 255.0f;
}

std::string color_text(const glm::vec3& color) {
    char text[8];
    const auto byte = [](float v) { return static_cast<unsigned>(std::lround(255 * v)); };
    std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(color.r) & 255, byte(color.g) & 255, byte(color.b) & 255);
    return text;
}

/// Gives layers without a colour the next one of a palette.
void choose_colors(std::vector<LayerOptions>& layers) {
    for (std::size_t i = 0; i < layers.size(); ++i)
        if (!layers[i].color && !is_mesh(layers[i])) layers[i].color = palette[i % std::size(palette)];
}

/// Where the next ",key=" begins, from a place on; npos: nowhere.
std::size_t next_key(const std::string& text, std::size_t from) {
    for (std::size_t comma = text.find(',', from); comma != std::string::npos; comma = text.find(',', comma + 1))
        for (const std::string_view key : keys)
            if (text.compare(comma + 1, key.size(), key) == 0 && text[comma + 1 + key.size()] == '=') return comma;
    return std::string::npos;
}

void set(LayerOptions& layer, std::string_view where, std::string_view key, const std::string& value) {
    if (key == "color") layer.color = parse_color(where, value);
    if (key == "width") layer.width = parse_number(where, value, width_range, "pixels");
    if (key == "opacity") layer.opacity = parse_number(where, value, part_range);
    if (key == "fill") layer.fill = parse_number(where, value, part_range);
    if (key == "label") layer.label = value;
    if (value.empty()) throw Error(Fault::bad_usage, where, std::string(key) + " is empty", accepted);
}

}  // namespace

bool is_mesh(const LayerOptions& layer) {
    std::string ending = layer.file.extension().native();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return ending == ".glb" || ending == ".ply" || ending == ".obj" || ending == ".stl";
}

LayerOptions parse_layer(std::string_view where, const std::string& text) {
    LayerOptions layer;
    std::size_t at = next_key(text, 0);
    layer.file = text.substr(0, at);
    if (layer.file.empty()) throw Error(Fault::bad_usage, where, "names no file", accepted);
    std::set<std::string> given;
    while (at != std::string::npos) {
        const std::size_t equals = text.find('=', at), next = next_key(text, equals);
        const std::string key = text.substr(at + 1, equals - at - 1);
        if (!given.insert(key).second) throw Error(Fault::bad_usage, where, key + " comes twice", accepted);
        set(layer, where, key, text.substr(equals + 1, next == std::string::npos ? next : next - equals - 1));
        at = next;
    }
    return layer;
}

std::string layer_text(const LayerOptions& layer) {
    const LayerOptions usual;
    std::string text = layer.file.native();
    const auto add = [&](const char* key, double value, double as_usual) {
        if (value != as_usual) text += std::string(",") + key + "=" + exact(value);
    };
    if (layer.color) text += ",color=" + color_text(*layer.color);
    add("width", layer.width, usual.width);
    add("opacity", layer.opacity, usual.opacity);
    add("fill", layer.fill, usual.fill);
    if (!layer.label.empty()) text += ",label=" + layer.label;
    return text;
}

void add_layer_option(CLI::App& command, std::vector<LayerOptions>& layers) {
    command
        .add_option_function<std::vector<std::string>>(
            "--layer",
            [&layers](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) layers.push_back(parse_layer("--layer", text));
                choose_colors(layers);
            },
            "Points, lines, polygons or a mesh on the ground: "
            "FILE[,color=#ffcc00][,width=2][,opacity=0.8][,fill=0.2][,label=NAME]; many, later on top, "
            "lines on meshes too; names over all")
        ->type_name("FILE[,...]")
        ->allow_extra_args(false);
}

}  // namespace render
