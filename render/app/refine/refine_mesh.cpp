// octaglobe refine MESH: one way to refine it, certified as it is written.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "planet/bisection/progressive.h"
#include "planet/error.h"
#include "planet/frames.h"
#include "planet/geodesy/geodetic.h"
#include "planet/parallel.h"
#include "render/app/figures.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/progress.h"
#include "render/app/refine/refine_base.h"
#include "render/app/refine/refine_output.h"
#include "render/app/refine/refine_region.h"
#include "render/app/refine/refine_terrain.h"

namespace render {
namespace {

using planet::Bisection;
using planet::Error;
using planet::Fault;
using planet::RefineEnd;
using planet::SideGeometry;
using planet::TrianglePlaces;

/// Sums of doubles may be off by this much where the mesh is exact.
constexpr double measuring_slack_m = 1e-6;
/// Without a budget: 11 GB.
constexpr std::size_t most_triangles = 100'000'000;

/// By its sides: Kahan, "Miscalculating Area and Angles of a Needle-like Triangle".
double area_from_sides(std::array<double, 3> s) {
    std::sort(s.begin(), s.end(), std::greater<>());
    const auto [a, b, c] = s;
    return 0.25 * std::sqrt(std::max(0.0, (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))));
}

class MeshRefiner {
  public:
    MeshRefiner(const RefineCommand& command, Report& report)
        : command_(command), report_(report), output_(command, report), base_(read()) {
        planet::check_frame(written_reference(base_.meaning, output_.format()), output_.format());
        if (!command.region.empty()) region_.emplace(command.region, base_.meaning);
        if (!command.elevation.empty()) read_terrain();
        if (command.sides == SideGeometry::plan && round())
            throw Error(Fault::bad_usage, "--sides", "an Earth-centred mesh has no plan", "space");
        if (command.split && round())
            throw Error(Fault::bad_usage, "--split", "is a point in plan, and an Earth-centred mesh has none",
                        "--region for a part of a planet");
        if (command.max_triangles && *command.max_triangles < base_.mesh.triangles.size())
            throw Error(Fault::bad_usage, "--max-triangles",
                        std::to_string(*command.max_triangles) + " are fewer than the mesh has",
                        std::to_string(base_.mesh.triangles.size()) + " or more");
        check_effort();
        bisection_.emplace(base_.mesh, bisection_options());
    }

    void run() {
        progress_.update("refining", std::nan(""));
        if (command_.steps) uniform_steps();
        if (command_.split) split_at(*command_.split);
        if (has_goal())
            refine_within_bound();
        else
            measure_as_written();
        finish();
    }

  private:
    RefineBase read() {
        const auto step = report_.step("read");
        progress_.update("reading", std::nan(""));
        return read_refine_base(command_.source, command_.weld, command_.frame, output_.format());
    }

    /// Base vertices are put on the ground too: a bound could not hold beside one that is off it.
    void read_terrain() {
        const auto step = report_.step("elevation");
        terrain_.emplace(command_.elevation, command_.datum, base_.meaning);
        for (glm::dvec3& p : base_.mesh.vertices) {
            const glm::dvec3 ground = terrain_->ground(p).value_or(p);
            lifted_max_ = std::max(lifted_max_, glm::distance(ground, p));
            p = ground;
        }
        if (terrain_->measure(base_.mesh).samples == 0)
            throw Error(Fault::bad_data, terrain_->name(), "has no sample within the mesh", "a raster that meets it");
    }

    bool round() const { return base_.meaning.round; }
    planet::BisectionRule rule() const { return command_.rule.value_or(planet::BisectionRule::modified); }
    SideGeometry sides() const {
        return command_.sides.value_or(terrain_ && !round() ? SideGeometry::plan : SideGeometry::space);
    }
    planet::BisectionOptions bisection_options() const {
        planet::BisectionOptions how{rule(), sides(), {}};
        if (terrain_ || round()) how.place = [this](const glm::dvec3& a, const glm::dvec3& b) { return place(a, b); };
        return how;
    }
    glm::dvec3 place(const glm::dvec3& a, const glm::dvec3& b) const {
        const glm::dvec3 middle = (a + b) * 0.5;
        glm::dvec3 there = round() ? between_heights(a, b) : middle;
        if (terrain_) there = terrain_->ground(middle).value_or(there);
        const double step = progressive_step();
        return step == 0 ? there : middle + glm::round((there - middle) / step) * step;
    }
    /// So many metres from midpoints, times a whole number, a progressive mesh has its places: a height takes it two bytes, not
    /// eight. 0: as they are.
    double progressive_step() const {
        constexpr double step = 1.0 / 256, least_bound = 100 * step;
        const bool placed = terrain_ || round();
        return command_.progressive && placed && command_.max_deviation.value_or(least_bound) >= least_bound ? step : 0;
    }
    /// Above the middle of a side of a round mesh, as high above the ellipsoid as its ends are in the mean: on the chord a
    /// planet would stay the solid that it was.
    glm::dvec3 between_heights(const glm::dvec3& a, const glm::dvec3& b) const {
        const planet::MeshReference& r = base_.meaning.reference;
        const auto ecef = [&](const glm::dvec3& p) { return r.origin + r.ecef_from_enu * p; };
        const auto height = [&](const glm::dvec3& p) { return planet::height_from_ecef(planet::wgs84, ecef(p)).m; };
        const glm::dvec3 normal = planet::normal_from_ecef(planet::wgs84, ecef((a + b) * 0.5));
        const glm::dvec3 there = planet::ecef_from_normal(planet::wgs84, normal, {(height(a) + height(b)) / 2});
        return glm::transpose(r.ecef_from_enu) * (there - r.origin);
    }
    std::string_view placed() const { return terrain_ ? "elevation" : round() ? "mean height" : "midpoint"; }
    bool has_goal() const { return command_.max_side || command_.max_deviation || command_.max_triangles; }
    std::function<bool(const TrianglePlaces&)> region() const {
        if (!region_) return {};
        return [this](const TrianglePlaces& triangle) { return region_->meets(triangle); };
    }

    void uniform_steps() {
        const auto step = report_.step("refine");
        for (int i = 0; i < *command_.steps; ++i) {
            if (bisection_->triangle_count() > most_triangles / 2) refuse_steps(i);
            bisection_->step(region());
        }
        stopped_by_ = "steps";
    }

    [[noreturn]] void refuse_steps(int accepted) const {
        throw Error(Fault::bad_usage, "--steps", std::to_string(*command_.steps) + " make too many triangles",
                    "at most " + std::to_string(accepted));
    }
    [[noreturn]] void refuse_limit(std::string_view option) const {
        throw Error(Fault::bad_usage, option, "takes more than " + std::to_string(most_triangles) + " triangles",
                    "a larger limit, or --max-triangles");
    }
    /// What is sure to take too long is refused at once: a step halves every triangle, and none with such sides is larger than
    /// an equilateral one.
    void check_effort() const {
        if (region_) return;
        const auto count = static_cast<double>(base_.mesh.triangles.size());
        const double steps = std::log2(static_cast<double>(most_triangles) / count);
        if (command_.steps && *command_.steps > steps) refuse_steps(static_cast<int>(steps));
        if (!command_.max_side || command_.max_triangles) return;
        double area = 0;
        for (const double a : base_areas()) area += a;
        const double largest = std::sqrt(3) / 4 * *command_.max_side * *command_.max_side;
        if (area / largest > static_cast<double>(most_triangles)) refuse_limit("--max-side");
    }

    void split_at(glm::dvec2 point) {
        const auto step = report_.step("refine");
        const auto side = bisection_->nearest_side(glm::dvec2(base_.meaning.in_metres({point, 0})));
        if (!side)
            throw Error(Fault::bad_usage, "--split", "no triangle holds that point",
                        "a point within the mesh, in plan");
        if (bisection_->split_side(*side) == 0)
            throw Error(Fault::bad_usage, "--split", "the side there is too short to halve", "another point");
        stopped_by_ = "split";
    }

    planet::RefineGoal goal(double tolerance) const {
        planet::RefineGoal goal;
        if (command_.max_side) goal.max_side = *command_.max_side;
        // Less would be asking for what sums of doubles cannot show.
        if (command_.max_deviation) goal.max_deviation = std::max(tolerance, 0.5 * measuring_slack_m);
        goal.max_triangles = command_.max_triangles.value_or(most_triangles);
        goal.order = order();
        goal.region = region();
        if (terrain_ && (command_.max_deviation || order() == planet::SplitOrder::deviation)) {
            goal.deviation = [this](std::span<const TrianglePlaces> triangles, std::span<double> deviations) {
                const unsigned threads = triangles.size() > 64 ? 0 : 1;
                planet::parallel_for(triangles.size(), threads,
                                     [&](std::size_t i) { deviations[i] = terrain_->deviation(triangles[i]); });
            };
        }
        return goal;
    }
    planet::SplitOrder order() const {
        return command_.order.value_or(command_.max_deviation ? planet::SplitOrder::deviation
                                                              : planet::SplitOrder::length);
    }

    /// What rounding takes from the bound is refined away: less and less is allowed until the mesh as written keeps it.
    void refine_within_bound() {
        constexpr int most_rounds = 16;
        double tolerance = command_.max_deviation.value_or(0);
        for (int round = 0; round < most_rounds; ++round) {
            {
                const auto step = report_.step("refine");
                end_ = bisection_->refine(goal(tolerance)).end;
            }
            if (end_ == RefineEnd::budget && !command_.max_triangles)
                refuse_limit(command_.max_deviation ? "--max-deviation" : "--max-side");
            set_stopped_by();
            measure_as_written();
            if (!command_.max_deviation) return;
            const double excess = measured_.max_in_region - *command_.max_deviation;
            if (excess <= measuring_slack_m || end_ != RefineEnd::met) break;
            tolerance -= 1.5 * excess;
            if (!(tolerance > 0)) break;
        }
        if (end_ == RefineEnd::budget || measured_.max_in_region <= *command_.max_deviation + measuring_slack_m) return;
        throw Error(Fault::bad_usage, "--max-deviation",
                    four_digits(*command_.max_deviation) + " m cannot be kept" + rounding_text(),
                    four_digits(measured_.max_in_region) + " m or more, or a .ply");
    }

    std::string rounding_text() const {
        const bool rounds = output_.format() == planet::MeshFormat::glb || output_.format() == planet::MeshFormat::stl;
        return rounds ? " in a " + command_.output->extension().string() + ", which rounds" : "";
    }

    void set_stopped_by() {
        if (end_ == RefineEnd::budget)
            stopped_by_ = "triangles";
        else if (end_ == RefineEnd::finest)
            stopped_by_ = "finest";
        else
            stopped_by_ = command_.max_deviation && command_.max_side ? "deviation and length"
                          : command_.max_deviation                    ? "deviation"
                                                                      : "length";
    }

    /// Leaves the mesh as its file will hold it.
    void measure_as_written() {
        const auto step = report_.step("certify");
        plain_ = bisection_->mesh();
        surface_ = surface_of(plain_, base_.meaning);
        rounding_ = output_.round(surface_, base_.meaning);
        if (!terrain_) return;
        planet::PlainMesh written{{}, surface_.triangles};
        written.vertices.reserve(surface_.vertices.size());
        for (const glm::dvec3& p : surface_.vertices) written.vertices.push_back(base_.meaning.in_metres(p));
        // As it was refined: what is rounded may meet another polygon.
        measured_ = terrain_->measure(
            written, !region_ ? std::function<bool(std::size_t)>() : [this](std::size_t t) {
                const auto& [a, b, c] = plain_.triangles[t];
                return region_->meets({plain_.vertices[a], plain_.vertices[b], plain_.vertices[c]});
            });
    }

    void finish() {
        const planet::BisectionReport found = bisection_->report();
        fill_report(found);
        progress_.update("writing", std::nan(""));
        if (command_.picture) output_.draw(plain_.vertices, plain_.triangles, levels(), base_.meaning);
        planet::MeshLooks looks = looks_of(plain_, base_.meaning);
        if (output_.format() == planet::MeshFormat::glb) looks.picture = base_.picture;
        output_.write(surface_, looks, base_.meaning, rounding_);
        if (command_.progressive)
            output_.write_progressive(bisection_->progressive(), progressive_step(), base_.meaning);
        output_.commit();
        tell(found);
    }

    /// In the geometry in which sides are judged.
    std::vector<double> base_areas() const {
        std::vector<double> areas;
        for (const auto& t : base_.mesh.triangles) {
            glm::dvec3 u = base_.mesh.vertices[t[1]] - base_.mesh.vertices[t[0]];
            glm::dvec3 v = base_.mesh.vertices[t[2]] - base_.mesh.vertices[t[0]];
            if (sides() == SideGeometry::plan) u.z = v.z = 0;
            areas.push_back(0.5 * glm::length(glm::cross(u, v)));
        }
        return areas;
    }

    /// How often its base triangle has been halved, by triangle.
    std::vector<std::uint8_t> levels() const {
        const std::vector<double> base_area = base_areas();
        std::vector<std::uint8_t> levels(bisection_->triangle_count());
        for (Bisection::Index t = 0; t < levels.size(); ++t) {
            const double area = area_from_sides(
                {bisection_->side_length(t, 0), bisection_->side_length(t, 1), bisection_->side_length(t, 2)});
            const double halvings = std::log2(base_area[bisection_->base_triangle(t)] / area);
            levels[t] =
                static_cast<std::uint8_t>(std::clamp(std::isfinite(halvings) ? std::round(halvings) : 0, 0.0, 255.0));
        }
        return levels;
    }

    void fill_report(const planet::BisectionReport& r) {
        report_.set("triangles", r.triangles);
        report_.set("vertices", r.vertices);
        report_.set("base_triangles", r.base_triangles);
        report_.set("base_vertices", r.base_vertices);
        if (command_.weld) report_.set("welded_vertices", base_.welded);
        report_rule(rule(), sides(), report_);
        report_.set("placed", placed());
        if (has_goal()) report_.set("order", order() == planet::SplitOrder::length ? "length" : "deviation");
        report_.set("stopped_by", stopped_by_);
        report_.set("splits", r.splits);
        report_.set("splits_requested", r.requests);
        report_.set("propagation_mean", r.propagation_mean);
        report_.set("propagation_max", r.propagation_max);
        report_.set("pending_triangles", r.pending_triangles);
        report_.set("angle_min_deg", r.angle_min / planet::degrees);
        report_.set("angle_min_complete_deg", r.angle_min_complete / planet::degrees);
        report_.set("angle_ratio_min", r.angle_ratio_min);
        report_.set("angle_ratio_min_pending", r.angle_ratio_min_pending);
        report_.set("similarity_classes", r.similarity_classes);
        report_.set("similarity_classes_max", r.similarity_classes_max);
        report_.set("side_max_m", r.side_max);
        report_.set("side_max_placed_m", r.side_max_placed);
        report_.set("bisection_bytes", bisection_->bytes());
        report_reference(base_.meaning.reference, report_);
        if (terrain_) report_terrain();
    }

    void report_terrain() {
        report_.set("elevation", terrain_->name());
        report_.set("lifted_max_m", lifted_max_);
        report_.set("deviation_max_m", measured_.max);
        report_.set("deviation_rms_m", measured_.rms);
        if (region_) report_.set("deviation_max_in_region_m", measured_.max_in_region);
        if (command_.max_deviation) report_.set("tolerance_m", *command_.max_deviation);
        report_.set("samples", measured_.samples);
        report_.set("samples_uncovered", measured_.uncovered);
    }

    void tell(const planet::BisectionReport& r) {
        progress_.clear();
        std::cout << grouped(r.triangles) << " triangles of " << grouped(r.base_triangles) << ", "
                  << grouped(r.vertices) << " vertices; smallest angle "
                  << fixed(r.angle_min_complete / planet::degrees, 2) << " degrees, at least "
                  << fixed(r.angle_ratio_min, 4) << " of its first";
        if (r.pending_triangles > 0) std::cout << " but in " << grouped(r.pending_triangles) << " pending triangles";
        if (terrain_) std::cout << "; deviation at most " << four_digits(measured_.max) << " m";
        if (!stopped_by_.empty()) std::cout << "; stopped by the " << stopped_by_;
        std::cout << "\n";
    }

    const RefineCommand& command_;
    Report& report_;
    Progress progress_;
    RefineOutput output_;
    RefineBase base_;
    std::optional<RefineRegion> region_;
    std::optional<RefineTerrain> terrain_;
    std::optional<Bisection> bisection_;
    double lifted_max_ = 0;
    RefineEnd end_ = RefineEnd::met;
    std::string stopped_by_;
    planet::PlainMesh plain_;      ///< as refined
    planet::SurfaceMesh surface_;  ///< as written
    planet::MeshRounding rounding_;
    RefineTerrain::Measured measured_;
};

}  // namespace

void refine_mesh(const RefineCommand& command, Report& report) {
    MeshRefiner(command, report).run();
}

}  // namespace render
