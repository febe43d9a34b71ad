// octaglobe query viewshed: what is seen from a place, as a raster, an outline or a picture.

#include <cmath>
#include <iostream>

#include "planet/elevation/grid_writer.h"
#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/terrain/viewshed.h"
#include "render/app/figures.h"
#include "render/app/output_file.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/query/query.h"
#include "render/app/query/query_sight.h"
#include "render/app/source_report.h"
#include "render/app/temporary_names.h"

namespace render {
namespace {

using planet::degrees;
using planet::Error;
using planet::Fault;
using planet::Viewshed;

struct Options {
    planet::Geodetic place;
    planet::ViewshedOptions view;
    std::filesystem::path output;
    std::string json;
    GroundOptions ground;
};

/// The ground lit from the north-west, what is seen in colour. RGBA: clear outside of the radius.
planet::Image picture_of(const Viewshed& view) {
    planet::Image image;
    image.width = image.height = view.side;
    image.channels = 4;
    image.pixels.assign(view.cells.size() * 4, 0);
    const auto height = [&](int column, int row) {
        return static_cast<double>(view.heights[static_cast<std::size_t>(std::clamp(row, 0, view.side - 1)) *
                                                    static_cast<std::size_t>(view.side) +
                                                static_cast<std::size_t>(std::clamp(column, 0, view.side - 1))]);
    };
    const glm::dvec3 light = glm::normalize(glm::dvec3(-1, 1, 1.4));
    for (int row = 0; row < view.side; ++row)
        for (int column = 0; column < view.side; ++column) {
            const std::uint8_t seen = view.at(column, row);
            if (seen == Viewshed::outside) continue;
            const double east = (height(column + 1, row) - height(column - 1, row)) / (2 * view.cell);
            const double north = (height(column, row - 1) - height(column, row + 1)) / (2 * view.cell);
            // At the rim a neighbour may be outside: no slope there.
            const glm::dvec3 normal =
                std::isfinite(east + north) ? glm::normalize(glm::dvec3(-east, -north, 1)) : glm::dvec3(0, 0, 1);
            const double lit = 0.35 + 0.65 * std::max(glm::dot(normal, light), 0.0) / light.z;
            const glm::dvec3 color = seen == Viewshed::visible ? glm::dvec3(242, 169, 59) : glm::dvec3(150, 154, 160);
            std::uint8_t* pixel =
                &image.pixels[4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(view.side) +
                                   static_cast<std::size_t>(column))];
            for (int c = 0; c < 3; ++c)
                pixel[c] = static_cast<std::uint8_t>(std::lround(std::clamp(color[c] * lit, 0.0, 255.0)));
            pixel[3] = 255;
        }
    return image;
}

void write(const Viewshed& view, const Options& options, OutputFile& output) {
    const std::string ending = options.output.extension();
    planet::ClassGrid grid;
    grid.width = grid.height = view.side;
    grid.cells = view.cells;
    grid.cell = view.cell;
    grid.top_left = glm::dvec2(-0.5, 0.5) * (view.side * view.cell);
    grid.crs = planet::azimuthal_equidistant_crs(options.place.latitude / degrees, options.place.longitude / degrees);
    grid.outside = Viewshed::outside;
    grid.description = "Viewshed from " + place_text(options.place) + ", eye " + fixed(options.view.eye_height, 2) +
                       " m and target " + fixed(options.view.target_height, 2) + " m above the ground, refraction " +
                       fixed(options.view.refraction, 3);
    grid.classes = {{Viewshed::hidden, "hidden"}, {Viewshed::visible, "visible"}};
    output.commit(ending == ".geojson" ? planet::geojson_of(grid, Viewshed::visible) : planet::geotiff_of(grid));
}

void viewshed(Options& options) {
    Report report("query viewshed", options.json);
    const bool picture = options.output.extension() == ".png";
    std::optional<OutputFile> output;
    if (picture)
        OutputFile("--output", options.output);  // refuses what cannot be written before the work
    else if (!options.output.empty())
        output.emplace("--output", options.output);
    const planet::StoreField field = open_ground(options.ground, report);
    Viewshed view;
    {
        const auto step = report.step("viewshed");
        Progress progress;
        options.view.progress = [&](double share) { progress.update("looking", share); };
        view = planet::viewshed(field, options.place, options.view);
    }
    const auto step = report.step("write");
    if (picture)
        planet::write_image(options.output.string(), picture_of(view), {.make_file = make_listed});
    else if (output)
        write(view, options, *output);
    report_damage(field, report);
    std::cout << fixed(view.visible_area, 0) << " m2 seen, " << fixed(100 * view.visible_share(), 2) << " % within "
              << fixed(options.view.radius, 0) << " m; cells of " << fixed(view.cell, 2) << " m, "
              << grouped(view.side_count()) << " x " << grouped(view.side_count()) << '\n';
    report.set("latitude_deg", options.place.latitude / degrees);
    report.set("longitude_deg", options.place.longitude / degrees);
    report.set("radius_m", options.view.radius);
    report.set("cell_m", view.cell);
    report.set("side_cells", view.side);
    report.set("visible_area_m2", view.visible_area);
    report.set("visible_share", view.visible_share());
    report.set("visible_cells", view.visible_count);
    report.set("cells", view.count);
    report.set("ground_cells", view.ground_cells);
    report.set("height_bound_max_m", view.bound > 0 ? nlohmann::ordered_json(view.bound) : nlohmann::ordered_json());
    report_sight_options(options.view, report);
    if (!options.output.empty()) report.set("output", options.output.native());
    report.set("crs",
               planet::azimuthal_equidistant_crs(options.place.latitude / degrees, options.place.longitude / degrees));
    report.set("sources", sources_json(field.sources()));
    report.write();
}

}  // namespace

void add_query_viewshed(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(query, "viewshed", "What is seen from a place over the ground",
                                    "octaglobe query viewshed 37.5767,-105.4858 --radius 20km -o viewshed.tif");
    add_value(*command, "place", "LAT,LON", "Degrees", [options](std::string_view, const std::string& text) {
        options->place = parse_place("place", text);
    })->required();
    add_value(*command, "--radius", "DISTANCE", "Along the ellipsoid, 10 m to 500 km [20km]",
              [options](std::string_view where, const std::string& text) {
                  options->view.radius = parse_distance(where, text, {10, planet::viewshed_radius_max_m});
              });
    add_value(*command, "--cell", "DISTANCE", "Of the grid [radius / 400]",
              [options](std::string_view where, const std::string& text) {
                  options->view.cell = parse_distance(where, text, {0.1, planet::viewshed_radius_max_m});
              });
    add_sight_options(*command, options->view);
    add_value(*command, "--threads", "COUNT", "1 to 256; 0: as many as there are processors [0]",
              [options](std::string_view where, const std::string& text) {
                  options->view.threads = static_cast<unsigned>(parse_whole(where, text, 0, 256));
              });
    add_value(*command, "-o,--output", "FILE",
              "A raster in an azimuthal equidistant projection, .tif; outlines, .geojson; a picture, .png",
              [options](std::string_view where, const std::string& text) {
                  options->output = text;
                  const std::string ending = options->output.extension();
                  if (ending != ".tif" && ending != ".png" && ending != ".geojson")
                      throw Error(Fault::bad_usage, where, shown(text) + " has no ending of a viewshed",
                                  ".tif, .geojson, .png");
              });
    add_ground_options(*command, options->ground);
    add_json_option(*command, options->json);
    command->final_callback([options] { viewshed(*options); });
}

}  // namespace render
