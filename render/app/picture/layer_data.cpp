#include "render/app/picture/layer_data.h"

#include <algorithm>

#include "planet/elevation/features.h"
#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/exporters/mesh_file.h"
#include "planet/geodesy/geoid.h"
#include "render/app/data_path.h"

namespace render {

namespace {

constexpr std::int64_t most_vertices = 20'000'000;  // some 2 GB of them, GDAL's own memory aside

constexpr LayerStyle coastline_style{
    .color{0.93f, 0.97f, 1.0f}, .width = 1.1, .opacity = 0.62, .fill = 0, .casing = false};
constexpr LayerStyle border_style{
    .color{1.0f, 0.90f, 0.66f}, .width = 1.1, .opacity = 0.55, .fill = 0, .casing = false};

constexpr glm::vec3 mesh_color(0.58f, 0.54f, 0.49f);  // clay

LayerStyle style_of(const LayerOptions& options) {
    return {.color = options.color.value_or(mesh_color),
            .width = options.width,
            .opacity = options.opacity,
            .fill = options.fill,
            .own_colors = !options.color};
}

/// The picture of a mesh, if it has one that can be drawn; else a line says why not.
MeshTexture texture_of(planet::MeshLooks& looks, const std::string& file, std::string& warning) {
    if (looks.picture.empty()) return {};
    if (looks.uv.empty()) {
        warning = file + ": its picture is not drawn, for not all vertices say where it lies";
        return {};
    }
    try {
        constexpr int largest_side = 8192;  // of a texture, anywhere
        MeshTexture texture{planet::read_image_bytes(looks.picture, file, {.max_width = largest_side}),
                            std::move(looks.uv)};
        if (texture.picture.height <= largest_side) return texture;
        warning = file + ": its picture is not drawn, for it is more than 8192 pixels high";
    } catch (const planet::Error& error) {
        warning = error.what();
    }
    return {};
}

/// A material's factor for all vertices. White, and what a mesh has whose colour nobody knows, is none by itself: clay shows
/// relief better.
void multiply_colors(planet::MeshLooks& looks, bool with_picture, std::size_t vertices) {
    const glm::vec3 factor(looks.base_color);
    const bool no_color = factor == glm::vec3(1) || factor == glm::vec3(static_cast<float>(planet::unknown_color));
    if (!with_picture && looks.colors.empty() && no_color) return;
    if (looks.colors.empty()) looks.colors.assign(vertices, glm::vec4(1));
    for (glm::vec4& color : looks.colors) color *= looks.base_color;
}

LoadedLayer read_mesh_layer(const std::filesystem::path& file) {
    planet::MeshReference reference;
    planet::MeshLooks looks;
    const planet::SurfaceMesh mesh = planet::read_mesh(file.native(), &reference, &looks);
    // glTF says that colours of vertices are linear; other formats have them as they are shown.
    if (planet::mesh_format(file.native()) != planet::MeshFormat::glb)
        for (glm::vec4& color : looks.colors) color = glm::vec4(linear_from_srgb(glm::vec3(color)), color.a);
    LoadedLayer loaded{file.stem().native(), {}, mesh.triangles.size(), mesh.vertices.size()};
    MeshTexture texture = texture_of(looks, file.native(), loaded.warning);
    multiply_colors(looks, !texture.picture.pixels.empty(), mesh.vertices.size());
    loaded.layer.mesh.emplace(mesh, reference, looks.colors, planet::Geoid(data_file("egm96-15.pgm")), file.native(),
                              std::move(texture));
    return loaded;
}

LoadedLayer read_layer(const std::filesystem::path& file, const std::string& label = {}) {
    planet::FeatureOptions options;
    options.name_field = label;
    options.max_vertices = most_vertices;
    const planet::Features features = planet::read_features(file.native(), options);
    LoadedLayer loaded{file.stem().native(), {}, features.feature_count, features.vertex_count()};
    Layer& layer = loaded.layer;
    for (const planet::FeatureName& name : features.names)
        layer.names.push_back(
            {name.text, planet::normal_from_geodetic(name.place.y * planet::degrees, name.place.x * planet::degrees),
             name.of_point ? LayerName::Place::beside_mark : LayerName::Place::middle});
    for (const glm::dvec3& point : features.points) layer.points.add({&point, 1});
    for (const auto& line : features.lines) layer.lines.add(line);
    for (const planet::Polygon& polygon : features.polygons) {
        layer.lines.add(polygon.outer);
        for (const auto& hole : polygon.holes) layer.lines.add(hole);
        layer.polygons.add(polygon);
    }
    return loaded;
}

LoadedLayer read_shipped(const char* name, const LayerStyle& style) {
    LoadedLayer loaded = read_layer(data_file(name));
    loaded.layer.style = style;
    return loaded;
}

}  // namespace

LayerData LayerData::load(const RenderOptions& options, bool all_shipped) {
    LayerData data;
    if (all_shipped || options.shows(Overlay::coastlines))
        data.coastlines_ = read_shipped("coastlines.geojson", coastline_style);
    if (all_shipped || options.shows(Overlay::borders)) data.borders_ = read_shipped("borders.geojson", border_style);
    for (const LayerOptions& layer : options.layers)
        data.own_.push_back(is_mesh(layer) ? read_mesh_layer(layer.file) : read_layer(layer.file, layer.label));
    return data;
}

std::vector<const Layer*> LayerData::shown(const RenderOptions& options) {
    std::vector<const Layer*> list;
    for (std::size_t i = 0; i < own_.size(); ++i) {
        own_[i].layer.style = style_of(options.layers[i]);
        if (options.layers[i].shown && options.layers[i].opacity > 0) list.push_back(&own_[i].layer);
    }
    // A mesh below all else is the ground for shipped lines, too.
    auto at = std::ranges::find_if(list, [](const Layer* layer) { return !layer->mesh; });
    if (options.shows(Overlay::coastlines)) at = list.insert(at, &coastlines_.layer);
    if (options.shows(Overlay::borders)) list.insert(at, &borders_.layer);
    return list;
}

bool LayerData::needs_stencil() const {
    return std::ranges::any_of(own_, [](const LoadedLayer& l) { return !l.layer.polygons.empty() || l.layer.mesh; });
}

std::vector<LayerReport> LayerData::report() const {
    std::vector<LayerReport> list;
    for (const LoadedLayer& layer : own_) list.push_back({layer.name, layer.features, layer.vertices, layer.warning});
    return list;
}

}  // namespace render
