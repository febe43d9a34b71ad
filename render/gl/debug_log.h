#pragma once
// What the driver has to say (KHR_debug), collected per context.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "render/gl/loader.h"

namespace render {

struct DebugMessage {
    GLenum type = 0;      ///< GL_DEBUG_TYPE_ERROR, ...
    GLenum severity = 0;  ///< GL_DEBUG_SEVERITY_HIGH, ...
    GLuint id = 0;
    std::string text;
};

/// Messages of one context. Only a context made with `debug` produces any.
class DebugLog {
  public:
    using Callback = std::function<void(const DebugMessage&)>;

    /// Called for every message as it comes, inside the OpenGL call at fault and on its thread: it must not throw.
    void set_callback(Callback callback) { callback_ = std::move(callback); }
    /// The first 256 messages since take(), oldest first.
    const std::vector<DebugMessage>& messages() const noexcept { return messages_; }
    /// Hands the messages over and forgets them.
    std::vector<DebugMessage> take() { return std::exchange(messages_, {}); }

    /// Routes the current context's messages here, synchronously, all but notifications. The log must outlive it.
    void attach();

  private:
    void add(DebugMessage message);
    static void APIENTRY receive(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                 const GLchar* message, const void* log);

    std::vector<DebugMessage> messages_;
    Callback callback_;
};

}  // namespace render
