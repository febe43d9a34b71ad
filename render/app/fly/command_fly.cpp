// octaglobe fly: a flight as a video, or as a folder of pictures.

#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>

#include "planet/error.h"
#include "render/app/fly/film.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/tile_report.h"

namespace render {
namespace {

struct Options {
    FilmOptions film;
    LineFollowing line;
    std::filesystem::path plan;
    std::string json;
    bool time_given = false;
    bool resume = false;
};

/// What frames depend on: the words of the command but for --resume, and the file that is flown along.
std::string flight_text(const std::filesystem::path& plan) {
    std::ifstream words("/proc/self/cmdline", std::ios::binary), file(plan, std::ios::binary);
    std::string text;
    for (std::string word; std::getline(words, word, '\0');)
        if (word != "--resume") text += word + '\n';
    return text + std::string(std::istreambuf_iterator<char>(file), {});
}

std::pair<long, long> frames_from_text(std::string_view where, const std::string& text) {
    const auto colon = text.find(':');
    if (colon == text.npos)
        throw planet::Error(planet::Fault::bad_usage, where, shown(text) + " is no range of frames",
                            "FIRST:LAST, both of them drawn, the first of all is 0");
    const std::string_view whole = text;
    const long first = parse_whole(where, whole.substr(0, colon), 0, most_frames - 1);
    return {first, parse_whole(where, whole.substr(colon + 1), first, most_frames - 1)};
}

void add_film_options(CLI::App& command, Options& o) {
    add_value(command, "--fps", "NUMBER", "Frames a second, 1 to 240 [30]",
              [&](std::string_view where, const std::string& text) {
                  o.film.fps = parse_number(where, text, {1, 240});
              });
    add_value(command, "--frames", "FIRST:LAST", "Only these; each has the pixels it has in the whole, 0 is the first",
              [&](std::string_view where, const std::string& text) { o.film.frames = frames_from_text(where, text); });
    add_value(command, "-o,--output", "NAME",
              "A video: .mp4, .webm, .mkv or .mov, by ffmpeg; else a folder of PNGs [flight]",
              [&](std::string_view where, const std::string& text) {
                  if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
                  o.film.render.output = text;
              });
}

void add_line_options(CLI::App& command, Options& o) {
    add_value(command, "--height", "DISTANCE", "Along a line: how high over the ground [500]",
              [&](std::string_view where, const std::string& text) {
                  o.line.height = parse_distance(where, text, {1, 1e7});
              });
    add_value(command, "--pitch", "DEGREES", "Along a line: up or down, 0 is level [-15]",
              [&](std::string_view where, const std::string& text) {
                  o.line.pitch = parse_angle(where, text, {-90, 90});
              });
    add_value(command, "--speed", "DISTANCE", "Along a line: how far in a second [100]",
              [&](std::string_view where, const std::string& text) {
                  o.line.speed_m_s = parse_distance(where, text, {0.1, 1e6});
              });
}

void refuse_large_frames(PictureSize size) {
    if (size.width <= film_side_max && size.height <= film_side_max) return;
    const std::string side = std::to_string(film_side_max);
    throw planet::Error(planet::Fault::bad_usage, "--size",
                        std::to_string(size.width) + "x" + std::to_string(size.height) + " is too large for frames",
                        "1x1 to " + side + "x" + side);
}

void fill(Report& report, const FilmOptions& options, const FilmReport& film) {
    report.set("output", options.render.output.native());
    report.set("width_pixels", options.render.size.width);
    report.set("height_pixels", options.render.size.height);
    report.set("frames_per_second", options.fps);
    report.set("flight_seconds", film.flight_seconds);
    report.set("frames", film.last_frame - film.first_frame + 1);
    report.set("first_frame", film.first_frame);
    report.set("last_frame", film.last_frame);
    report.set("frames_of_flight", film.frames_of_flight);
    report.set("frames_drawn", film.drawn_frames);
    report.set("triangles_max", film.triangles_max);
    report_tiles(report, film.tiles);
    report.set("deviation_max_m", film.deviation_max_m);
    report.set("pixel_deviation_max", film.pixel_deviation_max);
    report.set("pixel_deviation_bound", options.render.max_pixel_deviation);
    report.set("layers", layers_json(film.layers));
    report.set("damaged_tiles", film.damage);
    report.set("backend", film.backend);
    report.set("gl_version", film.gl_version);
    report.set("gl_renderer", film.gl_renderer);
    for (const auto& [step, seconds] : film.seconds) report.add_seconds(step, seconds);
}

void fly(Options& o) {
    const RenderOptions& render = o.film.render;
    refuse_large_frames(render.size);
    PlannedKey usual{.exaggeration = render.exaggeration};
    if (o.time_given) usual.time = render.time;
    const FlightPlan plan = read_flight_plan(o.plan, usual, o.line);
    Report report("fly", o.json);
    const auto output = make_frame_output(render.output, render.size, o.film.fps, {o.resume, flight_text(o.plan)});
    FilmReport film;
    {
        Progress progress;
        o.film.render.progress = [&](std::string_view step, double fraction) { progress.update(step, fraction); };
        film = draw_film(o.film, plan, *output);
        output->finish();
    }
    warn_of_layers(film.layers);
    for (const auto& line : film.damage)
        std::cerr << "octaglobe: warning: " << line << "; a coarser one stands in for it\n";
    fill(report, o.film, film);
    report.write();
}

}  // namespace

void add_fly(CLI::App& program) {
    auto options = std::make_shared<Options>();
    options->film.render.size = {1280, 720};
    options->film.render.output = "flight";
    CLI::App* command = add_command(
        program, "fly", "Draw a flight",
        "octaglobe fly path.json -o flight.mp4 --size 1280x720 --fps 30\n"
        "  octaglobe fly river.geojson --height 800m --speed 200m -o frames\n\n"
        "PATH is a JSON file of views:\n"
        "  {\"keys\": [{\"at\": [37.58, -105.49], \"range\": \"2000km\"},\n"
        "            {\"range\": \"40km\", \"heading\": 30, \"pitch\": -25, \"seconds\": 8},\n"
        "            {\"heading\": 120, \"speed\": 0.5}]}\n"
        "The words are those of render: at, range or height, heading, pitch, exaggeration, time. What a key leaves\n"
        "out is as in the one before; where none says a time, it is morning at the place seen from nearest.\n"
        "seconds: when a key is reached; speed: how much faster than a quiet pace.\n"
        "Or it is a GeoJSON, GPX or KML file with one line to follow.");
    add_value(*command, "path", "PATH", "The views to fly through, or a line to follow",
              [options](std::string_view, const std::string& text) { options->plan = text; })
        ->required();
    add_film_options(*command, *options);
    command->add_flag("--resume", options->resume,
                      "Goes on with the frames of the same command, where it was killed; for a folder of PNGs");
    add_line_options(*command, *options);
    add_lens_options(*command, options->film.render);
    add_look_options(*command, options->film.render);
    add_backend_option(*command, options->film.render);
    add_json_option(*command, options->json);
    command->final_callback([options, command] {
        options->time_given = command->count("--time") > 0;
        fly(*options);
    });
}

}  // namespace render
