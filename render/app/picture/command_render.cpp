// octaglobe render: a picture.

#include <iostream>
#include <memory>

#include "planet/error.h"
#include "render/app/picture/picture.h"
#include "render/app/picture/render_options.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/source_report.h"
#include "render/app/tile_report.h"

namespace render {
namespace {

struct Options {
    RenderOptions render;
    std::string json;
};

void fill(Report& report, const RenderOptions& options, const PictureReport& picture) {
    report.set("output", options.output.native());
    report.set("width_pixels", options.size.width);
    report.set("height_pixels", options.size.height);
    if (const auto& crop = options.crop)
        report.set("crop_pixels", {{"x", crop->x}, {"y", crop->y}, {"width", crop->width}, {"height", crop->height}});
    report.set("latitude_deg", options.at.latitude / planet::degrees);
    report.set("longitude_deg", options.at.longitude / planet::degrees);
    report.set("eye_height_m", picture.eye_height_m);
    if (const auto& centre = picture.centre) {
        report.set("centre_latitude_deg", centre->place.latitude / planet::degrees);
        report.set("centre_longitude_deg", centre->place.longitude / planet::degrees);
        report.set("centre_height_m", centre->ground.height);
        report.set("centre_height_bound_m",
                   centre->ground.bound > 0 ? nlohmann::ordered_json(centre->ground.bound) : nlohmann::ordered_json());
        report.set("centre_range_m", centre->range_m);
        report.set("centre_deviation_m", centre->deviation_m);
    }
    report.set("time", planet::iso8601_from_utc(options.time));
    report.set("triangles", picture.triangles);
    report.set("vertices", picture.vertices);
    report.set("strip_indices", picture.strip_indices);
    report_tiles(report, picture.tiles);
    report.set("gpu_bytes", picture.sent_bytes);
    report.set("gpu_bytes_at_rest", picture.at_rest.sent_bytes);
    report.set("gpu_bytes_moving", picture.moving.sent_bytes);
    report.set("update_seconds_at_rest", picture.at_rest.seconds);
    report.set("update_seconds_moving", picture.moving.seconds);
    report.set("deviation_max_m", picture.deviation_max_m);
    report.set("pixel_deviation_max", picture.pixel_deviation_max);
    report.set("pixel_deviation_bound", options.max_pixel_deviation);
    report.set("damaged", !picture.damage.empty());
    report.set("damaged_tiles", picture.damage);
    report.set("exaggeration", options.exaggeration);
    report.set("crs", picture.crs);
    report.set("vertical_datum", picture.vertical_datum);
    report.set("sources", sources_json(picture.sources));
    report.set("layers", layers_json(picture.layers));
    report.set("backend", picture.backend);
    report.set("gl_version", picture.gl_version);
    report.set("gl_renderer", picture.gl_renderer);
    for (const auto& [step, seconds] : picture.seconds) report.add_seconds(step, seconds);
}

void refuse_crop_outside(const RenderOptions& options) {
    const PictureCrop crop = options.drawn();
    const auto [width, height] = options.size;
    if (crop.x + crop.width <= width && crop.y + crop.height <= height) return;
    throw planet::Error(planet::Fault::bad_usage, "--crop", "reaches beyond the picture",
                        "a part of " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
}

}  // namespace

void add_render(CLI::App& program) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(
        program, "render", "Draw a picture",
        "octaglobe render -o globe.png\n"
        "  octaglobe render --at 37.58,-105.49 --range 60km --heading 30 --pitch -25 --size 1920x1080 -o blanca.png");
    add_picture_options(*command, options->render);
    add_json_option(*command, options->json);
    command->final_callback([options, command] {
        RenderOptions& render = options->render;
        complete_view_options(*command, render);
        refuse_crop_outside(render);
        Progress progress;
        render.progress = [&](std::string_view step, double fraction) { progress.update(step, fraction); };
        render.measure_frames = !options->json.empty();
        Report report("render", options->json);
        // Refuses an output that cannot be written before the work, not after it.
        { const OutputFile writable("--output", render.output); }
        const PictureReport picture = draw_picture(render);
        warn_of_layers(picture.layers);
        for (const auto& line : picture.damage)
            std::cerr << "octaglobe: warning: " << line << "; a coarser one stands in for it\n";
        fill(report, render, picture);
        report.write();
    });
}

}  // namespace render
