#include "render/gl/shader_source.h"

#include <algorithm>
#include <cassert>
#include <regex>

#include "planet/error.h"

namespace render {
namespace {

[[noreturn]] void fail(std::string_view file, int line, std::string_view what, std::string_view accepted = {}) {
    throw planet::Error(planet::Fault::no_graphics, std::string(file) + ":" + std::to_string(line), what, accepted);
}

std::string_view take_line(std::string_view& rest) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    return line;
}

/// The word of a preprocessor line ("include" of `  # include "x"`), and what follows it; empty for other lines.
std::string_view directive(std::string_view line, std::string_view& argument) {
    constexpr std::string_view blanks = " \t\r";
    const auto skip = [&] { line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size())); };
    skip();
    if (!line.starts_with('#')) return {};
    line.remove_prefix(1);
    skip();
    const std::size_t end = std::min(line.find_first_of(" \t\r\"<"), line.size());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    skip();
    argument = line.substr(0, line.find_last_not_of(blanks) + 1);
    return word;
}

class Composer {
  public:
    Composer(std::span<const std::string> defines, const SourceFinder& find) : defines_(defines), find_(find) {}

    void add(const std::string& name, std::string_view text) {
        const std::size_t number = shader.files.size();
        shader.files.push_back(name);
        int line_number = 0;
        for (std::string_view rest = text; !rest.empty();) {
            const std::string_view line = take_line(rest);
            ++line_number;
            std::string_view argument;
            const std::string_view word = directive(line, argument);
            if (number == 0 && line_number == 1 && word != "version") fail(name, 1, "the first line is not #version");
            if (word == "include") {
                include(name, line_number, argument);
                set_line(line_number + 1, number);
            } else if (word == "version") {
                if (number != 0 || line_number != 1)
                    fail(name, line_number, "#version is not the first line of a shader");
                shader.text.append(line).append("\n");
                for (const std::string& define : defines_) shader.text.append("#define ").append(define).append("\n");
                set_line(2, 0);
            } else {
                shader.text.append(line).append("\n");
            }
        }
    }

    ComposedShader shader;

  private:
    void include(const std::string& from, int line_number, std::string_view argument) {
        if (argument.size() < 3 || argument.front() != '"' || argument.find('"', 1) != argument.size() - 1)
            fail(from, line_number, "bad #include " + std::string(argument), "#include \"file.glsl\"");
        const std::string name(argument.substr(1, argument.size() - 2));
        if (std::find(shader.files.begin(), shader.files.end(), name) != shader.files.end()) return;
        const std::optional<std::string_view> text = find_(name);
        if (!text) fail(from, line_number, "no shader \"" + name + "\" to include");
        set_line(1, shader.files.size());
        add(name, *text);
    }
    void set_line(int line_number, std::size_t file) {
        shader.text += "#line " + std::to_string(line_number) + " " + std::to_string(file) + "\n";
    }

    std::span<const std::string> defines_;
    const SourceFinder& find_;
};

}  // namespace

std::optional<std::string_view> find_shader_source(std::string_view name) {
    for (const ShaderSource& source : shader_sources())
        if (source.name == name) return source.text;
    return std::nullopt;
}

std::string_view shader_source(std::string_view name) {
    const std::optional<std::string_view> text = find_shader_source(name);
    assert(text.has_value());
    return text.value_or(std::string_view());
}

ComposedShader compose_shader(std::string_view name, std::span<const std::string> defines, const SourceFinder& find) {
    const std::optional<std::string_view> text = find(name);
    if (!text) throw planet::Error(planet::Fault::no_graphics, name, "there is no such shader");
    if (text->empty()) fail(name, 1, "the shader is empty");
    Composer composer(defines, find);
    composer.add(std::string(name), *text);
    return std::move(composer.shader);
}

std::string name_files(std::string_view log, std::span<const std::string> files) {
    static const std::regex position(R"(^(\d{1,4})(?::(\d+)\(\d+\)|\((\d+)\)|:(\d+))\s*:?\s*)");
    std::string text;
    for (std::string_view rest = log; !rest.empty();) {
        const std::string line(take_line(rest));
        std::smatch match;
        if (std::regex_search(line, match, position)) {
            const auto file = static_cast<std::size_t>(std::stoul(match[1].str()));
            const std::string number = match[2].str() + match[3].str() + match[4].str();
            if (file < files.size()) {
                text += files[file] + ":" + number + ": " + match.suffix().str() + "\n";
                continue;
            }
        }
        text += line + "\n";
    }
    while (text.ends_with('\n') || text.ends_with('\0')) text.pop_back();
    return text;
}

}  // namespace render
