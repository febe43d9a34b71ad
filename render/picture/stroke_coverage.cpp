#include "render/picture/stroke_coverage.h"

#include <algorithm>
#include <cassert>

namespace render {

StrokeCoverage::StrokeCoverage(int width, int height)
    : width_(width),
      height_(height),
      clip_{0, 0, static_cast<float>(width), static_cast<float>(height)},
      cover_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0),
      dirty_top_(height) {}

void StrokeCoverage::add(const Stroke& stroke) {
    const glm::vec2 a(stroke.a), b(stroke.b), along = b - a;
    const float half = 0.5f * stroke.width, reach = half + 1, length2 = std::max(glm::dot(along, along), 1e-12f);
    const glm::vec2 low = glm::max(glm::min(a, b) - reach, glm::vec2(clip_.left, clip_.top));
    const glm::vec2 high = glm::min(glm::max(a, b) + reach, glm::vec2(clip_.right, clip_.bottom));
    const int top = std::max(0, static_cast<int>(low.y)), bottom = std::min(height_, static_cast<int>(high.y));
    const int left = std::max(0, static_cast<int>(low.x)), right = std::min(width_, static_cast<int>(high.x));
    for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) {
            const glm::vec2 p = glm::vec2(x, y) + 0.5f - a;
            const float t = std::clamp(glm::dot(p, along) / length2, 0.0f, 1.0f);
            const float cover = std::clamp(half + 0.5f - glm::length(p - t * along), 0.0f, 1.0f);
            const auto level = static_cast<std::uint8_t>(255 * cover * std::min(stroke.width, 1.0f) + 0.5f);
            std::uint8_t& here =
                cover_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
            here = std::max(here, level);
        }
    dirty_top_ = std::min(dirty_top_, top);
    dirty_bottom_ = std::max(dirty_bottom_, bottom);
}

void StrokeCoverage::paint(planet::Image& image, Color color) {
    assert(image.width == width_ && image.height == height_ && image.channels == 3);
    const std::uint8_t rgb[] = {color.red, color.green, color.blue};
    const std::size_t row = static_cast<std::size_t>(width_);
    for (std::size_t i = static_cast<std::size_t>(std::min(dirty_top_, height_)) * row;
         i < static_cast<std::size_t>(dirty_bottom_) * row; ++i) {
        if (cover_[i] == 0) continue;
        const int alpha = cover_[i] * color.alpha;  // of 255^2
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint8_t& p = image.pixels[3 * i + k];
            p = static_cast<std::uint8_t>(p + ((rgb[k] - p) * alpha + (rgb[k] > p ? 32512 : -32512)) / 65025);
        }
        cover_[i] = 0;
    }
    dirty_top_ = height_;
    dirty_bottom_ = 0;
}

}  // namespace render
