#include "render/app/refine_view.h"

#include <charconv>
#include <limits>
#include <numbers>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/utm.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFrame;

[[noreturn]] void refuse(const std::string& crs) {
    throw Error(Fault::bad_usage, "--view",
                crs.empty() ? "the mesh is at no known place" : "places are not known in " + crs.substr(0, 60),
                "a mesh of frame enu, ecef or utm, or in EPSG:4326");
}

/// 326zz and 327zz: the zone, and whether it is a northern one.
std::pair<int, bool> utm_zone(const std::string& crs) {
    int code = 0;
    if (!crs.starts_with("EPSG:")) refuse(crs);
    const auto [end, failed] = std::from_chars(crs.data() + 5, crs.data() + crs.size(), code);
    const int zone = code % 100;
    if (failed != std::errc{} || end != crs.data() + crs.size() || (code / 100 != 326 && code / 100 != 327) ||
        zone < 1 || zone > 60)
        refuse(crs);
    return {zone, code / 100 == 326};
}

/// At height 0 of the mesh's datum, in its coordinates.
glm::dvec3 place_in_mesh(const planet::Geodetic& place, const RefineMeaning& meaning) {
    const planet::MeshReference& reference = meaning.reference;
    const glm::dvec3 ecef = planet::ecef_from_geodetic(planet::wgs84, place);
    if (reference.frame == MeshFrame::ecef) return ecef;
    if (reference.frame == MeshFrame::enu) return glm::transpose(reference.ecef_from_enu) * (ecef - reference.origin);
    if (reference.geographic)
        return meaning.in_metres({place.longitude / planet::degrees, place.latitude / planet::degrees, 0});
    const auto [zone, north] = utm_zone(reference.crs);
    const planet::Utm utm = planet::utm_from_geodetic(place, zone);
    return {utm.easting, utm.northing + (utm.north == north ? 0 : north ? -1e7 : 1e7), 0};
}

}  // namespace

glm::dvec3 eye_of(const RefineView& view, const planet::Progressive& mesh, const RefineMeaning& meaning) {
    const bool ecef = meaning.reference.frame == MeshFrame::ecef;
    const glm::dvec3 foot = place_in_mesh(view.place, meaning);
    const glm::dvec3 up =
        ecef ? planet::normal_from_geodetic(view.place.latitude, view.place.longitude) : glm::dvec3(0, 0, 1);
    double nearest = std::numeric_limits<double>::infinity(), height = 0;
    for (const glm::dvec3& p : mesh.places()) {
        const glm::dvec3 away = p - foot;
        const double above = glm::dot(away, up), across = glm::length(away - above * up);
        // Not the other side of a planet.
        if ((ecef && glm::dot(p, up) < 0) || across >= nearest) continue;
        nearest = across;
        height = above;
    }
    return foot + (height + view.range) * up;
}

bool seen_coarse(const planet::Progressive& mesh, planet::Progressive::Index vertex, const glm::dvec3& eye) {
    const planet::SplitSide side = mesh.ends(vertex);
    const glm::dvec3 a = mesh.place(side.a), b = mesh.place(side.b);
    return glm::distance(a, b) > view_share * glm::distance(eye, (a + b) * 0.5);
}

}  // namespace render
