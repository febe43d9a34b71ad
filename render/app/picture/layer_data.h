#pragma once
// Layers as they are read from files.

#include <string>
#include <vector>

#include "render/app/picture/layer_report.h"
#include "render/app/picture/render_options.h"
#include "render/layers/layer.h"

namespace render {

struct LoadedLayer {
    std::string name;  ///< of the file, without its folder and ending
    Layer layer;
    std::size_t features = 0, vertices = 0;  ///< in the file; of a mesh its triangles are features
    std::string warning{};                   ///< what of it cannot be drawn; empty: nothing
};

/// What a picture's options name: shipped coastlines and borders, and the user's layers.
class LayerData {
  public:
    /// @param all_shipped also what the options do not show now
    /// Throws planet::Error: bad_data for a file that cannot be read or has nothing with a place, bad_usage for a label
    /// that is none of its attributes.
    static LayerData load(const RenderOptions& options, bool all_shipped = false);

    /// Those to draw, the lowest first, as the options say: they have the same layers in the same order.
    std::vector<const Layer*> shown(const RenderOptions& options);
    /// Whether any has polygons or a mesh, shown or not.
    bool needs_stencil() const;

    /// Whether none was loaded.
    bool empty() const { return own_.empty() && coastlines_.vertices == 0 && borders_.vertices == 0; }
    /// Exchanges the places of two of own().
    void swap(std::size_t a, std::size_t b) { std::swap(own_[a], own_[b]); }
    /// Of own().
    std::vector<LayerReport> report() const;
    const std::vector<LoadedLayer>& own() const { return own_; }

  private:
    LoadedLayer coastlines_, borders_;
    std::vector<LoadedLayer> own_;  ///< as RenderOptions::layers
};

}  // namespace render
