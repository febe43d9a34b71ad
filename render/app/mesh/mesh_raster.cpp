// octaglobe mesh DEM: a raster, within a bound or a budget.

#include <algorithm>
#include <cmath>
#include <iostream>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/patches/decimation.h"
#include "planet/patches/patch_measure.h"
#include "render/app/drape.h"
#include "render/app/mesh/mesh_keep.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/mesh/raster_frames.h"
#include "render/app/normals.h"
#include "render/app/progress.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

/// Sums of doubles may be off by this much where the mesh is exact.
constexpr double measuring_slack_m = 1e-6;

/// Of a raster and of its patches: 1 GB of heights.
constexpr std::size_t most_samples = std::size_t{1} << 28;

class RasterMesher {
  public:
    RasterMesher(const MeshOptions& options, Report& report)
        : options_(options),
          report_(report),
          output_(options),
          raster_(read()),
          patches_(*raster_, most_samples),
          frame_(frame_of_raster(raster_, output_.frame(false), datum())),
          map_(*raster_, options.drape ? options.drape->string() : "") {
        planet::check_frame(frame_.reference(), output_.format());
        if (options.drape) drape_.emplace(*options.drape);
    }

    void run() {
        if (!options_.keep.empty()) read_features();
        if (!frame_.affine()) {
            const auto step = begin("place", "placing");
            check_reach(frame_, *raster_);
            at_poles_ = samples_at_poles(*raster_);
            samples_ = planet::place_samples(patches_, frame_, telling("placing"));
        }
        if (options_.level)
            make_level();
        else if (!options_.max_deviation || !make_within_bound())
            make_within_budget();
        finish();
    }

  private:
    /// Times a step of the report, and tells of it on a terminal.
    Report::Step begin(const char* step, const char* shown) {
        progress_.update(shown, std::nan(""));
        return report_.step(step);
    }
    std::function<void(double)> telling(const char* shown) {
        return [this, shown](double part) { progress_.update(shown, part); };
    }

    std::shared_ptr<const planet::Raster> read() {
        const auto step = begin("read", "reading");
        planet::RasterOptions how;
        how.plain = true;
        how.max_samples = most_samples;
        return std::make_shared<const planet::Raster>(planet::read_raster(options_.source, how));
    }

    planet::VerticalDatum datum() const { return options_.datum.value_or(planet::VerticalDatum::egm96); }

    void read_features() {
        const auto step = begin("keep", "reading features");
        const KeptSamples found = samples_on(planet::read_features(options_.keep, *raster_), *raster_, patches_);
        if (found.samples.empty())
            throw Error(Fault::bad_data, options_.keep, "has nothing on the raster",
                        "features within " + raster_->name);
        kept_ = found.samples;
        report_.set("kept_samples", kept_.size());
        report_.set("kept_outside", found.outside);
    }

    /// The coarsest mesh that has what it must keep.
    planet::PatchTriangulation coarsest() const {
        planet::PatchTriangulation mesh = planet::coarsest(patches_);
        for (const auto* samples : {&kept_, &at_poles_})
            for (const glm::ivec2 sample : *samples) planet::keep_sample(mesh, patches_.lattice(), sample);
        return mesh;
    }

    void make_level() {
        planet::PatchTriangulation mesh = coarsest();
        if (*options_.level > mesh.levels())
            throw Error(Fault::bad_usage, "--level", std::to_string(*options_.level) + " is finer than the raster",
                        "0 to " + std::to_string(mesh.levels()));
        {
            const auto step = begin("refine", "refining");
            planet::refine_to_level(mesh, *options_.level);
        }
        extract_and_measure(mesh);
    }

    /// Deviations are those of the lattice. A frame that curves and a format that rounds change them; so what is written
    /// is measured, and triangles that are too far off are split until none is.
    /// @return false if that takes more triangles than there may be
    bool make_within_bound() {
        const planet::DenseQuadtree<float> deviation = flat_deviations();
        planet::PatchTriangulation mesh = coarsest();
        {
            const auto step = begin("refine", "refining");
            const double tolerance = std::max(0.0, *options_.max_deviation - patches_.sample_rounding());
            planet::refine_to_tolerance(mesh, deviation, tolerance);
        }
        for (;;) {
            extract_and_measure(mesh);
            if (options_.max_triangles && surface_.triangles.size() > *options_.max_triangles) return false;
            std::vector<planet::CellCode> too_far;
            double worst = 0;
            for (std::size_t i = 0; i < mesh_.cell.size(); ++i) {
                const double off = achieved_.by_triangle[i] + patches_.sample_rounding();
                if (off <= *options_.max_deviation + measuring_slack_m) continue;
                too_far.push_back(mesh_.cell[i]);
                worst = std::max(worst, off);
            }
            if (too_far.empty()) return true;
            bool split = false;
            for (const planet::CellCode cell : too_far)
                if (mesh.level_of(cell) < mesh.levels()) split |= mesh.split(cell) > 0;
            if (!split) refuse_bound(*options_.max_deviation, worst, output_.format());
        }
    }

    void make_within_budget() {
        const planet::MeshFrame frame = frame_.reference().frame;
        const bool curved = !frame_.affine() && (frame == planet::MeshFrame::enu || frame == planet::MeshFrame::ecef);
        const planet::DenseQuadtree<float> deviation = curved ? curved_deviations() : flat_deviations();
        planet::PatchTriangulation mesh = coarsest();
        {
            const auto step = begin("refine", "refining");
            const bool enough = options_.priority == MeshPriority::least
                                    ? planet::refine_to_budget(mesh, patches_, deviation, *options_.max_triangles)
                                    : decimate(mesh, deviation);
            if (!enough) refuse_budget(mesh);
        }
        extract_and_measure(mesh);
    }

    /// From all samples down to the budget. @return false, and nothing changes, if what must stay takes more
    bool decimate(planet::PatchTriangulation& mesh, const planet::DenseQuadtree<float>& deviation) {
        std::vector<glm::ivec2> keep = kept_;
        keep.insert(keep.end(), at_poles_.begin(), at_poles_.end());
        planet::PatchTriangulation full = planet::coarsest(patches_);
        planet::refine_to_level(full, full.levels());
        const auto priority =
            options_.priority == MeshPriority::max ? planet::DecimationPriority::max : planet::DecimationPriority::rms;
        const auto done = planet::decimate(full, patches_, deviation,
                                           {.priority = priority,
                                            .max_triangles = *options_.max_triangles,
                                            .keep = keep,
                                            .progress = telling("refining")});
        if (done.triangles > *options_.max_triangles) return false;
        mesh = std::move(full);
        return true;
    }

    planet::DenseQuadtree<float> flat_deviations() {
        const auto step = begin("deviations", "deviations");
        return planet::patch_deviations(patches_, 0, telling("deviations"));
    }

    /// With the planet's curvature: of heights over the plane that touches it at the raster's middle. They stand for the
    /// deviations along each sample's vertical, and are the nearer to them the smaller the raster; what is written is
    /// measured as it is.
    planet::DenseQuadtree<float> curved_deviations() {
        const auto step = begin("deviations", "deviations");
        const glm::dvec2 middle(0.5 * (raster_->width - 1), 0.5 * (raster_->height - 1));
        const double ground = 0;
        glm::dvec3 base;
        glm::vec3 up;
        frame_.place({&middle, 1}, {&ground, 1}, {&base, 1}, {&up, 1});
        planet::Raster over_plane;
        over_plane.width = patches_.width();
        over_plane.height = patches_.height();
        std::vector<float> heights(samples_.position.size());
        for (std::size_t i = 0; i < heights.size(); ++i)
            heights[i] = static_cast<float>(glm::dot(samples_.position[i] - base, glm::dvec3(up)));
        over_plane.samples = std::move(heights);
        return planet::patch_deviations(planet::PatchRaster(over_plane, most_samples), 0, telling("deviations"));
    }

    [[noreturn]] void refuse_budget(const planet::PatchTriangulation& coarsest) const {
        std::size_t least = 0;
        coarsest.for_each_leaf([&](planet::CellCode leaf) {
            least += planet::triangles_of_leaf(patches_, patches_.lattice().corners(leaf));
        });
        throw Error(Fault::bad_usage, "--max-triangles", std::to_string(*options_.max_triangles) + " is too few",
                    std::to_string(least) + " or more for this raster" + (kept_.empty() ? "" : " and these features"));
    }

    void extract_and_measure(const planet::PatchTriangulation& mesh) {
        {
            const auto step = begin("extract", "extracting");
            mesh_ = planet::extract(mesh, patches_);
            surface_.vertices = planet::place_vertices(mesh_, frame_);
            surface_.triangles = mesh_.triangles;
            if (surface_.triangles.empty())
                throw Error(Fault::bad_data, options_.source, "no triangle of its mesh has three valid corners",
                            options_.level           ? "a finer --level"
                            : options_.max_triangles ? "a larger --max-triangles"
                                                     : "three valid samples side by side");
            if (std::ranges::any_of(surface_.vertices, is_nowhere)) refuse_reach(raster_->name);
            rounding_ = planet::round_to_format(surface_, frame_.reference(), output_.format());
        }
        const auto step = begin("measure", "measuring");
        achieved_ = planet::measure(mesh_, surface_.vertices, patches_, frame_, frame_.affine() ? nullptr : &samples_,
                                    telling("measuring"));
    }

    void finish() {
        surface_.strip = mesh_.strip;
        surface_.level.reserve(mesh_.cell.size());
        for (const planet::CellCode cell : mesh_.cell)
            surface_.level.push_back(
                static_cast<std::uint8_t>(planet::bisection_level_of(cell, patches_.grid().root_bits())));
        if (frame_.mirrored()) turn_over();
        progress_.update("writing", std::nan(""));
        output_.write(surface_, frame_.reference(), rounding_, report_, looks());
        fill_report();
        draw();
        output_.commit();
        progress_.clear();
        std::cout << grouped(surface_.triangles.size()) << " triangles, " << grouped(surface_.vertices.size())
                  << " vertices; deviation at most " << four_digits(achieved_.max + patches_.sample_rounding())
                  << " m, rms " << four_digits(achieved_.rms) << " m over " << grouped(achieved_.samples)
                  << " samples\n";
    }

    /// Of a draped mesh; nothing of others.
    planet::MeshLooks looks() const {
        planet::MeshLooks looks;
        if (!drape_) return looks;
        std::vector<glm::ivec2> samples;
        samples.reserve(mesh_.vertices.size());
        for (const planet::LatticeVertex& v : mesh_.vertices) samples.push_back(v.at);
        looks.uv = texture_coordinates(map_.at(samples, {0, 0}));
        looks.normals = normals_of(surface_);
        looks.picture = drape_->whole();
        return looks;
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
        progress_.update("drawing", std::nan(""));
        const planet::RasterFrame plan = frame_of_raster(raster_, planet::MeshFrame::source, datum());
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
    Progress progress_;
    MeshOutput output_;
    std::shared_ptr<const planet::Raster> raster_;
    planet::PatchRaster patches_;
    planet::RasterFrame frame_;
    const DrapeMap map_;
    std::optional<Drape> drape_;
    planet::PlacedSamples samples_;
    std::vector<glm::ivec2> kept_, at_poles_;

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
