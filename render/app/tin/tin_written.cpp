#include "render/app/tin/tin_written.h"

#include <algorithm>
#include <cmath>

#include "planet/error.h"
#include "planet/mesh/surface_check.h"
#include "planet/tin/tin_mending.h"
#include "planet/tin/tin_solid.h"
#include "render/app/mesh/raster_frames.h"
#include "render/app/tin/tin_source.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::HeightGrid;
using planet::RasterFrame;

void close_below(planet::SurfaceMesh& surface, const planet::TinSolid& solid, const TinFloor& floor,
                 const RasterFrame& frame) {
    for (const glm::ivec2 sample : solid.floor) {
        const glm::dvec2 at(sample);
        glm::dvec3& place = surface.vertices.emplace_back();
        frame.place({&at, 1}, {&floor.height, 1}, {&place, 1}, {});
        if (floor.z) place.z = *floor.z;
    }
    for (auto t : solid.below) {
        if (frame.mirrored()) std::swap(t[1], t[2]);
        surface.triangles.push_back(t);
    }
    surface.level.resize(surface.triangles.size(), 0);
}

/// The largest deviation that, with the rounding of samples added, is within the tolerance to the last bit.
double largest_within(double tolerance, double rounding) {
    double deviation = tolerance - rounding;
    while (deviation + rounding > tolerance) deviation = std::nextafter(deviation, -1.0);
    return deviation;
}

class Certifier {
  public:
    Certifier(const HeightGrid& grid, const RasterFrame& frame, const TinGoal& goal)
        : grid_(grid),
          frame_(frame),
          goal_(goal),
          measure_(grid, frame,
                   {largest_within(goal.tolerance, grid.sample_rounding()), goal.by_sample, goal.threads}) {}

    WrittenTin run(planet::TinMesh mesh) {
        WrittenTin tin;
        tin.mesh = std::move(mesh);
        place(tin);
        measure_.measure(tin.mesh, tin.surface.vertices);
        for (;;) {
            tell(tin);
            const std::vector<planet::FarTriangle> due = look(tin);
            if (due.empty() || tin.mesh.triangles.size() + 2 * due.size() > goal_.max_triangles) break;
            mend(tin, due);
        }
        tin.deviation = measure_.take();
        return tin;
    }

  private:
    void tell(WrittenTin& tin) const {
        const planet::WrittenDeviation& found = measure_.found();
        tin.deviation_max = found.max + grid_.sample_rounding();
        tin.kept = found.too_far.empty();
    }

    /// @return what can be mended here: corners cannot be inserted again, and a shared border is not only ours
    std::vector<planet::FarTriangle> look(WrittenTin& tin) const {
        std::vector<planet::FarTriangle> due;
        tin.border_samples.clear();
        for (const planet::FarTriangle& far : measure_.found().too_far) {
            const auto& corners = tin.mesh.triangles[far.triangle];
            if (std::ranges::any_of(corners, [&](auto v) { return tin.mesh.vertices[v] == far.sample; })) continue;
            if (goal_.border_is_shared && on_border(far.sample))
                tin.border_samples.push_back(far.sample);
            else
                due.push_back(far);
        }
        tin.mendable = tin.kept || !due.empty() || !tin.border_samples.empty();
        return due;
    }

    void mend(WrittenTin& tin, const std::vector<planet::FarTriangle>& due) {
        tin.surface = {};
        const planet::MendedTin mended = planet::mend(tin.mesh, grid_, due);
        tin.inserted += mended.inserted;
        const double step = tin.rounding.step;
        place(tin);
        if (tin.rounding.step != step)  // everything has moved
            measure_.measure(tin.mesh, tin.surface.vertices);
        else
            measure_.measure_again(tin.mesh, tin.surface.vertices, mended.changed);
    }

    void place(WrittenTin& tin) const {
        if (tin.mesh.triangles.empty())
            throw Error(Fault::bad_data, "the TIN", "no triangle has three valid corners",
                        "three valid samples side by side");
        std::optional<planet::TinSolid> solid;
        if (goal_.floor) {
            solid = planet::solid_below(std::move(tin.mesh), {grid_.width() - 1, grid_.height() - 1});
            tin.mesh = solid->top;
        }
        tin.surface = planet::surface_from_tin(tin.mesh, grid_, frame_);
        if (solid) close_below(tin.surface, *solid, *goal_.floor, frame_);
        if (std::ranges::any_of(tin.surface.vertices, is_nowhere)) refuse_reach("the raster");
        tin.rounding = planet::round_to_format(tin.surface, frame_.reference(), goal_.format, goal_.least_step);
    }

    bool on_border(glm::ivec2 p) const {
        return p.x == 0 || p.y == 0 || p.x == grid_.width() - 1 || p.y == grid_.height() - 1;
    }

    const HeightGrid& grid_;
    const RasterFrame& frame_;
    const TinGoal& goal_;
    planet::WrittenMeasure measure_;
};

}  // namespace

void WrittenTin::keep_surface_only() {
    mesh = {};
    deviation.by_sample = std::vector<float>();  // = {} would keep the room
    surface.strip = std::vector<std::uint32_t>();
    surface.level = std::vector<std::uint8_t>();
}

TinFloor floor_below(const HeightGrid& grid, const RasterFrame& frame, double base) {
    TinFloor floor{height_range(grid).x - base, {}};
    if (frame.reference().frame == planet::MeshFrame::enu && curves(frame))
        floor.z = height_range(planet::heights_above_tangent_plane(grid, frame)).x - base * frame.exaggeration();
    return floor;
}

WrittenTin as_written(planet::TinMesh mesh, const HeightGrid& grid, const RasterFrame& frame, const TinGoal& goal) {
    return Certifier(grid, frame, goal).run(std::move(mesh));
}

long check_closed(const planet::SurfaceMesh& solid, planet::MeshFrame frame) {
    const planet::SurfaceCheck found = planet::check(solid, frame);
    if (found.border_sides + found.wrong_sides + found.degenerate + found.unused_vertices > 0)
        throw Error(Fault::check_failed, "the solid", "is not closed: " + found.summary());
    return found.euler();
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
    const std::string written = file.temporary().string();
    if (!written.empty() && !planet::file_holds(written, format, tin.surface))
        throw Error(Fault::check_failed, written, "does not hold what was measured");
    return bytes;
}

}  // namespace render
