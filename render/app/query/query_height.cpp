// octaglobe query height: of the ground or the sea, at one place or at millions.

#include <algorithm>
#include <charconv>
#include <iostream>
#include <numeric>

#include "planet/error.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/parallel.h"
#include "render/app/figures.h"
#include "render/app/output_file.h"
#include "render/app/program.h"
#include "render/app/query/place_list.h"
#include "render/app/query/query.h"
#include "render/app/source_report.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

struct Options : HeightOptions {
    std::string list, output;
};

struct Answer {
    planet::Ground ground;
    HeightReference::Heights heights;
    planet::SurfaceOrigin origin;
    int level = 0;  ///< bisection level of the cell
};

/// In the order of the cells, so that a cursor goes from one to the next, on all processors.
std::vector<Answer> answers(const planet::StoreField& field, const SourceNames& names,
                            const std::vector<planet::Geodetic>& places) {
    const HeightReference reference(field);
    std::vector<glm::dvec3> normals(places.size());
    std::vector<std::uint64_t> codes(places.size());
    constexpr std::size_t chunk = 4096;
    const std::size_t chunks = (places.size() + chunk - 1) / chunk;
    const auto each = [&](auto&& work) {
        planet::parallel_for(chunks, 0,
                             [&](std::size_t c) { work(c * chunk, std::min((c + 1) * chunk, places.size())); });
    };
    each([&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            normals[i] = planet::normal_from_geodetic(places[i].latitude, places[i].longitude);
            codes[i] = planet::cell_at(normals[i], 24).bits();
        }
    });
    std::vector<std::uint32_t> order(places.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](auto a, auto b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
    std::vector<Answer> found(places.size());
    each([&](std::size_t first, std::size_t end) {
        planet::SurfaceCursor cursor = field.cursor();
        for (std::size_t k = first; k < end; ++k) {
            const std::size_t i = order[k];
            const planet::Ground ground = planet::ground_at(cursor, normals[i]);
            found[i] = {ground, reference.heights(ground, normals[i]),
                        names.known(cursor.origin(normals[i]), ground.bound > 0), cursor.cell().bisection_level()};
        }
    });
    return found;
}

double spacing_of(const Answer& answer) {
    return planet::cell_metrics(answer.level).vertex_spacing * planet::wgs84.mean_radius();
}

/// "0.25 m above EGM96, ...; samples there within 1.2 m of the surface, ...; from dem.tif".
std::string line_of(const Answer& a, const SourceNames& names, planet::VerticalDatum first, bool damaged) {
    const std::string H = fixed(a.heights.H.m, 2) + " m above EGM96",
                      h = fixed(a.heights.h.m, 2) + " m above the ellipsoid";
    std::string line = first == planet::VerticalDatum::egm96 ? H + ", " + h : h + ", " + H;
    const bool bounded = a.ground.bound > 0;
    const bool has_source = a.origin.count > 1 || (a.origin.count == 1 ? a.origin.files[0] > 0 : bounded);
    if (damaged)
        line += "; no bound, a tile there is damaged";
    else if (bounded)
        line += "; samples there within " + four_digits(a.ground.bound) + " m of the surface";
    else
        line += has_source ? "; no sample there" : "; no source there";
    line += ", whose vertices are " + four_digits(spacing_of(a)) + " m apart";
    return has_source ? line + "; " + names.text(a.origin) : line;
}

nlohmann::ordered_json json_of(const planet::Geodetic& place, const Answer& a, const SourceNames& names,
                               planet::VerticalDatum datum, bool damaged) {
    nlohmann::ordered_json json = place_json(place);
    json["height_m"] = a.heights.above(datum);
    json["height_bound_m"] = bound_json(a.ground, damaged);
    json["orthometric_height_m"] = a.heights.H.m;
    json["ellipsoidal_height_m"] = a.heights.h.m;
    json["geoid_undulation_m"] = a.heights.N.m;
    json["sag_m"] = a.ground.sag();
    json["vertex_spacing_m"] = spacing_of(a);
    names.set(json, a.origin);
    return json;
}

void append_number(std::string& text, double value, int decimals) {
    char digits[64];
    const auto [end, failure] =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals);
    text.append(digits, failure == std::errc() ? end : digits);
}

std::string table_of(const std::vector<planet::Geodetic>& places, const std::vector<Answer>& found,
                     const SourceNames& names) {
    std::string text = "latitude_deg,longitude_deg,height_m,ellipsoidal_height_m,height_bound_m,";
    text.append(SourceNames::csv_columns).append("\n");
    text.reserve(text.size() + places.size() * 64);
    for (std::size_t i = 0; i < places.size(); ++i) {
        append_number(text, places[i].latitude / planet::degrees, 9);
        append_number(text += ',', places[i].longitude / planet::degrees, 9);
        append_number(text += ',', found[i].heights.H.m, 3);
        append_number(text += ',', found[i].heights.h.m, 3);
        text += ',';
        if (found[i].ground.bound > 0) append_number(text, found[i].ground.bound, 3);
        text.append(",").append(names.csv(found[i].origin)).append("\n");
    }
    return text;
}

void height(const Options& options) {
    if (options.places.empty() == options.list.empty())
        throw Error(Fault::bad_usage, "query height",
                    options.list.empty() ? "place is required" : "--points is instead of places",
                    "LAT,LON one or more times, or --points");
    Report report("query height", options.json);
    std::optional<OutputFile> output;
    if (!options.output.empty()) output.emplace("--output", options.output);
    std::vector<planet::Geodetic> places = options.places;
    if (!options.list.empty()) {
        const auto step = report.step("read");
        places = read_places(options.list);
    }
    const planet::StoreField field = open_ground(options.ground, report);
    const SourceNames names(field.sources());
    std::vector<Answer> found;
    {
        const auto step = report.step("heights");
        found = answers(field, names, places);
    }
    const bool damaged = report_damage(field, report);
    if (output) {
        output->commit(table_of(places, found, names));
    } else if (!options.list.empty()) {
        std::cout << table_of(places, found, names);
    } else {
        for (const Answer& answer : found) std::cout << line_of(answer, names, options.datum, damaged) << '\n';
    }
    report.set("crs", "EPSG:4326");
    report.set("vertical_datum", planet::name_of(options.datum));
    report.set("sources", sources_json(field.sources()));
    report.set("points", places.size());
    if (places.size() == 1) {
        const nlohmann::ordered_json only = json_of(places[0], found[0], names, options.datum, damaged);
        for (const auto& [key, value] : only.items()) report.set(key, value);
    } else if (options.list.empty()) {
        auto list = nlohmann::ordered_json::array();
        for (std::size_t i = 0; i < places.size(); ++i)
            list.push_back(json_of(places[i], found[i], names, options.datum, damaged));
        report.set("heights", list);
    }
    report.write();
}

}  // namespace

void add_query_height(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* at = add_command(query, "height", "The height of the ground or the sea at places",
                               "octaglobe query height -16.5,180\n"
                               "  octaglobe query height --points places.csv -o heights.csv");
    add_places(*at, "place", "Degrees", options->places, 0);
    add_value(*at, "--points", "FILE",
              "Many places instead: .csv (latitude, longitude), .geojson, .kml, ... or - for CSV",
              [&list = options->list](std::string_view where, const std::string& text) {
                  if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path, or -");
                  list = text;
              });
    add_value(*at, "-o,--output", "FILE", "The answers as CSV",
              [&output = options->output](std::string_view where, const std::string& text) {
                  if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
                  output = text;
              });
    add_height_options(*at, *options, "What comes first");
    at->final_callback([options] { height(*options); });
}

}  // namespace render
