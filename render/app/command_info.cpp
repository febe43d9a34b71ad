// octaglobe info: the build, its data, every way into OpenGL, limits; or what a store holds (store_report.h).

#include <algorithm>
#include <glm/glm.hpp>
#include <iostream>
#include <memory>
#include <thread>

#include "planet/error.h"
#include "render/app/data_path.h"
#include "render/app/program.h"
#include "render/app/report.h"
#include "render/app/store/store_report.h"
#include "render/app/table.h"
#include "render/app/values.h"
#include "render/app/version.h"
#include "render/gl/context.h"

namespace render {
namespace {

namespace fs = std::filesystem;

#if defined(__clang__)
const std::string compiler_name;  // its __VERSION__ begins with its name
#else
const std::string compiler_name = "g++ ";
#endif

/// Prints a line and puts the same into the report.
class Lines {
  public:
    explicit Lines(Report& report) : report_(report) {}
    void add(const std::string& title, const std::string& key, const std::string& text) {
        rows_.push_back({title, text});
        report_.set(key, text);
    }
    void add_text(const std::string& title, const std::string& text) { rows_.push_back({title, text}); }
    Report& report() { return report_; }
    void print() const { print_table(std::cout, rows_); }

  private:
    Report& report_;
    std::vector<std::vector<std::string>> rows_;
};

std::string known(std::string_view version) {
    return version.empty() ? "built without" : std::string(version);
}

void add_versions(Lines& lines) {
    lines.add("octaglobe", "version", std::string(version));
    lines.add("build", "build_type", std::string(build_type));
    lines.add("compiler", "compiler", compiler_name + __VERSION__);
    lines.add("GLM", "glm_version",
              std::to_string(GLM_VERSION_MAJOR) + "." + std::to_string(GLM_VERSION_MINOR) + "." +
                  std::to_string(GLM_VERSION_PATCH) + "." + std::to_string(GLM_VERSION_REVISION));
    lines.add("GeographicLib", "geographiclib_version", std::string(geographiclib_version));
    lines.add("SQLite", "sqlite_version", known(sqlite_version));
    lines.add("GDAL", "gdal_version", known(gdal_version));
    lines.add("OpenImageIO", "openimageio_version", known(openimageio_version));
}

/// Not the scripts and lists that the data folder holds beside the data.
bool is_product(const fs::path& file) {
    const fs::path ending = file.extension();
    return !ending.empty() && ending != ".py" && ending != ".md";
}

void add_data(Lines& lines) {
    const auto folder = data_folder();
    std::string places;
    for (const auto& place : data_places()) places.append(places.empty() ? "" : ", ").append(place.native());
    lines.add("data", "data_folder", folder ? folder->native() : "not found; looked in " + places);
    auto files = nlohmann::ordered_json::object();
    std::vector<fs::path> sorted;
    std::error_code failure;
    if (folder)
        for (const auto& entry : fs::directory_iterator(*folder, failure))
            if (entry.is_regular_file(failure) && is_product(entry.path())) sorted.push_back(entry.path());
    std::sort(sorted.begin(), sorted.end());
    for (const auto& file : sorted) {
        const auto bytes = fs::file_size(file, failure);
        if (failure) continue;
        files[file.filename().native()] = bytes;
        lines.add_text("", file.filename().native() + "  " + std::to_string(bytes) + " bytes");
    }
    lines.report().set("data_bytes", files);
    const auto cache = cache_folder();
    lines.add("cache", "cache_folder",
              cache ? cache->native() : "none: neither XDG_CACHE_HOME nor HOME can be written; caches stay in memory");
}

void add_backends(Lines& lines) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& probe : probe_backends()) {
        lines.add_text(probe.name, probe.available ? "OpenGL " + probe.gl_version + ", " + probe.gl_renderer
                                                   : "not usable: " + probe.reason);
        for (std::size_t i = 0; i < probe.devices.size(); ++i)
            lines.add_text("", "device " + std::to_string(i) + ": " + probe.devices[i]);
        list.push_back({{"name", probe.name},
                        {"available", probe.available},
                        {"gl_version", probe.gl_version},
                        {"gl_renderer", probe.gl_renderer},
                        {"devices", probe.devices},
                        {"reason", probe.reason},
                        {"seconds", probe.milliseconds / 1000}});
    }
    lines.report().set("backends", list);
}

void add_limits(Lines& lines) {
    const unsigned processors = std::thread::hardware_concurrency();
    lines.add_text("processors", std::to_string(processors));
    lines.report().set("processors", processors);
    const std::string side = std::to_string(picture_side_max);
    lines.add_text("picture", "1x1 to " + side + "x" + side + " pixels");
    lines.report().set("picture_side_max_pixels", picture_side_max);
}

}  // namespace

void add_info(CLI::App& program) {
    auto json = std::make_shared<std::string>(), file = std::make_shared<std::string>();
    CLI::App* command = add_command(program, "info", "The build, its data, every way into OpenGL, limits; or a store",
                                    "octaglobe info --json info.json\n"
                                    "  octaglobe info earth.octa");
    add_value(*command, "file", "FILE", "Instead: what an elevation store holds",
              [file](std::string_view where, const std::string& text) {
                  if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
                  *file = text;
              });
    add_json_option(*command, *json);
    command->final_callback([json, file] {
        Report report("info", *json);
        if (!file->empty()) {
            describe_store(*file, report);
            report.write();
            return;
        }
        Lines lines(report);
        add_versions(lines);
        add_data(lines);
        {
            const auto step = report.step("graphics");
            add_backends(lines);
        }
        add_limits(lines);
        lines.print();
        report.write();
    });
}

}  // namespace render
