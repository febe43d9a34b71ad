#pragma once
// Which names a view shows, and where on the picture.

#include <functional>
#include <span>

#include "render/layers/draped_lines.h"
#include "render/layers/layer.h"

namespace render {

/// A name on the picture: pixels of the whole picture, the text's left middle.
struct PlacedLabel {
    const std::string* text = nullptr;
    glm::vec2 at{0};
    float width = 0;
};

/// @param layers the lowest first: names of higher ones come before those of lower ones, and in a layer those that come
/// first in the file. A name that would touch one before it is left out, and so is one whose place is hidden by the
/// ground; this depends on the view alone, not on what was shown before. @param size of the letters, pixels
/// @param width_of a text of that size
std::vector<PlacedLabel> place_labels(std::span<const Layer* const> layers, const Camera& camera,
                                      const DrapeGround& ground, double size,
                                      const std::function<double(const std::string&)>& width_of);

}  // namespace render
