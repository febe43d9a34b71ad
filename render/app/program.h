#pragma once
// The program `octaglobe`: one file for each command.
//
// A command is a file command_NAME.cpp that defines add_NAME, and one line in OCTAGLOBE_COMMANDS. add_NAME declares the
// subcommand and what it does:
//
//     void add_area(CLI::App& program) {
//         struct Options { std::string json; };
//         auto options = std::make_shared<Options>();
//         CLI::App* command = add_command(program, "area", "the area of a polygon", "octaglobe area 0,0 0,1 1,0");
//         add_json_option(*command, options->json);
//         command->final_callback([options] { ... });     // returns: exit status 0; throws planet::Error: its fault
//     }

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#define OCTAGLOBE_COMMANDS(command)                                                                                    \
    command(render) command(view) command(fly) command(bake) command(mesh) command(tin) command(refine) command(query) \
        command(check) command(verify) command(info)

namespace render {

#define OCTAGLOBE_DECLARE(name) void add_##name(CLI::App& program);
OCTAGLOBE_COMMANDS(OCTAGLOBE_DECLARE)
#undef OCTAGLOBE_DECLARE

/// A subcommand with its help: what it does, and an example of one line or more.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what, const std::string& example);

/// An option with a value that `read` takes over, or refuses by planet::Error. Given twice it is an error.
CLI::Option* add_value(CLI::App& command, const std::string& name, const std::string& form, const std::string& what,
                       std::function<void(std::string_view where, const std::string& text)> read);

/// --json FILE.
void add_json_option(CLI::App& command, std::string& path);

/// Throws planet::Error(bad_usage) unless it holds.
void require(bool holds, std::string_view where, std::string_view what, std::string_view accepted);

/// Runs the program and returns its exit status: 0 done, 1 a check failed, 2 bad usage, 3 bad input data, 4 no usable
/// graphics. An error is one line on standard error.
/// @param arguments without the program's name
int run_program(std::vector<std::string> arguments);

}  // namespace render
