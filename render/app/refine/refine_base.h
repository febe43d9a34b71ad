#pragma once
// Meshes from files as longest-side bisection takes them, and back.

#include <optional>
#include <string>

#include "planet/bisection/plain_mesh.h"
#include "planet/exporters/mesh_file.h"

namespace render {

/// What the numbers of a PlainMesh mean. Its x and y are those of the file times metres_per_unit, so that shapes are judged
/// in metres where a file has degrees.
struct RefineMeaning {
    planet::MeshReference reference{};
    glm::dvec2 metres_per_unit{1};
    /// An .stl of ours: metres east, north and up of a place that its header has no room for.
    bool somewhere_local = false;
    /// Earth-centred, or local from an Earth-centred file: a planet or a part of one, without a plan. Places are
    /// ecef = origin + ecef_from_enu p.
    bool round = false;
    bool normals = false, uv = false, colors = false;  ///< which attributes vertices have, in this order

    glm::dvec3 in_file(const glm::dvec3& p) const { return {p.x / metres_per_unit.x, p.y / metres_per_unit.y, p.z}; }
    glm::dvec3 in_metres(const glm::dvec3& p) const { return {p.x * metres_per_unit.x, p.y * metres_per_unit.y, p.z}; }
};

struct RefineBase {
    planet::PlainMesh mesh;
    RefineMeaning meaning;
    std::string picture;     ///< of a .glb
    std::size_t welded = 0;  ///< vertices that went
};

/// Metres in a unit of x and of y: of degrees, near the middle of the mesh; else 1.
glm::dvec2 metres_per_unit(const planet::MeshReference& reference, const std::vector<glm::dvec3>& vertices);

/// Reads a mesh. @param weld joins vertices at the same place first @param frame asked for @param format to be written
/// Throws planet::Error: bad_data for what is no mesh, or no conforming one: its first offending side is named; bad_usage
/// for a frame in which it cannot be.
RefineBase read_refine_base(const std::string& path, bool weld, const std::optional<planet::MeshFrame>& frame,
                            planet::MeshFormat format);

/// As a file has it.
planet::SurfaceMesh surface_of(const planet::PlainMesh& mesh, const RefineMeaning& meaning);
/// Normals are made unit vectors again.
planet::MeshLooks looks_of(const planet::PlainMesh& mesh, const RefineMeaning& meaning);

/// The note of a progressive mesh, and back: lines "key value".
std::string note_from(const RefineMeaning& meaning);
/// @param attribute_width of the mesh that the note goes with. A note of others, or one that does not fit, says nothing of
/// attributes.
RefineMeaning meaning_from(const std::string& note, std::size_t attribute_width);

}  // namespace render
