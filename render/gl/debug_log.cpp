#include "render/gl/debug_log.h"

#include <string_view>

namespace render {

void DebugLog::attach() {
    gl().DebugMessageCallback(&DebugLog::receive, this);
    gl().DebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, nullptr, GL_FALSE);
    gl().Enable(GL_DEBUG_OUTPUT);
    gl().Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

void DebugLog::add(DebugMessage message) {
    constexpr std::size_t kept = 256;
    if (callback_) callback_(message);
    if (messages_.size() < kept) messages_.push_back(std::move(message));
}

void APIENTRY DebugLog::receive(GLenum, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar* message,
                                const void* log) {
    const std::string_view text =
        length < 0 ? std::string_view(message) : std::string_view(message, static_cast<std::size_t>(length));
    auto* self = const_cast<DebugLog*>(static_cast<const DebugLog*>(log));  // attach() gave a pointer to non-const
    self->add({type, severity, id, std::string(text)});
}

}  // namespace render
