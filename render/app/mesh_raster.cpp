// octaglobe mesh DEM: a raster, within a bound or a budget.

#include <cmath>
#include <iostream>

#include "planet/elevation/features.h"
#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/patches/patch_measure.h"
#include "render/app/data_path.h"
#include "render/app/mesh_output.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

/// Sums of doubles may be off by this much where the mesh is exact.
constexpr double measuring_slack_m = 1e-6;

class RasterMesher {
  public:
    RasterMesher(const MeshOptions& options, Report& report)
        : options_(options),
          report_(report),
          output_(options),
          raster_(read()),
          patches_(*raster_),
          frame_(make_frame()) {
        planet::check_frame(frame_.reference(), output_.format());
    }

    void run() {
        planet::PatchTriangulation mesh = planet::coarsest(patches_);
        if (!options_.keep.empty()) keep(mesh);
        refine(mesh);
        extract_within_bound(mesh);
        finish();
    }

  private:
    std::shared_ptr<const planet::Raster> read() {
        const auto step = report_.step("read");
        planet::RasterOptions how;
        how.plain = true;
        return std::make_shared<const planet::Raster>(planet::read_raster(options_.source, how));
    }

    planet::RasterFrame make_frame() {
        const planet::MeshFrame frame = output_.frame(false);
        const bool curved = frame == planet::MeshFrame::enu || frame == planet::MeshFrame::ecef;
        std::shared_ptr<const planet::Geoid> geoid;
        if (curved && !raster_->plain && options_.datum == planet::VerticalDatum::egm96)
            geoid = std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm"));
        return {raster_, frame, options_.datum, geoid};
    }

    void keep(planet::PatchTriangulation& mesh) {
        const auto step = report_.step("keep");
        const planet::Features features = planet::read_features(options_.keep, *raster_);
        std::size_t outside = 0;
        for (const glm::dvec3& p : features.points) outside += !keep_at(mesh, sample_of(p));
        const auto along = [&](const std::vector<glm::dvec3>& line) {
            for (std::size_t i = 1; i < line.size(); ++i)
                outside += keep_between(mesh, sample_of(line[i - 1]), sample_of(line[i]));
        };
        for (const auto& line : features.lines) along(line);
        for (const auto& polygon : features.polygons) {
            along(polygon.outer);
            for (const auto& hole : polygon.holes) along(hole);
        }
        if (kept_.empty())
            throw Error(Fault::bad_data, options_.keep, "has nothing on the raster",
                        "features within " + raster_->name);
        report_.set("kept_samples", kept_.size());
        report_.set("kept_outside", outside);
    }

    glm::dvec2 sample_of(const glm::dvec3& feature) const {
        const planet::SampleGrid& g = raster_->grid;
        const glm::dvec2 d = glm::dvec2(feature) - g.origin;
        return glm::dvec2(d.x * g.per_row.y - d.y * g.per_row.x, g.per_column.x * d.y - g.per_column.y * d.x) /
               g.determinant();
    }
    // The sample nearest to a place; false where there is none, or a void one.
    bool keep_at(planet::PatchTriangulation& mesh, const glm::dvec2& at) {
        const glm::dvec2 nearest = glm::round(at);
        if (!(nearest.x >= 0 && nearest.y >= 0 && nearest.x < patches_.width() && nearest.y < patches_.height()))
            return false;
        const glm::ivec2 sample(nearest);
        if (std::isnan(patches_.at(sample))) return false;
        planet::keep_sample(mesh, patches_.lattice(), sample);
        if (kept_.empty() || kept_.back() != sample) kept_.push_back(sample);
        return true;
    }
    // Every sample that a line passes, within the raster. @return how many of its ends lie outside
    std::size_t keep_between(planet::PatchTriangulation& mesh, glm::dvec2 a, glm::dvec2 b) {
        const glm::dvec2 d = b - a;
        double from = 0, to = 1;  // the part within the raster
        for (int axis = 0; axis < 2; ++axis) {
            const double last = (axis == 0 ? patches_.width() : patches_.height()) - 0.5;
            if (d[axis] == 0) {
                if (a[axis] < -0.5 || a[axis] > last) return 1;
                continue;
            }
            const double s = (-0.5 - a[axis]) / d[axis], t = (last - a[axis]) / d[axis];
            from = std::max(from, std::min(s, t));
            to = std::min(to, std::max(s, t));
        }
        if (from > to) return 1;
        const double length = glm::max(std::abs(d.x), std::abs(d.y)) * (to - from);
        const auto steps = static_cast<long>(std::ceil(length)) + 1;
        for (long i = 0; i <= steps; ++i)
            keep_at(mesh, a + d * (from + (to - from) * static_cast<double>(i) / static_cast<double>(steps)));
        return from > 0 || to < 1;
    }

    void refine(planet::PatchTriangulation& mesh) {
        if (options_.level) {
            if (*options_.level > mesh.levels())
                throw Error(Fault::bad_usage, "--level", std::to_string(*options_.level) + " is finer than the raster",
                            "0 to " + std::to_string(mesh.levels()));
            const auto step = report_.step("refine");
            planet::refine_to_level(mesh, *options_.level);
            return;
        }
        {
            const auto step = report_.step("deviations");
            deviation_ = planet::patch_deviations(patches_);
        }
        const auto step = report_.step("refine");
        if (options_.max_deviation) planet::refine_to_tolerance(mesh, deviation_, tolerance());
        if (options_.max_triangles && !planet::refine_to_budget(mesh, patches_, deviation_, *options_.max_triangles)) {
            // The bound or the features need more: the budget decides, from the start.
            if (!kept_.empty() || !options_.max_deviation) refuse_budget(mesh);
            mesh = planet::coarsest(patches_);
            if (!planet::refine_to_budget(mesh, patches_, deviation_, *options_.max_triangles)) refuse_budget(mesh);
        }
    }

    double tolerance() const { return std::max(0.0, *options_.max_deviation - patches_.sample_rounding()); }

    [[noreturn]] void refuse_budget(const planet::PatchTriangulation& mesh) const {
        std::size_t least = 0;
        mesh.for_each_leaf([&](planet::CellCode leaf) {
            least += planet::triangles_of_leaf(patches_, patches_.lattice().corners(leaf));
        });
        throw Error(Fault::bad_usage, "--max-triangles", std::to_string(*options_.max_triangles) + " is too few",
                    std::to_string(least) + " or more for this raster" + (kept_.empty() ? "" : " and these features"));
    }

    /// Deviations are those of the lattice. A frame that curves and a format that rounds change them; so what is written
    /// is measured, and triangles that are too far off are split until none is.
    void extract_within_bound(planet::PatchTriangulation& mesh) {
        if (!frame_.affine()) {
            const auto step = report_.step("place");
            samples_ = planet::place_samples(patches_, frame_);
        }
        for (;;) {
            extract_and_measure(mesh);
            if (!options_.max_deviation || options_.max_triangles || options_.level) return;
            std::vector<planet::CellCode> too_far;
            for (std::size_t i = 0; i < mesh_.cell.size(); ++i)
                if (achieved_.by_triangle[i] + patches_.sample_rounding() >
                    *options_.max_deviation + measuring_slack_m)
                    too_far.push_back(mesh_.cell[i]);
            if (too_far.empty()) return;
            bool split = false;
            for (const planet::CellCode cell : too_far)
                if (mesh.level_of(cell) < mesh.levels()) split |= mesh.split(cell) > 0;
            if (!split)
                throw Error(Fault::bad_usage, "--max-deviation",
                            std::to_string(*options_.max_deviation) + " m cannot be kept in this format",
                            "more than its rounding of " + std::to_string(rounding_.z) + " m, or a .ply");
        }
    }

    void extract_and_measure(const planet::PatchTriangulation& mesh) {
        {
            const auto step = report_.step("extract");
            mesh_ = planet::extract(mesh, patches_);
            surface_.vertices = planet::place_vertices(mesh_, frame_);
            surface_.triangles = mesh_.triangles;
            if (surface_.triangles.empty())
                throw Error(Fault::bad_data, options_.source, "has no three valid samples side by side");
            rounding_ = planet::round_to_format(surface_, frame_.reference(), output_.format());
        }
        const auto step = report_.step("measure");
        achieved_ = planet::measure(mesh_, surface_.vertices, patches_, frame_, frame_.affine() ? nullptr : &samples_);
    }

    void finish() {
        surface_.strip = mesh_.strip;
        surface_.level.reserve(mesh_.cell.size());
        for (const planet::CellCode cell : mesh_.cell)
            surface_.level.push_back(
                static_cast<std::uint8_t>(planet::bisection_level_of(cell, patches_.grid().root_bits())));
        if (frame_.mirrored()) turn_over();
        output_.write(surface_, frame_.reference(), rounding_, report_);
        fill_report();
        draw();
        std::cout << grouped(surface_.triangles.size()) << " triangles, " << grouped(surface_.vertices.size())
                  << " vertices; deviation at most " << achieved_.max + patches_.sample_rounding() << " m, rms "
                  << achieved_.rms << " m over " << grouped(achieved_.samples) << " samples\n";
    }

    /// Rows that run south turn the lattice over.
    void turn_over() {
        for (auto& t : surface_.triangles) std::swap(t[1], t[2]);
        planet::turn_strips(surface_.strip);
    }

    void fill_report() {
        report_mesh(surface_, frame_.reference(), report_);
        report_.set("deviation_max_m", achieved_.max + patches_.sample_rounding());
        report_.set("deviation_rms_m", achieved_.rms);
        if (options_.max_deviation) report_.set("tolerance_m", *options_.max_deviation);
        report_.set("samples", achieved_.samples);
        report_.set("samples_uncovered", achieved_.uncovered);
        report_.set("samples_void",
                    static_cast<std::size_t>(patches_.width()) * static_cast<std::size_t>(patches_.height()) -
                        patches_.valid_samples());
        report_.set("source", raster_->name);
        report_.set("columns", patches_.width());
        report_.set("rows", patches_.height());
        report_.set("patches", patches_.grid().patch_count());
        report_.set("patch_samples", patches_.lattice().patch_size() + 1);
    }

    void draw() {
        if (!options_.picture) return;
        const planet::RasterFrame plan(raster_, planet::MeshFrame::source, options_.datum, nullptr);
        const std::vector<glm::dvec3> places = planet::place_vertices(mesh_, plan);
        output_.draw({.vertices = places,
                      .triangles = surface_.triangles,
                      .level = surface_.level,
                      .metres_per_unit = plan.metres_per_unit(),
                      .relief = true},
                     report_);
    }

    const MeshOptions& options_;
    Report& report_;
    MeshOutput output_;
    std::shared_ptr<const planet::Raster> raster_;
    planet::PatchRaster patches_;
    planet::RasterFrame frame_;
    planet::DenseQuadtree<float> deviation_;
    planet::PlacedSamples samples_;
    std::vector<glm::ivec2> kept_;

    planet::PatchMesh mesh_;
    planet::SurfaceMesh surface_;
    planet::MeshRounding rounding_;
    planet::AchievedDeviation achieved_;
};

}  // namespace

void mesh_raster(const MeshOptions& options, Report& report) {
    RasterMesher(options, report).run();
}

}  // namespace render
