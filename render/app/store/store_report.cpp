#include "render/app/store/store_report.h"

#include <iostream>

#include "render/app/figures.h"
#include "render/app/source_report.h"
#include "render/app/store/store_summary.h"
#include "render/app/table.h"

namespace render {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t areas_printed = 8;

std::string degrees_text(double value, char positive, char negative) {
    return fixed(std::abs(value), 2) + (value < 0 ? negative : positive);
}

std::string box_text(const StoreArea& area) {
    return degrees_text(area.south, 'N', 'S') + " to " + degrees_text(area.north, 'N', 'S') + ", " +
           degrees_text(area.west, 'E', 'W') + " to " + degrees_text(area.east, 'E', 'W');
}

std::string state_text(const StoreSummary& summary, const planet::StoreMetadata& m) {
    if (m.complete) return "complete";
    return "not complete: " + fixed(100 * summary.done, 1) + " % of " + grouped(m.tiles) +
           " tiles; octaglobe bake --resume goes on";
}

void add_overview(Rows& rows, const planet::StoreMetadata& m, const StoreSummary& summary) {
    rows.push_back({"state", state_text(summary, m)});
    rows.push_back({"format", "version " + std::to_string(m.format_version)});
    rows.push_back({"ellipsoid", planet::to_string(m.ellipsoid) + ", a " + fixed(m.ellipsoid.a, 3) + " m, b " +
                                     fixed(m.ellipsoid.b, 3) + " m"});
    rows.push_back({"heights", "above " + std::string(planet::name_of(m.datum)) + ", in steps of " +
                                   four_digits(m.quantum_m) + " m" +
                                   (summary.least_m <= summary.most_m
                                        ? ", " + fixed(summary.least_m, 1) + " to " + fixed(summary.most_m, 1) + " m"
                                        : "")});
    if (!m.undulation.empty()) rows.push_back({"geoid", m.undulation});
    rows.push_back({"finest", "bisection level " + std::to_string(m.finest_level) + ", " +
                                  four_digits(spacing_of_level(m.ellipsoid, m.finest_level)) + " m between vertices"});
    if (m.complete)
        rows.push_back({"bound", "no source sample is farther than " + four_digits(m.resampling_max_m) +
                                     " m from the finest surface"});
}

void print_levels(const StoreSummary& summary, const planet::StoreMetadata& m) {
    Rows rows{{"tiles from level", "tiles", "vertices"}};
    for (const StoreLevel& each : summary.levels)
        rows.push_back({std::to_string(each.level), grouped(each.tiles), each.vertices ? grouped(*each.vertices) : ""});
    rows.push_back({"all", grouped(summary.tiles), m.complete ? grouped(m.vertices) : ""});
    print_table(std::cout, rows);
}

void print_areas(const StoreSummary& summary) {
    Rows rows{{"tiles from level", "tiles", "area"}};
    for (std::size_t i = 0; i < std::min(areas_printed, summary.areas.size()); ++i)
        rows.push_back(
            {std::to_string(summary.areas[i].level), grouped(summary.areas[i].tiles), box_text(summary.areas[i])});
    if (rows.size() == 1) return;
    std::cout << '\n';
    print_table(std::cout, rows);
    if (summary.areas.size() > areas_printed)
        std::cout << "and " << grouped(summary.areas.size() - areas_printed) << " more areas\n";
}

void print_sources(const planet::StoreMetadata& m) {
    Rows rows{{"source", "spacing", "heights above", "CRS", "SHA-256"}};
    for (const planet::SourceInfo& source : m.sources)
        rows.push_back({source.name, source.spacing_m > 0 ? four_digits(source.spacing_m) + " m" : "any",
                        std::string(planet::name_of(source.datum)), crs_text(source.crs),
                        source.checksum.substr(0, 16)});
    if (rows.size() == 1) return;
    std::cout << '\n';
    print_table(std::cout, rows);
}

nlohmann::ordered_json levels_json(const StoreSummary& summary) {
    auto list = nlohmann::ordered_json::array();
    for (const StoreLevel& each : summary.levels) {
        list.push_back({{"bisection_level", each.level}, {"tiles", each.tiles}});
        list.back()["vertices"] = each.vertices ? nlohmann::ordered_json(*each.vertices) : nlohmann::ordered_json();
    }
    return list;
}

nlohmann::ordered_json areas_json(const StoreSummary& summary) {
    auto list = nlohmann::ordered_json::array();
    for (const StoreArea& each : summary.areas)
        list.push_back({{"bisection_level", each.level},
                        {"tiles", each.tiles},
                        {"south_deg", each.south},
                        {"west_deg", each.west},
                        {"north_deg", each.north},
                        {"east_deg", each.east}});
    return list;
}

void fill(Report& report, const planet::StoreMetadata& m, const StoreSummary& summary) {
    report.set("complete", m.complete);
    report.set("done", summary.done);
    report.set("format_version", m.format_version);
    report.set("ellipsoid", planet::to_string(m.ellipsoid));
    report.set("ellipsoid_a_m", m.ellipsoid.a);
    report.set("ellipsoid_f", m.ellipsoid.f);
    report.set("vertical_datum", planet::name_of(m.datum));
    report.set("geoid", m.undulation);
    report.set("quantum_m", m.quantum_m);
    report.set("finest_level", m.finest_level);
    report.set("least_level_asked", m.settings.least_level);
    report.set("finest_level_asked", m.settings.finest_level);
    report.set("density_asked", m.settings.extra_levels);
    report.set("spacing_m", spacing_of_level(m.ellipsoid, m.finest_level));
    report.set("height_min_m", summary.least_m);
    report.set("height_max_m", summary.most_m);
    report.set("resampling_max_m", m.complete ? nlohmann::ordered_json(m.resampling_max_m) : nlohmann::ordered_json());
    report.set("tiles", summary.tiles);
    report.set("tiles_planned", m.tiles);
    report.set("vertices", m.complete ? nlohmann::ordered_json(m.vertices) : nlohmann::ordered_json());
    report.set("levels", levels_json(summary));
    report.set("areas", areas_json(summary));
    report.set("sources", sources_json(m.sources));
}

}  // namespace

void describe_store(const std::filesystem::path& file, Report& report) {
    const auto store = planet::ElevationStore::open(file);
    const StoreSummary summary = summarize(store);
    const auto bytes = std::filesystem::file_size(file);
    Rows rows{{"store", file.native() + ", " + bytes_text(bytes)}};
    add_overview(rows, store.metadata(), summary);
    print_table(std::cout, rows);
    std::cout << '\n';
    print_levels(summary, store.metadata());
    print_areas(summary);
    print_sources(store.metadata());
    report.set("file", file.native());
    report.set("bytes", bytes);
    fill(report, store.metadata(), summary);
}

}  // namespace render
