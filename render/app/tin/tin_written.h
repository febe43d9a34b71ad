#pragma once
// A TIN as its file will hold it, certified: placed in the frame, rounded as the format rounds, measured at every sample,
// and mended where a sample is too far, until none is.

#include <limits>
#include <optional>

#include "planet/exporters/mesh_file.h"
#include "planet/tin/written_tin.h"
#include "render/app/output_file.h"

namespace render {

/// Where the floor of a solid lies.
struct TinFloor {
    double height = 0;          ///< m, as heights are
    std::optional<double> z{};  ///< of an enu frame that curves, instead: so that it is flat
};
/// @param base m below the lowest sample @param frame of the grid's window
TinFloor floor_below(const planet::HeightGrid& grid, const planet::RasterFrame& frame, double base);

struct TinGoal {
    double tolerance = std::numeric_limits<double>::infinity();  ///< m
    /// Mending ends before there are more.
    std::size_t max_triangles = std::numeric_limits<std::size_t>::max();
    planet::MeshFormat format = planet::MeshFormat::ply;
    double least_step = 0;  ///< of a .glb's grid
    unsigned threads = 0;
    bool by_sample = false;  ///< the deviation of every sample, too
    /// Samples on the border of the grid are not inserted but listed: a neighbour has them too.
    bool border_is_shared = false;
    std::optional<TinFloor> floor{};  ///< closes the mesh to a solid
};

struct WrittenTin {
    planet::TinMesh mesh;         ///< in the lattice; of a solid its top
    planet::SurfaceMesh surface;  ///< in the frame, rounded. Its first vertices and triangles are those of the mesh
    planet::MeshRounding rounding;
    planet::WrittenDeviation deviation;      ///< without the rounding of samples
    double deviation_max = 0;                ///< m, with it
    bool kept = true;                        ///< the tolerance
    bool mendable = true;                    ///< if not: the format's rounding is too coarse for the tolerance
    std::size_t inserted = 0;                ///< samples, to mend
    std::vector<glm::ivec2> border_samples;  ///< too far, on a shared border

    /// Frees the memory of all but the vertices and triangles of the surface; numbers stay.
    void keep_surface_only();
};

/// @param mesh whose vertices are samples of the grid @param frame of the grid's window
/// Throws planet::Error(bad_data) if there is no triangle, bad_usage if the frame does not reach all of them.
WrittenTin as_written(planet::TinMesh mesh, const planet::HeightGrid& grid, const planet::RasterFrame& frame,
                      const TinGoal& goal);

/// Throws planet::Error(check_failed) for a solid that is not. @return V - E + F
long check_closed(const planet::SurfaceMesh& solid, planet::MeshFrame frame);

/// Writes what was measured, reads the file again, and compares: what holds of the one holds of the other.
/// Throws planet::Error: bad_usage if it cannot be written, check_failed if the file differs. @return bytes
std::size_t write_checked(OutputFile& file, const WrittenTin& tin, const planet::MeshReference& reference,
                          planet::MeshFormat format, const planet::MeshLooks& looks);

}  // namespace render
