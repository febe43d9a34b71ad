#include "render/app/mesh/mesh_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/exporters/reference_text.h"
#include "render/app/mesh/raster_frames.h"
#include "render/app/temporary_names.h"
#include "render/gl/context.h"

namespace render {

using planet::MeshFormat;
using planet::MeshFrame;

namespace {

constexpr int least_fitting_height = 400, most_fitting_height = 3200;  ///< pixels

}  // namespace

MeshOutput::MeshOutput(const MeshOptions& options) : options_(options) {
    if (options.picture) const OutputFile writable("--picture", *options.picture);
    if (!options.output) return;
    format_ = planet::mesh_format(options.output->native());
    if (options.planet && format_ == MeshFormat::stl)
        throw planet::Error(planet::Fault::bad_usage, "--output", "an .stl holds no planet", ".glb, .ply or .obj");
    file_ = std::make_unique<OutputFile>("--output", *options.output);
}

MeshFrame MeshOutput::frame(bool planet) const {
    if (options_.frame) return *options_.frame;
    if (planet) return MeshFrame::ecef;
    return usual_frame(format_);
}

void MeshOutput::write(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference,
                       const planet::MeshRounding& rounding, Report& report) {
    report.set("rounding_xy", rounding.xy);
    report.set("rounding_z_m", rounding.z);
    if (!file_) return;
    const auto step = report.step("write");
    std::size_t bytes = 0;
    planet::write_mesh(
        [&](std::string_view block) {
            bytes += block.size();
            file_->append(block);
        },
        mesh, reference, format_, rounding);
    report.set("output", options_.output->string());
    report.set("output_bytes", bytes);
}

void MeshOutput::draw(MeshPicture picture, Report& report) {
    if (!options_.picture) return;
    const auto step = report.step("picture");
    if (options_.picture_size) {
        picture.width = options_.picture_size->width;
        picture.height = options_.picture_size->height;
    } else if (!picture.planet && !picture.window) {
        picture.height = fitting_height(picture, least_fitting_height, most_fitting_height);
    }
    const Context context = Context::create();
    planet::write_image(options_.picture->string(), draw_mesh_picture(picture), {.make_file = make_listed});
    report.set("picture", options_.picture->string());
}

void MeshOutput::commit() {
    if (file_) file_->commit();
}

void refuse_bound(double asked, double possible, MeshFormat format) {
    const bool rounds = format == MeshFormat::glb || format == MeshFormat::stl;
    const std::string ending = format == MeshFormat::glb ? ".glb" : ".stl";
    const double rounded_up = possible * (1 + 1e-6);  // four_digits() takes less for the rounding of sums
    throw planet::Error(planet::Fault::bad_usage, "--max-deviation",
                        four_digits(asked) + " m cannot be kept" +
                            (rounds ? " in a " + ending + ", which rounds" : ": samples are kept as floats"),
                        four_digits(rounded_up) + " m or more" + (rounds ? ", or a .ply" : ""));
}

void add_mesh_picture_size(CLI::App& command, const std::string& what, std::optional<PictureSize>& size) {
    add_value(command, "--size", "WxH", what, [&size](std::string_view where, const std::string& text) {
        const PictureSize given = parse_size(where, text);
        const auto [low, high] = std::minmax(given.width, given.height);
        require(low >= picture_size_min && high <= picture_size_max, where, shown(text) + " is out of range",
                std::to_string(picture_size_min) + " to " + std::to_string(picture_size_max) + " a side");
        size = given;
    })->needs("--picture");
}

void report_reference(const planet::MeshReference& reference, Report& report) {
    report.set("frame", planet::to_string(reference.frame));
    report.set("crs", reference.crs);
    report.set("vertical_datum", reference.vertical_datum);
}

void report_mesh(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference, Report& report) {
    report.set("triangles", mesh.triangles.size());
    report.set("vertices", mesh.vertices.size());
    report.set("strip_indices", mesh.strip.size());
    report.set("strips",
               mesh.strip.empty() ? 0 : 1 + std::count(mesh.strip.begin(), mesh.strip.end(), planet::strip_restart));
    report_reference(reference, report);
}

}  // namespace render
