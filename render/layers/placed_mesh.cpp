#include "render/layers/placed_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/utm.h"

namespace render {

namespace {

using planet::degrees;
using planet::Error;
using planet::Fault;
using planet::MeshFrame;
using planet::MeshReference;
using planet::NormalPosition;
using planet::wgs84;

constexpr std::string_view accepted = "a .glb, .ply or .obj of octaglobe in enu, ecef, utm, or longitude and latitude";

/// A zone by its EPSG code, if a CRS is UTM on WGS84.
std::optional<planet::Utm> utm_of(const std::string& crs) {
    int code = 0;
    if (!crs.starts_with("EPSG:") || std::from_chars(crs.data() + 5, crs.data() + crs.size(), code).ec != std::errc())
        return std::nullopt;
    const int zone = code % 100;
    if ((code / 100 != 326 && code / 100 != 327) || zone < 1 || zone > 60) return std::nullopt;
    return planet::Utm{.zone = zone, .north = code / 100 == 326};
}

/// From a vertex to its normal and its height as the file has it, above whatever datum.
std::function<NormalPosition(const glm::dvec3&)> placement(const MeshReference& r, const std::string& file) {
    const bool located = glm::length(r.origin) > 0.5 * wgs84.b;
    if (r.frame == MeshFrame::ecef) return [](const glm::dvec3& v) { return planet::position_from_ecef(wgs84, v); };
    if (r.frame == MeshFrame::enu && located)
        return [r](const glm::dvec3& v) { return planet::position_from_ecef(wgs84, r.origin + r.ecef_from_enu * v); };
    if (const auto utm = utm_of(r.crs); utm && !r.geographic && r.frame != MeshFrame::enu)
        return [utm](const glm::dvec3& v) {
            planet::Utm at = *utm;
            at.easting = v.x, at.northing = v.y;
            const planet::Geodetic g = planet::geodetic_from_utm(at);
            return NormalPosition{planet::normal_from_geodetic(g.latitude, g.longitude), {v.z}};
        };
    if (r.frame == MeshFrame::source && r.geographic)
        return [](const glm::dvec3& v) {
            return NormalPosition{planet::normal_from_geodetic(v.y * degrees, v.x * degrees), {v.z}};
        };
    throw Error(Fault::bad_data, file, "does not say where on the Earth its mesh is", accepted);
}

}  // namespace

PlacedMesh::PlacedMesh(const planet::SurfaceMesh& mesh, const MeshReference& reference,
                       std::span<const glm::vec4> colors, const planet::Geoid& geoid, const std::string& file,
                       MeshTexture texture)
    : has_colors_(!colors.empty()), triangles_(mesh.triangles), texture_(std::move(texture)) {
    const auto place = placement(reference, file);
    // Positions about the planet's centre have ellipsoidal heights, whatever those of the source were.
    const bool ellipsoidal = reference.frame == MeshFrame::ecef || reference.frame == MeshFrame::enu ||
                             reference.vertical_datum == "ellipsoid";
    places_.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::dvec3& v = mesh.vertices[i];
        const NormalPosition at = place(v);
        if (!(std::abs(at.h.m) < 1e5) || !std::isfinite(at.normal.x))
            throw Error(Fault::bad_data, file, "has vertices that are not on the Earth's ground", accepted);
        const double undulation = geoid.undulation(at.normal).m;
        const glm::u16vec4 color(has_colors_ ? 65535.0f * glm::clamp(colors[i], 0.0f, 1.0f) + 0.5f : glm::vec4(0));
        places_.push_back(
            {at.normal, ellipsoidal ? at.h.m - undulation : at.h.m, undulation, {color.r, color.g, color.b, color.a}});
    }
}

bool PlacedMesh::repeats_picture() const {
    return std::ranges::any_of(texture_.uv,
                               [](const glm::vec2& uv) { return uv != glm::clamp(uv, glm::vec2(0), glm::vec2(1)); });
}

std::vector<PlacedMesh::Vertex> PlacedMesh::vertices(double exaggeration) const {
    std::vector<glm::dvec3> points;
    points.reserve(places_.size());
    for (const Place& p : places_)
        points.push_back(planet::ecef_from_normal(wgs84, p.normal, {p.undulation + exaggeration * p.height}));
    std::vector<glm::dvec3> normals(points.size(), glm::dvec3(0));
    for (const auto& [a, b, c] : triangles_) {
        const glm::dvec3 across = glm::cross(points[b] - points[a], points[c] - points[a]);
        for (const std::uint32_t i : {a, b, c}) normals[i] += across;
    }
    std::vector<Vertex> list;
    list.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double length = glm::length(normals[i]);
        list.push_back({planet::grid_from_ecef(points[i]),
                        glm::vec3(length > 0 ? normals[i] / length : places_[i].normal),
                        static_cast<float>(places_[i].height), places_[i].color,
                        texture_.uv.empty() ? glm::vec2(0) : texture_.uv[i]});
    }
    return list;
}

}  // namespace render
