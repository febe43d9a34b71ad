#pragma once
// What `octaglobe mesh` can be told, and what its three kinds of mesh have in common.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "planet/elevation/elevation_field.h"
#include "planet/frames.h"
#include "planet/mesh/surface_mesh.h"
#include "render/app/report.h"
#include "render/app/values.h"

namespace render {

enum class MeshPriority {
    least,  ///< the least mesh of its own largest deviation
    max,    ///< decimation by the largest deviation
    rms,    ///< decimation by the sum of squares
};

struct MeshOptions {
    std::string source;  ///< a raster; empty: --planet or --patches
    bool planet = false;
    int columns = 0, rows = 0;  ///< of --patches
    int patch_level = 4;

    std::optional<double> max_deviation{};  ///< m
    std::optional<std::size_t> max_triangles{};
    std::optional<int> level{};
    std::string keep;    ///< a vector file
    std::string remove;  ///< "A,B": a place on the planet, or a sample of the patches
    MeshPriority priority = MeshPriority::least;

    std::optional<planet::MeshFrame> frame{};      ///< nothing: the format's own
    std::optional<planet::VerticalDatum> datum{};  ///< of the raster's heights; nothing: EGM96
    std::optional<std::filesystem::path> store{};  ///< of the planet, instead of the default Earth

    std::optional<std::filesystem::path> output{};
    std::optional<std::filesystem::path> drape{};  ///< a picture, into a .glb of a raster
    std::optional<std::filesystem::path> picture{};
    std::optional<PictureSize> picture_size{};  ///< nothing: as the mesh is proportioned
    std::string json;
};

/// Each makes its mesh, writes what was asked for, fills the report and prints one line.
void mesh_raster(const MeshOptions& options, Report& report);
void mesh_planet(const MeshOptions& options, Report& report);
/// The merging domain of a vertex, on patches or on the planet.
void mesh_domain(const MeshOptions& options, Report& report);

}  // namespace render
