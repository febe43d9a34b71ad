#include "render/layers/graticule.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/horizon.h"

namespace render {

namespace {

using planet::degrees;
using planet::wgs84;

std::string degrees_text(long minutes) {
    const std::string text = std::to_string(minutes / 60) + "\xc2\xb0";
    return minutes % 60 == 0 ? text : text + " " + std::to_string(minutes % 60) + "\xe2\x80\xb2";
}

std::string parallel_name(double latitude) {
    const auto minutes = std::lround(std::abs(latitude) / degrees * 60);
    return minutes == 0 ? "Equator" : degrees_text(minutes) + (latitude < 0 ? " S" : " N");
}

std::string meridian_name(double longitude) {
    const double turned = std::remainder(longitude, 360 * degrees);
    const auto minutes = std::lround(std::abs(turned) / degrees * 60);
    if (minutes == 0) return "Prime Meridian";
    return minutes == 180 * 60 ? degrees_text(minutes) : degrees_text(minutes) + (turned < 0 ? " W" : " E");
}

}  // namespace

double graticule_step(const Camera& camera, double pixel_scale) {
    constexpr double least_px = 110;
    constexpr double steps[] = {1 / 60.0, 2 / 60.0, 5 / 60.0, 10 / 60.0, 0.5, 1, 2, 5, 10, 15, 30};
    const double height = std::max(planet::height_from_ecef(planet::wgs84, camera.eye).m, 1.0);
    for (const double step : steps)
        if (step * planet::degrees * planet::wgs84.a * camera.focal_px / pixel_scale / height > least_px)
            return step * planet::degrees;
    return 30 * planet::degrees;
}

std::vector<LayerName> graticule_names(const Camera& camera, double step) {
    constexpr int most_lines = 12;  // on either side of the middle
    constexpr double least_slant = 0.25, last_parallel = 89 * degrees;
    const glm::dvec3 ahead = -glm::transpose(camera.view_from_ecef)[2];
    const auto distance = planet::distance_to_ellipsoid(wgs84, camera.eye, ahead);
    if (!distance) return {};
    const planet::Geodetic about =
        planet::geodetic_from_normal(planet::normal_from_ecef(wgs84, camera.eye + *distance * ahead));
    const double parallel = std::round(about.latitude / step) * step,
                 meridian = std::round(about.longitude / step) * step;
    std::vector<LayerName> names;
    const auto add = [&](double latitude, double longitude, std::string text) {
        if (std::abs(latitude) > last_parallel) return;
        const glm::dvec3 normal = planet::normal_from_geodetic(latitude, longitude);
        const glm::dvec3 to_eye = camera.eye - planet::ecef_from_normal(wgs84, normal);
        if (glm::dot(glm::normalize(to_eye), normal) < least_slant) return;
        names.push_back({std::move(text), normal, LayerName::Place::above_right});
    };
    add(parallel, meridian, parallel_name(parallel));
    // Where lines cross there is room for one name: the middle meridian has its own halfway to the next parallel.
    add(parallel + std::copysign(0.5 * step, about.latitude - parallel), meridian, meridian_name(meridian));
    for (int line = 1; line <= most_lines; ++line)
        for (const int i : {line, -line}) {
            const double longitude = meridian + i * step;
            add(parallel + i * step, meridian, parallel_name(parallel + i * step));
            if (line * step < 180 * degrees) add(parallel, longitude, meridian_name(longitude));
        }
    return names;
}

}  // namespace render
