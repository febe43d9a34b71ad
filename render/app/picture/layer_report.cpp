#include "render/app/picture/layer_report.h"

namespace render {

nlohmann::ordered_json layers_json(const std::vector<LayerReport>& layers) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const LayerReport& layer : layers)
        list.push_back({{"name", layer.name}, {"features", layer.features}, {"vertices", layer.vertices}});
    return list;
}

}  // namespace render
