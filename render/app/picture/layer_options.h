#pragma once
// What `--layer` can be told.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/layers/layer_style.h"

namespace CLI {
class App;
}

namespace render {

struct LayerOptions {
    std::filesystem::path file;
    std::optional<glm::vec3>
        color{};  ///< sRGB, 0..1; parsed as none given: the next of a palette, of a mesh that of clay
    double width = LayerStyle().width, opacity = LayerStyle().opacity, fill = LayerStyle().fill;
    std::string label{};  ///< the attribute that names features; empty: no names
    bool shown = true;    ///< the viewer can switch it off
};

/// Whether the file's ending is that of a mesh.
bool is_mesh(const LayerOptions& layer);

/// "FILE,color=#rrggbb,width=2,opacity=0.8,fill=0.2,label=NAME", keys in any order, each at most once. A comma that no
/// key follows belongs to the name of the file. Throws planet::Error(bad_usage).
LayerOptions parse_layer(std::string_view where, const std::string& text);

/// The text that parses to these options; what is as by default is left out.
std::string layer_text(const LayerOptions& layer);

/// Adds --layer, which may come many times.
void add_layer_option(CLI::App& command, std::vector<LayerOptions>& layers);

}  // namespace render
