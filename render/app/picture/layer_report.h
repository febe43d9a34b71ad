#pragma once
// Layers in a report.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace render {

/// A layer, as it is in its file.
struct LayerReport {
    std::string name;
    std::size_t features = 0, vertices = 0;
    std::string warning{};  ///< what of it is not drawn, and why; empty: nothing
};

/// A line on standard error for each layer that is not drawn as it is in its file.
void warn_of_layers(const std::vector<LayerReport>& layers);

/// An array of objects, the lowest layer first.
nlohmann::ordered_json layers_json(const std::vector<LayerReport>& layers);

}  // namespace render
