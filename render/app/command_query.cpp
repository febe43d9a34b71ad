// octaglobe query: numbers about the planet. Each answer is one line that begins with the number, in metres.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "planet/geodesy/geodesic.h"
#include "render/app/earth.h"
#include "render/app/program.h"
#include "render/app/render_options.h"
#include "render/app/report.h"

namespace render {
namespace {

using planet::degrees;

struct Options {
    std::vector<planet::Geodetic> places;
    EarthSources sources;
    std::string json;
};

/// A number with so many decimals; no "-0.0".
std::string fixed(double value, int decimals) {
    char text[400];
    const int length = std::snprintf(text, sizeof text, "%.*f", decimals, value);
    const std::string number(text, static_cast<std::size_t>(length));
    return number.find_first_of("123456789") == std::string::npos && number.front() == '-' ? number.substr(1) : number;
}

/// 0..360 degrees, clockwise from north.
double bearing(double azimuth) {
    return std::fmod(azimuth / degrees + 360, 360);
}

void height(const Options& options) {
    Report report("query height", options.json);
    const planet::Geodetic& place = options.places.front();
    const Earth earth = open_earth(options.sources);
    const glm::dvec3 normal = planet::normal_from_geodetic(place.latitude, place.longitude);
    const planet::OrthometricHeight H{static_cast<double>(earth.heights->height(normal))};
    const planet::GeoidUndulation N = earth.geoid->undulation(place.latitude, place.longitude);
    const planet::EllipsoidalHeight h = H + N;
    std::cout << fixed(H.m, 2) << " m above EGM96, " << fixed(h.m, 2) << " m above the ellipsoid\n";
    report.set("latitude_deg", place.latitude / degrees);
    report.set("longitude_deg", place.longitude / degrees);
    report.set("height_m", H.m);
    report.set("ellipsoidal_height_m", h.m);
    report.set("geoid_undulation_m", N.m);
    report.set("vertical_datum", planet::name_of(earth.heights->datum()));
    report.set("crs", "EPSG:4326");
    report.write();
}

void distance(const Options& options) {
    Report report("query distance", options.json);
    const planet::Geodetic &from = options.places[0], &to = options.places[1];
    const planet::GeodesicInverse line = planet::Geodesics(planet::wgs84).inverse(from, to);
    std::cout << fixed(line.distance, 4) << " m, setting out at " << fixed(bearing(line.start_azimuth), 6)
              << " degrees and arriving at " << fixed(bearing(line.end_azimuth), 6) << " degrees\n";
    report.set("distance_m", line.distance);
    report.set("start_azimuth_deg", bearing(line.start_azimuth));
    report.set("end_azimuth_deg", bearing(line.end_azimuth));
    report.set("crs", "EPSG:4326");
    report.write();
}

void add_place(CLI::App& command, const std::string& name, Options& options) {
    add_value(command, name, "LAT,LON", "Degrees", [&, name](std::string_view, const std::string& text) {
        options.places.push_back(parse_place(name, text));
    })->required();
}

}  // namespace

void add_query(CLI::App& program) {
    CLI::App* query =
        add_command(program, "query", "Heights and distances, in metres", "octaglobe query height 37.5767,-105.4858");
    query->require_subcommand(1);
    auto options = std::make_shared<Options>();

    CLI::App* at = add_command(*query, "height", "The height of the ground or the sea at a place",
                               "octaglobe query height -16.5,180");
    add_place(*at, "place", *options);
    add_elevation_options(*at, options->sources);
    add_json_option(*at, options->json);
    at->final_callback([options] { height(*options); });

    CLI::App* between = add_command(*query, "distance", "The length of the shortest line on the ellipsoid (WGS84)",
                                    "octaglobe query distance 37.5767,-105.4858 46.8523,-121.7603");
    add_place(*between, "from", *options);
    add_place(*between, "to", *options);
    add_json_option(*between, options->json);
    between->final_callback([options] { distance(*options); });
}

}  // namespace render
