#pragma once
// Whether this machine has any way in to OpenGL: what draws is skipped without.

#include <algorithm>

#include "render/gl/context.h"

namespace render {

inline bool can_draw() {
    const auto ways = probe_backends();
    return std::any_of(ways.begin(), ways.end(), [](const auto& way) { return way.available; });
}

}  // namespace render
