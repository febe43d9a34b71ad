#include "render/app/view/view_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "planet/geodesy/geodetic.h"
#include "render/app/figures.h"

namespace render {

namespace {

using planet::degrees;

/// How far a view may be off, pixels.
constexpr double rounding_px = 1e-3;

/// Decimals after which less than `step` is left.
int decimals_for(double step) {
    return std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 12);
}

double rounded(double value, int decimals) {
    const std::string text = fixed(value, decimals);
    double result = value;
    std::from_chars(text.data(), text.data() + text.size(), result);
    return result;
}

/// An angle in radians as the text of degrees that is parsed to it: text * degrees has rounded once.
std::string degrees_text(double angle) {
    const std::string plain = exact(angle / degrees);
    for (int decimals = 0; decimals <= 15; ++decimals) {
        const std::string text = fixed(angle / degrees, decimals);
        if (std::strtod(text.c_str(), nullptr) * degrees == angle) return text;
    }
    return plain;
}

/// Fit for a shell.
std::string quoted(const std::string& text) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%#";
    const bool comment = text.starts_with('#');  // within a word it is none
    if (!text.empty() && !comment && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string q = "'";
    for (const char c : text) q += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return q + "'";
}

std::string shown_overlays(const RenderOptions& o) {
    std::string list;
    for (const auto& [name, overlay] : overlay_names)
        if (o.shows(overlay)) list.append(list.empty() ? "" : ",").append(name);
    return list;
}

}  // namespace

RenderOptions options_of_pose(const RenderOptions& options, const DrawnSurface& surface, const Pose& pose) {
    RenderOptions o = options;
    const double focal = focal_length_px(o.fov, o.size.width, o.size.height);
    const double clearance = std::max(pose.h - surface.ground(pose.normal), least_clearance_m);
    const double step_m = rounding_px * clearance / focal, step_rad = rounding_px / focal;
    const planet::Geodetic at = planet::geodetic_from_normal(pose.normal);
    const int place = decimals_for(step_m / (planet::wgs84.a * degrees)), turn = decimals_for(step_rad / degrees);
    o.at = {rounded(at.latitude / degrees, place) * degrees, rounded(at.longitude / degrees, place) * degrees, {}};
    const double ground = surface.ground(planet::normal_from_geodetic(o.at.latitude, o.at.longitude));
    o.height = std::max(rounded(pose.h - ground, decimals_for(step_m)), 0.1);
    o.range.reset();
    o.heading = std::fmod(rounded(pose.heading / degrees, turn), 360.0) * degrees;
    o.pitch = std::clamp(rounded(pose.pitch / degrees, turn), -90.0, 90.0) * degrees;
    return o;
}

std::string render_line(const RenderOptions& o) {
    const RenderOptions usual;
    std::string line = "octaglobe render";
    const auto add = [&](const std::string& name, const std::string& value) {
        line += " " + name + " " + quoted(value);
    };
    add("--at", degrees_text(o.at.latitude) + "," + degrees_text(o.at.longitude));
    if (o.height) add("--height", exact(*o.height));
    if (o.range) add("--range", exact(*o.range));
    if (o.heading != usual.heading) add("--heading", degrees_text(o.heading));
    add("--pitch", degrees_text(o.pitch));
    if (o.fov != usual.fov) add("--fov", degrees_text(o.fov));
    add("--size", std::to_string(o.size.width) + "x" + std::to_string(o.size.height));
    add("--time", planet::iso8601_from_utc(o.time));
    if (o.exaggeration != usual.exaggeration) add("--exaggeration", exact(o.exaggeration));
    if (o.max_pixel_deviation != usual.max_pixel_deviation) add("--max-pixel-deviation", exact(o.max_pixel_deviation));
    if (o.max_triangles) add("--max-triangles", std::to_string(*o.max_triangles));
    if (o.show != 0) add("--show", shown_overlays(o));
    if (o.drawn_scale() != 1) add("--scale", exact(*o.scale));
    if (o.samples != 0) add("--samples", std::to_string(o.samples));
    if (o.store) add("--store", o.store->native());
    for (const auto& [name, files] :
         {std::pair("--elevation", &o.earth.elevation), std::pair("--imagery", &o.imagery)}) {
        if (files->empty()) continue;
        line += std::string(" ") + name;
        for (const auto& file : *files) line += " " + quoted(file.native());
    }
    for (const LayerOptions& layer : o.layers)
        if (layer.shown) add("--layer", layer_text(layer));
    if (!o.earth.elevation.empty() && o.earth.elevation_datum != usual.earth.elevation_datum)
        add("--elevation-datum", "ellipsoid");
    return line;
}

Pose pose_of_camera(const Camera& camera) {
    const glm::dmat3 axes = glm::transpose(camera.view_from_ecef);
    return pose_from(camera.eye, -axes[2], axes[1]);
}

}  // namespace render
