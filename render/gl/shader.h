#pragma once
// Programs from embedded shaders.

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/handle.h"
#include "render/gl/shader_source.h"

namespace render {

struct ProgramOptions {
    std::vector<std::string> defines{};            ///< "NAME" or "NAME VALUE", for every stage
    std::vector<std::string> feedback_varyings{};  ///< captured by transform feedback, interleaved, in this order
    SourceFinder find = find_shader_source;        ///< where names of shaders and includes are looked up
};

/// A linked program with its uniforms.
class Program {
  public:
    Program() = default;
    /// Compiles and links the shaders of the given names. The name tells the stage: .vert.glsl, .frag.glsl, .geom.glsl,
    /// .comp.glsl. Throws planet::Error (no_graphics): one line with our file, its line and the driver's words.
    static Program link(std::span<const std::string_view> names, const ProgramOptions& options = {});
    static Program link(std::initializer_list<std::string_view> names, const ProgramOptions& options = {}) {
        return link(std::span(names.begin(), names.size()), options);
    }

    GLuint name() const noexcept { return handle_.name(); }
    explicit operator bool() const noexcept { return static_cast<bool>(handle_); }
    void use() const { gl().UseProgram(name()); }

    /// The location of a uniform outside blocks ("fog", "lights[0]", "lights[2].color"); -1 if the program has none,
    /// for one that is not used is optimised away. Looked up once.
    GLint location(std::string_view uniform) const;

    // Sets a uniform, whichever program is in use. One that the program does not have is left out.
    void set(std::string_view uniform, GLint value);
    void set(std::string_view uniform, GLuint value);
    void set(std::string_view uniform, float value);
    void set(std::string_view uniform, const glm::vec2& value);
    void set(std::string_view uniform, const glm::vec3& value);
    void set(std::string_view uniform, const glm::vec4& value);
    void set(std::string_view uniform, const glm::ivec2& value);
    void set(std::string_view uniform, const glm::ivec3& value);
    void set(std::string_view uniform, const glm::ivec4& value);
    void set(std::string_view uniform, const glm::mat3& value);
    void set(std::string_view uniform, const glm::mat4& value);
    void set(std::string_view uniform, std::span<const float> values);
    void set(std::string_view uniform, std::span<const glm::vec3> values);
    void set(std::string_view uniform, std::span<const glm::vec4> values);

  private:
    Handle<ProgramKind> handle_;
    mutable std::map<std::string, GLint, std::less<>> locations_;
};

}  // namespace render
