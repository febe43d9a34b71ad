// octaglobe mesh --remove: the merging domain of a vertex, on patches or on the planet.

#include <iostream>
#include <unordered_map>

#include "planet/error.h"
#include "planet/geodesy/ellipsoid.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/patches/patch_mesh.h"
#include "planet/quadtree/patch_lattice.h"
#include "planet/quadtree/triangulation.h"
#include "render/app/mesh/mesh_output.h"

namespace render {
namespace {

using planet::CellCode;
using planet::Error;
using planet::Fault;

/// More would hide the triangles.
constexpr std::size_t most_marks = 3000;

/// What a topology adds: where vertices are, and which one was meant.
class Patches {
  public:
    static constexpr bool is_planet = false;
    explicit Patches(const MeshOptions& o) : lattice_(planet::PatchGrid(o.columns, o.rows), o.patch_level) {}

    const planet::PatchGrid& topology() const { return lattice_.grid(); }
    int levels() const { return lattice_.bisection_levels(); }
    std::array<glm::dvec3, 3> corners(CellCode cell) const {
        const planet::LatticeCorners c = lattice_.corners(cell);
        return {at(c.left), at(c.right), at(c.apex)};
    }
    glm::dvec3 split_vertex(CellCode cell) const {
        return at(planet::PatchLattice::split_vertex(lattice_.corners(cell)));
    }

    CellCode cell_of(const std::string& text) const {
        const std::string accepted = "X,Y with X 0 to " + std::to_string(lattice_.width() - 1) + " and Y 0 to " +
                                     std::to_string(lattice_.height() - 1) + ", no corner of a patch";
        const auto comma = text.find(',');
        if (comma == std::string::npos)
            throw Error(Fault::bad_usage, "--remove", shown(text) + " is no sample", accepted);
        const auto x = static_cast<int>(parse_whole("--remove", text.substr(0, comma), 0, lattice_.width() - 1));
        const auto y = static_cast<int>(parse_whole("--remove", text.substr(comma + 1), 0, lattice_.height() - 1));
        const auto cell = lattice_.cell_split_at({x, y});
        if (!cell) throw Error(Fault::bad_usage, "--remove", shown(text) + " is the corner of a patch", accepted);
        return *cell;
    }

  private:
    static glm::dvec3 at(glm::ivec2 p) { return {p.x, p.y, 0}; }
    planet::PatchLattice lattice_;
};

class Planet {
  public:
    static constexpr bool is_planet = true;
    explicit Planet(const MeshOptions& o) : levels_(*o.level) {}

    planet::OctahedronTopology topology() const { return {}; }
    int levels() const { return levels_; }
    std::array<glm::dvec3, 3> corners(CellCode cell) const {
        const planet::Corners c = planet::corners(planet::LocationCode(cell));
        return {at(c.left), at(c.right), at(c.apex)};
    }
    glm::dvec3 split_vertex(CellCode cell) const {
        return at(planet::split_vertex(planet::corners(planet::LocationCode(cell))));
    }
    CellCode cell_of(const std::string& text) const {
        const planet::Geodetic g = parse_place("--remove", text);
        const auto vertex = planet::nearest_vertex(planet::normal_from_geodetic(g.latitude, g.longitude), levels_);
        if (vertex.cell == 0)
            throw Error(Fault::bad_usage, "--remove", shown(text) + " is nearest to a corner of the octahedron",
                        "another place, or a finer --level");
        return vertex.cell;
    }

  private:
    static glm::dvec3 at(const glm::dvec3& n) { return planet::ecef_from_normal(planet::wgs84, n, {0}); }
    int levels_;
};

struct Domain {
    std::vector<std::size_t> merged_by_step;
    std::vector<glm::dvec3> removed;  ///< the vertex asked for, then the others
    std::unordered_map<CellCode, std::uint8_t> step_of;
    std::size_t visited = 0;
};

template <class Space, class Mesh>
Domain remove(const Space& space, Mesh& mesh, CellCode cell) {
    Domain domain;
    domain.removed.push_back(space.split_vertex(cell));
    domain.visited = mesh.remove(cell, [&](CellCode merged, int step) {
        domain.merged_by_step.resize(static_cast<std::size_t>(step));
        ++domain.merged_by_step.back();
        domain.step_of[merged] = static_cast<std::uint8_t>(step);
        mesh.for_each_split_below(merged, [&](CellCode gone) {
            // Each vertex once, though it splits two cells.
            if (planet::diamond(mesh.topology(), gone) == gone && gone != planet::diamond(mesh.topology(), cell))
                domain.removed.push_back(space.split_vertex(gone));
        });
    });
    return domain;
}

/// Unique by place: corners of patches and of faces have no code of their own.
class MeshBuilder {
  public:
    template <class Space>
    void add(const Space& space, CellCode cell, int level) {
        std::array<std::uint32_t, 3> t{};
        const auto corners = space.corners(cell);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [at, is_new] =
                index_.try_emplace(key(corners[k]), static_cast<std::uint32_t>(mesh_.vertices.size()));
            if (is_new) mesh_.vertices.push_back(corners[k]);
            t[k] = at->second;
        }
        if (level % 2 == 1) std::swap(t[0], t[1]);  // children are wound the other way round
        mesh_.triangles.push_back(t);
        mesh_.level.push_back(static_cast<std::uint8_t>(level));
    }
    planet::SurfaceMesh take() {
        planet::append_strips(mesh_.triangles, mesh_.strip);
        return std::move(mesh_);
    }

  private:
    struct Hash {
        std::size_t operator()(const std::array<double, 3>& p) const {
            std::size_t h = 0;
            for (const double v : p) h = h * 0x9e3779b97f4a7c15u + std::hash<double>{}(v);
            return h;
        }
    };
    static std::array<double, 3> key(const glm::dvec3& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }
    planet::SurfaceMesh mesh_;
    std::unordered_map<std::array<double, 3>, std::uint32_t, Hash> index_;
};

void fill_report(const Domain& domain, int label, Report& report) {
    report.set("vertex_label", label);
    report.set("vertex_grid", planet::vertex_grid(label));
    report.set("spreading_steps", domain.merged_by_step.size());
    report.set("merged_triangles", domain.step_of.size());
    report.set("merged_by_step", domain.merged_by_step);
    report.set("removed_vertices", domain.removed.size());
    report.set("cells_visited", domain.visited);
}

std::string counted(std::size_t number, const char* one, const char* many) {
    return grouped(number) + " " + (number == 1 ? one : many);
}

template <class Space>
void run(const Space& space, const MeshOptions& options, Report& report) {
    MeshOutput output(options);
    planet::MeshReference reference;
    reference.frame = Space::is_planet ? planet::MeshFrame::ecef : planet::MeshFrame::enu;
    if (Space::is_planet) {
        reference.crs = "EPSG:4978";
        reference.vertical_datum = "ellipsoid";
    }
    planet::check_frame(reference, output.format());
    const CellCode cell = space.cell_of(options.remove);
    planet::Triangulation<std::decay_t<decltype(space.topology())>, planet::DenseSplitSet> mesh(space.topology(),
                                                                                                space.levels());
    for (int rank = 0; rank < mesh.topology().root_count(); ++rank) mesh.split_cells().fill(mesh.topology().root(rank));
    const int label = planet::vertex_label(cell, mesh.topology().root_bits());
    const Domain domain = remove(space, mesh, cell);

    MeshBuilder builder;
    std::vector<std::uint8_t> step;
    mesh.for_each_leaf([&](CellCode leaf) {
        builder.add(space, leaf, mesh.level_of(leaf));
        const auto merged = domain.step_of.find(leaf);
        step.push_back(merged == domain.step_of.end() ? std::uint8_t{0} : merged->second);
    });
    planet::SurfaceMesh surface = builder.take();
    MeshPicture picture{
        .vertices = surface.vertices,
        .triangles = surface.triangles,
        .level = surface.level,
        .step = step,
        .marks = std::span(domain.removed).first(domain.removed.size() <= most_marks ? domain.removed.size() : 1),
        .planet = Space::is_planet,
        .look_from = Space::is_planet ? domain.removed[0] : glm::dvec3(0, 0, 1)};
    if (Space::is_planet) picture.window = merging_window(picture);
    if (picture.window && picture.window->radius > 0.8 * planet::wgs84.a) picture.window.reset();
    const planet::MeshRounding rounding = planet::round_to_format(surface, reference, output.format());
    output.write(surface, reference, rounding, report);
    output.draw(picture, report);
    output.commit();
    report_mesh(surface, reference, report);
    fill_report(domain, label, report);
    std::cout << "vertex " << shown(options.remove) << ": label " << label << " (" << planet::vertex_grid(label)
              << "), " << grouped(domain.step_of.size()) << " triangles merge in "
              << counted(domain.merged_by_step.size(), "step", "steps") << ", "
              << counted(domain.removed.size(), "vertex", "vertices") << " removed\n";
}

}  // namespace

void mesh_domain(const MeshOptions& options, Report& report) {
    if (options.planet)
        run(Planet(options), options, report);
    else
        run(Patches(options), options, report);
}

}  // namespace render
