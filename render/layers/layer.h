#pragma once
// A layer: what of a file lies on the ground, and how it looks.

#include <optional>
#include <string>
#include <vector>

#include "render/layers/filled_polygons.h"
#include "render/layers/geodesic_lines.h"
#include "render/layers/layer_style.h"
#include "render/layers/placed_mesh.h"

namespace render {

struct LayerName {
    std::string text;
    glm::dvec3 normal{0, 0, 1};                                                ///< geodetic, of its place
    enum class Place { middle, beside_mark, above_right } at = Place::middle;  ///< of the text, about its place
};

struct Layer {
    LayerStyle style;
    GeodesicLines lines;   ///< the outlines of polygons too
    GeodesicLines points;  ///< each a line of one vertex
    FilledPolygons polygons;
    std::optional<PlacedMesh> mesh;
    std::vector<LayerName> names;
};

}  // namespace render
