// octaglobe query line-of-sight: whether one place is seen from another.

#include <iostream>

#include "planet/terrain/sight.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/query/query.h"
#include "render/app/query/query_sight.h"
#include "render/app/source_report.h"

namespace render {
namespace {

using planet::degrees;
using planet::Sight;
using planet::Visibility;

struct Options {
    std::vector<planet::Geodetic> places;
    planet::SightOptions sight;
    std::string json;
    GroundOptions ground;
};

const char* name_of(Visibility v) {
    return v == Visibility::visible ? "visible" : v == Visibility::hidden ? "hidden" : "undecided";
}

std::string line_of(const Sight& s) {
    const std::string where = place_text(s.obstruction) + ", " + fixed(s.obstruction_distance, 1) + " m from the eye";
    std::string line = s.visible ? "visible" : "hidden";
    if (s.visible)
        line += s.clearance > 0.005
                    ? ": the ground is nearest, " + fixed(s.clearance, 2) + " m below the line, at " + where
                    : ": no ground before the target is nearer to the line than the target's own";
    else
        line += ": the ground is " + fixed(-s.clearance, 2) + " m above the line at " + where + "; " +
                fixed(s.rise_needed, 2) + " m higher it would be seen";
    if (s.certain == Visibility::undecided) line += "; undecided within the bound of " + four_digits(s.bound) + " m";
    return line;
}

void line_of_sight(const Options& options) {
    Report report("query line-of-sight", options.json);
    planet::check(options.sight);
    const planet::StoreField field = open_ground(options.ground, report);
    Sight s;
    {
        const auto step = report.step("sight");
        s = planet::line_of_sight(field, options.places[0], options.places[1], options.sight);
    }
    report_damage(field, report);
    std::cout << fixed(s.distance, 2) << " m, " << line_of(s) << '\n';
    report.set("distance_m", s.distance);
    report.set("visible", s.visible);
    report.set("visibility", name_of(s.certain));
    report.set("clearance_m", s.clearance);
    report.set("obstruction_latitude_deg", s.obstruction.latitude / degrees);
    report.set("obstruction_longitude_deg", s.obstruction.longitude / degrees);
    report.set("obstruction_ellipsoidal_height_m", s.obstruction.h.m);
    report.set("obstruction_distance_m", s.obstruction_distance);
    report.set("rise_needed_m", s.rise_needed);
    report.set("height_bound_max_m", s.bound > 0 ? nlohmann::ordered_json(s.bound) : nlohmann::ordered_json());
    report.set("ground_cells", s.cells);
    report_sight_options(options.sight, report);
    report.set("crs", "EPSG:4326");
    report.set("sources", sources_json(field.sources()));
    report.write();
}

}  // namespace

void add_sight_options(CLI::App& command, planet::SightOptions& options) {
    add_value(command, "--eye-height", "DISTANCE", "Above the ground, 0.01 m to 20 km [2]",
              [&](std::string_view where, const std::string& text) {
                  options.eye_height = parse_distance(where, text, {0.01, planet::sight_height_max_m});
              });
    add_value(command, "--target-height", "DISTANCE", "Above the ground, 0 to 20 km [0]",
              [&](std::string_view where, const std::string& text) {
                  options.target_height = parse_distance(where, text, {0, planet::sight_height_max_m});
              });
    add_value(command, "--refraction", "COEFFICIENT", "Curvature of light in the Earth's, -1 to 0.5; 0: none [0.13]",
              [&](std::string_view where, const std::string& text) {
                  options.refraction = parse_number(where, text, {-1, 0.5});
              });
}

void report_sight_options(const planet::SightOptions& options, Report& report) {
    report.set("eye_height_m", options.eye_height);
    report.set("target_height_m", options.target_height);
    report.set("refraction_coefficient", options.refraction);
}

void add_query_sight(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        add_command(query, "line-of-sight", "Whether a place is seen from another over the ground",
                    "octaglobe query line-of-sight 37.58,-105.49 37.75,-105.6 --eye-height 2 --target-height 10");
    for (const char* name : {"from", "to"})
        add_value(*command, name, "LAT,LON", "Degrees", [options, name](std::string_view, const std::string& text) {
            options->places.push_back(parse_place(name, text));
        })->required();
    add_sight_options(*command, options->sight);
    add_ground_options(*command, options->ground);
    add_json_option(*command, options->json);
    command->final_callback([options] { line_of_sight(*options); });
}

}  // namespace render
