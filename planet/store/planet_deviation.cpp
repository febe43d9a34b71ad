// How far a mesh of the planet is from the finest vertices of its store.
//
// The vertices of a tile are measured as the split vertices of its cells: each twice, once from either side of its diamond,
// against the triangle of the mesh that holds the cell, or if the vertex belongs to the mesh against one that has it as a
// corner. Triangles of the mesh are met in the order of the curve, in which the cells below a triangle are ranges of local
// indices: one plane against contiguous arrays.

#include <algorithm>
#include <cassert>
#include <cmath>

#include "planet/mesh/deviation.h"
#include "planet/parallel.h"
#include "planet/store/planet_mesh.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

/// The place of a cell's beginning on the curve around the planet.
std::uint64_t curve_place(LocationCode cell) {
    return static_cast<std::uint64_t>(loop_rank_of_face(cell.face())) << max_bisection_level |
           cell.path() << (max_bisection_level - cell.bisection_level());
}
std::uint64_t curve_length(LocationCode cell) {
    return std::uint64_t{1} << (max_bisection_level - cell.bisection_level());
}

/// The triangles of a mesh as planes, found by their place on the curve.
class MeshPlanes {
  public:
    MeshPlanes(const PlanetMesh& mesh, std::span<const glm::dvec3> vertices) : mesh_(mesh), vertices_(vertices) {}

    LocationCode cell(std::size_t triangle) const { return mesh_.cells[triangle]; }
    CellPlane plane(std::size_t triangle) const {
        const auto& t = mesh_.mesh.triangles[triangle];
        return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
    }
    /// The triangle that holds a place, not before triangle `from`.
    std::size_t at(std::uint64_t place, std::size_t from = 0) const { return first_from(place + 1, from) - 1; }
    /// The first triangle that begins at a place or after it.
    std::size_t first_from(std::uint64_t place, std::size_t from) const {
        const auto begin = mesh_.cells.begin() + static_cast<std::ptrdiff_t>(from);
        const auto found =
            std::partition_point(begin, mesh_.cells.end(), [&](LocationCode c) { return curve_place(c) < place; });
        return static_cast<std::size_t>(found - mesh_.cells.begin());
    }

  private:
    const PlanetMesh& mesh_;
    std::span<const glm::dvec3> vertices_;
};

struct Sum {
    double maximum = 0, squares = 0;
    std::uint64_t samples = 0;
};

constexpr std::size_t width = 8;

/// Measures one tile at a time.
class TileMeasure {
  public:
    TileMeasure(const PlanetLattice& lattice, const MeshPlanes& planes) : lattice_(lattice), planes_(planes) {}

    Sum measure(const LatticeTile& tile) {
        tile_ = &tile;
        lattice_.place(tile, scratch_);
        arrange();
        corner_maximum_ = 0;
        triangle_ = planes_.at(curve_place(tile.root));
        if (planes_.cell(triangle_).bisection_level() < tile.root.bisection_level())
            measure_below(1, planes_.plane(triangle_));
        else
            visit(1);
        Sum sum = reduce();
        if (tile.root.bisection_level() == 0) add_face_corners(sum);
        return sum;
    }

  private:
    unsigned cells() const { return 1u << tile_->depth; }

    // Normals and positions by local index of the cell that the vertex splits.
    void arrange() {
        const TileLayout& layout = tile_layout();
        const std::size_t padded = std::max<std::size_t>(cells(), width);
        above_.assign(padded, std::numeric_limits<double>::quiet_NaN());
        for (int axis = 0; axis < 3; ++axis) {
            n_[axis].resize(padded);
            p_[axis].resize(padded);
            const double *n = scratch_.lattice.normals(axis), *p = scratch_.lattice.positions(axis);
            for (unsigned i = 1; i < cells(); ++i) {
                n_[axis][i] = n[layout.split_vertex[i]];
                p_[axis][i] = p[layout.split_vertex[i]];
            }
        }
    }

    // The split vertices of a cell and of all cells below it against a plane.
    void measure_below(unsigned local, const CellPlane& plane) {
        for (unsigned first = local, end = local + 1; first < cells(); first *= 2, end *= 2)
            measure_range(first, end, plane);
    }
    void measure_range(unsigned first, unsigned end, const CellPlane& plane) {
        const double *nx = n_[0].data(), *ny = n_[1].data(), *nz = n_[2].data();
        const double *px = p_[0].data(), *py = p_[1].data(), *pz = p_[2].data();
        const glm::dvec3 A = plane.corner, N = plane.normal;
        double* out = above_.data();
#pragma GCC ivdep
        for (unsigned i = first; i < end; ++i)
            out[i] = ((A.x - px[i]) * N.x + (A.y - py[i]) * N.y + (A.z - pz[i]) * N.z) /
                     (nx[i] * N.x + ny[i] * N.y + nz[i] * N.z);
    }

    // Goes through the triangles in a cell, from the present one on. Returns the one that begins where its second child
    // begins, or that is the cell.
    std::size_t visit(unsigned local) {
        const LocationCode cell = cell_code(tile_->root, local);
        if (planes_.cell(triangle_) == cell) {
            const CellPlane plane = planes_.plane(triangle_);
            measure_below(local, plane);
            for (const std::uint16_t v : tile_layout().corners[local]) measure_corner(plane, v);
            return triangle_++;
        }
        if (!tile_->exists(local)) {  // in a tile below, or finer than the store
            const std::size_t middle = planes_.at(curve_place(cell) + curve_length(cell) / 2, triangle_);
            triangle_ = planes_.first_from(curve_place(cell) + curve_length(cell), middle);
            return middle;
        }
        // The split vertex is the left corner of every cell at the beginning of child 1 of child 0, or child 0's apex.
        const std::size_t with_vertex = visit(2 * local);
        const std::size_t middle = triangle_;
        visit(2 * local + 1);
        measure_range(local, local + 1, planes_.plane(with_vertex));
        return middle;
    }

    void measure_corner(const CellPlane& plane, std::size_t v) {
        const double t = std::abs(plane.above(scratch_.lattice.position(v), scratch_.lattice.normal(v)));
        if (t > corner_maximum_) corner_maximum_ = t;
    }

    // Eight sums side by side, then one after the other: the same bits for any vector width.
    Sum reduce() {
        count_once();
        double most[width]{}, squares[width]{}, samples[width]{};
        above_[0] = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t i = 0; i < above_.size(); i += width)
            for (std::size_t w = 0; w < width; ++w) {
                const double t = std::abs(above_[i + w]);
                const double counts = t >= 0 ? counts_[i + w] : 0.0, known = t >= 0 ? t : 0.0;
                most[w] = known > most[w] ? known : most[w];
                squares[w] += counts * known * known;
                samples[w] += counts;
            }
        Sum sum{corner_maximum_};
        for (std::size_t w = 0; w < width; ++w) {
            sum.maximum = std::max(sum.maximum, most[w]);
            sum.squares += squares[w];
            sum.samples += static_cast<std::uint64_t>(samples[w]);
        }
        return sum;
    }

    // 1 for one of the two cells of every diamond, 0 for the other.
    void count_once() {
        static const std::vector<double> inside = [] {
            std::vector<double> counts(tile_cells, 0.0);
            for (unsigned i = 1; i < tile_cells; ++i) counts[i] = i < tile_layout().split_neighbor[i] ? 1.0 : 0.0;
            return counts;
        }();
        counts_.assign(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(above_.size()));
        for (const SideCell side : side_cells(tile_->depth)) {
            const LocationCode cell = cell_code(tile_->root, side.cell);
            counts_[side.cell] = cell < neighbor(cell) ? 1.0 : 0.0;
        }
    }

    // The six corners of the octahedron split no cell: a pole by the first face at it, the others by the face to the east.
    void add_face_corners(Sum& sum) {
        const LocationCode root = tile_->root;
        const auto measure_at = [&](std::size_t triangle, std::size_t v, bool counts) {
            corner_maximum_ = 0;
            measure_corner(planes_.plane(triangle), v);
            sum.maximum = std::max(sum.maximum, corner_maximum_);
            if (!counts) return;
            sum.squares += corner_maximum_ * corner_maximum_;
            ++sum.samples;
        };
        measure_at(planes_.at(curve_place(root)), 0, root.face() < 4);
        measure_at(planes_.at(curve_place(root) + curve_length(root) / 2 - 1), 2, root.face() % 4 == 0);
    }

    const PlanetLattice& lattice_;
    const MeshPlanes& planes_;
    const LatticeTile* tile_ = nullptr;
    LatticeScratch scratch_;
    std::vector<double> n_[3], p_[3], above_, counts_;
    double corner_maximum_ = 0;
    std::size_t triangle_ = 0;
};

}  // namespace

DeviationReport measure(const PlanetLattice& lattice, const PlanetMesh& mesh, std::span<const glm::dvec3> vertices) {
    assert(vertices.size() == mesh.mesh.vertices.size());
    const std::vector<LocationCode> roots = lattice.store().tiles();
    const MeshPlanes planes(mesh, vertices);
    constexpr std::size_t batch = 16;
    std::vector<Sum> sums(roots.size());
    parallel_for((roots.size() + batch - 1) / batch, lattice.threads(), [&](std::size_t b) {
        TileMeasure one(lattice, planes);
        for (std::size_t i = b * batch; i < std::min(roots.size(), (b + 1) * batch); ++i) {
            const LatticeTile* tile = lattice.find(roots[i]);
            const auto loaded = tile ? nullptr : lattice.read(roots[i]);
            sums[i] = one.measure(tile ? *tile : *loaded);
        }
    });
    DeviationReport report;
    double squares = 0;
    for (const Sum& s : sums) {
        report.maximum = std::max(report.maximum, s.maximum);
        squares += s.squares;
        report.samples += s.samples;
    }
    report.rms = std::sqrt(squares / static_cast<double>(report.samples));
    report.resampling = lattice.store().metadata().resampling_max_m;
    return report;
}

}  // namespace planet
