#pragma once
// Error checks of OpenGL calls. A GL error is a mistake of ours except for want of memory, which data can cause: so
// creating an object of a size that data decides ends with require_gl, and everything else with check_gl, which is
// compiled away in release builds.

#include <string>
#include <string_view>

namespace render {

#ifdef NDEBUG
inline constexpr bool gl_checks = false;
#else
inline constexpr bool gl_checks = true;
#endif

/// The errors since the last call, "GL_INVALID_ENUM, ..." with the driver's own words in a debug context; empty if
/// none. Clears the context's error flag and takes the errors out of its debug log.
std::string take_gl_errors();

/// Throws planet::Error (no_graphics) with `where` and the errors, if there are any. Waits for the driver's thread
/// where it has one, never for the drawing itself.
void require_gl(std::string_view where);

/// require_gl in debug builds, nothing otherwise.
inline void check_gl([[maybe_unused]] std::string_view where) {
    if constexpr (gl_checks) require_gl(where);
}

}  // namespace render
