#pragma once
// What `octaglobe refine` can be told.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "planet/bisection/bisection.h"
#include "planet/elevation/elevation_field.h"
#include "planet/exporters/mesh_file.h"
#include "render/app/report.h"
#include "render/app/values.h"

namespace render {

/// Where a selective refinement is seen from.
struct RefineView {
    planet::Geodetic place{};  ///< on the ground
    double range = 0;          ///< m above it
};

struct RefineCommand {
    std::string source;  ///< a mesh, or a progressive mesh (.oprog)
    bool weld = false;

    std::optional<planet::BisectionRule> rule{};  ///< nothing: modified; of a progressive mesh, its own
    std::optional<planet::SideGeometry>
        sides{};  ///< nothing: plan with elevation, but of an Earth-centred mesh; else space
    std::optional<planet::SplitOrder> order{};  ///< nothing: deviation with a bound of it, else length

    std::optional<double> max_side{}, max_deviation{};  ///< m
    std::optional<std::size_t> max_triangles{};
    std::optional<int> steps{};
    std::optional<glm::dvec2> split{};  ///< a point in plan
    std::string region;                 ///< a vector file
    std::string elevation;              ///< a raster
    std::optional<planet::VerticalDatum> datum{};

    std::optional<double> at{};  ///< share of the records
    std::optional<RefineView> view{};
    std::optional<int> morph{};  ///< frames
    std::optional<planet::MeshFormat> frame_format{};

    std::optional<planet::MeshFrame> frame{};       ///< nothing: the mesh's own if the format holds it, else enu
    std::optional<std::filesystem::path> output{};  ///< a file; with --morph a new folder
    std::optional<std::filesystem::path> progressive{}, picture{};
    std::optional<PictureSize> picture_size{};
    std::string json;
};

/// A mesh file is refined, a progressive one is read in part. Each writes what was asked for, fills the report and prints
/// one line.
void refine_mesh(const RefineCommand& command, Report& report);
void refine_stream(const RefineCommand& command, Report& report);

}  // namespace render
