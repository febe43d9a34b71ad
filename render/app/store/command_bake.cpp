// octaglobe bake: elevation data becomes a store.

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "planet/error.h"
#include "render/app/data_path.h"
#include "render/app/figures.h"
#include "render/app/picture/earth_store.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/source_report.h"
#include "render/app/store/bake_sources.h"
#include "render/app/store/bake_target.h"
#include "render/app/store/store_summary.h"
#include "render/app/table.h"
#include "render/app/values.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using Where = std::string_view;

constexpr std::size_t least_memory = std::size_t{96} << 20, most_memory = std::size_t{1} << 40;

std::string file_name(Where where, const std::string& text) {
    if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
    return text;
}

double quantum_from_text(Where where, const std::string& text) {
    const double quantum = parse_distance(where, text, {1.0 / 256, 64});
    int exponent = 0;
    if (std::frexp(quantum, &exponent) != 0.5)
        throw Error(Fault::bad_usage, where, shown(text) + " is no power of two",
                    "64, 32, ... 0.5, 0.25 ... 0.00390625 m");
    return quantum;
}

void add_source_options(CLI::App& command, BakeCommand& o) {
    command
        .add_option_function<std::vector<std::string>>(
            "source",
            [&](const std::vector<std::string>& texts) {
                for (const auto& text : texts) o.sources.push_back(file_name("source", text));
            },
            "Rasters of heights that GDAL reads, and quoted patterns of them; later ones on top")
        ->type_name("FILE");
    command
        .add_option_function<std::vector<std::string>>(
            "--datum",
            [&](const std::vector<std::string>& texts) {
                constexpr planet::VerticalDatum data[] = {planet::VerticalDatum::egm96,
                                                          planet::VerticalDatum::ellipsoid};
                for (const auto& text : texts)
                    o.datum.push_back(data[parse_choice("--datum", text, {"egm96", "ellipsoid"})]);
            },
            "What heights are above: egm96 or ellipsoid; once for all sources, or again for each\n"
            "of them in their order [what the file says, else egm96]")
        ->type_name("DATUM")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    add_value(command, "--base", "WHAT", "Below all sources: earth (the shipped one), or none: height 0 [none]",
              [&](Where where, const std::string& text) {
                  o.over_earth = parse_choice(where, text, {"none", "earth"}) == 1;
              });
}

void add_store_options(CLI::App& command, BakeCommand& o) {
    add_value(command, "-o,--output", "FILE", "The store, e.g. earth.octa", [&](Where where, const std::string& text) {
        o.output = file_name(where, text);
    })->required();
    auto* resume = command.add_flag("--resume", o.bake.resume,
                                    "Go on where a bake of the same sources and options was stopped;\n"
                                    "nothing to do if it was not");
    command.add_flag("--replace", o.bake.replace, "Give up a store that is there")->excludes(resume);
    add_value(command, "--density", "LEVELS",
              "Finer than one vertex a sample by so many bisection levels, -20 to 20 [0]",
              [&](Where where, const std::string& text) {
                  o.bake.extra_levels = static_cast<int>(parse_whole(where, text, -20, 20));
              });
    add_value(command, "--least-level", "LEVEL",
              "Cells are at least this fine everywhere, also where no source is, 1 to 40 [18: 22 km]",
              [&](Where where, const std::string& text) {
                  o.least_level = static_cast<int>(parse_whole(where, text, 1, 40));
              });
    add_value(command, "--finest-level", "LEVEL", "No cell is finer than this bisection level, 1 to 60 [60]",
              [&](Where where, const std::string& text) {
                  o.bake.finest_level = static_cast<int>(parse_whole(where, text, 1, 60));
              });
    add_value(command, "--quantum", "METRES",
              "Step of heights, a power of two, 1/256 to 64 m [0.25, less below 30 m spacing]",
              [&](Where where, const std::string& text) { o.bake.quantum_m = quantum_from_text(where, text); });
    add_value(command, "--threads", "COUNT", "1 to 256; 0: as many as there are processors [0]",
              [&](Where where, const std::string& text) {
                  o.bake.threads = static_cast<int>(parse_whole(where, text, 0, 256));
              });
    add_value(command, "--memory", "BYTES", "Limit of the memory used, e.g. 512MiB [1GiB]",
              [&](Where where, const std::string& text) {
                  o.memory_bytes = parse_memory(where, text, least_memory, most_memory);
              });
}

nlohmann::ordered_json bound_json(double metres) {
    return std::isfinite(metres) ? nlohmann::ordered_json(metres) : nlohmann::ordered_json();
}

void fill(Report& report, const BakeCommand& command, const planet::BakeReport& baked,
          const planet::ElevationField& field, double seconds) {
    report.set("output", command.output.native());
    report.set("bytes", std::filesystem::file_size(command.output));
    report.set("tiles", baked.tiles);
    report.set("tile_bytes", baked.tile_bytes);
    report.set("vertices", baked.vertices);
    report.set("vertices_baked", baked.vertices - baked.vertices_resumed);
    report.set("vertices_per_second", static_cast<double>(baked.vertices - baked.vertices_resumed) / seconds);
    report.set("finest_level", baked.finest_level);
    report.set("spacing_m", spacing_of_level(command.bake.ellipsoid, baked.finest_level));
    report.set("quantum_m", baked.quantum_m);
    report.set("resampling_max_m", bound_json(baked.resampling_max_m));
    report.set("ellipsoid", planet::to_string(command.bake.ellipsoid));
    report.set("vertical_datum", planet::name_of(field.datum()));
    report.set("sources", sources_json(field.sources()));
    auto assumed = nlohmann::ordered_json::array();
    for (const planet::SourceInfo& source : field.sources())
        if (source.datum_assumed) assumed.push_back(source.name);
    report.set("vertical_datum_assumed", assumed);
    for (const auto& [step, taken] : baked.seconds) report.add_seconds(step, taken);
}

void print(const BakeCommand& command, const planet::BakeReport& baked, const planet::ElevationField& field,
           double seconds) {
    using Rows = std::vector<std::vector<std::string>>;
    Rows rows{{command.output.native(), bytes_text(std::filesystem::file_size(command.output)) + " in " +
                                            four_digits(seconds) + " s, " + bytes_text(peak_memory_bytes()) +
                                            " of memory"}};
    rows.push_back({"tiles", grouped(baked.tiles)});
    const std::uint64_t now = baked.vertices - baked.vertices_resumed;
    rows.push_back({"vertices",
                    grouped(baked.vertices) + (baked.vertices_resumed > 0 ? ", " + grouped(now) + " of them now" : "") +
                        ", " + grouped(static_cast<std::size_t>(static_cast<double>(now) / seconds)) + " a second"});
    rows.push_back({"finest", "bisection level " + std::to_string(baked.finest_level) + ", " +
                                  four_digits(spacing_of_level(command.bake.ellipsoid, baked.finest_level)) +
                                  " m between vertices"});
    rows.push_back({"heights", "above " + std::string(planet::name_of(field.datum())) + " in steps of " +
                                   four_digits(baked.quantum_m) + " m"});
    rows.push_back(
        {"bound", "no source sample is farther than " + four_digits(baked.resampling_max_m) + " m from the surface"});
    for (const planet::SourceInfo& source : field.sources())
        rows.push_back({"source", source.name + ", " + crs_text(source.crs) + ", above " +
                                      std::string(planet::name_of(source.datum)) +
                                      (source.datum_assumed ? " (assumed: it does not say), " : ", ") +
                                      (source.spacing_m > 0 ? four_digits(source.spacing_m) + " m" : "any spacing")});
    print_table(std::cout, rows);
}

void set_levels(BakeCommand& command) {
    const int finest = command.bake.finest_level, least = command.least_level.value_or(std::min(18, finest));
    if (least > finest)
        throw Error(Fault::bad_usage, "--least-level",
                    std::to_string(least) + " is finer than the finest level " + std::to_string(finest),
                    "1 to " + std::to_string(finest));
    command.bake.least_level = least;
}

/// What the program and GDAL take up themselves; the bake and the sources share the rest.
constexpr std::size_t program_memory = std::size_t{66} << 20;
constexpr std::size_t one_arena_below = std::size_t{256} << 20;

void tell_finished(const BakeCommand& command, Report& report) {
    std::cout << command.output.native() << " is finished\n";
    report.set("output", command.output.native());
    report.set("vertices_baked", 0);
    report.write();
}

void run(BakeCommand& command) {
    Report report("bake", command.json);
    set_levels(command);
    // What one thread frees is then of use to the others: 14 MiB less with two, for a tenth of the speed.
    if (command.memory_bytes < one_arena_below) mallopt(M_ARENA_MAX, 1);
    const std::size_t shared = command.memory_bytes - program_memory;
    const std::size_t for_sources = shared / 5;
    command.bake.memory_bytes = shared - for_sources;
    check_bake_sources(command);
    const BakeTarget target = check_bake_target(command.output, command.bake.resume, command.bake.replace);
    if (command.sources.empty() && !command.over_earth && target != BakeTarget::finished)
        throw Error(Fault::bad_usage, "bake", "no sources", "files, patterns or --base earth");
    if (target == BakeTarget::finished && command.sources.empty() && !command.over_earth) {
        tell_finished(command, report);
        return;
    }
    const auto start = std::chrono::steady_clock::now();
    Progress progress;
    const auto geoid = std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm"));
    const auto field = [&] {
        const auto step = report.step("sources");
        return open_bake_sources(command, geoid, for_sources,
                                 [&](double fraction) { progress.update("sources", fraction); });
    }();
    set_geoid(command.bake, geoid);
    command.bake.progress = [&](std::string_view step, double fraction) { progress.update(step, fraction); };
    const planet::BakeReport baked = planet::bake(*field, command.bake, command.output);
    if (target == BakeTarget::finished) {  // of these sources and options, else it were refused
        progress.clear();
        tell_finished(command, report);
        return;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress.clear();
    print(command, baked, *field, seconds);
    fill(report, command, baked, *field, seconds);
    report.write();
}

}  // namespace

void add_bake(CLI::App& program) {
    auto options = std::make_shared<BakeCommand>();
    CLI::App* command = add_command(program, "bake", "Elevation data of any size into one file to draw and query from",
                                    "octaglobe bake base.tif region.tif 'tiles/*.hgt' --datum egm96 -o earth.octa\n"
                                    "  octaglobe bake --base earth dem.tif -o earth.octa --json report.json");
    add_source_options(*command, *options);
    add_store_options(*command, *options);
    add_json_option(*command, options->json);
    command->final_callback([options] { run(*options); });
}

}  // namespace render
