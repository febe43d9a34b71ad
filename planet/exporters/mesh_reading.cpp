// What the readers have in common: the file in memory, and the last checks.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>

#include "planet/error.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

constexpr std::string_view a_mesh_file = "a .glb, .ply, .obj or .stl file of triangles";

std::vector<std::uint8_t> bytes_of_file(const std::string& path) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) throw Error(Fault::bad_data, path, "no such file", a_mesh_file);
    if (!std::filesystem::is_regular_file(status)) throw Error(Fault::bad_data, path, "is not a file", a_mesh_file);
    std::ifstream in(path, std::ios::binary);
    const auto size = std::filesystem::file_size(path, failed);
    if (!in || failed) throw Error(Fault::bad_data, path, "cannot be read", a_mesh_file);
    std::vector<std::uint8_t> bytes(size);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::uintmax_t>(in.gcount()) != size) throw Error(Fault::bad_data, path, "cannot be read whole");
    return bytes;
}

ReadMesh read(std::span<const std::uint8_t> file, MeshFormat format) {
    switch (format) {
        case MeshFormat::glb:
            return read_glb(file);
        case MeshFormat::ply:
            return read_ply(file);
        case MeshFormat::obj:
            return read_obj(file);
        case MeshFormat::stl:
            break;
    }
    return read_stl(file);
}

void check(const SurfaceMesh& mesh) {
    if (mesh.triangles.empty()) throw MalformedBytes("has no triangles");
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t i : t)
            if (i >= mesh.vertices.size())
                throw MalformedBytes("a triangle has vertex " + std::to_string(i) + " of " +
                                     std::to_string(mesh.vertices.size()));
    for (const glm::dvec3& v : mesh.vertices)
        if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
            throw MalformedBytes("a coordinate is not finite");
}

// An attribute that some vertices lack is none.
template <class Vector>
void settle(std::vector<Vector>& attribute, std::size_t vertices) {
    if (attribute.size() != vertices) attribute.clear();
    for (const Vector& value : attribute)
        for (int i = 0; i < Vector::length(); ++i)
            if (!std::isfinite(value[i])) throw MalformedBytes("an attribute of a vertex is not finite");
}

void settle(MeshLooks& looks, std::size_t vertices) {
    settle(looks.normals, vertices);
    settle(looks.uv, vertices);
    settle(looks.colors, vertices);
}

}  // namespace

SurfaceMesh read_mesh(const std::string& path, MeshReference* reference, MeshLooks* looks) {
    return read_mesh(path, mesh_format(path), reference, looks);
}

SurfaceMesh read_mesh(const std::string& path, MeshFormat format, MeshReference* reference, MeshLooks* looks) {
    try {
        ReadMesh found = read(bytes_of_file(path), format);
        check(found.mesh);
        if (reference) *reference = std::move(found.reference);
        if (looks) {
            settle(found.looks, found.mesh.vertices.size());
            *looks = std::move(found.looks);
        }
        return std::move(found.mesh);
    } catch (const MalformedBytes& e) {
        throw Error(Fault::bad_data, path, e.what(), a_mesh_file);
    } catch (const std::bad_alloc&) {
        throw Error(Fault::bad_data, path, "does not fit into memory");
    }
}

}  // namespace planet
