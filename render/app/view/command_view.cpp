// octaglobe view: a window.

#include <iostream>
#include <memory>

#include "planet/error.h"
#include "planet/geodesy/ellipsoid.h"
#include "planet/store/elevation_store.h"
#include "render/app/picture/render_options.h"
#include "render/app/program.h"
#include "render/app/report.h"
#include "render/app/tile_report.h"
#include "render/app/view/viewer.h"

namespace render {
namespace {

struct Options {
    ViewerOptions viewer;
    std::string json;
};

void add_window_options(CLI::App& command, ViewerOptions& o) {
    command.add_flag("--full-screen", o.full_screen, "Fill the screen");
    command.add_flag("--bare", o.bare, "Nothing but the globe in the window");
    add_value(command, "--frames", "COUNT", "Leave after so many frames",
              [&](std::string_view where, const std::string& text) {
                  o.frames = static_cast<int>(parse_whole(where, text, 1, 1'000'000));
              });
    add_value(command, "--turn", "DEGREES", "Turn about the place by so much each of --frames",
              [&](std::string_view where, const std::string& text) {
                  o.turn = parse_angle(where, text, {-360, 360});
              })
        ->needs("--frames");
    add_value(command, "--screenshot", "FILE", "Write what the settled window shows, after --frames, and leave",
              [&](std::string_view where, const std::string& text) {
                  if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
                  o.screenshot = text;
              });
}

void fill(Report& report, const ViewerReport& view) {
    report.set("frames", view.frames);
    report.set("frame_seconds_median", view.frame_seconds_median);
    report.set("frame_seconds_max", view.frame_seconds_max);
    report.set("update_seconds_median", view.update_seconds_median);
    report.set("gl_errors", view.gl_errors);
    report.set("first_gl_error", view.first_gl_error);
    report.set("memory_early_bytes", view.memory_early_bytes);
    report.set("memory_late_bytes", view.memory_late_bytes);
    report.set("triangles", view.triangles);
    report.set("gpu_bytes", view.gpu_bytes);
    report_tiles(report, view.tiles);
    report.set("deviation_max_m", view.deviation_max_m);
    report.set("pixel_deviation_max", view.pixel_deviation_max);
    report.set("settled", view.settled);
    report.set("view", view.view);
    report.set("damaged_tiles", view.damage);
    report.set("layers", layers_json(view.layers));
    report.set("context", view.context);
    report.set("gl_version", view.gl_version);
    report.set("gl_renderer", view.gl_renderer);
}

}  // namespace

void add_view(CLI::App& program) {
    auto options = std::make_shared<Options>();
    options->viewer.render.size = {1280, 720};
    CLI::App* command = add_command(program, "view", "A window on the globe; H in it shows the keys",
                                    "octaglobe view\n  octaglobe view --at 37.58,-105.49 --range 40km --pitch -25");
    add_view_options(*command, options->viewer.render);
    add_look_options(*command, options->viewer.render);
    add_window_options(*command, options->viewer);
    add_json_option(*command, options->json);
    command->final_callback([options, command] {
        RenderOptions& render = options->viewer.render;
        complete_view_options(*command, render);
        Report report("view", options->json);
        if (!options->viewer.screenshot.empty()) {
            const OutputFile writable("--screenshot", options->viewer.screenshot);
        }
        // A store that cannot be read is refused before a window opens.
        if (render.store) planet::ElevationStore::open(*render.store, planet::wgs84);
        const ViewerReport view = view_globe(options->viewer);
        for (const auto& line : view.damage)
            std::cerr << "octaglobe: warning: " << line << "; a coarser one stands in for it\n";
        fill(report, view);
        report.write();
    });
}

}  // namespace render
