#pragma once
// Mesh files: .glb, .ply, .obj and .stl, written and read.
//
//          coordinates                frames                            says its frame, CRS and datum in
//   .ply   double                     all                               comments of the header
//   .obj   shortest exact decimals    all                               comments at its head
//   .glb   float offsets on a grid    all but degrees                   asset.extras
//   .stl   float                      enu                               the 80 bytes of its header, cut off
//
// Attributes of vertices (MeshLooks) are in a .glb as NORMAL, TEXCOORD_0 and COLOR_0, in a .ply as nx ny nz, s t and red green
// blue alpha, in an .obj as vn, vt and three numbers more behind v; an .stl has none.
//
// A .glb is y-up as glTF wants: its (x, y, z) are (x, z, -y) of the frame, for enu and utm east, up, south. So they are for
// ecef, which is how 3D Tiles reads a .glb: ecef = (x, -z, y). The root node's translation, in double, is the origin of the
// float offsets. Vertices and origin lie on one grid of a power of two on which each coordinate spans at most 24 bits, sign
// included: a 95 km tile has 1/128 m, a planet 1 m. So origin + offset is the rounded vertex exactly, and files with grids
// of the same step share the bits of their borders, whatever their origins.

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "planet/mesh/surface_mesh.h"

namespace planet {

enum class MeshFormat { glb, ply, obj, stl };

/// By the path's ending, in any case. Throws Error(bad_usage) naming what would be accepted.
MeshFormat mesh_format(const std::string& path);

/// Throws Error(bad_usage) if the format cannot hold the frame: degrees in a .glb, other than enu in an .stl.
void check_frame(const MeshReference& reference, MeshFormat format);

/// How far rounding to a format moves a vertex at most, along each axis; in the units of the frame.
struct MeshRounding {
    double xy = 0;    ///< x and y
    double z = 0;     ///< z
    double step = 0;  ///< of the grid on which all coordinates lie; 0 where the format has none
};

/// The most that round_to_format() can move any vertex of a mesh whose bounds are low and high: known before there is a
/// mesh. Throws as round_to_format() does.
MeshRounding rounding_bound(const glm::dvec3& low, const glm::dvec3& high, const MeshReference& reference,
                            MeshFormat format, double least_step = 0);

/// Rounds the vertices in place to what the format will hold, so that deviations can be measured on the very numbers
/// written, and says by how much it moved them. Vertices closer than a step may fall together.
/// @param least_step of a .glb's grid, rounded up to a power of two. Neighbouring tiles that differ in size share the bits
///                   of their border only on grids of one step.
/// Throws as check_frame() does, and Error(bad_data) for a mesh without triangles or with coordinates beyond 1e30.
MeshRounding round_to_format(SurfaceMesh& mesh, const MeshReference& reference, MeshFormat format,
                             double least_step = 0);

/// What a file holds besides places and triangles; an .stl leaves it out, and only a .glb holds a picture.
struct MeshLooks {
    std::vector<glm::vec3> normals = {};  ///< by vertex, of unit length, in the frame; or empty
    std::vector<glm::vec2> uv = {};       ///< by vertex, from the top left corner of the picture; or empty
    /// By vertex, red, green, blue, alpha, 0..1, as the file has them; or empty. A .ply holds 8 bits of each, an .obj no alpha.
    std::vector<glm::vec4> colors = {};
    std::string picture = {};  ///< the bytes of a PNG or JPEG file; or empty
    /// What colours and the picture are multiplied with, linear: as read, not written. Where the materials of a .glb
    /// differ in it, the colours are multiplied already.
    glm::vec4 base_color = glm::vec4(1);
};

/// Of each channel of the base colour, linear, that a .glb is written with where nothing is known of the mesh's colours.
inline constexpr double unknown_color = 0.6;

/// Takes the bytes of a file in order, some 1 MB or more at a time. What it throws passes through write_mesh().
using ByteSink = std::function<void(std::string_view)>;

/// Writes triangles in the order of the mesh; levels and strips are not written. Needs no memory to speak of.
/// @param mesh     as round_to_format() left it. Else each coordinate becomes the nearest one that the format holds.
/// @param rounding what round_to_format() said: a .glb tells it. @param looks of a .glb, .ply or .obj
/// Throws as check_frame() does, Error(bad_data) for a mesh without triangles, too large for the format, or (.glb, .stl)
/// with coordinates beyond 1e30.
void write_mesh(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, MeshFormat format,
                const std::optional<MeshRounding>& rounding = std::nullopt, const MeshLooks& looks = {});

/// Reads a mesh file of the format that the path's ending names: what write_mesh() writes, and of what others write
///   .ply   ascii, little- and big-endian; any scalar types; polygons, as fans; other elements are skipped
///   .glb   any scenes of nodes with triangles, strips and fans; no extensions of geometry, sparse accessors, or other files
///   .obj   v and f of any kind, polygons as fans; all else is skipped
///   .stl   binary and ascii; corners at the same place become one vertex
/// Triangles are as the file has them: nothing is joined, turned or left out. Levels and strips stay empty.
/// @param reference if given, what the file says of its coordinates, as far as it does.
/// @param looks if given, the attributes that all vertices have. Of an .obj vertex with several normals or texture coordinates
///              these are those of its first corner. The picture is that of a .glb's first triangles.
/// Throws Error(bad_data) for a file that is not there, damaged, has no triangles, coordinates that are not finite, or so
/// many instances that it has more vertices than bytes. Memory stays within some 100 times the file's size.
SurfaceMesh read_mesh(const std::string& path, MeshReference* reference = nullptr, MeshLooks* looks = nullptr);
/// The same of a file whose name may end in anything.
SurfaceMesh read_mesh(const std::string& path, MeshFormat format, MeshReference* reference = nullptr,
                      MeshLooks* looks = nullptr);

/// Whether a file that write_mesh() has written has just the triangles of a mesh, in their order, each corner to the bit.
/// @param mesh as round_to_format() left it. A .glb or .ply that is damaged throws as read_mesh() does.
bool file_holds(const std::string& path, MeshFormat format, const SurfaceMesh& mesh);

}  // namespace planet
