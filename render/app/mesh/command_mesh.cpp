// octaglobe mesh: rasters and the planet as triangulations with a bound.

#include <algorithm>
#include <filesystem>
#include <memory>

#include "planet/error.h"
#include "planet/exporters/mesh_file.h"
#include "render/app/arguments.h"
#include "render/app/mesh/mesh_options.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/program.h"
#include "render/picture/mesh_picture.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using Where = std::string_view;

constexpr double largest_deviation_m = 1e7;

std::string file_name(Where where, const std::string& text) {
    if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
    return text;
}

void add_what(CLI::App& command, MeshOptions& o) {
    add_value(command, "dem", "FILE", "A raster of heights in any format and CRS that GDAL reads, or a heightmap",
              [&](Where where, const std::string& text) { o.source = file_name(where, text); });
    command.add_flag("--planet", o.planet, "Instead: the whole planet, closed");
    add_value(command, "--store", "FILE", "A baked store instead of the default Earth",
              [&](Where where, const std::string& text) { o.store = file_name(where, text); })
        ->needs("--planet");
    add_value(command, "--patches", "CxR", "Instead: flat square patches, up to 64x64, for --remove",
              [&](Where where, const std::string& text) {
                  const auto cross = text.find('x');
                  if (cross == std::string::npos)
                      throw Error(Fault::bad_usage, where, shown(text) + " is no grid", "1x1 to 64x64");
                  o.columns = static_cast<int>(parse_whole(where, text.substr(0, cross), 1, 64));
                  o.rows = static_cast<int>(parse_whole(where, text.substr(cross + 1), 1, 64));
              });
    add_value(command, "--patch-level", "LEVEL", "Patches of 2^LEVEL + 1 samples a side, 1 to 10 [4]",
              [&](Where where, const std::string& text) {
                  o.patch_level = static_cast<int>(parse_whole(where, text, 1, 10));
              })
        ->needs("--patches");
}

void add_how_much(CLI::App& command, MeshOptions& o) {
    add_value(command, "--max-deviation", "METRES", "The bound: no sample is farther from the mesh, along its vertical",
              [&](Where where, const std::string& text) {
                  o.max_deviation = parse_distance(where, text, {0, largest_deviation_m});
              });
    add_value(command, "--max-triangles", "COUNT", "The budget: never more; where a bound takes more, it gives way",
              [&](Where where, const std::string& text) {
                  o.max_triangles = static_cast<std::size_t>(parse_whole(where, text, 2, 4'000'000'000));
              });
    add_value(
        command, "--level", "LEVEL", "Instead: the uniform mesh of a bisection level; two more halve its sides",
        [&](Where where, const std::string& text) { o.level = static_cast<int>(parse_whole(where, text, 0, 56)); });
    add_value(
        command, "--priority", "WHICH",
        "What a budget is spent on: the largest deviation (least: the least mesh; max: decimation) or the rms [least]",
        [&](Where where, const std::string& text) {
            o.priority = static_cast<MeshPriority>(parse_choice(where, text, {"least", "max", "rms"}));
        })
        ->needs("--max-triangles");
    add_value(command, "--keep", "FILE", "Points, lines, outlines whose samples must stay: GeoJSON, GeoPackage, ...",
              [&](Where where, const std::string& text) { o.keep = file_name(where, text); });
    add_value(command, "--remove", "A,B",
              "Remove a vertex of the finest mesh with all that depend on it: sample X,Y of\n"
              "--patches, or the vertex nearest to LAT,LON with --planet --level 1 to 22",
              [&](Where where, const std::string& text) { o.remove = file_name(where, text); });
}

void add_where_to(CLI::App& command, MeshOptions& o) {
    add_value(command, "-o,--output", "FILE", "The mesh: .glb, .ply, .obj or .stl",
              [&](Where where, const std::string& text) { o.output = file_name(where, text); });
    add_value(command, "--frame", "FRAME",
              "source (the raster's CRS), utm, enu (metres east, north and up of the raster's\n"
              "middle) or ecef [.ply, .obj: source; .glb, .stl: enu; the planet: ecef]",
              [&](Where where, const std::string& text) {
                  o.frame = static_cast<planet::MeshFrame>(parse_choice(where, text, {"source", "utm", "enu", "ecef"}));
              });
    add_value(command, "--datum", "DATUM", "What the raster's heights are above: egm96 or ellipsoid [egm96]",
              [&](Where where, const std::string& text) {
                  o.datum = static_cast<planet::VerticalDatum>(parse_choice(where, text, {"egm96", "ellipsoid"}));
              });
    add_value(command, "--drape", "FILE",
              "A picture, put into a .glb: where its georeference says, else over the raster edge to edge",
              [&](Where where, const std::string& text) { o.drape = file_name(where, text); });
    add_value(command, "--picture", "FILE", "A picture of the triangles: .png, .jpg or .tif",
              [&](Where where, const std::string& text) { o.picture = parse_picture_name(where, text); });
    add_mesh_picture_size(command, "Of the picture [1600 wide, as high as the terrain; the planet 1600x1600]",
                          o.picture_size);
    add_json_option(command, o.json);
}

void check_files(const MeshOptions& o) {
    require(o.output || o.picture || !o.json.empty(), "mesh", "nothing to write",
            "-o FILE, --picture FILE or --json FILE");
    const std::filesystem::path json = o.json;
    const bool twice = (o.output && (o.output == o.picture || *o.output == json)) || (o.picture && *o.picture == json);
    require(!twice, "mesh", "one file for two things", "--output, --picture and --json with a file each");
}

void check_drape(const MeshOptions& o) {
    if (!o.drape) return;
    require(!o.source.empty(), "--drape", "goes over a raster", "a raster");
    require(o.output && planet::mesh_format(o.output->native()) == planet::MeshFormat::glb, "--drape",
            "only a .glb holds a picture", "-o FILE.glb");
    require(*o.drape != *o.output, "--drape", "would be overwritten", "another --output");
}

void check_removal(const MeshOptions& o) {
    require(o.source.empty(), "--remove", "goes with no raster", "--patches, or --planet --level");
    require(!o.max_deviation && !o.max_triangles && o.keep.empty() && !o.frame && !o.datum && !o.store, "--remove",
            "goes with no bound, budget, features, frame, datum or store",
            "--patches --patch-level, or --planet --level");
    if (o.planet)
        require(o.level && *o.level >= 1 && *o.level <= 22, "--remove", "needs a level", "--planet --level 1 to 22");
    else
        require(!o.level, "--level", "is for --planet and rasters", "--patch-level");
}

void check(const MeshOptions& o) {
    const int kinds = !o.source.empty() + o.planet + (o.columns > 0);
    require(kinds == 1, "mesh", kinds == 0 ? "nothing to mesh" : "more than one thing to mesh",
            "a raster, or --planet, or --patches");
    check_files(o);
    check_drape(o);
    if (!o.remove.empty()) return check_removal(o);
    require(o.columns == 0, "--patches", "without a vertex to remove", "--remove X,Y");
    require(o.max_deviation || o.max_triangles || o.level, "mesh", "no bound given",
            "--max-deviation, --max-triangles or --level");
    require(!o.level || (!o.max_deviation && !o.max_triangles), "--level", "goes with no bound and no budget",
            "--level alone");
    if (!o.planet) return;
    require(!o.frame || *o.frame == planet::MeshFrame::ecef, "--frame", "the planet has one frame", "ecef");
    require(!o.datum, "--datum", "is for rasters", "--planet without it");
    require(!o.max_triangles || *o.max_triangles >= 8, "--max-triangles",
            std::to_string(o.max_triangles.value_or(0)) + " is too few for the planet", "8 or more");
    require(!o.level || o.keep.empty(), "--keep", "goes with no level of the planet",
            "--max-deviation or --max-triangles");
}

void run(const MeshOptions& options) {
    check(options);
    Report report("mesh", options.json);
    if (!options.remove.empty())
        mesh_domain(options, report);
    else if (options.planet)
        mesh_planet(options, report);
    else
        mesh_raster(options, report);
    report.write();
}

}  // namespace

void add_mesh(CLI::App& program) {
    auto options = std::make_shared<MeshOptions>();
    CLI::App* command =
        add_command(program, "mesh", "A mesh of a raster or of the planet, within a bound or a budget",
                    "octaglobe mesh dem.tif --max-deviation 20 -o terrain.glb\n"
                    "  octaglobe mesh dem.tif --max-triangles 1000 --keep ridges.geojson --frame utm -o t.ply\n"
                    "  octaglobe mesh --planet --max-deviation 2000 -o earth.glb --json report.json\n"
                    "  octaglobe mesh --patches 3x3 --patch-level 4 --remove 24,24 --picture domain.png");
    add_what(*command, *options);
    add_how_much(*command, *options);
    add_where_to(*command, *options);
    command->final_callback([options] { run(*options); });
}

}  // namespace render
