#pragma once
// A view as a command line, and back.

#include <string>

#include "render/app/picture/drawn_surface.h"
#include "render/app/picture/render_options.h"
#include "render/viewer/camera.h"

namespace render {

/// Options with the place, height, heading and pitch of a pose, rounded to what a command line says: by less than a
/// thousandth of a pixel at the nearest ground, in as few digits as that takes.
RenderOptions options_of_pose(const RenderOptions& options, const DrawnSurface& surface, const Pose& pose);

/// "octaglobe render --at ...", for a shell: options that differ from their defaults. What was rounded before is
/// written exactly.
std::string render_line(const RenderOptions& options);

/// The pose of a picture's camera.
Pose pose_of_camera(const Camera& camera);

}  // namespace render
