#include "render/app/picture/render_options.h"

#include <string>

#include "planet/error.h"
#include "render/app/picture/daylight.h"
#include "render/app/program.h"
#include "render/picture/camera.h"

namespace render {
namespace {

using Where = std::string_view;

constexpr Range scale_range{0.5, 4};

std::vector<std::string_view> names_of_overlays() {
    std::vector<std::string_view> names;
    for (const auto& each : overlay_names) names.push_back(each.name);
    return names;
}

std::uint32_t overlays_from_text(Where where, const std::string& text) {
    std::uint32_t bits = 0;
    for (const std::size_t index : parse_choices(where, text, names_of_overlays()))
        bits |= static_cast<std::uint32_t>(overlay_names[index].overlay);
    return bits;
}

constexpr BackendChoice backends[] = {BackendChoice::automatic, BackendChoice::egl, BackendChoice::egl_device,
                                      BackendChoice::egl_surfaceless, BackendChoice::osmesa};

std::vector<std::string_view> names_of_backends() {
    std::vector<std::string_view> names;
    for (const auto backend : backends) names.push_back(backend_name(backend));
    return names;
}

std::filesystem::path path_from_text(Where where, const std::string& text) {
    if (text.empty()) throw planet::Error(planet::Fault::bad_usage, where, "empty file name", "a path");
    return text;
}

std::filesystem::path picture_path_from_text(Where where, const std::string& text) {
    std::filesystem::path path = path_from_text(where, text);
    std::string ending = path.extension().native();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const char* known : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr"})
        if (ending == known) return path;
    throw planet::Error(planet::Fault::bad_usage, where, shown(text) + " has no ending of a picture",
                        ".png, .jpg, .jpeg, .tif, .tiff, .exr");
}

void add_files(CLI::App& command, const std::string& name, const std::string& what,
               std::vector<std::filesystem::path>& files) {
    command
        .add_option_function<std::vector<std::string>>(
            name,
            [name, &files](const std::vector<std::string>& texts) {
                for (const auto& text : texts) files.push_back(path_from_text(name, text));
            },
            what)
        ->type_name("FILE");
}

void add_drawing_options(CLI::App& command, RenderOptions& o) {
    add_value(command, "--exaggeration", "FACTOR", "Of heights, 0 to 100 [1]",
              [&](Where where, const std::string& text) {
                  o.exaggeration = parse_number(where, text, {0, 100});
              });
    add_value(command, "--max-pixel-deviation", "PIXELS", "Certified bound on what the mesh may be off [0.5]",
              [&](Where where, const std::string& text) {
                  o.max_pixel_deviation = parse_number(where, text, {0.05, 100}, "pixels");
              });
    add_value(command, "--max-triangles", "COUNT", "The best picture with at most so many triangles",
              [&](Where where, const std::string& text) {
                  o.max_triangles = static_cast<std::size_t>(parse_whole(where, text, 1, 2'000'000'000));
              });
    add_value(command, "--memory", "BYTES", "Limit of elevation tiles kept, e.g. 512MiB [1GiB]",
              [&](Where where, const std::string& text) {
                  o.memory_bytes = parse_memory(where, text, std::size_t{1} << 20, std::size_t{1} << 40);
              });
    add_value(command, "--show", "LIST",
              "Draw on top: coastlines,borders,graticule,relief,mesh,levels,curve,segments,deviations",
              [&](Where where, const std::string& text) { o.show = overlays_from_text(where, text); });
    add_value(command, "--scale", "FACTOR", "Of lines, marks and letters, 0.5 to 4 [1; in a window its display's]",
              [&](Where where, const std::string& text) { o.scale = parse_number(where, text, scale_range); });
    add_value(command, "--samples", "COUNT", "Samples a pixel: 1, 2, 4, 8 [4 near the ground, 1 from afar]",
              [&](Where where, const std::string& text) {
                  o.samples = 1 << parse_choice(where, text, {"1", "2", "4", "8"});
              });
    add_value(
        command, "--threads", "COUNT", "1 to 256; 0: as many as there are processors [0]",
        [&](Where where, const std::string& text) { o.threads = static_cast<int>(parse_whole(where, text, 0, 256)); });
}

}  // namespace

void add_lens_options(CLI::App& command, RenderOptions& o) {
    add_value(command, "--fov", "DEGREES", "Field of view across the shorter side, 1 to 150 [40]",
              [&](Where where, const std::string& text) {
                  o.fov = parse_angle(where, text, {1, 150});
              });
    add_value(command, "--size", "WxH", "Pixels [1920x1080; of a window and of frames 1280x720]",
              [&](Where where, const std::string& text) { o.size = parse_size(where, text); });
    add_value(command, "--time", "UTC", "Where the sun and the stars are [morning at the place, in its summer]",
              [&](Where where, const std::string& text) { o.time = planet::utc_from_iso8601(text, where); });
}

void add_view_options(CLI::App& command, RenderOptions& o) {
    add_value(command, "--at", "LAT,LON", "The place, degrees (without it: the whole globe)",
              [&](Where where, const std::string& text) { o.at = parse_place(where, text); });
    auto* range = add_value(command, "--range", "DISTANCE", "How far the eye is from the ground at --at",
                            [&](Where where, const std::string& text) {
                                o.range = parse_distance(where, text, {1, 1e9});
                            });
    add_value(command, "--height", "DISTANCE", "Put the eye above --at, this high over the ground",
              [&](Where where, const std::string& text) {
                  o.height = parse_distance(where, text, {0.1, 1e9});
              })
        ->excludes(range);
    add_value(command, "--heading", "DEGREES", "Where the eye looks, clockwise from north [0]",
              [&](Where where, const std::string& text) {
                  o.heading = parse_angle(where, text, {0, 360});
              });
    add_value(command, "--pitch", "DEGREES", "Up or down: -90 straight down, 0 level [-90; with --height 0]",
              [&](Where where, const std::string& text) {
                  o.pitch = parse_angle(where, text, {-90, 90});
              });
    add_lens_options(command, o);
}

void complete_view_options(const CLI::App& command, RenderOptions& o) {
    if (o.height && command.count("--pitch") == 0) o.pitch = 0;
    if (command.count("--at") > 0 && command.count("--time") == 0)
        o.time = morning_at(o.at, o.height ? *o.height : o.range.value_or(whole_globe_range(o.fov)));
}

void add_elevation_options(CLI::App& command, EarthSources& sources) {
    add_files(command, "--elevation", "Rasters of heights over the default Earth, the last on top", sources.elevation);
    add_value(
        command, "--elevation-datum", "DATUM", "What their heights are above: egm96 or ellipsoid [egm96]",
        [&](Where where, const std::string& text) {
            constexpr planet::VerticalDatum data[] = {planet::VerticalDatum::egm96, planet::VerticalDatum::ellipsoid};
            sources.elevation_datum = data[parse_choice(where, text, {"egm96", "ellipsoid"})];
        })
        ->needs("--elevation");
}

void add_look_options(CLI::App& command, RenderOptions& o) {
    add_drawing_options(command, o);
    add_elevation_options(command, o.earth);
    add_value(command, "--store", "FILE", "A baked store instead of the default Earth",
              [&](Where where, const std::string& text) { o.store = path_from_text(where, text); })
        ->excludes("--elevation");
    add_layer_option(command, o.layers);
    add_files(command, "--imagery", "Pictures of the whole globe, the last on top, instead of the default", o.imagery);
}

void add_backend_option(CLI::App& command, RenderOptions& o) {
    add_value(command, "--backend", "NAME", "auto, egl, egl-device, egl-surfaceless or osmesa [auto]",
              [&](Where where, const std::string& text) {
                  o.backend = backends[parse_choice(where, text, names_of_backends())];
              });
}

void add_picture_options(CLI::App& command, RenderOptions& o) {
    add_view_options(command, o);
    add_look_options(command, o);
    add_backend_option(command, o);
    add_value(command, "--crop", "X,Y,WxH", "Only this part of the picture: the pixels it has in the whole",
              [&](Where where, const std::string& text) { o.crop = parse_crop(where, text); });
    add_value(command, "-o,--output", "FILE", "The picture: .png, .jpg, .tif or .exr [globe.png]",
              [&](Where where, const std::string& text) { o.output = picture_path_from_text(where, text); });
}

}  // namespace render
