#include "render/app/mesh/mesh_places.h"

#include <charconv>
#include <limits>
#include <string>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/utm.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::Geodetic;
using planet::MeshFrame;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const std::string& crs, std::string_view where) {
    throw Error(Fault::bad_usage, where,
                crs.empty() ? "the mesh is at no known place" : "places are not known in " + crs.substr(0, 60),
                "a mesh of frame enu, ecef or utm, or in EPSG:4326");
}

/// 326zz and 327zz: the zone, 0 for UPS (61), and whether it is a northern one.
std::pair<int, bool> utm_zone(const std::string& crs, std::string_view where) {
    int code = 0;
    if (!crs.starts_with("EPSG:")) refuse(crs, where);
    const auto [end, failed] = std::from_chars(crs.data() + 5, crs.data() + crs.size(), code);
    const int zone = code % 100;
    if (failed != std::errc{} || end != crs.data() + crs.size() || (code / 100 != 326 && code / 100 != 327) ||
        zone < 1 || zone > 61)
        refuse(crs, where);
    return {zone % 61, code / 100 == 326};
}

}  // namespace

MeshPlaces::MeshPlaces(const planet::MeshReference& reference, std::string_view where,
                       std::shared_ptr<const planet::Geoid> geoid)
    : reference_(reference), geoid_(std::move(geoid)) {
    const bool flat = reference.frame == MeshFrame::source || reference.frame == MeshFrame::utm;
    if (flat && !reference.geographic) std::tie(zone_, north_) = utm_zone(reference.crs, where);
}

// Northings run on across the equator.
Geodetic MeshPlaces::flat_geodetic(const glm::dvec3& p) const try {
    if (reference_.geographic)
        return std::abs(p.y) <= 90 ? Geodetic{p.y * planet::degrees, p.x * planet::degrees, {p.z}}
                                   : Geodetic{nan, nan, {nan}};
    Geodetic g = planet::geodetic_from_utm({zone_, north_, p.x, p.y});
    g.h.m = p.z;
    return g;
} catch (const Error&) {
    return {nan, nan, {nan}};
}

Geodetic MeshPlaces::geodetic(const glm::dvec3& p) const {
    if (reference_.frame == MeshFrame::ecef) return planet::geodetic_from_ecef(planet::wgs84, p);
    if (reference_.frame == MeshFrame::enu)
        return planet::geodetic_from_ecef(planet::wgs84, reference_.origin + reference_.ecef_from_enu * p);
    Geodetic g = flat_geodetic(p);
    if (geoid_) g.h.m += geoid_->undulation(g.latitude, g.longitude).m;
    return g;
}

glm::dvec3 MeshPlaces::in_mesh(const Geodetic& place) const try {
    const bool flat = reference_.frame == MeshFrame::source || reference_.frame == MeshFrame::utm;
    if (!flat) {
        const glm::dvec3 ecef = planet::ecef_from_geodetic(planet::wgs84, place);
        return reference_.frame == MeshFrame::ecef
                   ? ecef
                   : glm::transpose(reference_.ecef_from_enu) * (ecef - reference_.origin);
    }
    const double N = geoid_ ? geoid_->undulation(place.latitude, place.longitude).m : 0;
    if (reference_.geographic)
        return {place.longitude / planet::degrees, place.latitude / planet::degrees, place.h.m - N};
    const planet::Utm utm = planet::utm_from_geodetic(place, zone_);
    const double across = utm.north == north_ ? 0 : zone_ == 0 ? nan : north_ ? -1e7 : 1e7;
    return {utm.easting, utm.northing + across, place.h.m - N};
} catch (const Error&) {
    return glm::dvec3(nan);
}

}  // namespace render
