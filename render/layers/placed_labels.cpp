#include "render/layers/placed_labels.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geodetic.h"

namespace render {

namespace {

using planet::wgs84;

constexpr std::size_t most_labels = 400;
constexpr double gap_px = 6, beside_mark_px = 4.5;
constexpr glm::dvec2 above_right_px(6, -10);

struct Box {
    double left, top, right, bottom;
    bool touches(const Box& other, double gap) const {
        return left < other.right + gap && other.left < right + gap && top < other.bottom + gap &&
               other.top < bottom + gap;
    }
};

/// From a name's place to its text's left middle, pixels.
/// @param mark_px radius, at the usual size
glm::dvec2 offset(LayerName::Place place, double width, double size, double mark_px) {
    const double scale = size / label_size_px;
    if (place == LayerName::Place::beside_mark) return {(mark_px + beside_mark_px) * scale, 0};
    if (place == LayerName::Place::above_right) return {above_right_px.x * scale, above_right_px.y * scale};
    return {-0.5 * width, 0};
}

/// Whether the ground hides a place from the eye: looked at in steps that grow with the distance from the place.
bool is_hidden(const glm::dvec3& place, const Camera& camera, const DrapeGround& ground) {
    const glm::dvec3 to_eye = camera.eye - place;
    const double distance = glm::length(to_eye), pixel = distance / camera.focal_px;
    constexpr double growth = 1.08;
    for (double along = std::max(2 * pixel, 5.0); along < distance; along *= growth) {
        const planet::NormalPosition at = planet::position_from_ecef(wgs84, place + along / distance * to_eye);
        if (at.h.m > ground.relief_m) return false;
        if (at.h.m < ground.height(at.normal) - 2 * pixel) return true;
    }
    return false;
}

}  // namespace

std::vector<PlacedLabel> place_labels(std::span<const Layer* const> layers, const Camera& camera,
                                      const DrapeGround& ground, double size,
                                      const std::function<double(const std::string&)>& width_of) {
    std::vector<PlacedLabel> labels;
    std::vector<Box> boxes;
    const double gap = gap_px * size / label_size_px;
    const planet::Culling culling = camera.culling({0, 0, camera.width, camera.height}, ground.culling.occluder_radius);
    for (std::size_t i = layers.size(); i-- > 0;) {
        const double mark_px = point_radius_widths * layers[i]->style.width;
        for (const LayerName& name : layers[i]->names) {
            if (labels.size() == most_labels) return labels;
            const glm::dvec3 foot = planet::ecef_from_normal(wgs84, name.normal);
            if (culling.hidden(foot, ground.relief_m) || is_behind_planet(camera.eye, foot)) continue;
            const glm::dvec3 place = planet::ecef_from_normal(wgs84, name.normal, {ground.height(name.normal)});
            const auto at = screen_from_ecef(camera, place);
            if (!at || at->x < 0 || at->y < 0 || at->x > camera.width || at->y > camera.height) continue;
            const double width = width_of(name.text);
            const glm::dvec2 start = glm::dvec2(*at) + offset(name.at, width, size, mark_px);
            const double left = std::round(start.x), middle = std::round(start.y);
            const Box box{left, middle - 0.5 * size, left + width, middle + 0.5 * size};
            // A line has other places for its name than one where it would be cut off.
            if (name.at == LayerName::Place::above_right && (box.right > camera.width || box.top < 0)) continue;
            if (std::ranges::any_of(boxes, [&](const Box& b) { return b.touches(box, gap); })) continue;
            if (is_hidden(place, camera, ground)) continue;
            boxes.push_back(box);
            labels.push_back({&name.text, {left, middle}, static_cast<float>(width)});
        }
    }
    return labels;
}

}  // namespace render
