#pragma once
// Strokes painted into a picture in memory, without a context. Strokes of one colour are painted at once: where they
// overlap, as the pieces of a letter do, they look like one.

#include <cstdint>
#include <span>
#include <vector>

#include "render/picture/mesh_figure.h"

namespace render {

class StrokeCoverage {
  public:
    StrokeCoverage(int width, int height);  ///< pixels

    /// Limits what is added from now on to a part of the picture.
    void clip(const PixelBox& box) { clip_ = box; }
    /// Its colour does not count.
    void add(const Stroke& stroke);
    void add(std::span<const Stroke> strokes) {
        for (const Stroke& s : strokes) add(s);
    }
    /// Paints what was added since the last time. @param image RGB, of the same size
    void paint(planet::Image& image, Color color);

  private:
    int width_, height_;
    PixelBox clip_;
    std::vector<std::uint8_t> cover_;       ///< 255 for all of a pixel
    int dirty_top_ = 0, dirty_bottom_ = 0;  ///< rows with any
};

}  // namespace render
