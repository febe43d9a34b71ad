#pragma once
// The writer and the reader of each format, behind mesh_file.h.

#include <bit>
#include <cstdint>
#include <span>

#include "planet/exporters/mesh_file.h"

namespace planet {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");

// Writers. The mesh has triangles, and the format holds the frame.
void write_glb(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference,
               const std::optional<MeshRounding>& rounding, const MeshLooks& looks);
void write_ply(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, const MeshLooks& looks);
void write_obj(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, const MeshLooks& looks);
void write_stl(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference);

struct ReadMesh {
    SurfaceMesh mesh;
    MeshReference reference;
    MeshLooks looks = {};  ///< arrays of other lengths than that of the vertices are none
};

// Readers, of a whole file. They throw MalformedBytes; read_mesh() checks indices and coordinates.
ReadMesh read_glb(std::span<const std::uint8_t> file);
ReadMesh read_ply(std::span<const std::uint8_t> file);
ReadMesh read_obj(std::span<const std::uint8_t> file);
ReadMesh read_stl(std::span<const std::uint8_t> file);

/// Throws Error(bad_data).
[[noreturn]] void refuse_size(std::string_view format, std::string_view accepted);

}  // namespace planet
