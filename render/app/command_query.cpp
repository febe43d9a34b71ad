// octaglobe query: numbers about the planet. Each answer is one line that begins with the number, in metres.

#include <cmath>
#include <iostream>
#include <memory>

#include "planet/error.h"
#include "planet/geodesy/geodesic.h"
#include "planet/store/store_field.h"
#include "render/app/data_path.h"
#include "render/app/earth_store.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/render_options.h"
#include "render/app/report.h"
#include "render/app/source_report.h"

namespace render {
namespace {

using planet::degrees;

struct Options {
    std::vector<planet::Geodetic> places;
    EarthSources sources;
    std::optional<std::filesystem::path> store;
    std::string json;
};

/// 0..360 degrees, clockwise from north.
double bearing(double azimuth) {
    return std::fmod(azimuth / degrees + 360, 360);
}

/// Heights come from the store that pictures are drawn from, because only there is it known how far the surface can be
/// from the samples it was made of.
std::shared_ptr<const planet::ElevationStore> open_store(const Options& options) {
    if (options.store)
        return std::make_shared<const planet::ElevationStore>(
            planet::ElevationStore::open(*options.store, planet::wgs84));
    Progress progress;
    LazyEarth earth(options.sources);
    ChecksumIndex index = user_checksum_index();
    auto store = open_earth_store(options.sources, earth, index,
                                  [&](std::string_view step, double fraction) { progress.update(step, fraction); });
    index.save();
    return store;
}

void height(const Options& options) {
    Report report("query height", options.json);
    const planet::Geodetic& place = options.places.front();
    const planet::StoreField field(open_store(options));
    const glm::dvec3 normal = planet::normal_from_geodetic(place.latitude, place.longitude);
    const double found = static_cast<double>(field.height(normal));
    const planet::GeoidUndulation N = planet::Geoid(data_file("egm96-15.pgm")).undulation(normal);
    const bool orthometric = field.datum() == planet::VerticalDatum::egm96;
    const planet::OrthometricHeight H =
        orthometric ? planet::OrthometricHeight{found} : planet::EllipsoidalHeight{found} - N;
    const planet::EllipsoidalHeight h = H + N;
    // Only tiles on the way down to the place have been read.
    const auto damage = field.cache().damage();
    for (const auto& line : damage) std::cerr << "octaglobe: warning: " << line << "; a coarser one stands in for it\n";
    const double bound = field.bound_at(normal).total();
    const bool has_source = bound > 0;  // no surface of plane cells is that near to samples
    const bool bounded = has_source && damage.empty();
    std::cout << fixed(H.m, 2) << " m above EGM96, " << fixed(h.m, 2) << " m above the ellipsoid; "
              << (bounded          ? "samples there within " + four_digits(bound) + " m of the surface"
                  : damage.empty() ? "no source there"
                                   : "no bound, a tile there is damaged")
              << '\n';
    report.set("latitude_deg", place.latitude / degrees);
    report.set("longitude_deg", place.longitude / degrees);
    report.set("height_m", H.m);
    report.set("height_bound_m", bounded ? nlohmann::ordered_json(bound) : nlohmann::ordered_json());
    report.set("ellipsoidal_height_m", h.m);
    report.set("geoid_undulation_m", N.m);
    report.set("vertical_datum", planet::name_of(planet::VerticalDatum::egm96));
    report.set("crs", "EPSG:4326");
    report.set("sources", sources_json(field.sources()));
    report.set("damaged", !damage.empty());
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
    add_value(*at, "--store", "FILE", "A baked store instead of the default Earth",
              [&store = options->store](std::string_view where, const std::string& text) {
                  if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
                  store = text;
              })
        ->excludes("--elevation");
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
