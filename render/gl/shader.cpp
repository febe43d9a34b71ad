#include "render/gl/shader.h"

#include <algorithm>
#include <array>

#include "planet/error.h"
#include "render/gl/checks.h"

namespace render {
namespace {

GLenum stage_of(std::string_view name) {
    struct Stage {
        std::string_view ending;
        GLenum stage;
    };
    static constexpr std::array stages{Stage{".vert.glsl", GL_VERTEX_SHADER}, Stage{".frag.glsl", GL_FRAGMENT_SHADER},
                                       Stage{".geom.glsl", GL_GEOMETRY_SHADER}, Stage{".comp.glsl", GL_COMPUTE_SHADER}};
    for (const Stage& stage : stages)
        if (name.ends_with(stage.ending)) return stage.stage;
    throw planet::Error(planet::Fault::no_graphics, name, "no shader stage in the name",
                        "*.vert.glsl, *.frag.glsl, *.geom.glsl, *.comp.glsl");
}

/// A log in one line, at most 1000 characters of it: planet::Error is one line.
std::string one_line(std::string log) {
    constexpr std::size_t most = 1000;
    for (std::size_t end = log.find('\n'); end != std::string::npos; end = log.find('\n')) log.replace(end, 1, " | ");
    if (log.size() > most) log.replace(most, std::string::npos, " ...");
    return log.empty() ? "the driver does not say why" : log;
}

template <class GetParameter, class GetLog>
std::string read_log(GLuint name, GetParameter get_parameter, GetLog get_log) {
    GLint length = 0;
    get_parameter(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 0)), '\0');
    GLsizei written = 0;
    if (length > 0) get_log(name, length, &written, log.data());
    log.resize(static_cast<std::size_t>(written));
    return log;
}

Handle<ShaderKind> compile(std::string_view name, const ProgramOptions& options) {
    const GLenum stage = stage_of(name);
    const ComposedShader source = compose_shader(name, options.defines, options.find);
    Handle<ShaderKind> shader(gl().CreateShader(stage));
    const GLchar* text = source.text.data();
    const auto length = static_cast<GLint>(source.text.size());
    gl().ShaderSource(shader.name(), 1, &text, &length);
    gl().CompileShader(shader.name());
    GLint compiled = GL_FALSE;
    gl().GetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_FALSE) return shader;
    const std::string log = read_log(shader.name(), gl().GetShaderiv, gl().GetShaderInfoLog);
    throw planet::Error(planet::Fault::no_graphics, name, one_line(name_files(log, source.files)));
}

}  // namespace

Program Program::link(std::span<const std::string_view> names, const ProgramOptions& options) {
    Program program;
    program.handle_ = Handle<ProgramKind>(gl().CreateProgram());
    std::string all_names;
    for (const std::string_view name : names) {
        const Handle<ShaderKind> shader = compile(name, options);
        gl().AttachShader(program.name(), shader.name());  // the program keeps it alive
        all_names.append(all_names.empty() ? "" : " + ").append(name);
    }
    if (!options.feedback_varyings.empty()) {
        std::vector<const GLchar*> varyings;
        for (const std::string& varying : options.feedback_varyings) varyings.push_back(varying.c_str());
        gl().TransformFeedbackVaryings(program.name(), static_cast<GLsizei>(varyings.size()), varyings.data(),
                                       GL_INTERLEAVED_ATTRIBS);
    }
    gl().LinkProgram(program.name());
    GLint linked = GL_FALSE;
    gl().GetProgramiv(program.name(), GL_LINK_STATUS, &linked);
    if (linked == GL_FALSE)
        throw planet::Error(planet::Fault::no_graphics, all_names,
                            one_line(read_log(program.name(), gl().GetProgramiv, gl().GetProgramInfoLog)));
    check_gl(all_names);
    return program;
}

GLint Program::location(std::string_view uniform) const {
    if (const auto found = locations_.find(uniform); found != locations_.end()) return found->second;
    const std::string text(uniform);
    return locations_.emplace(text, gl().GetUniformLocation(name(), text.c_str())).first->second;
}

void Program::set(std::string_view uniform, GLint value) {
    gl().ProgramUniform1i(name(), location(uniform), value);
}
void Program::set(std::string_view uniform, GLuint value) {
    gl().ProgramUniform1ui(name(), location(uniform), value);
}
void Program::set(std::string_view uniform, float value) {
    gl().ProgramUniform1f(name(), location(uniform), value);
}
void Program::set(std::string_view uniform, const glm::vec2& value) {
    gl().ProgramUniform2fv(name(), location(uniform), 1, &value.x);
}
void Program::set(std::string_view uniform, const glm::vec3& value) {
    set(uniform, std::span(&value, 1));
}
void Program::set(std::string_view uniform, const glm::vec4& value) {
    set(uniform, std::span(&value, 1));
}
void Program::set(std::string_view uniform, const glm::ivec2& value) {
    gl().ProgramUniform2iv(name(), location(uniform), 1, &value.x);
}
void Program::set(std::string_view uniform, const glm::ivec3& value) {
    gl().ProgramUniform3iv(name(), location(uniform), 1, &value.x);
}
void Program::set(std::string_view uniform, const glm::ivec4& value) {
    gl().ProgramUniform4iv(name(), location(uniform), 1, &value.x);
}
void Program::set(std::string_view uniform, const glm::mat3& value) {
    gl().ProgramUniformMatrix3fv(name(), location(uniform), 1, GL_FALSE, &value[0].x);
}
void Program::set(std::string_view uniform, const glm::mat4& value) {
    gl().ProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, &value[0].x);
}
void Program::set(std::string_view uniform, std::span<const float> values) {
    gl().ProgramUniform1fv(name(), location(uniform), static_cast<GLsizei>(values.size()), values.data());
}
void Program::set(std::string_view uniform, std::span<const glm::vec3> values) {
    gl().ProgramUniform3fv(name(), location(uniform), static_cast<GLsizei>(values.size()), &values.data()->x);
}
void Program::set(std::string_view uniform, std::span<const glm::vec4> values) {
    gl().ProgramUniform4fv(name(), location(uniform), static_cast<GLsizei>(values.size()), &values.data()->x);
}

}  // namespace render
