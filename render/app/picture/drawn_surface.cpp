#include "render/app/picture/drawn_surface.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/geoid.h"
#include "planet/octahedron/cell_metrics.h"
#include "render/app/data_path.h"

namespace render {

namespace {

using planet::wgs84;

/// No geoid of the Earth lies deeper below the ellipsoid, m: EGM96 goes down to -107.
constexpr double deepest_geoid_m = 120;
constexpr double highest_ground_m = 9000;

}  // namespace

DrawnSurface::DrawnSurface(std::shared_ptr<const planet::ElevationStore> s, const RenderOptions& options)
    : store(s),
      exaggeration(options.exaggeration),
      field(s, options.memory_bytes),
      tiles(field.cache(), {store->metadata().ellipsoid, exaggeration}) {
    if (!store->metadata().undulation.empty()) geoid.emplace(data_file("egm96-15.pgm"));
}

PatchSurface DrawnSurface::for_patches() const {
    return {.heights = [this](auto normals, auto heights) { field.heights(normals, heights); },
            .spacing =
                [this](const glm::dvec3& normal) {
                    planet::SurfaceCursor cursor = field.cursor();
                    cursor.seek(normal);
                    return planet::cell_metrics(cursor.cell().bisection_level()).vertex_spacing * wgs84.mean_radius();
                }};
}

double DrawnSurface::occluder_radius() const {
    double lowest = 0;
    for (int face = 0; face < planet::face_count; ++face)
        if (const auto tile = field.cache().tile(planet::LocationCode::face_root(face)))
            lowest = std::min(lowest, static_cast<double>(tile->min_height) * exaggeration);
    return store->metadata().ellipsoid.b + lowest - deepest_geoid_m;
}

double DrawnSurface::ground(const glm::dvec3& normal, double exaggerated) const {
    const double undulation = geoid ? geoid->undulation(normal).m : 0;
    return static_cast<double>(field.height(normal)) * exaggerated + undulation;
}

glm::dvec3 DrawnSurface::above_ground(const glm::dvec3& eye, double exaggerated, double clearance_m) const {
    const planet::NormalPosition p = planet::position_from_ecef(wgs84, eye);
    const double floor = ground(p.normal, exaggerated) + clearance_m;
    return p.h.m < floor ? planet::ecef_from_normal(wgs84, p.normal, {floor}) : eye;
}

DrapeGround DrawnSurface::for_layers(const planet::Segments& segments, const Camera& camera, const PicturePart& part,
                                     double scale) const {
    const int border = static_cast<int>(
        64 * std::max(scale, 1.0));  // of what reaches into the part from beside it, such as wide lines and labels
    const PicturePart wider{part.x - border, part.y - border, part.width + 2 * border, part.height + 2 * border};
    return {.drawn = planet::SegmentSurface(segments),
            .height = [this](const glm::dvec3& normal) { return ground(normal); },
            .culling = camera.culling(wider, occluder_radius()),
            .relief_m = highest_ground_m * std::max(exaggeration, 1.0) + deepest_geoid_m};
}

Camera DrawnSurface::camera(const RenderOptions& o) const {
    const glm::dvec3 n = planet::normal_from_geodetic(o.at.latitude, o.at.longitude);
    const double ground_h = ground(n);
    glm::dvec3 eye;
    if (o.height) {
        eye = planet::ecef_from_normal(wgs84, n, {ground_h + *o.height});
    } else {
        const double range = o.range.value_or(whole_globe_range(o.fov));
        eye = planet::ecef_from_normal(wgs84, n, {ground_h}) - range * look_direction(n, o.heading, o.pitch);
        // A shallow view can start inside a mountain: the eye then stands on it.
        eye = above_ground(eye, exaggeration, std::min(2.0, range));
    }
    return make_camera(eye, n, o.heading, o.pitch, focal_length_px(o.fov, o.size.width, o.size.height), o.size.width,
                       o.size.height);
}

}  // namespace render
