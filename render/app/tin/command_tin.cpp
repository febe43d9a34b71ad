// octaglobe tin: rasters as triangulated irregular networks.

#include <memory>

#include "planet/error.h"
#include "render/app/program.h"
#include "render/app/tin/tin_options.h"
#include "render/app/values.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using Where = std::string_view;

constexpr double largest_deviation_m = 1e7, largest_base_m = 1e6;

std::string file_name(Where where, const std::string& text) {
    if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
    return text;
}

/// An option of one file or more.
CLI::Option* add_files(CLI::App& command, const std::string& name, const std::string& what,
                       std::vector<std::string>& files) {
    return command
        .add_option_function<std::vector<std::string>>(
            name,
            [&files, name](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) files.push_back(file_name(name, text));
            },
            what)
        ->type_name("FILE");
}

void add_what(CLI::App& command, TinCommand& o) {
    add_files(command, "dem",
              "Rasters of heights that GDAL reads, and quoted patterns of them, all on one grid;\nlater ones on top",
              o.sources);
    add_files(command, "--features", "Points and lines that must be in it: GeoJSON, GeoPackage, ...; polygons as lines",
              o.features);
    add_files(command, "--mask", "Polygons: nothing outside of them is triangulated", o.masks);
    add_value(command, "--datum", "DATUM",
              "What heights are above: egm96 or ellipsoid [what the file says, else egm96]",
              [&](Where where, const std::string& text) {
                  o.datum = static_cast<planet::VerticalDatum>(parse_choice(where, text, {"egm96", "ellipsoid"}));
              });
}

void add_how_much(CLI::App& command, TinCommand& o) {
    add_value(command, "--max-deviation", "METRES", "The bound: no sample is farther from the mesh, along its vertical",
              [&](Where where, const std::string& text) {
                  o.max_deviation = parse_distance(where, text, {0, largest_deviation_m});
              });
    add_value(command, "--max-triangles", "COUNT", "The budget: never more. Of bound and budget, whichever comes first",
              [&](Where where, const std::string& text) {
                  o.max_triangles = static_cast<std::size_t>(parse_whole(where, text, 2, 4'000'000'000));
              });
    add_value(command, "--quality", "QUALITY", "fast, standard or best: fewer triangles for more time [standard]",
              [&](Where where, const std::string& text) {
                  o.quality = static_cast<planet::TinQuality>(parse_choice(where, text, {"fast", "standard", "best"}));
              });
    add_value(command, "--metric", "METRIC",
              "What is refined first: local (the largest deviation), regional (the region with most of it),\n"
              "rms (with most of its square), or gpu (local, measured by drawing) [local]",
              [&](Where where, const std::string& text) {
                  o.measure.metric =
                      static_cast<TinMetricName>(parse_choice(where, text, {"local", "regional", "rms", "gpu"}));
              });
    add_value(command, "--locate", "WAY",
              "How samples find their triangle: auto, or as the iterative TIN was published, by cells or naive:\n"
              "the same result as greedy insertion without a grid, for comparison [auto]",
              [&](Where where, const std::string& text) {
                  o.measure.locate = static_cast<TinLocateName>(parse_choice(where, text, {"auto", "cells", "naive"}));
              });
}

void add_shape(CLI::App& command, TinCommand& o) {
    add_value(command, "--frame", "FRAME",
              "source (the raster's CRS), utm, enu (metres east, north and up of the raster's\n"
              "middle) or ecef [.ply, .obj: source; .glb, .stl: enu]",
              [&](Where where, const std::string& text) {
                  o.frame = static_cast<planet::MeshFrame>(parse_choice(where, text, {"source", "utm", "enu", "ecef"}));
              });
    add_value(command, "--exaggeration", "FACTOR",
              "Of heights in the file, 0.01 to 100; deviations stay metres of true height [1]",
              [&](Where where, const std::string& text) {
                  o.exaggeration = parse_number(where, text, {0.01, 100});
              });
    add_value(
        command, "--base", "METRES",
        "A solid, for printing: walls, and a floor so far below the lowest sample,\nbesides the triangles of a budget",
        [&](Where where, const std::string& text) {
            o.base = parse_distance(where, text, {1e-3, largest_base_m});
        });
}

void add_where_to(CLI::App& command, TinCommand& o) {
    add_value(command, "-o,--output", "FILE", "The mesh: .glb, .ply, .obj or .stl; with --tile a new folder",
              [&](Where where, const std::string& text) { o.output = file_name(where, text); });
    auto* tile = add_value(command, "--tile", "N",
                           "Tiles of N x N samples, 2 to 16384, that fit bit for bit; any size of raster",
                           [&](Where where, const std::string& text) {
                               o.tile = static_cast<int>(parse_whole(where, text, 2, planet::TinTiling::max_step));
                           });
    add_value(
        command, "--format", "FORMAT", "Of tiles: glb, ply, obj or stl [glb]",
        [&](Where where, const std::string& text) {
            o.tile_format = static_cast<planet::MeshFormat>(parse_choice(where, text, {"glb", "ply", "obj", "stl"}));
        })
        ->needs(tile);
    add_value(command, "--error-grid", "FILE", "The deviation at every sample, as a GeoTIFF",
              [&](Where where, const std::string& text) { o.error_grid = file_name(where, text); });
    add_value(command, "--drape", "FILE",
              "A picture, put into a .glb: where its georeference says, else over the raster edge to edge",
              [&](Where where, const std::string& text) { o.drape = file_name(where, text); });
    add_value(command, "--picture", "FILE",
              "A picture of steps towards it, each over the deviations it set out from: .png, .jpg or .tif",
              [&](Where where, const std::string& text) { o.picture = parse_picture_name(where, text); });
    add_value(command, "--stages", "COUNT,...", "Triangles at each step of the picture [50,150,250,450,750,1050]",
              [&](Where where, const std::string& text) { o.stages = parse_wholes(where, text, 3, 4'000'000'000); })
        ->needs("--picture");
    add_json_option(command, o.json);
}

bool same_file(const std::optional<std::filesystem::path>& a, const std::optional<std::filesystem::path>& b) {
    return a && b && a->lexically_normal() == b->lexically_normal();
}

void check_files(const TinCommand& o) {
    require(o.output || o.error_grid || o.picture || !o.json.empty(), "tin", "nothing to write",
            "-o FILE, --error-grid FILE, --picture FILE or --json FILE");
    std::optional<std::filesystem::path> json;
    if (!o.json.empty()) json = o.json;
    require(!same_file(o.output, json) && !same_file(o.output, o.error_grid) && !same_file(o.error_grid, json) &&
                !same_file(o.picture, json) && !same_file(o.picture, o.output) && !same_file(o.picture, o.error_grid),
            "tin", "one file for two things", "--output, --error-grid, --picture and --json with a file each");
    if (!o.drape) return;
    const bool glb = o.tile > 0 ? o.tile_format == planet::MeshFormat::glb
                                : o.output && planet::mesh_format(o.output->native()) == planet::MeshFormat::glb;
    require(glb, "--drape", "only a .glb holds a picture", "-o FILE.glb");
    require(!o.base, "--drape", "goes with no solid", "--drape without --base");
}

void check_tiles(const TinCommand& o) {
    require(o.output.has_value(), "--tile", "without a folder", "-o FOLDER");
    require(o.measure.metric != TinMetricName::gpu, "--tile", "goes not with gpu, which draws the raster as a whole",
            "--metric local, regional or rms");
    require(o.measure.goes_in_tiles(), "--tile",
            "goes with no other way to locate: it needs an error grid of the whole raster", "--locate auto");
    require(!o.picture, "--tile", "goes with no picture of steps, which are of one mesh", "--picture without --tile");
}

void check(const TinCommand& o) {
    require(!o.sources.empty(), "tin", "nothing to triangulate", "a raster");
    check_files(o);
    require(o.max_deviation || o.max_triangles, "tin", "no bound given", "--max-deviation or --max-triangles");
    require(o.measure.locate == TinLocateName::automatic || o.measure.metric == TinMetricName::local, "--locate",
            "goes with the local metric only", "--metric local");
    if (o.tile > 0) check_tiles(o);
}

void run(const TinCommand& command) {
    check(command);
    Report report("tin", command.json);
    if (command.tile > 0)
        tin_tiles(command, report);
    else
        tin_raster(command, report);
    report.write();
}

}  // namespace

void add_tin(CLI::App& program) {
    auto options = std::make_shared<TinCommand>();
    CLI::App* command = add_command(program, "tin", "A TIN of rasters: few triangles within a bound or a budget",
                                    "octaglobe tin dem.tif --max-deviation 5 -o terrain.glb --drape photo.jpg\n"
                                    "  octaglobe tin dem.tif --max-triangles 50000 --metric rms -o terrain.ply\n"
                                    "  octaglobe tin dem.tif --max-deviation 5 --features ridges.geojson peaks.gpkg "
                                    "--mask area.geojson -o terrain.obj\n"
                                    "  octaglobe tin dem.tif --max-deviation 5 --base 10 -o print.stl\n"
                                    "  octaglobe tin 'tiles/*.tif' --max-deviation 5 --tile 1024 -o out/");
    add_what(*command, *options);
    add_how_much(*command, *options);
    add_shape(*command, *options);
    add_where_to(*command, *options);
    command->final_callback([options] { run(*options); });
}

}  // namespace render
