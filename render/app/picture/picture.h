#pragma once
// One settled picture, from options to file.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/streaming/resident_tiles.h"
#include "planet/terrain/ground.h"
#include "render/app/picture/layer_report.h"
#include "render/app/picture/render_options.h"

namespace render {

/// What the mesh of a frame costs, given that of the frame before.
struct FrameCost {
    double seconds = 0;  ///< of one processor, to update it
    std::uint64_t sent_bytes = 0;
};

/// What the middle of a picture shows.
struct PictureCentre {
    planet::Geodetic place;  ///< on the triangle that is drawn there
    planet::Ground ground;   ///< what a query answers at that place: not exaggerated
    double range_m = 0;      ///< from the eye
    double deviation_m = 0;  ///< certified, of the triangle from the finest surface, exaggerated
};

/// What was drawn, for the report. Counts are of what was built for this view.
struct PictureReport {
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;
    std::uint64_t strip_indices = 0;
    planet::ResidentCounts tiles;         ///< elevation tiles in use
    std::uint64_t sent_bytes = 0;         ///< of the mesh, to the GPU, over all parts
    FrameCost at_rest, moving;            ///< with RenderOptions::measure_frames
    double deviation_max_m = 0;           ///< largest certified deviation of a drawn cell
    double pixel_deviation_max = 0;       ///< pixels, certified; infinite beside a damaged tile
    double eye_height_m = 0;              ///< above the ellipsoid
    std::optional<PictureCentre> centre;  ///< nothing: the sky
    std::vector<std::string> damage;      ///< a line for each tile that could not be read; its parent stood in for it
    std::string crs;                      ///< of what is drawn, e.g. "EPSG:4979"
    std::string vertical_datum;
    std::vector<planet::SourceInfo> sources;
    std::vector<LayerReport> layers;
    std::string backend;  ///< the way in that was taken, never "auto"
    std::string gl_version;
    std::string gl_renderer;
    std::vector<std::pair<std::string, double>> seconds;  ///< step, seconds
};

/// Draws the picture and writes options.output, whole or not at all; its format is that of the file name's ending.
/// Throws planet::Error: bad_usage (the output cannot be written), bad_data (a source), no_graphics.
PictureReport draw_picture(const RenderOptions& options);

}  // namespace render
