// octaglobe check: the accuracy certificate. Every claim with its figure and its bound.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>

#include "planet/error.h"
#include "render/app/check/check_parts.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/table.h"

namespace render {
namespace {

/// A further part is a function of check_parts.h, and a line here.
struct Part {
    const char* name;
    CheckPart (*measure)(Progress& progress);
    bool only_if_asked = false;
};
constexpr Part parts[] = {
    {"positions",
     [](Progress&) {
         return CheckPart{planet::check_positions(planet::wgs84), {}};
     }},
    {"grid", [](Progress&) { return check_grid(); }},
    {"vertex shaders", [](Progress&) { return check_vertex_shaders(); }},
    {"meshes",
     [](Progress& progress) {
         return check_meshes([&](std::string_view step, double fraction) { progress.update(step, fraction); });
     }},
    {"data", [](Progress&) { return check_data_files(); }},
    {"closure", [](Progress&) { return check_closure(); }, true},
};

/// Three significant digits, without a locale.
std::string figure(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 3).ptr};
}

void print(const std::vector<planet::CheckRow>& rows) {
    std::vector<std::vector<std::string>> cells{{"check", "value", "bound", "unit", "pass"}};
    for (const auto& row : rows)
        cells.push_back({row.name, figure(row.value), figure(row.bound), row.unit, row.passed ? "yes" : "NO"});
    print_table(std::cout, cells);
}

nlohmann::ordered_json json_from_rows(const std::vector<planet::CheckRow>& rows) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& row : rows)
        list.push_back({{"name", row.name},
                        {"value", row.value},
                        {"bound", row.bound},
                        {"unit", row.unit},
                        {"passed", row.passed}});
    return list;
}

struct Certificate {
    std::string tables;
    std::vector<planet::CheckRow> rows;
    std::vector<std::string> reasons;  ///< a line for each part that could not be measured
    std::vector<std::string> skipped;  ///< a line for each that this machine has no means for
};

Certificate measure(Report& report, bool closure) {
    Progress progress;
    Certificate all;
    for (const Part& part : parts) {
        if (part.only_if_asked && !closure) continue;
        progress.update(part.name, std::nan(""));
        const auto step = report.step(part.name);
        try {
            const CheckPart more = part.measure(progress);
            all.rows.insert(all.rows.end(), more.rows.begin(), more.rows.end());
            if (!more.tables.empty()) all.tables += more.tables + '\n';
            if (!more.skipped.empty()) all.skipped.push_back(more.skipped);
        } catch (const planet::Error& error) {
            // What cannot be measured does not hold; the rest of the certificate is still worth having.
            all.rows.push_back(planet::check_row(part.name + std::string(" could not be checked"), 1, 0, "failure"));
            all.reasons.push_back(error.what());
        }
    }
    return all;
}

void run(const std::string& json, bool closure) {
    Report report("check", json);
    const auto [tables, rows, reasons, skipped] = measure(report, closure);
    const auto failed = std::count_if(rows.begin(), rows.end(), [](const auto& row) { return !row.passed; });
    std::cout << tables;
    print(rows);
    for (const auto& reason : reasons) std::cout << reason << '\n';
    for (const auto& line : skipped) std::cout << "skipped: " << line << '\n';
    report.set("checks", rows.size());
    report.set("failed", failed);
    report.set("passed", failed == 0);
    report.set("rows", json_from_rows(rows));
    report.set("reasons", reasons);
    report.set("skipped", skipped);
    report.write();
    if (failed > 0)
        throw planet::Error(planet::Fault::check_failed, "check",
                            std::to_string(failed) + " of " + std::to_string(rows.size()) + " bounds do not hold");
}

}  // namespace

void add_check(CLI::App& program) {
    auto json = std::make_shared<std::string>();
    auto closure = std::make_shared<bool>(false);
    CLI::App* command =
        add_command(program, "check", "The accuracy certificate: exit status 1 if a bound does not hold",
                    "octaglobe check --json certificate.json");
    command->add_flag("--closure", *closure,
                      "Also measure what removing a vertex takes along, and print two tables of it");
    add_json_option(*command, *json);
    command->final_callback([json, closure] { run(*json, *closure); });
}

}  // namespace render
