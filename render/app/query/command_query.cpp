// octaglobe query: numbers about the planet. Each answer is one line that begins with the number, in metres.

#include <cmath>
#include <iostream>

#include "planet/error.h"
#include "render/app/data_path.h"
#include "render/app/figures.h"
#include "render/app/picture/earth_store.h"
#include "render/app/picture/render_options.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/query/query.h"

namespace render {

using planet::degrees;

void add_ground_options(CLI::App& command, GroundOptions& options) {
    add_elevation_options(command, options.sources);
    add_value(command, "--store", "FILE", "A baked store instead of the default Earth",
              [&store = options.store](std::string_view where, const std::string& text) {
                  if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
                  store = text;
              })
        ->excludes("--elevation");
}

void add_height_options(CLI::App& command, HeightOptions& options, const std::string& datum_use) {
    add_value(command, "--datum", "DATUM", datum_use + ": egm96 or ellipsoid [egm96]",
              [&datum = options.datum](std::string_view where, const std::string& text) {
                  datum = parse_choice(where, text, {"egm96", "ellipsoid"}) == 0 ? planet::VerticalDatum::egm96
                                                                                 : planet::VerticalDatum::ellipsoid;
              });
    add_ground_options(command, options.ground);
    add_json_option(command, options.json);
}

planet::StoreField open_ground(const GroundOptions& options, Report& report) {
    const auto step = report.step("store");
    if (options.store)
        return planet::StoreField(std::make_shared<const planet::ElevationStore>(
            planet::ElevationStore::open(*options.store, planet::wgs84)));
    Progress progress;
    LazyEarth earth(options.sources);
    ChecksumIndex index = user_checksum_index();
    auto store = open_earth_store(options.sources, earth, index,
                                  [&](std::string_view what, double fraction) { progress.update(what, fraction); });
    index.save();
    return planet::StoreField(std::move(store));
}

bool report_damage(const planet::StoreField& field, Report& report) {
    // Only tiles on the way down to what was asked for have been read.
    const auto damage = field.cache().damage();
    for (const auto& line : damage) std::cerr << "octaglobe: warning: " << line << "; a coarser one stands in for it\n";
    report.set("damaged", !damage.empty());
    return !damage.empty();
}

HeightReference::HeightReference(const planet::StoreField& field)
    : geoid_(data_file("egm96-15.pgm")), datum_(field.datum()) {}

HeightReference::Heights HeightReference::heights(const planet::Ground& ground, const glm::dvec3& normal) const {
    const planet::GeoidUndulation N = geoid_.undulation(normal);
    const planet::OrthometricHeight H = datum_ == planet::VerticalDatum::egm96
                                            ? planet::OrthometricHeight{ground.height}
                                            : planet::EllipsoidalHeight{ground.height} - N;
    return {H, H + N, N};
}

CLI::Option* add_places(CLI::App& command, const std::string& name, const std::string& what,
                        std::vector<planet::Geodetic>& places, int least, int most) {
    auto* option = command.add_option_function<std::vector<std::string>>(
        name,
        [&places, name](const std::vector<std::string>& texts) {
            for (const auto& text : texts) places.push_back(parse_place(name, text));
        },
        what);
    return option->type_name("LAT,LON")->required(least > 0)->expected(std::max(least, 1), most);
}

double bearing(double azimuth) {
    return std::fmod(azimuth / degrees + 360, 360);
}

std::string place_text(const planet::Geodetic& place) {
    return fixed(place.latitude / degrees, 6) + "," + fixed(place.longitude / degrees, 6);
}

nlohmann::ordered_json place_json(const planet::Geodetic& place) {
    return {{"latitude_deg", place.latitude / degrees}, {"longitude_deg", place.longitude / degrees}};
}

nlohmann::ordered_json bound_json(const planet::Ground& ground, bool damaged) {
    // No surface is that near to samples: where there is no bound there is no source.
    return ground.bound > 0 && !damaged ? nlohmann::ordered_json(ground.bound) : nlohmann::ordered_json();
}

void add_query(CLI::App& program) {
    CLI::App* query =
        add_command(program, "query", "Heights, profiles, distances, areas, lines of sight and viewsheds, in metres",
                    "octaglobe query height 37.5767,-105.4858");
    query->require_subcommand(1);
    add_query_height(*query);
    add_query_profile(*query);
    add_query_distance(*query);
    add_query_area(*query);
    add_query_sight(*query);
    add_query_viewshed(*query);
}

}  // namespace render
