// octaglobe query distance: the shortest line on the ellipsoid, and how long the ground below it is.

#include <iostream>

#include "planet/geodesy/geodesic_path.h"
#include "planet/terrain/ground_path.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/query/query.h"
#include "render/app/source_report.h"

namespace render {
namespace {

struct Options {
    std::vector<planet::Geodetic> places;
    bool on_terrain = false;
    std::string json;
    GroundOptions ground;
};

void distance_on_terrain(const Options& options, const planet::Geodesics& geodesics, Report& report) {
    const planet::StoreField field = open_ground(options.ground, report);
    Progress progress;
    const auto step = report.step("measure");
    const planet::PathTotals totals = planet::measure_path(field, planet::GeodesicPath(geodesics, options.places),
                                                           [&](double share) { progress.update("measuring", share); });
    progress.clear();
    report_damage(field, report);
    std::cout << fixed(totals.length, 2) << " m along the ground within " << four_digits(1e-6 * totals.length)
              << " m, up " << fixed(totals.ascent, 1) << " m and down " << fixed(totals.descent, 1) << " m, over ";
    report.set("terrain_length_m", totals.length);
    report.set("terrain_length_bound_m", 1e-6 * totals.length);
    report.set("ascent_m", totals.ascent);
    report.set("descent_m", totals.descent);
    report.set("sources", sources_json(field.sources()));
}

void distance(const Options& options) {
    Report report("query distance", options.json);
    const planet::Geodetic &from = options.places[0], &to = options.places[1];
    const planet::Geodesics geodesics(planet::wgs84);
    const planet::GeodesicInverse line = geodesics.inverse(from, to);
    if (options.on_terrain) distance_on_terrain(options, geodesics, report);
    const bool unique = geodesics.is_unique(from, to);
    std::cout << fixed(line.distance, 4) << " m" << (options.on_terrain ? " on the ellipsoid" : "")
              << ", setting out at " << fixed(bearing(line.start_azimuth), 6) << " degrees and arriving at "
              << fixed(bearing(line.end_azimuth), 6) << " degrees"
              << (unique ? "\n" : "; one of several lines that are equally short\n");
    report.set("distance_m", line.distance);
    report.set("start_azimuth_deg", bearing(line.start_azimuth));
    report.set("end_azimuth_deg", bearing(line.end_azimuth));
    report.set("unique", unique);
    report.set("crs", "EPSG:4326");
    report.write();
}

}  // namespace

void add_query_distance(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(query, "distance", "The length of the shortest line on the ellipsoid (WGS84)",
                                    "octaglobe query distance 37.5767,-105.4858 46.8523,-121.7603");
    for (const char* name : {"from", "to"})
        add_value(*command, name, "LAT,LON", "Degrees", [options, name](std::string_view, const std::string& text) {
            options->places.push_back(parse_place(name, text));
        })->required();
    command->add_flag("--on-terrain", options->on_terrain, "Also the length of the ground below that line");
    add_ground_options(*command, options->ground);
    add_json_option(*command, options->json);
    command->final_callback([options] { distance(*options); });
}

}  // namespace render
