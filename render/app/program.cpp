#include "render/app/program.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>

#include "planet/error.h"
#include "render/app/arguments.h"
#include "render/app/values.h"
#include "render/app/version.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

int fail(Fault fault, std::string_view line) {
    std::cout.flush();  // in order, where both go to one terminal
    std::cerr << "octaglobe: " << line << '\n';
    return static_cast<int>(fault);
}

/// The innermost command that was given, e.g. "query height".
const CLI::App* given_command(const CLI::App* app, std::string& name) {
    while (!app->get_subcommands().empty()) {
        app = app->get_subcommands().front();
        name.append(name.empty() ? "" : " ").append(app->get_name());
    }
    return app;
}

/// The parser's complaint as one line: what, where, accepted.
std::string usage_line(const CLI::App& program, const CLI::ParseError& error) {
    std::string name;
    const CLI::App* command = given_command(&program, name);
    const std::string help = "see octaglobe " + (name.empty() ? "" : name + " ") + "--help";
    std::string names;
    const auto list = [&](const std::string& text) { names.append(names.empty() ? "" : ", ").append(text); };

    const auto commands = command->get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* each : commands) list(each->get_name());
    const std::vector<std::string> rest = program.remaining(true);
    if (!commands.empty()) {
        const std::string where = name.empty() ? "command" : name;
        const bool option = !rest.empty() && rest.front().starts_with('-');
        return Error(Fault::bad_usage, where,
                     rest.empty() ? "none given" : shown(rest.front()) + (option ? " is no option" : " is unknown"),
                     names + "; " + help)
            .what();
    }
    if (!rest.empty() && dynamic_cast<const CLI::ExtrasError*>(&error)) {
        for (const CLI::Option* each : command->get_options())
            if (each->nonpositional()) list(each->get_name());
        const bool option = rest.front().starts_with('-');
        return Error(Fault::bad_usage, name, shown(rest.front()) + (option ? " is no option" : " is too much"),
                     option ? names : help)
            .what();
    }
    return Error(Fault::bad_usage, name, error.what(), help).what();
}

void declare(CLI::App& program) {
    program.description(
        "Octaglobe: a closed, certified triangulation of a planet, drawn headless.\n"
        "Angles are in degrees, lengths in metres (or with a unit: 60km), times in UTC.\n"
        "Exit status: 0 done, 1 a check failed, 2 bad usage, 3 bad input data, 4 no usable graphics.");
    program.footer("octaglobe COMMAND --help tells more, with an example.");
    program.set_version_flag("--version", "octaglobe " + std::string(version));
    program.get_option("--help")->description("This text");
    program.require_subcommand(1);
#define OCTAGLOBE_ADD(name) add_##name(program);
    OCTAGLOBE_COMMANDS(OCTAGLOBE_ADD)
#undef OCTAGLOBE_ADD
}

int parse_and_run(std::vector<std::string> arguments) {
    CLI::App program("", "octaglobe");
    declare(program);
    arguments = with_negative_values(std::move(arguments));
    std::reverse(arguments.begin(), arguments.end());  // the parser takes them off the back
    try {
        program.parse(std::move(arguments));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) return fail(Fault::bad_usage, usage_line(program, error));
        program.exit(error, std::cout, std::cerr);  // --help, --version
    }
    std::cout.flush();
    if (!std::cout) throw Error(Fault::bad_usage, "standard output", "cannot be written");
    return 0;
}

}  // namespace

CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what, const std::string& example) {
    CLI::App* command = parent.add_subcommand(name, what);
    command->footer("Example:\n  " + example);
    command->get_option("--help")->description("This text");
    return command;
}

CLI::Option* add_value(CLI::App& command, const std::string& name, const std::string& form, const std::string& what,
                       std::function<void(std::string_view, const std::string&)> read) {
    const std::string where = name.substr(0, name.find(',')).starts_with("--") ? name : name.substr(name.find(',') + 1);
    return command
        .add_option_function<std::string>(
            name, [where, read = std::move(read)](const std::string& text) { read(where, text); }, what)
        ->type_name(form);
}

void require(bool holds, std::string_view where, std::string_view what, std::string_view accepted) {
    if (!holds) throw planet::Error(planet::Fault::bad_usage, where, what, accepted);
}

void add_json_option(CLI::App& command, std::string& path) {
    add_value(command, "--json", "FILE", "Write a machine-readable report: flat JSON, SI units in the keys",
              [&path](std::string_view where, const std::string& text) {
                  if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
                  path = text;
              });
}

int run_program(std::vector<std::string> arguments) try {
    return parse_and_run(std::move(arguments));
} catch (const Error& error) {
    return fail(error.fault(), error.what());
} catch (const std::bad_alloc&) {
    return fail(Fault::bad_data, "out of memory");
} catch (const std::filesystem::filesystem_error& error) {
    return fail(Fault::bad_data, Error(Fault::bad_data, error.path1().native(), error.code().message()).what());
} catch (const std::exception& error) {
    return fail(Fault::bad_data, Error(Fault::bad_data, "internal failure", error.what()).what());
}

}  // namespace render
