#include "render/app/picture/picture_parts.h"

#include <algorithm>

namespace render {

namespace {

constexpr int least_part = 64;
/// Two bands, one part high, are in memory: 120 MB each if they have so many pixels. Flatter parts than half cost time.
constexpr int band_pixels = 40'000'000;

/// What two have in common; no width or no height where there is nothing.
PicturePart common(const PicturePart& a, const PicturePart& b) {
    const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
    return {x, y, std::max(std::min(a.x + a.width, b.x + b.width) - x, 0),
            std::max(std::min(a.y + a.height, b.y + b.height) - y, 0)};
}

}  // namespace

PicturePart grown(const PicturePart& part, int margin) {
    return {part.x - margin, part.y - margin, part.width + 2 * margin, part.height + 2 * margin};
}

PictureParts::PictureParts(const Camera& camera, const PictureCrop& wanted, const Limits& limits)
    : wanted_{wanted.x, wanted.y, wanted.width, wanted.height},
      single_(camera.width <= limits.side && camera.height <= limits.side),
      margin_(limits.margin),
      width_(single_ ? limits.side : limits.side - 2 * least_part_margin),
      height_(std::clamp(band_pixels / camera.width, (limits.side - 2 * least_part_margin) / 2, width_)) {
    for (int y = 0; y < camera.height; y += height_)
        for (int x = 0; x < camera.width; x += width_)
            add({x, y, std::min(width_, camera.width - x), std::min(height_, camera.height - y)});
    std::ranges::reverse(rest_);
}

PicturePart PictureParts::take() {
    const PicturePart part = rest_.back();
    rest_.pop_back();
    return part;
}

bool PictureParts::can_be_split(const PicturePart& part) const {
    return !single_ && std::min(part.width, part.height) >= 2 * least_part;
}

void PictureParts::put_back_split(const PicturePart& part) {
    const int w = part.width / 2, h = part.height / 2;
    add({part.x + w, part.y + h, part.width - w, part.height - h});
    add({part.x, part.y + h, w, part.height - h});
    add({part.x + w, part.y, part.width - w, h});
    add({part.x, part.y, w, h});
}

PicturePart PictureParts::kept(const PicturePart& part) const {
    return common(part, wanted_);
}

PicturePart PictureParts::band(const PicturePart& part) const {
    return common({wanted_.x, part.y / height_ * height_, wanted_.width, height_}, wanted_);
}

void PictureParts::add(const PicturePart& part) {
    const PicturePart k = kept(part);
    if (k.width > 0 && k.height > 0) rest_.push_back(part);
}

}  // namespace render
