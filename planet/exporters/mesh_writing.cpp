// What the formats have in common: names, frames, rounding.

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <filesystem>

#include "planet/error.h"
#include "planet/exporters/float_grid.h"
#include "planet/exporters/mesh_formats.h"
#include "planet/exporters/reference_text.h"

namespace planet {
namespace {

constexpr std::array<std::string_view, 4> endings{".glb", ".ply", ".obj", ".stl"};  // as in MeshFormat

std::string_view ending(MeshFormat format) {
    return endings[static_cast<std::size_t>(format)];
}

void check_triangles(const SurfaceMesh& mesh, MeshFormat format) {
    if (mesh.triangles.empty() || mesh.vertices.empty())
        throw Error(Fault::bad_data, ending(format), "the mesh has no triangles", "at least one");
    assert(mesh.vertices.size() < strip_restart);
}

// Half the gap between floats at the largest magnitude.
double float_rounding(double low, double high) {
    const float largest = static_cast<float>(std::max(std::abs(low), std::abs(high)));
    return 0.5 * static_cast<double>(std::nextafter(largest, 2e30f) - largest);
}

// To 24 bits, after Veltkamp: Dekker, "A floating-point technique for extending the available precision", Numerische
// Mathematik 18 (1971), equation 5.6. A conversion to float and back would say the same, were it not that GCC 12 takes it
// for nothing where it makes vectors of pairs (-O2).
double nearest_float(double v) {
    const double c = v * ((1 << 29) + 1);
    return c - (c - v);
}

// Moves every vertex to round(v) and measures by how much.
template <class Round>
MeshRounding round_vertices(SurfaceMesh& mesh, const Round& round) {
    glm::dvec3 moved(0);
    for (glm::dvec3& v : mesh.vertices) {
        const glm::dvec3 rounded(round(v.x), round(v.y), round(v.z));
        moved = glm::max(moved, glm::abs(rounded - v));
        v = rounded;
    }
    return {std::max(moved.x, moved.y), moved.z, 0};
}

double grid_step(const Bounds& bounds, double least_step) {
    return std::max(step_to_round(bounds), power_of_two_above(least_step));
}

}  // namespace

MeshFormat mesh_format(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    const auto found = std::find(endings.begin(), endings.end(), extension);
    if (found == endings.end()) throw Error(Fault::bad_usage, path, "is not a mesh format", ".glb, .ply, .obj or .stl");
    return static_cast<MeshFormat>(found - endings.begin());
}

void check_frame(const MeshReference& reference, MeshFormat format) {
    if (format == MeshFormat::glb && reference.geographic)
        throw Error(Fault::bad_usage, ending(format), "its coordinates are lengths, x and y here are degrees",
                    "frame enu, utm or ecef");
    if (format == MeshFormat::stl && reference.frame != MeshFrame::enu)
        throw Error(Fault::bad_usage, ending(format),
                    "frame " + std::string(to_string(reference.frame)) + " is not written", "frame enu");
}

MeshRounding rounding_bound(const glm::dvec3& low, const glm::dvec3& high, const MeshReference& reference,
                            MeshFormat format, double least_step) {
    check_frame(reference, format);
    if (format == MeshFormat::ply || format == MeshFormat::obj) return {};
    const glm::dvec3 corners[]{low, high};
    const Bounds bounds = bounds_of(corners, ending(format));
    if (format == MeshFormat::stl)
        return {std::max(float_rounding(low.x, high.x), float_rounding(low.y, high.y)), float_rounding(low.z, high.z),
                0};
    const double step = grid_step(bounds, least_step);
    return {step / 2, step / 2, step};
}

MeshRounding round_to_format(SurfaceMesh& mesh, const MeshReference& reference, MeshFormat format, double least_step) {
    check_frame(reference, format);
    check_triangles(mesh, format);
    if (format == MeshFormat::ply || format == MeshFormat::obj) return {};
    const Bounds bounds = bounds_of(mesh.vertices, ending(format));
    if (format == MeshFormat::stl) return round_vertices(mesh, nearest_float);
    const double step = grid_step(bounds, least_step), steps = 1 / step;
    MeshRounding rounding = round_vertices(mesh, [=](double v) { return std::rint(v * steps) * step; });
    rounding.step = step;
    return rounding;
}

void write_mesh(const ByteSink& sink, const SurfaceMesh& mesh, const MeshReference& reference, MeshFormat format,
                const std::optional<MeshRounding>& rounding, const MeshLooks& looks) {
    check_frame(reference, format);
    check_triangles(mesh, format);
    assert(looks.normals.empty() || looks.normals.size() == mesh.vertices.size());
    assert(looks.uv.empty() || looks.uv.size() == mesh.vertices.size());
    assert(looks.colors.empty() || looks.colors.size() == mesh.vertices.size());
    switch (format) {
        case MeshFormat::glb:
            return write_glb(sink, mesh, reference, rounding, looks);
        case MeshFormat::ply:
            return write_ply(sink, mesh, reference, looks);
        case MeshFormat::obj:
            return write_obj(sink, mesh, reference, looks);
        case MeshFormat::stl:
            return write_stl(sink, mesh, reference);
    }
}

void refuse_size(std::string_view format, std::string_view accepted) {
    throw Error(Fault::bad_data, format, "the mesh is too large for the format", accepted);
}

}  // namespace planet
