#pragma once
// The shaders of render/shaders, embedded in the program, and their composition by #include.
//
//   // terrain.frag.glsl
//   #version 450 core
//   #include "atmosphere.glsl"
//   void main() { ... }
//
// A file is included once in a shader, wherever it is named first; so files may include what they need, in circles too.
// Only the main file has a #version, and it is the first line. #line directives keep the lines of each file, so a
// compiler's message is about our file and our line.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace render {

struct ShaderSource {
    std::string_view name;  ///< file name within render/shaders, e.g. "terrain.vert.glsl"
    std::string_view text;
};

/// Every embedded shader, by ascending name.
std::span<const ShaderSource> shader_sources();

/// The text of an embedded shader; nothing if there is none of that name.
std::optional<std::string_view> find_shader_source(std::string_view name);

/// The text of an embedded shader. Asking for one that does not exist is misuse.
std::string_view shader_source(std::string_view name);

using SourceFinder = std::function<std::optional<std::string_view>(std::string_view name)>;

/// A shader with its includes put in.
struct ComposedShader {
    std::string text;
    std::vector<std::string> files;  ///< by source string number, the one that #line and messages carry
};

/// Puts a shader together. Each define ("NAME" or "NAME VALUE") becomes a #define behind the #version line.
/// Throws planet::Error (no_graphics) that names file and line for an unknown file, a bad #include or a #version that
/// is missing or out of place.
ComposedShader compose_shader(std::string_view name, std::span<const std::string> defines = {},
                              const SourceFinder& find = find_shader_source);

/// A compiler's log in terms of our files: "0:12(5): error: ..." (Mesa) or "0(12) : error ..." (NVIDIA) becomes
/// "terrain.frag.glsl:12: error: ...". Lines of another form stay as they are.
std::string name_files(std::string_view log, std::span<const std::string> files);

}  // namespace render
