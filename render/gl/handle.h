#pragma once
// Ownership of one OpenGL object.

#include <utility>

#include "render/gl/loader.h"

namespace render {

/// A move-only owner of an OpenGL object's name. `Kind` has static destroy(GLuint). A default or moved-from handle has
/// name 0. An object dies with its context: a handle that is destroyed when its context is gone, or while another one
/// is current, lets go of the name (which is freed with its own context) and never touches the other's objects.
template <class Kind>
class Handle {
  public:
    Handle() = default;
    /// Takes over an object of the current context.
    explicit Handle(GLuint name) noexcept : name_(name), context_id_(gl().context_id) {}
    Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)), context_id_(other.context_id_) {}
    Handle& operator=(Handle&& other) noexcept {
        if (this != &other) {
            destroy();
            name_ = std::exchange(other.name_, 0);
            context_id_ = other.context_id_;
        }
        return *this;
    }
    ~Handle() { destroy(); }

    GLuint name() const noexcept { return name_; }
    explicit operator bool() const noexcept { return name_ != 0; }

  private:
    void destroy() noexcept {
        if (name_ != 0 && has_gl() && gl().context_id == context_id_) Kind::destroy(name_);
    }

    GLuint name_ = 0;
    std::uint32_t context_id_ = 0;
};

struct BufferKind {
    static void destroy(GLuint name) noexcept { gl().DeleteBuffers(1, &name); }
};
struct TextureKind {
    static void destroy(GLuint name) noexcept { gl().DeleteTextures(1, &name); }
};
struct SamplerKind {
    static void destroy(GLuint name) noexcept { gl().DeleteSamplers(1, &name); }
};
struct FramebufferKind {
    static void destroy(GLuint name) noexcept { gl().DeleteFramebuffers(1, &name); }
};
struct VertexArrayKind {
    static void destroy(GLuint name) noexcept { gl().DeleteVertexArrays(1, &name); }
};
struct ShaderKind {
    static void destroy(GLuint name) noexcept { gl().DeleteShader(name); }
};
struct ProgramKind {
    static void destroy(GLuint name) noexcept { gl().DeleteProgram(name); }
};

}  // namespace render
