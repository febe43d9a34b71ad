#include "render/app/tin/tin_written.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "planet/error.h"
#include "planet/mesh/surface_check.h"
#include "planet/patches/patch_mesh.h"
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

class Certifier {
  public:
    Certifier(const HeightGrid& grid, const RasterFrame& frame, const TinGoal& goal)
        : grid_(grid), frame_(frame), goal_(goal) {}

    /// All triangles are measured at first and in the end; between, those that mending has made.
    WrittenTin run(planet::TinMesh mesh) {
        WrittenTin tin;
        tin.mesh = std::move(mesh);
        place(tin);
        for (;;) {
            measure_all(tin);
            Findings found = look(tin.mesh, tin.deviation);
            tin.kept = found.too_far == 0;
            tin.mendable = tin.kept || !found.samples.empty() || !found.border.empty();
            tin.border_samples = std::move(found.border);
            if (found.samples.empty() || !mend(tin, std::move(found.samples))) return tin;
        }
    }

  private:
    struct Findings {
        std::size_t too_far = 0;          ///< triangles
        std::vector<glm::ivec2> samples;  ///< the worst of each; corners cannot be inserted again
        std::vector<glm::ivec2> border;   ///< those on a shared border
    };

    void measure_all(WrittenTin& tin) const {
        tin.deviation =
            planet::measure_written(tin.mesh, tin.surface.vertices, grid_, frame_, goal_.threads, goal_.by_sample);
        tin.deviation_max = tin.deviation.max + grid_.sample_rounding();
    }

    Findings look(const planet::TinMesh& mesh, const planet::WrittenDeviation& deviation) const {
        Findings found;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            if (!is_too_far(deviation.by_triangle[i])) continue;
            ++found.too_far;
            const glm::ivec2 worst = deviation.farthest[i];
            if (std::ranges::any_of(mesh.triangles[i], [&](auto v) { return mesh.vertices[v] == worst; })) continue;
            (goal_.border_is_shared && on_border(worst) ? found.border : found.samples).push_back(worst);
        }
        return found;
    }

    bool is_too_far(double deviation) const { return deviation + grid_.sample_rounding() > goal_.tolerance; }

    /// Keys of the triangles within the tolerance, ascending.
    std::vector<std::uint64_t> within(const planet::TinMesh& mesh, const std::vector<double>& deviation) const {
        std::vector<std::uint64_t> keys;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            if (!is_too_far(deviation[i])) keys.push_back(key(mesh, i));
        std::sort(keys.begin(), keys.end());
        return keys;
    }

    /// Of a triangle, by its corners. That two share one is as good as impossible, and would be noticed in the end.
    static std::uint64_t key(const planet::TinMesh& mesh, std::size_t triangle) {
        std::array<std::uint64_t, 3> corner{};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 p = mesh.vertices[mesh.triangles[triangle][k]];
            corner[k] = std::uint64_t{static_cast<std::uint32_t>(p.y)} << 32 | static_cast<std::uint32_t>(p.x);
        }
        std::sort(corner.begin(), corner.end());
        std::uint64_t key = 0;
        for (const std::uint64_t c : corner) {  // as splitmix64 stirs
            key = (key ^ c) * 0xbf58476d1ce4e5b9u;
            key ^= key >> 29;
        }
        return key;
    }

    /// Inserts the worst samples until no triangle that this makes is too far.
    /// @return false, and the last state is measured, if that takes more triangles than there may be
    bool mend(WrittenTin& tin, std::vector<glm::ivec2> samples) const {
        std::vector<std::uint64_t> done = within(tin.mesh, tin.deviation.by_triangle);
        tin.deviation = {};
        while (!samples.empty()) {
            tin.surface = {};
            planet::TinMesh mended = planet::with_samples(tin.mesh, grid_, samples, goal_.features);
            if (mended.triangles.size() > goal_.max_triangles) {
                place(tin);
                measure_all(tin);
                return false;
            }
            tin.inserted += samples.size();
            tin.mesh = std::move(mended);
            const double step = tin.rounding.step;
            place(tin);
            if (tin.rounding.step != step) done.clear();  // everything has moved
            planet::TinMesh fresh{tin.mesh.vertices, {}, {}};
            for (std::size_t i = 0; i < tin.mesh.triangles.size(); ++i)
                if (!std::binary_search(done.begin(), done.end(), key(tin.mesh, i)))
                    fresh.triangles.push_back(tin.mesh.triangles[i]);
            const planet::WrittenDeviation deviation =
                planet::measure_written(fresh, tin.surface.vertices, grid_, frame_, goal_.threads);
            samples = look(fresh, deviation).samples;
            const std::vector<std::uint64_t> now = within(fresh, deviation.by_triangle);
            const auto middle = static_cast<std::ptrdiff_t>(done.size());
            done.insert(done.end(), now.begin(), now.end());
            std::inplace_merge(done.begin(), done.begin() + middle, done.end());
        }
        return true;
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
    WrittenTin tin = Certifier(grid, frame, goal).run(std::move(mesh));
    tin.deviation.by_triangle = std::vector<double>();
    tin.deviation.farthest = std::vector<glm::ivec2>();
    return tin;
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
    if (!file.temporary().empty()) compare(file.temporary().string(), format, tin.surface);
    return bytes;
}

}  // namespace render
