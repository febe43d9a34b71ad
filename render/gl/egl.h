#pragma once
// EGL without a display: on a device (a GPU, or Mesa's software device) or on Mesa's surfaceless platform. libEGL is
// opened at run time; OCTAGLOBE_EGL_LIBRARY names another library than libEGL.so.1.

#include <optional>
#include <string>
#include <vector>

#include "render/gl/native_context.h"

namespace render {

/// A core 4.5 context on the EGL device with the given index, or, without one, on the first device that gives it.
/// Throws planet::Error (bad_usage) if there are devices and none of that index.
Attempt open_egl_device(std::optional<int> device, bool debug);

/// A core 4.5 context on EGL_MESA_platform_surfaceless.
Attempt open_egl_surfaceless(bool debug);

/// One line for each EGL device, in the order of the device index; empty where there are none.
std::vector<std::string> egl_device_names();

}  // namespace render
