#include "render/app/refine/refine_frame.h"

#include <cmath>

#include "planet/elevation/elevation_field.h"
#include "planet/error.h"
#include "planet/geodesy/local_frame.h"
#include "planet/geodesy/utm.h"
#include "render/app/data_path.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFormat;
using planet::MeshFrame;

constexpr std::string_view option = "--frame";

bool holds(MeshFormat format, const planet::MeshReference& reference) {
    const bool nowhere = reference.frame == MeshFrame::source && reference.crs.empty();
    if (format == MeshFormat::glb) return !reference.geographic;
    return format != MeshFormat::stl || reference.frame == MeshFrame::enu || nowhere;
}

glm::dvec3 middle_of(const planet::SurfaceMesh& mesh) {
    glm::dvec3 low = mesh.vertices[0], high = low;
    for (const glm::dvec3& v : mesh.vertices) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    return (low + high) * 0.5;
}

/// Heights above the ellipsoid are asked for, and these are above EGM96.
bool needs_geoid(const planet::MeshReference& from, MeshFrame to) {
    const bool ellipsoidal = from.frame == MeshFrame::enu || from.frame == MeshFrame::ecef ||
                             from.vertical_datum == planet::name_of(planet::VerticalDatum::ellipsoid);
    return to != MeshFrame::utm && !ellipsoidal;
}

}  // namespace

MeshFrame frame_for(const std::optional<MeshFrame>& asked, const planet::MeshReference& reference, MeshFormat format) {
    if (asked) return *asked;
    return holds(format, reference) ? reference.frame : MeshFrame::enu;
}

FrameChange::FrameChange(const planet::MeshReference& from, MeshFrame to, const planet::SurfaceMesh& mesh)
    : from_(from) {
    if (to == MeshFrame::source)
        throw Error(Fault::bad_usage, option, "the mesh's source is not known",
                    "enu, ecef or utm, or the frame it has");
    from_places_.emplace(
        from, option,
        needs_geoid(from, to) ? std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm")) : nullptr);
    const planet::Geodetic middle = from_places_->geodetic(middle_of(mesh));
    if (std::isnan(middle.latitude))
        throw Error(Fault::bad_usage, option, "the mesh's middle is no place on the Earth", "another mesh");
    to_.frame = to;
    to_.crs = "EPSG:4978";
    to_.vertical_datum = planet::name_of(planet::VerticalDatum::ellipsoid);
    if (to == MeshFrame::utm) {
        const planet::Utm utm = planet::utm_from_geodetic(middle);
        to_.crs = "EPSG:" + std::to_string(planet::epsg_from_utm_zone(utm.zone, utm.north));
        to_.vertical_datum = from.vertical_datum;
    } else if (to == MeshFrame::enu) {
        const planet::LocalFrame local(planet::wgs84, {middle.latitude, middle.longitude, {}});
        to_.origin = local.origin();
        to_.ecef_from_enu = local.ecef_from_enu_rotation();
    }
    to_places_.emplace(to_, option);
}

// A normal goes where a metre along it does.
void FrameChange::apply(planet::SurfaceMesh& mesh, planet::MeshLooks& looks) const {
    const glm::dvec2 metres = metres_per_unit(from_, mesh.vertices);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        glm::dvec3& p = mesh.vertices[v];
        const glm::dvec3 there = changed(p);
        if (std::isnan(there.x + there.y + there.z))
            throw Error(Fault::bad_usage, option, "does not reach all of the mesh", "another frame");
        if (!looks.normals.empty()) {
            const glm::dvec3 n(looks.normals[v]);
            const glm::dvec3 turned = changed(p + glm::dvec3(glm::dvec2(n) / metres, n.z)) - there;
            const double length = glm::length(turned);
            looks.normals[v] = length > 0 ? glm::vec3(turned / length) : glm::vec3(0);
        }
        p = there;
    }
}

}  // namespace render
