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
};

/// An array of objects, the lowest layer first.
nlohmann::ordered_json layers_json(const std::vector<LayerReport>& layers);

}  // namespace render
