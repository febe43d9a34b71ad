#include "planet/patches/raster_frame.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/geodesy/utm.h"

namespace planet {

namespace {

// PROJ takes what is less far from WGS84 there, as do rasters (their longitude and latitude are those of WGS84).
bool on_another_planet(const Raster& raster) {
    return std::abs(raster.radius_m - wgs84.a) > 0.01 * wgs84.a;
}

}  // namespace

RasterFrame::RasterFrame(std::shared_ptr<const Raster> raster, MeshFrame frame, VerticalDatum datum,
                         std::shared_ptr<const Geoid> geoid, double exaggeration)
    : raster_(std::move(raster)),
      datum_(datum),
      geoid_(std::move(geoid)),
      exaggeration_(exaggeration),
      affine_(frame == MeshFrame::source || raster_->plain) {
    reference_.frame = frame;
    if (raster_->plain) {
        if (frame == MeshFrame::utm || frame == MeshFrame::ecef)
            throw Error(Fault::bad_usage, raster_->name, "has no place on the planet", "--frame source or enu");
        return;
    }
    if (on_another_planet(*raster_)) {
        if (frame != MeshFrame::source)
            throw Error(Fault::bad_usage, raster_->name,
                        "is on another planet, whose equator has a radius of " +
                            std::to_string(std::lround(raster_->radius_m / 1000)) + " km",
                        "--frame source, in a .ply or .obj");
    } else {
        reference_.vertical_datum = name_of(datum);
    }
    if (frame == MeshFrame::source) {
        reference_.crs = raster_->crs;
        reference_.geographic = raster_->geographic();
    } else {
        set_local_frame();
    }
}

void RasterFrame::set_local_frame() {
    const glm::dvec2 middle(0.5 * (raster_->width - 1), 0.5 * (raster_->height - 1));
    glm::dvec2 place;
    geodetic({&middle, 1}, {&place, 1});
    if (std::isnan(place.x + place.y))
        throw Error(Fault::bad_data, raster_->name, "has no place on the planet at its middle", "--frame source");
    const Geodetic g{place.y * degrees, place.x * degrees, {}};
    if (reference_.frame == MeshFrame::utm) {
        const Utm utm = utm_from_geodetic(g);
        zone_ = utm.zone;
        north_ = utm.north;
        reference_.crs = "EPSG:" + std::to_string(epsg_from_utm_zone(zone_, north_));
        return;
    }
    reference_.crs = "EPSG:4978";
    reference_.vertical_datum = name_of(VerticalDatum::ellipsoid);
    if (reference_.frame == MeshFrame::enu) {
        local_ = LocalFrame(wgs84, g);
        reference_.origin = local_.origin();
        reference_.ecef_from_enu = local_.ecef_from_enu_rotation();
    }
}

glm::dvec2 RasterFrame::metres_per_unit() const {
    if (!reference_.geographic) return {1, 1};
    const double latitude = raster_->grid.crs_from_sample({0, 0.5 * (raster_->height - 1)}).y;
    return {111320 * std::max(0.01, std::cos(latitude * degrees)), 110574};
}

void RasterFrame::geodetic(std::span<const glm::dvec2> at, std::span<glm::dvec2> longitude_latitude) const {
    for (std::size_t i = 0; i < at.size(); ++i) longitude_latitude[i] = raster_->grid.crs_from_sample(at[i] + first_);
    if (!raster_->geographic()) raster_->transform->geodetic_from_crs(longitude_latitude);
}

glm::dvec3 RasterFrame::in_utm(double latitude, double longitude, double height) const try {
    const Utm utm = utm_from_geodetic({latitude, longitude, {}}, zone_);
    const double other = utm.north == north_ ? 0 : north_ ? -1e7 : 1e7;  // northings run on across the equator
    return {utm.easting, utm.northing + other, height};
} catch (const Error&) {
    return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

void RasterFrame::place(std::span<const glm::dvec2> at, std::span<const double> height, std::span<glm::dvec3> position,
                        std::span<glm::vec3> up) const {
    if (affine_) {
        for (std::size_t i = 0; i < at.size(); ++i)
            position[i] = glm::dvec3(raster_->grid.crs_from_sample(at[i] + first_), exaggeration_ * height[i]);
        std::fill(up.begin(), up.end(), glm::vec3(0, 0, 1));
        return;
    }
    std::vector<glm::dvec2> places(at.size());
    geodetic(at, places);
    for (std::size_t i = 0; i < at.size(); ++i) {
        const double latitude = std::clamp(places[i].y, -90.0, 90.0) * degrees;
        const double longitude = places[i].x * degrees;
        if (reference_.frame == MeshFrame::utm) {
            position[i] = in_utm(latitude, longitude, exaggeration_ * height[i]);
            if (!up.empty()) up[i] = {0, 0, 1};
            continue;
        }
        const glm::dvec3 n = normal_from_geodetic(latitude, longitude);
        const double N = datum_ == VerticalDatum::egm96 && geoid_ ? geoid_->undulation(latitude, longitude).m : 0;
        const glm::dvec3 p = ecef_from_normal(wgs84, n, {exaggeration_ * height[i] + N});
        const bool enu = reference_.frame == MeshFrame::enu;
        position[i] = enu ? local_.enu_from_ecef(p) : p;
        if (!up.empty()) up[i] = glm::vec3(enu ? glm::transpose(local_.ecef_from_enu_rotation()) * n : n);
    }
}

}  // namespace planet
