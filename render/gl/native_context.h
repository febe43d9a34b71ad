#pragma once
// What a way into OpenGL (egl.h, osmesa.h) hands to class Context.

#include <memory>
#include <string>
#include <vector>

#include "render/gl/loader.h"

namespace render {

inline constexpr int gl_major = 4, gl_minor = 5;  ///< the core version that is asked for

/// A context of some library. Destroy it only while it is current on no thread.
class NativeContext {
  public:
    NativeContext() = default;
    NativeContext(const NativeContext&) = delete;
    NativeContext& operator=(const NativeContext&) = delete;
    virtual ~NativeContext() = default;
    /// Makes it current on this thread. Returns what went wrong; empty if nothing did.
    virtual std::string make_current() = 0;
    /// Leaves this thread without a context. Only while it is current on this thread.
    virtual void release() = 0;
    virtual Resolver resolver() const = 0;
};

/// A try to open a context: it, or one line that says why there is none.
struct Attempt {
    std::unique_ptr<NativeContext> context;
    std::string reason;
    int device = -1;  ///< the index of the EGL device it is on; -1 where there is no such choice
};

}  // namespace render
