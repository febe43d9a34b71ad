#pragma once
// A layer: what of a file lies on the ground, and how it looks.

#include "render/layers/filled_polygons.h"
#include "render/layers/geodesic_lines.h"
#include "render/layers/layer_style.h"

namespace render {

struct Layer {
    LayerStyle style;
    GeodesicLines lines;   ///< the outlines of polygons too
    GeodesicLines points;  ///< each a line of one vertex
    FilledPolygons polygons;
};

}  // namespace render
