#include "render/app/picture/layer_report.h"

#include <iostream>

namespace render {

nlohmann::ordered_json layers_json(const std::vector<LayerReport>& layers) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const LayerReport& layer : layers) {
        list.push_back({{"name", layer.name}, {"features", layer.features}, {"vertices", layer.vertices}});
        if (!layer.warning.empty()) list.back()["warning"] = layer.warning;
    }
    return list;
}

void warn_of_layers(const std::vector<LayerReport>& layers) {
    for (const LayerReport& layer : layers)
        if (!layer.warning.empty()) std::cerr << "octaglobe: warning: " << layer.warning << '\n';
}

}  // namespace render
