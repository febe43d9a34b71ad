#include "planet/patches/raster_frame.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planet/error.h"

namespace planet {

namespace {

// Samples placed at once, whose angles stay in the processor's cache.
constexpr std::size_t batch = 256;

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
        set_parallels();
        return;
    }
    set_graticule();
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

void RasterFrame::place_in_utm(std::span<const glm::dvec2> at, std::span<const double> height,
                               std::span<glm::dvec3> position, std::span<glm::vec3> up) const {
    std::vector<glm::dvec2> places;
    if (!parallels_) {
        places.resize(at.size());
        geodetic(at, places);
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
        const UtmParallels::Place p = parallels_ ? on_parallel(at[i]) : in_utm(places[i]);
        position[i] = {p.easting, p.northing, exaggeration_ * height[i]};
    }
    std::fill(up.begin(), up.end(), glm::vec3(0, 0, 1));
}

UtmParallels::Place RasterFrame::on_parallel(const glm::dvec2& at) const {
    const glm::dvec2 p = at + first_;
    if (is_sample(at)) return parallels_->at(static_cast<int>(p.x), static_cast<int>(p.y));
    return in_utm(raster_->grid.crs_from_sample(p));
}

UtmParallels::Place RasterFrame::in_utm(const glm::dvec2& degrees_east_north) const {
    return utm_place(std::clamp(degrees_east_north.y, -90.0, 90.0) * degrees, degrees_east_north.x * degrees, zone_,
                     north_);
}

RasterFrame::Longitude RasterFrame::longitude_of(double degrees_east) {
    const double radians = degrees_east * degrees;
    return {radians, std::cos(radians), std::sin(radians)};
}

RasterFrame::Latitude RasterFrame::latitude_of(double degrees_north) {
    const double radians = std::clamp(degrees_north, -90.0, 90.0) * degrees;
    const double c = std::cos(radians), s = std::sin(radians), a2 = wgs84.a * wgs84.a, b2 = wgs84.b * wgs84.b;
    const double w = std::sqrt(a2 * (c * c) + b2 * (s * s));  // as in ecef_from_normal()
    return {radians, c, s, a2 / w, b2 / w};
}

bool RasterFrame::is_graticule() const {
    return raster_->geographic() && raster_->grid.per_column.y == 0 && raster_->grid.per_row.x == 0;
}

void RasterFrame::set_graticule() {
    if (!is_graticule()) return;
    const SampleGrid& grid = raster_->grid;
    auto graticule = std::make_shared<Graticule>();
    for (int x = 0; x < raster_->width; ++x) graticule->column.push_back(longitude_of(grid.crs_from_sample({x, 0}).x));
    for (int y = 0; y < raster_->height; ++y) graticule->row.push_back(latitude_of(grid.crs_from_sample({0, y}).y));
    graticule_ = std::move(graticule);
}

void RasterFrame::set_parallels() {
    if (!is_graticule()) return;
    const SampleGrid& grid = raster_->grid;
    std::vector<double> latitudes;
    for (int y = 0; y < raster_->height; ++y)
        latitudes.push_back(std::clamp(grid.crs_from_sample({0, y}).y, -90.0, 90.0) * degrees);
    const UtmParallels::Columns columns{grid.crs_from_sample({0, 0}).x * degrees, grid.per_column.x * degrees,
                                        raster_->width};
    if (auto found = UtmParallels::make(zone_, north_, columns, latitudes))
        parallels_ = std::make_shared<const UtmParallels>(std::move(*found));
}

// Not between samples, and not beyond the raster.
bool RasterFrame::is_sample(const glm::dvec2& at) const {
    const glm::dvec2 p = at + first_;
    return (p.x >= 0) & (p.y >= 0) & (p.x <= raster_->width - 1) & (p.y <= raster_->height - 1) &
           (p.x == std::floor(p.x)) & (p.y == std::floor(p.y));
}

bool RasterFrame::all_in_graticule(std::span<const glm::dvec2> at) const {
    bool all = graticule_ != nullptr;
    for (const glm::dvec2& p : at) all &= is_sample(p);
    return all;
}

// Longitude and latitude of the i-th place. At most a batch of them.
template <class LongitudeOf, class LatitudeOf>
void RasterFrame::place_at(const LongitudeOf& longitude, const LatitudeOf& latitude, std::span<const double> height,
                           std::span<glm::dvec3> position, std::span<glm::vec3> up) const {
    const std::size_t n = height.size();
    std::array<GeoidUndulation, batch> undulation{};
    if (datum_ == VerticalDatum::egm96 && geoid_) {
        std::array<double, batch> north, east;
        for (std::size_t i = 0; i < n; ++i) {
            north[i] = latitude(i).radians;
            east[i] = longitude(i).radians;
        }
        geoid_->undulations({north.data(), n}, {east.data(), n}, std::span(undulation).first(n));
    }
    const bool enu = reference_.frame == MeshFrame::enu;
    const glm::dmat3 enu_from_ecef = glm::transpose(local_.ecef_from_enu_rotation());
    for (std::size_t i = 0; i < n; ++i) {
        const Longitude& east = longitude(i);
        const Latitude& north = latitude(i);
        const glm::dvec3 normal(north.cosine * east.cosine, north.cosine * east.sine, north.sine);
        const double h = exaggeration_ * height[i] + undulation[i].m;
        const glm::dvec3 p(glm::dvec2(normal) * (north.to_axis + h), normal.z * (north.to_equator + h));
        position[i] = enu ? enu_from_ecef * (p - local_.origin()) : p;
        if (!up.empty()) up[i] = glm::vec3(enu ? enu_from_ecef * normal : normal);
    }
}

void RasterFrame::place_on_ellipsoid(std::span<const glm::dvec2> at, std::span<const double> height,
                                     std::span<glm::dvec3> position, std::span<glm::vec3> up) const {
    if (all_in_graticule(at)) {
        const Longitude* column = graticule_->column.data() + static_cast<std::ptrdiff_t>(first_.x);
        const Latitude* row = graticule_->row.data() + static_cast<std::ptrdiff_t>(first_.y);
        place_at([&](std::size_t i) -> const Longitude& { return column[static_cast<std::ptrdiff_t>(at[i].x)]; },
                 [&](std::size_t i) -> const Latitude& { return row[static_cast<std::ptrdiff_t>(at[i].y)]; }, height,
                 position, up);
        return;
    }
    std::array<glm::dvec2, batch> places;
    std::array<Longitude, batch> longitude;
    std::array<Latitude, batch> latitude;
    geodetic(at, std::span(places).first(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) {
        longitude[i] = longitude_of(places[i].x);
        latitude[i] = latitude_of(places[i].y);
    }
    place_at([&](std::size_t i) -> const Longitude& { return longitude[i]; },
             [&](std::size_t i) -> const Latitude& { return latitude[i]; }, height, position, up);
}

void RasterFrame::place(std::span<const glm::dvec2> at, std::span<const double> height, std::span<glm::dvec3> position,
                        std::span<glm::vec3> up) const {
    if (affine_) {
        for (std::size_t i = 0; i < at.size(); ++i)
            position[i] = glm::dvec3(raster_->grid.crs_from_sample(at[i] + first_), exaggeration_ * height[i]);
        std::fill(up.begin(), up.end(), glm::vec3(0, 0, 1));
        return;
    }
    if (reference_.frame == MeshFrame::utm) return place_in_utm(at, height, position, up);
    for (std::size_t i = 0; i < at.size(); i += batch) {
        const std::size_t n = std::min(batch, at.size() - i);
        place_on_ellipsoid(at.subspan(i, n), height.subspan(i, n), position.subspan(i, n),
                           up.empty() ? up : up.subspan(i, n));
    }
}

}  // namespace planet
