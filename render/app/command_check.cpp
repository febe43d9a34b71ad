// octaglobe check: the accuracy certificate. Every claim with its figure and its bound.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>

#include "planet/error.h"
#include "render/app/check_parts.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/table.h"

namespace render {
namespace {

/// A further part is a function that returns rows, and a line here.
struct Part {
    const char* name;
    std::vector<planet::CheckRow> (*rows)();
};
constexpr Part parts[] = {
    {"positions", [] { return planet::check_positions(planet::wgs84); }},
    {"data", check_data_files},
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

/// @param reasons gets a line for each part that could not be measured
std::vector<planet::CheckRow> all_rows(Report& report, std::vector<std::string>& reasons) {
    Progress progress;
    std::vector<planet::CheckRow> rows;
    for (const Part& part : parts) {
        progress.update(part.name, std::nan(""));
        const auto step = report.step(part.name);
        try {
            const auto more = part.rows();
            rows.insert(rows.end(), more.begin(), more.end());
        } catch (const planet::Error& error) {
            // What cannot be measured does not hold; the rest of the certificate is still worth having.
            rows.push_back(planet::check_row(part.name + std::string(" could not be checked"), 1, 0, "failure"));
            reasons.push_back(error.what());
        }
    }
    return rows;
}

void run(const std::string& json) {
    Report report("check", json);
    std::vector<std::string> reasons;
    const auto rows = all_rows(report, reasons);
    const auto failed = std::count_if(rows.begin(), rows.end(), [](const auto& row) { return !row.passed; });
    print(rows);
    for (const auto& reason : reasons) std::cout << reason << '\n';
    report.set("checks", rows.size());
    report.set("failed", failed);
    report.set("passed", failed == 0);
    report.set("rows", json_from_rows(rows));
    report.set("reasons", reasons);
    report.write();
    if (failed > 0)
        throw planet::Error(planet::Fault::check_failed, "check",
                            std::to_string(failed) + " of " + std::to_string(rows.size()) + " bounds do not hold");
}

}  // namespace

void add_check(CLI::App& program) {
    auto json = std::make_shared<std::string>();
    CLI::App* command =
        add_command(program, "check", "The accuracy certificate: exit status 1 if a bound does not hold",
                    "octaglobe check --json certificate.json");
    add_json_option(*command, *json);
    command->final_callback([json] { run(*json); });
}

}  // namespace render
