#pragma once
// The whole planet as one closed mesh of given deviation or size, and the measure of how far it is from the store's
// finest surface.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "planet/mesh/surface_mesh.h"
#include "planet/octahedron/location_code.h"
#include "planet/store/planet_lattice.h"

namespace planet {

struct PlanetMeshOptions {
    /// Metres, >= 0: no finest vertex of the store is farther from the mesh, along its geodetic normal.
    double max_deviation = 0;
    /// 0: no limit. Else at least 8; where the deviation asked for takes more triangles, it gives way.
    std::size_t max_triangles = 0;
    /// Metres: by how much a writer will move a vertex at most. The deviation holds after that, unless it is below what
    /// the rounding alone makes.
    double rounding = 0;
    /// Directions (of any length > 0) at which the mesh reaches the finest level: the nearest finest vertex is one of its
    /// vertices.
    std::vector<glm::dvec3> keep{};
};

struct PlanetMesh {
    SurfaceMesh mesh;                 ///< ecef, metres; one strip; along the closed Sierpinski curve
    std::vector<LocationCode> cells;  ///< by triangle
    /// Metres: the deviation asked for, or the one that the limit of triangles allows, rounding apart: no cell deviates by
    /// more. Infinity for a uniform mesh.
    double tolerance = 0;
};

/// The *least* conforming mesh all of whose cells have an own deviation within the tolerance, and that keeps what it has
/// to: a mesh that lacks one of its vertices does not conform, or has a cell that deviates more. With a limit of triangles:
/// the same for the smallest tolerance that allows it. Triangles are cells of the store's lattice.
/// Throws Error(bad_usage) for an option out of range, or if keep alone takes more triangles than allowed.
PlanetMesh planet_mesh(PlanetLattice& lattice, const PlanetMeshOptions& options);

inline constexpr int finest_uniform_level = 22;  // 33 million triangles, 2 GB

/// All 8 * 2^level cells of one bisection level. Vertices lie on the finest surface: on those of the store where it has
/// them, and where it ends in the planes of its finest cells. Memory: about 60 bytes a triangle.
/// Throws Error(bad_usage) for a level outside 0..finest_uniform_level.
PlanetMesh uniform_planet_mesh(PlanetLattice& lattice, int bisection_level);

/// How far a mesh is from the finest vertices of a store, along their geodetic normals, and these from the source.
struct DeviationReport {
    double maximum = 0;         ///< metres: over both sides of a vertex that lies between triangles
    double rms = 0;             ///< metres: root mean square over the samples
    std::uint64_t samples = 0;  ///< every finest vertex of the planet, once
    double resampling = 0;      ///< metres: no source sample is farther from the finest surface
    double total() const { return maximum + resampling; }
};

/// Measures at every finest vertex of the store, in the frame of planet/mesh/deviation.h.
/// @param vertices of the mesh as they were written, ecef in metres: as many as mesh.vertices, in their order
/// The same bits for any number of threads.
DeviationReport measure(const PlanetLattice& lattice, const PlanetMesh& mesh, std::span<const glm::dvec3> vertices);

}  // namespace planet
