#include "render/gl/checks.h"

#include "planet/error.h"
#include "render/gl/debug_log.h"
#include "render/gl/loader.h"

namespace render {
namespace {

std::string_view error_name(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "GL_INVALID_ENUM";
        case GL_INVALID_VALUE:
            return "GL_INVALID_VALUE";
        case GL_INVALID_OPERATION:
            return "GL_INVALID_OPERATION";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "GL_INVALID_FRAMEBUFFER_OPERATION";
        case GL_OUT_OF_MEMORY:
            return "GL_OUT_OF_MEMORY";
        case GL_CONTEXT_LOST:
            return "GL_CONTEXT_LOST";
        default:
            return "an unknown GL error";
    }
}

}  // namespace

std::string take_gl_errors() {
    std::string text;
    const auto append = [&](std::string_view part) { text.append(text.empty() ? "" : ", ").append(part); };
    // A lost context may answer with the same error for ever: as many as there are kinds are enough.
    for (int i = 0; i < 8; ++i) {
        const GLenum error = gl().GetError();
        if (error == GL_NO_ERROR) break;
        append(error_name(error));
    }
    if (gl().debug_log == nullptr) return text;
    for (const DebugMessage& message : gl().debug_log->take())
        if (message.type == GL_DEBUG_TYPE_ERROR) append(message.text);
    return text;
}

void require_gl(std::string_view where) {
    if (const std::string errors = take_gl_errors(); !errors.empty())
        throw planet::Error(planet::Fault::no_graphics, where, errors);
}

}  // namespace render
