// octaglobe tin DEM: one mesh.

#include <malloc.h>

#include <iostream>

#include "planet/elevation/raster_writer.h"
#include "planet/error.h"
#include "planet/patches/patch_mesh.h"
#include "planet/tin/make_tin.h"
#include "render/app/drape.h"
#include "render/app/figures.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/mesh/raster_frames.h"
#include "render/app/normals.h"
#include "render/app/progress.h"
#include "render/app/temporary_names.h"
#include "render/app/tin/tin_gpu_measure.h"
#include "render/app/tin/tin_source.h"
#include "render/app/tin/tin_written.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::HeightGrid;
using planet::MeshFormat;
using planet::MeshFrame;

class TinMaker {
  public:
    TinMaker(const TinCommand& command, Report& report)
        : command_(command),
          report_(report),
          file_(open_output()),
          format_(file_ ? planet::mesh_format(command.output->native()) : MeshFormat::ply),
          source_(command),
          frame_(source_.frame(frame_kind(), format_)),
          error_grid_(open_error_grid()),
          map_(*source_.raster(), command.drape ? command.drape->string() : ""),
          heights_(read()) {
        if (command.drape) drape_.emplace(*command.drape);
        if (command.picture) const OutputFile writable("--picture", *command.picture);
    }

    void run() {
        read_features();
        WrittenTin tin = certified(make());
        tin.surface.strip.reserve(2 * tin.surface.triangles.size());
        planet::append_strips(tin.surface.triangles, tin.surface.strip);  // only to be counted
        fill_report(tin);
        draw_steps();
        heights_.reset();
        write(tin);
        tell(tin);
    }

  private:
    std::unique_ptr<OutputFile> open_output() const {
        if (!command_.output) return nullptr;
        planet::mesh_format(command_.output->native());  // first of all
        return std::make_unique<OutputFile>("--output", *command_.output);
    }
    MeshFrame frame_kind() const {
        if (command_.frame) return *command_.frame;
        return usual_frame(format_);
    }
    std::unique_ptr<planet::RasterWriter> open_error_grid() const {
        if (!command_.error_grid) return nullptr;
        return std::make_unique<planet::RasterWriter>(command_.error_grid->string(), *source_.raster(), make_listed);
    }
    HeightGrid read() {
        const auto step = report_.step("read");
        progress_.update("reading", std::nan(""));
        return source_.heights();
    }

    void read_features() {
        if (!command_.features.empty()) {
            const auto step = report_.step("features");
            features_ = source_.features();
        }
        if (curves(frame_))
            for (const glm::ivec2 p : source_.pole_samples()) features_.points.push_back(p);
    }

    planet::TinResult make() {
        progress_.update("triangulating", std::nan(""));
        planet::TinOptions how;
        const double bound = command_.max_deviation.value_or(0);
        how.tolerance = std::max(0.5 * bound, bound - rounding());  // what that leaves is mended
        if (!curves(frame_)) {
            if (!frame_.affine()) how.tolerance *= 1 - curve_spare;
            return make(how, *heights_);
        }
        const planet::RasterFrame tangent = source_.tangent_frame();
        how.tolerance *= command_.exaggeration * share_above_plane(tangent, {heights_->width(), heights_->height()});
        const auto over_plane = [&](glm::ivec2 low, glm::ivec2 high) {
            return planet::heights_above_tangent_plane(HeightGrid(*heights_, low, high), tangent.window(low), 1);
        };
        if (command_.measure.plain()) {  // in tiles: all at once would be as much memory again
            how.heights = over_plane;
            return make(how, *heights_);
        }
        return make(how, planet::heights_above_tangent_plane(*heights_, tangent));
    }

    planet::TinResult make(planet::TinOptions& how, const HeightGrid& grid) {
        if (command_.max_triangles) how.max_triangles = *command_.max_triangles;
        how.quality = command_.quality;
        how.features = features_;
        const std::unique_ptr<planet::TinMeasure> measure = make_tin_measure(command_.measure, grid);
        how.measure = measure.get();
        if (const auto* gpu = dynamic_cast<const GpuMeasure*>(measure.get())) {
            report_.set("depth_step_m", gpu->depth_step());
            report_.set("gl_renderer", gpu->context().gl_renderer());
        }
        planet::TinResult result = planet::make_tin(grid, how);
        for (const auto& [name, seconds] : result.seconds) report_.add_seconds(name, seconds);
        return result;
    }

    /// By how much the file's format may move the ground, in metres of height, where it rises by no more than 45 degrees.
    double rounding() const {
        const glm::dvec2 range = height_range(*heights_);
        const PlacedBox box = box_of_window(frame_, {0, 0}, {heights_->width() - 1, heights_->height() - 1},
                                            range.x - command_.base.value_or(0), range.y);
        const auto bound = planet::rounding_bound(box.low, box.high, frame_.reference(), format_);
        return bound.z / command_.exaggeration + bound.xy + heights_->sample_rounding();
    }

    WrittenTin certified(planet::TinResult made) {
        const auto step = report_.step("certify");
        ::malloc_trim(0);  // what many threads have made tiles in
        progress_.update("measuring", std::nan(""));
        features_found_ = made.features;
        end_ = made.end;
        TinGoal goal;
        if (command_.max_deviation && made.end == planet::GreedyEnd::tolerance)
            goal.tolerance = *command_.max_deviation;
        if (command_.max_triangles) goal.max_triangles = *command_.max_triangles;
        goal.format = format_;
        goal.by_sample = error_grid_ != nullptr;
        if (command_.base) goal.floor = floor_below(*heights_, frame_, *command_.base);
        WrittenTin tin = as_written(std::move(made.mesh), *heights_, frame_, goal);
        if (!tin.kept && !tin.mendable) refuse_bound(*command_.max_deviation, tin.deviation_max, format_);
        if (!tin.kept) end_ = planet::GreedyEnd::budget;  // what would mend it is more than there may be
        if (command_.base) {
            report_.set("euler", check_closed(tin.surface, frame_.reference().frame));
            report_.set("closed", true);
        }
        return tin;
    }

    planet::MeshLooks looks(const WrittenTin& tin) const {
        planet::MeshLooks looks;
        if (format_ != MeshFormat::glb || command_.base) return looks;  // without normals, viewers show facets
        looks.normals = normals_of(tin.surface);
        looks.uv = texture_coordinates(map_.at(tin.mesh.vertices, {0, 0}));
        if (drape_) looks.picture = drape_->whole();
        return looks;
    }

    void write(WrittenTin& tin) {
        const auto step = report_.step("write");
        progress_.update("writing", std::nan(""));
        if (error_grid_)
            error_grid_->write({0, 0, source_.raster()->width, source_.raster()->height}, tin.deviation.by_sample);
        if (file_) {
            const planet::MeshLooks shown = looks(tin);
            tin.keep_surface_only();  // leaves room to read the file again
            ::malloc_trim(0);
            report_.set("output", command_.output->string());
            report_.set("output_bytes", write_checked(*file_, tin, frame_.reference(), format_, shown));
        }
        if (error_grid_) error_grid_->finish();
        if (command_.error_grid) report_.set("error_grid", command_.error_grid->string());
        if (file_) file_->commit();
    }

    void draw_steps() {
        if (!command_.picture) return;
        const auto step = report_.step("picture");
        progress_.update("drawing", std::nan(""));
        const std::unique_ptr<planet::TinMeasure> measure = make_tin_measure(command_.measure, *heights_);
        planet::TinOptions how;
        how.features = features_;
        how.measure = measure.get();
        const planet::RasterFrame plan = source_.frame(MeshFrame::source, MeshFormat::ply);
        write_tin_steps(*heights_, metres_per_sample(plan), how, command_.stages, command_.picture->string());
        report_.set("picture", command_.picture->string());
    }

    void fill_report(const WrittenTin& tin) {
        report_mesh(tin.surface, frame_.reference(), report_);
        report_.set("deviation_max_m", tin.deviation_max);
        report_.set("deviation_rms_m", tin.deviation.rms);
        if (command_.max_deviation) report_.set("tolerance_m", *command_.max_deviation);
        report_.set("stopped_by", stopped_by());
        report_.set("angle_min_deg", tin.deviation.angle_min / planet::degrees);
        report_.set("samples", tin.deviation.samples);
        report_.set("samples_uncovered", tin.deviation.uncovered);
        report_.set("samples_void", heights_->count() - heights_->valid_samples());
        report_.set("samples_mended", tin.inserted);
        report_.set("rounding_xy", tin.rounding.xy);
        report_.set("rounding_z_m", tin.rounding.z);
        report_.set("exaggeration", command_.exaggeration);
        if (command_.base) report_.set("base_m", *command_.base);
        if (!command_.features.empty()) report_features(features_found_, features_.outside, report_);
        report_.set("source", source_.raster()->name);
        report_.set("columns", heights_->width());
        report_.set("rows", heights_->height());
    }

    std::string stopped_by() const { return end_ == planet::GreedyEnd::budget ? "triangles" : "deviation"; }

    void tell(const WrittenTin& tin) {
        progress_.clear();
        std::cout << grouped(tin.surface.triangles.size()) << " triangles, " << grouped(tin.surface.vertices.size())
                  << " vertices; deviation at most " << four_digits(tin.deviation_max) << " m, rms "
                  << four_digits(tin.deviation.rms) << " m over " << grouped(tin.deviation.samples)
                  << " samples; stopped by the " << stopped_by() << "\n";
    }

    const TinCommand& command_;
    Report& report_;
    Progress progress_;
    std::unique_ptr<OutputFile> file_;
    const MeshFormat format_;
    const TinSource source_;
    const planet::RasterFrame frame_;
    std::unique_ptr<planet::RasterWriter> error_grid_;
    const DrapeMap map_;
    std::optional<HeightGrid> heights_;  ///< until the mesh is certified
    std::optional<Drape> drape_;
    planet::TinFeatures features_;
    planet::FeatureReport features_found_;
    planet::GreedyEnd end_ = planet::GreedyEnd::tolerance;
};

}  // namespace

void tin_raster(const TinCommand& command, Report& report) {
    TinMaker(command, report).run();
}

}  // namespace render
