#pragma once
// What `octaglobe tin` can be told.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/exporters/mesh_file.h"
#include "planet/tin/tiled_tin.h"
#include "render/app/report.h"
#include "render/app/tin/tin_measure.h"
#include "render/app/tin/tin_picture.h"

namespace render {

struct TinCommand {
    std::vector<std::string> sources;  ///< files and patterns of them, on one grid; later ones on top

    std::optional<double> max_deviation{};  ///< m
    std::optional<std::size_t> max_triangles{};
    std::vector<std::string> features, masks;  ///< vector files
    TinMeasureChoice measure;
    planet::TinQuality quality = planet::TinQuality::standard;

    std::optional<planet::MeshFrame> frame{};      ///< nothing: the format's own
    std::optional<planet::VerticalDatum> datum{};  ///< of the heights; nothing: what the files say, else EGM96
    double exaggeration = 1;
    std::optional<double> base{};  ///< m below the lowest sample: the floor of a solid

    int tile = 0;  ///< samples a side; 0: one mesh
    planet::MeshFormat tile_format = planet::MeshFormat::glb;

    std::optional<std::filesystem::path> output{};  ///< a file; with tiles a folder
    std::optional<std::filesystem::path> error_grid{}, drape{};
    std::optional<std::filesystem::path> picture{};  ///< of steps towards it
    std::vector<std::size_t> stages = paper_stages;  ///< triangles, of the picture's panels
    std::string json;
};

/// Each makes its TIN, writes what was asked for, fills the report and prints one line.
void tin_raster(const TinCommand& command, Report& report);
void tin_tiles(const TinCommand& command, Report& report);

}  // namespace render
