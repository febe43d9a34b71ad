#pragma once
// The functions of core OpenGL 4.5, called as gl().Clear(GL_COLOR_BUFFER_BIT).
//
// Nothing links to libGL: one process may hold contexts of several libraries (EGL, OSMesa, a window), and each context
// has its own table, loaded through its own resolver. gl() is the table of the context that is current on this thread.
// The list of functions is made from GL/glcorearb.h when the build is configured (list_functions.cmake).

#define GL_GLEXT_PROTOTYPES 1  // for the types alone: a call of ::glClear compiles and does not link
#include <GL/glcorearb.h>

#include <cassert>
#include <cstdint>
#include <string>

namespace render {

using ProcAddress = void (*)();
using Resolver = ProcAddress (*)(const char* name);

class DebugLog;

/// What a context can hold. Core 4.5 promises the least values given here.
struct Limits {
    GLint texture_size = 16384;  ///< side of a 2-D texture
    GLint cube_size = 16384;     ///< side of a cube map's face
    GLint volume_size = 2048;    ///< side of a 3-D texture
    GLint array_layers = 2048;   ///< layers of a 2-D array
    GLint target_size = 16384;   ///< side of what can be drawn to: textures and viewports
    GLint samples = 4;           ///< samples of a pixel for both colour and depth
};

/// One context's function pointers; the member of glClear is Clear.
struct Functions {
#define OCTAGLOBE_GL(name) decltype(&::gl##name) name = nullptr;
#include "gl_functions.inc"
#undef OCTAGLOBE_GL
    /// Never 0 and never reused: tells which context an object belongs to.
    std::uint32_t context_id = 0;
    Limits limits;
    DebugLog* debug_log = nullptr;  ///< never null in a context made by class Context
};

/// Fills every pointer. Returns the name of the first function that the resolver does not have; empty if it has all.
/// Some resolvers (libglvnd's) answer any name with a stub, so check the version of the context too.
std::string load_functions(Functions& functions, Resolver resolver);

namespace detail {
inline constinit thread_local const Functions* current_functions = nullptr;
}

/// Is a context current on this thread?
inline bool has_gl() noexcept {
    return detail::current_functions != nullptr;
}

/// The functions of the context that is current on this thread. Calling it without one is misuse.
inline const Functions& gl() noexcept {
    assert(has_gl());
    return *detail::current_functions;
}

}  // namespace render
