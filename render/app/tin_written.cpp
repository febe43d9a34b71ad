#include "render/app/tin_written.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/patches/patch_mesh.h"
#include "planet/tin/tin_solid.h"
#include "render/app/tin_source.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::HeightGrid;
using planet::RasterFrame;

bool is_nowhere(const glm::dvec3& p) {
    return std::isnan(p.x + p.y);
}

/// Where the floor of a solid lies below samples: flat where up is z, else so high above the ellipsoid.
class Floor {
  public:
    Floor(const HeightGrid& grid, const RasterFrame& frame, double base) : frame_(frame) {
        height_ = height_range(grid).x - base;
        if (frame.reference().frame == planet::MeshFrame::ecef || !curves(frame)) return;
        const HeightGrid z = planet::heights_above_tangent_plane(grid, frame);
        level_ = height_range(z).x - base * frame.exaggeration();
    }

    std::vector<glm::dvec3> places(const std::vector<glm::ivec2>& below) const {
        std::vector<glm::dvec2> at(below.begin(), below.end());
        const std::vector<double> heights(below.size(), height_);
        std::vector<glm::dvec3> out(below.size());
        frame_.place(at, heights, out, {});
        if (level_)
            for (glm::dvec3& p : out) p.z = *level_;
        return out;
    }

  private:
    const RasterFrame& frame_;
    double height_;
    std::optional<double> level_{};
};

void close_below(WrittenTin& tin, const planet::TinSolid& solid, const Floor& floor, bool mirrored) {
    planet::SurfaceMesh& surface = tin.surface;
    std::ranges::move(floor.places(solid.floor), std::back_inserter(surface.vertices));
    for (auto t : solid.below) {
        if (mirrored) std::swap(t[1], t[2]);
        surface.triangles.push_back(t);
    }
    surface.level.resize(surface.triangles.size(), 0);
    surface.strip.clear();
    planet::append_strips(surface.triangles, surface.strip);
}

class Certifier {
  public:
    Certifier(const HeightGrid& grid, const RasterFrame& frame, const TinGoal& goal)
        : grid_(grid), frame_(frame), goal_(goal) {
        if (goal.base) floor_.emplace(grid, frame, *goal.base);
    }

    WrittenTin run(planet::TinMesh mesh) {
        WrittenTin tin;
        for (tin.mesh = std::move(mesh);;) {
            place(tin);
            tin.deviation =
                planet::measure_written(tin.mesh, tin.surface.vertices, grid_, frame_, goal_.threads, goal_.by_sample);
            tin.deviation_max = tin.deviation.max + grid_.sample_rounding();
            const std::vector<glm::ivec2> samples = too_far(tin);
            if (samples.empty()) return tin;
            planet::TinMesh mended = planet::with_samples(tin.mesh, grid_, samples, goal_.features);
            if (mended.triangles.size() > goal_.max_triangles) return tin;
            tin.inserted += samples.size();
            tin.mesh = std::move(mended);
        }
    }

  private:
    void place(WrittenTin& tin) const {
        if (tin.mesh.triangles.empty())
            throw Error(Fault::bad_data, "the TIN", "no triangle has three valid corners",
                        "three valid samples side by side");
        std::optional<planet::TinSolid> solid;
        if (floor_) {
            solid = planet::solid_below(std::move(tin.mesh), {grid_.width() - 1, grid_.height() - 1});
            tin.mesh = solid->top;
        }
        tin.surface = planet::surface_from_tin(tin.mesh, grid_, frame_);
        if (solid) close_below(tin, *solid, *floor_, frame_.mirrored());
        if (std::ranges::any_of(tin.surface.vertices, is_nowhere))
            throw Error(Fault::bad_usage, "--frame", "does not reach all of the raster", "another frame, e.g. source");
        tin.rounding = planet::round_to_format(tin.surface, frame_.reference(), goal_.format, goal_.least_step);
    }

    /// The worst samples of triangles that exceed the tolerance. Corners cannot be inserted again.
    std::vector<glm::ivec2> too_far(WrittenTin& tin) const {
        std::vector<glm::ivec2> samples;
        const double bound = goal_.tolerance + tin_measuring_slack_m - grid_.sample_rounding();
        tin.kept = true;
        tin.border_samples.clear();
        for (std::size_t i = 0; i < tin.mesh.triangles.size(); ++i) {
            if (!(tin.deviation.by_triangle[i] > bound)) continue;
            tin.kept = false;
            const glm::ivec2 worst = tin.deviation.farthest[i];
            if (std::ranges::any_of(tin.mesh.triangles[i], [&](auto v) { return tin.mesh.vertices[v] == worst; }))
                continue;
            (goal_.border_is_shared && on_border(worst) ? tin.border_samples : samples).push_back(worst);
        }
        tin.mendable = tin.kept || !samples.empty() || !tin.border_samples.empty();
        return samples;
    }

    bool on_border(glm::ivec2 p) const {
        return p.x == 0 || p.y == 0 || p.x == grid_.width() - 1 || p.y == grid_.height() - 1;
    }

    const HeightGrid& grid_;
    const RasterFrame& frame_;
    const TinGoal& goal_;
    std::optional<Floor> floor_;
};

void compare(const std::string& path, planet::MeshFormat format, const planet::SurfaceMesh& measured) {
    const planet::SurfaceMesh found = planet::read_mesh(path, format);
    bool same = found.triangles.size() == measured.triangles.size();
    for (std::size_t i = 0; same && i < found.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            same = same && found.vertices[found.triangles[i][k]] == measured.vertices[measured.triangles[i][k]];
    if (!same) throw Error(Fault::check_failed, path, "does not hold what was measured");
}

}  // namespace

WrittenTin as_written(planet::TinMesh mesh, const HeightGrid& grid, const RasterFrame& frame, const TinGoal& goal) {
    return Certifier(grid, frame, goal).run(std::move(mesh));
}

std::size_t write_checked(OutputFile& file, const WrittenTin& tin, const planet::MeshReference& reference,
                          planet::MeshFormat format, const planet::MeshLooks& looks) {
    std::size_t bytes = 0;
    planet::write_mesh(
        [&](std::string_view block) {
            bytes += block.size();
            file.append(block);
        },
        tin.surface, reference, format, tin.rounding, looks);
    if (!file.temporary().empty()) compare(file.temporary().string(), format, tin.surface);
    return bytes;
}

}  // namespace render
