// octaglobe refine: longest-side bisection of any triangle mesh.

#include <algorithm>
#include <memory>

#include "planet/error.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/program.h"
#include "render/app/refine/refine_options.h"
#include "render/picture/mesh_picture.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using Where = std::string_view;

constexpr double largest_length_m = 1e8;
constexpr int most_steps = 40, most_frames = 10'000;

std::string file_name(Where where, const std::string& text) {
    if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
    return text;
}

/// "X,Y" in the units of the mesh.
glm::dvec2 parse_point(Where where, const std::string& text) {
    const auto comma = text.find(',');
    if (comma == std::string::npos) throw Error(Fault::bad_usage, where, shown(text) + " is no point", "X,Y");
    return {parse_number(where, text.substr(0, comma), {-1e30, 1e30}),
            parse_number(where, text.substr(comma + 1), {-1e30, 1e30})};
}

/// "LAT,LON,RANGE"
RefineView parse_view(Where where, const std::string& text) {
    const auto comma = text.rfind(',');
    if (comma == std::string::npos || text.find(',') == comma)
        throw Error(Fault::bad_usage, where, shown(text) + " is no view", "LAT,LON,RANGE, e.g. 37.6,-105.5,20km");
    return {parse_place(where, text.substr(0, comma)),
            parse_distance(where, text.substr(comma + 1), {1, largest_length_m})};
}

void add_what(CLI::App& command, RefineCommand& o) {
    add_value(command, "mesh", "FILE", "Triangles: .glb, .ply, .obj or .stl; or a progressive mesh, .oprog",
              [&](Where where, const std::string& text) { o.source = file_name(where, text); });
    command.add_flag("--weld", o.weld, "Join vertices at the same place first");
    add_value(command, "--rule", "RULE",
              "modified: four similar triangles where both halves are split and no angle suffers (at least 0.67 of\n"
              "the smallest at the start); plain: halves only (at least 1/2) [modified]",
              [&](Where where, const std::string& text) {
                  o.rule = static_cast<planet::BisectionRule>(parse_choice(where, text, {"modified", "plain"}));
              });
    add_value(command, "--sides", "GEOMETRY",
              "Where sides are judged: space or plan [plan with --elevation but for an Earth-centred mesh, else space]",
              [&](Where where, const std::string& text) {
                  o.sides = static_cast<planet::SideGeometry>(parse_choice(where, text, {"space", "plan"}));
              });
}

void add_how_much(CLI::App& command, RefineCommand& o) {
    add_value(command, "--max-side", "METRES", "No side is longer, in units of the mesh where these are not metres",
              [&](Where where, const std::string& text) {
                  o.max_side = parse_distance(where, text, {1e-9, largest_length_m});
              });
    auto* elevation = add_value(command, "--elevation", "FILE", "A raster of heights: all vertices are put on it",
                                [&](Where where, const std::string& text) { o.elevation = file_name(where, text); });
    add_value(command, "--datum", "DATUM", "What the raster's heights are above: egm96 or ellipsoid [egm96]",
              [&](Where where, const std::string& text) {
                  o.datum = static_cast<planet::VerticalDatum>(parse_choice(where, text, {"egm96", "ellipsoid"}));
              })
        ->needs(elevation);
    add_value(command, "--max-deviation", "METRES",
              "The bound: no sample of the raster is farther above or below the mesh as written",
              [&](Where where, const std::string& text) {
                  o.max_deviation = parse_distance(where, text, {0, largest_length_m});
              })
        ->needs(elevation);
    add_value(command, "--max-triangles", "COUNT", "The budget: never more. Of limits, whichever comes first",
              [&](Where where, const std::string& text) {
                  o.max_triangles = static_cast<std::size_t>(parse_whole(where, text, 1, 1 << 28));
              });
    add_value(command, "--order", "ORDER",
              "What is split first: length or deviation [length; deviation with its bound]",
              [&](Where where, const std::string& text) {
                  o.order = static_cast<planet::SplitOrder>(parse_choice(where, text, {"length", "deviation"}));
              });
    add_value(command, "--region", "FILE", "Polygons: only triangles that meet them are split for their own sake",
              [&](Where where, const std::string& text) { o.region = file_name(where, text); });
    add_value(command, "--steps", "COUNT", "Instead: uniform steps; two of them halve all sides",
              [&](Where where, const std::string& text) {
                  o.steps = static_cast<int>(parse_whole(where, text, 0, most_steps));
              });
    add_value(command, "--split", "X,Y", "Instead: the side nearest to a point in plan, in units of the mesh",
              [&](Where where, const std::string& text) { o.split = parse_point(where, text); });
}

void add_stream(CLI::App& command, RefineCommand& o) {
    add_value(command, "--progressive", "FILE", "The base mesh and its splits in order: .oprog",
              [&](Where where, const std::string& text) { o.progressive = file_name(where, text); });
    add_value(command, "--at", "SHARE", "Of an .oprog: the first splits only, 0 to 1 [1]",
              [&](Where where, const std::string& text) {
                  o.at = parse_number(where, text, {0, 1});
              });
    add_value(
        command, "--view", "LAT,LON,RANGE",
        "Of an .oprog: only sides that look longer than 1/50 of their distance from RANGE above a place are split",
        [&](Where where, const std::string& text) { o.view = parse_view(where, text); });
    auto* morph = add_value(command, "--morph", "COUNT",
                            "Of an .oprog: a folder of so many frames, from the base mesh to the last",
                            [&](Where where, const std::string& text) {
                                o.morph = static_cast<int>(parse_whole(where, text, 2, most_frames));
                            });
    add_value(
        command, "--format", "FORMAT", "Of frames: glb, ply, obj or stl [glb]",
        [&](Where where, const std::string& text) {
            o.frame_format = static_cast<planet::MeshFormat>(parse_choice(where, text, {"glb", "ply", "obj", "stl"}));
        })
        ->needs(morph);
}

void add_where_to(CLI::App& command, RefineCommand& o) {
    add_value(command, "-o,--output", "FILE", "The mesh: .glb, .ply, .obj or .stl; with --morph a new folder",
              [&](Where where, const std::string& text) { o.output = file_name(where, text); });
    add_value(command, "--frame", "FRAME",
              "source (as it is), utm, enu (metres east, north and up of the mesh's middle) or ecef\n"
              "[that of the mesh; enu for degrees in a .glb and all in an .stl]",
              [&](Where where, const std::string& text) {
                  o.frame = static_cast<planet::MeshFrame>(parse_choice(where, text, {"source", "utm", "enu", "ecef"}));
              });
    add_value(command, "--picture", "FILE", "The triangles in plan, bisection levels in colour: .png, .jpg or .tif",
              [&](Where where, const std::string& text) { o.picture = parse_picture_name(where, text); });
    add_mesh_picture_size(command, "Of the picture [1600 wide, as high as the mesh; a planet 1600x1600]",
                          o.picture_size);
    add_json_option(command, o.json);
}

void check_files(const RefineCommand& o) {
    require(o.output || o.progressive || o.picture || !o.json.empty(), "refine", "nothing to write",
            "-o FILE, --progressive FILE, --picture FILE or --json FILE");
    std::vector<std::filesystem::path> files;
    for (const auto& file : {o.output, o.progressive, o.picture})
        if (file) files.push_back(file->lexically_normal());
    if (!o.json.empty()) files.push_back(std::filesystem::path(o.json).lexically_normal());
    std::sort(files.begin(), files.end());
    require(std::adjacent_find(files.begin(), files.end()) == files.end(), "refine", "one file for two things",
            "--output, --progressive, --picture and --json with a file each");
}

/// Of a mesh: one way to refine it.
void check_mesh(const RefineCommand& o) {
    require(!o.at && !o.view && !o.morph,
            o.at     ? "--at"
            : o.view ? "--view"
                     : "--morph",
            "is for progressive meshes", "an .oprog file; --progressive makes one");
    const bool goal = o.max_side || o.max_deviation || o.max_triangles;
    const int ways = goal + o.steps.has_value() + o.split.has_value();
    require(ways <= 1, o.steps ? "--steps" : "--split", "goes with no limit and no other way to refine",
            "--steps, --split, or limits");
    require(ways == 1 || o.weld, "refine", "no limit given",
            "--max-side, --max-deviation, --max-triangles, --steps or --split; or --weld alone");
    require(goal || !o.order, "--order", "is for limits", "--max-side, --max-deviation or --max-triangles");
    require(o.order != planet::SplitOrder::deviation || !o.elevation.empty(), "--order", "deviation from what",
            "--order deviation with --elevation FILE");
    require(o.region.empty() || goal || o.steps, "--region", "is for limits and steps", "--max-side or --steps");
}

void check_stream(const RefineCommand& o) {
    require(!o.max_side && !o.max_deviation && !o.max_triangles && !o.steps && !o.split && o.region.empty() &&
                o.elevation.empty() && !o.order && !o.sides && !o.weld && !o.progressive,
            "refine", "a progressive mesh is not refined further", "--at, --view or --morph");
    require(!o.view || !o.morph, "--morph", "goes with no view", "--morph or --view");
    require(!o.morph || o.output, "--morph", "without a folder", "-o FOLDER");
}

void run(const RefineCommand& command) {
    require(!command.source.empty(), "refine", "nothing to refine", "a mesh file");
    check_files(command);
    const bool stream = std::filesystem::path(command.source).extension() == ".oprog";
    if (stream)
        check_stream(command);
    else
        check_mesh(command);
    Report report("refine", command.json);
    if (stream)
        refine_stream(command, report);
    else
        refine_mesh(command, report);
    report.write();
}

}  // namespace

void add_refine(CLI::App& program) {
    auto options = std::make_shared<RefineCommand>();
    CLI::App* command = add_command(
        program, "refine", "Longest-side bisection of any triangle mesh, with a bound on its angles",
        "octaglobe refine mesh.ply --max-side 100 -o finer.glb\n"
        "  octaglobe refine tin.glb --elevation dem.tif --max-deviation 2 -o fine.glb --picture refine.png\n"
        "  octaglobe refine mesh.ply --steps 3 --region area.geojson -o part.ply\n"
        "  octaglobe refine mesh.obj --max-triangles 200000 --progressive out.oprog\n"
        "  octaglobe refine out.oprog --at 0.35 -o part.glb\n"
        "  octaglobe refine out.oprog --view 37.6,-105.5,20km -o seen.glb\n"
        "  octaglobe refine out.oprog --morph 30 -o frames/");
    add_what(*command, *options);
    add_how_much(*command, *options);
    add_stream(*command, *options);
    add_where_to(*command, *options);
    command->final_callback([options] { run(*options); });
}

}  // namespace render
