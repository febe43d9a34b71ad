#pragma once
// The lines of the graticule: how far they lie apart, and what they are called.

#include <vector>

#include "render/layers/layer.h"
#include "render/picture/camera.h"

namespace render {

/// Between lines of the graticule, rad: such that some tens of pixels lie between them below the eye.
/// @param pixel_scale below 1 where the picture is shown larger: it has the lines that it has in full size
double graticule_step(const Camera& camera, double pixel_scale);

/// "45° N", "7° 30′ W", "Equator", "Prime Meridian", "180°": parallels where they meet the meridian next to the middle of the
/// picture, and the other way around, the middle ones first; that meridian halfway to the next parallel. None at the limb, where lines are foreshortened, nor where the middle shows the sky.
/// @param step of graticule_step()
std::vector<LayerName> graticule_names(const Camera& camera, double step);

}  // namespace render
