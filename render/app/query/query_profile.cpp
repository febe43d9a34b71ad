// octaglobe query profile: heights along geodesics, as a figure or a table.

#include <iostream>

#include "planet/error.h"
#include "planet/geodesy/geodesic_path.h"
#include "planet/terrain/ground_path.h"
#include "render/app/figures.h"
#include "render/app/output_file.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/query/profile_chart.h"
#include "render/app/query/query.h"
#include "render/app/source_report.h"

namespace render {
namespace {

using planet::degrees;
using planet::Error;
using planet::Fault;

struct Options : HeightOptions {
    std::size_t samples = 500;
    std::filesystem::path output;
    bool curvature = false;
};

struct Sample {
    planet::PathSample at;
    HeightReference::Heights heights;
    planet::SurfaceOrigin origin;
    double slope = 0;  ///< rise over run along the path, of the heights above the datum asked for
};

std::vector<Sample> samples_of(const planet::StoreField& field, const SourceNames& names,
                               const planet::GeodesicPath& path, const Options& options) {
    const HeightReference reference(field);
    planet::SurfaceCursor cursor = field.cursor();
    std::vector<Sample> samples;
    for (const planet::PathSample& s : planet::sample_path(field, path, options.samples)) {
        const glm::dvec3 n = planet::normal_from_geodetic(s.place.latitude, s.place.longitude);
        cursor.seek(n);
        samples.push_back({s, reference.heights(s.ground, n), names.known(cursor.origin(n), s.ground.bound > 0), 0});
    }
    const auto height = [&](std::size_t i) { return samples[i].heights.above(options.datum); };
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::size_t before = i > 0 ? i - 1 : i, after = i + 1 < samples.size() ? i + 1 : i;
        const double run = samples[after].at.distance - samples[before].at.distance;
        samples[i].slope = run > 0 ? (height(after) - height(before)) / run : 0;
    }
    return samples;
}

std::string table_of(const std::vector<Sample>& samples, const SourceNames& names) {
    std::string text =
        "distance_m,latitude_deg,longitude_deg,height_m,ellipsoidal_height_m,slope_percent,height_bound_m,";
    text.append(SourceNames::csv_columns).append("\n");
    for (const Sample& s : samples) {
        text += fixed(s.at.distance, 3) + "," + fixed(s.at.place.latitude / degrees, 9) + "," +
                fixed(s.at.place.longitude / degrees, 9) + "," + fixed(s.heights.H.m, 3) + "," +
                fixed(s.heights.h.m, 3) + "," + fixed(100 * s.slope, 3) + "," +
                (s.at.ground.bound > 0 ? fixed(s.at.ground.bound, 3) : "") + "," + names.csv(s.origin) + "\n";
    }
    return text;
}

/// From where to where along the path heights are from the same files: to half the distance between samples.
nlohmann::ordered_json stretches_json(const std::vector<Sample>& samples, const SourceNames& names) {
    auto list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double end = samples[i].at.distance;
        if (i == 0 || !(samples[i].origin == samples[i - 1].origin)) {
            const double begin = i == 0 ? 0 : 0.5 * (samples[i - 1].at.distance + end);
            if (i > 0) list.back()["to_m"] = begin;
            list.push_back({{"from_m", begin}});
            names.set(list.back(), samples[i].origin);
        }
        list.back()["to_m"] = end;
    }
    return list;
}

std::string figure_of(const std::vector<Sample>& samples, const planet::GeodesicPath& path, const Options& options,
                      double bound) {
    ProfileChart chart;
    for (const Sample& s : samples) {
        chart.distance.push_back(s.at.distance);
        chart.height.push_back(s.heights.above(options.datum));
    }
    for (std::size_t leg = 1; leg < path.legs(); ++leg) chart.corners.push_back(path.leg_start(leg));
    const auto text = [](const planet::Geodetic& place) {
        const double latitude = place.latitude / degrees, longitude = place.longitude / degrees;
        return fixed(std::abs(latitude), 4) + "\u00b0" + (latitude < 0 ? "S" : "N") + " " +
               fixed(std::abs(longitude), 4) + "\u00b0" + (longitude < 0 ? "W" : "E");
    };
    chart.from = text(options.places.front());
    chart.to = text(options.places.back());
    chart.datum = options.datum == planet::VerticalDatum::egm96 ? "EGM96" : "the ellipsoid";
    chart.note = grouped(samples.size()) + " samples" +
                 (bound > 0 ? ", source within " + four_digits(bound) + " m" : std::string());
    if (options.curvature) {
        const glm::dvec3 middle = path.normal_at(path.length() / 2);
        chart.radius = planet::curvature_radii(planet::wgs84, middle).mean();
    }
    return svg_of(chart);
}

void report_totals(const planet::PathTotals& totals, const planet::GeodesicPath& path, Report& report) {
    report.set("distance_m", path.length());
    report.set("terrain_length_m", totals.length);
    report.set("ascent_m", totals.ascent);
    report.set("descent_m", totals.descent);
    report.set("lowest_m", totals.lowest);
    report.set("lowest_at_m", totals.lowest_at);
    report.set("highest_m", totals.highest);
    report.set("highest_at_m", totals.highest_at);
    report.set("height_bound_max_m",
               totals.bound > 0 ? nlohmann::ordered_json(totals.bound) : nlohmann::ordered_json());
}

void profile(const Options& options) {
    Report report("query profile", options.json);
    std::optional<OutputFile> output;
    if (!options.output.empty()) output.emplace("--output", options.output);
    const planet::GeodesicPath path(planet::Geodesics(planet::wgs84), options.places);
    const planet::StoreField field = open_ground(options.ground, report);
    planet::PathTotals totals;
    {
        const auto step = report.step("measure");
        Progress progress;
        totals = planet::measure_path(field, path, [&](double share) { progress.update("measuring", share); });
    }
    const SourceNames names(field.sources());
    {
        const auto step = report.step("sample");
        const std::vector<Sample> samples = samples_of(field, names, path, options);
        report.set("stretches", stretches_json(samples, names));
        if (output) {
            output->commit(options.output.extension() == ".csv" ? table_of(samples, names)
                                                                : figure_of(samples, path, options, totals.bound));
            report.set("output", options.output.native());
            report.set("samples", samples.size());
        }
    }
    report_damage(field, report);
    std::cout << fixed(path.length(), 2) << " m along the ellipsoid, " << fixed(totals.length, 2)
              << " m along the ground; up " << fixed(totals.ascent, 1) << " m, down " << fixed(totals.descent, 1)
              << " m; from " << fixed(totals.lowest, 1) << " m to " << fixed(totals.highest, 1) << " m above "
              << (field.datum() == planet::VerticalDatum::egm96 ? "EGM96" : "the ellipsoid") << '\n';
    report_totals(totals, path, report);
    report.set("crs", "EPSG:4326");
    report.set("vertical_datum", planet::name_of(field.datum()));
    report.set("sources", sources_json(field.sources()));
    report.write();
}

}  // namespace

void add_query_profile(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(query, "profile", "The ground along shortest lines through places",
                                    "octaglobe query profile 37.2,-105.9 37.9,-105.1 -o profile.svg");
    add_places(*command, "place", "Degrees, two or more", options->places, 2);
    add_value(*command, "--samples", "COUNT", "Evenly along the path, 2 to 1000000 [500]",
              [options](std::string_view where, const std::string& text) {
                  options->samples = static_cast<std::size_t>(parse_whole(where, text, 2, 1'000'000));
              });
    add_value(*command, "-o,--output", "FILE", "A figure, .svg, or a table, .csv",
              [options](std::string_view where, const std::string& text) {
                  options->output = text;
                  if (options->output.extension() != ".svg" && options->output.extension() != ".csv")
                      throw Error(Fault::bad_usage, where, shown(text) + " has no ending of a profile", ".svg, .csv");
              });
    command->add_flag("--curvature", options->curvature, "Draw the figure with the planet's curvature");
    add_height_options(*command, *options, "Of the figure and the slopes");
    command->final_callback([options] { profile(*options); });
}

}  // namespace render
