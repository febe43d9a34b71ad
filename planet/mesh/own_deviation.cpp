#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>

#include "planet/mesh/deviation.h"
#include "planet/mesh/lane_plane.h"

namespace planet {

namespace {

// Below local level `lane_level` every cell of a tile has the same structure, so those cells are the lanes: 64 of them
// in a full tile, each with the 45 vertices of a tile six levels deep.
struct LaneLayout {
    int lane_level = 0;
    int sub_depth = 0;
    std::size_t lanes = 0, groups = 0;
    std::size_t sub_vertices = 0;
    /// [group][sub vertex][lane]: the vertex index in the tile. Lanes beyond the last repeat it.
    std::vector<std::uint16_t> vertex;
    /// For sub cell u the vertices in it but its corners: inside[first[u]] .. inside[first[u + 1]].
    std::vector<std::uint16_t> first, inside;
};

// Local index in the tile of sub cell u below the lane's root.
unsigned tile_cell(unsigned lane_root, unsigned u) {
    const int level = std::bit_width(u) - 1;
    return lane_root << level | (u ^ 1u << level);
}

void list_inside(LaneLayout& l, const TileLayout& t) {
    const unsigned cells = 1u << l.sub_depth;
    l.first.assign(cells + 1, 0);
    for (unsigned u = 1; u < cells; ++u) {
        l.first[u] = static_cast<std::uint16_t>(l.inside.size());
        std::vector<std::uint16_t> in;
        const int level = std::bit_width(u) - 1;
        for (int k = 0; k < l.sub_depth - level; ++k)
            for (unsigned j = u << k; j < (u + 1) << k; ++j) in.push_back(t.split_vertex[j]);
        std::sort(in.begin(), in.end());
        in.erase(std::unique(in.begin(), in.end()), in.end());
        l.inside.insert(l.inside.end(), in.begin(), in.end());
    }
    l.first[cells] = static_cast<std::uint16_t>(l.inside.size());
}

LaneLayout make_lanes(int depth) {
    const TileLayout& t = tile_layout();
    LaneLayout l;
    l.lane_level = depth / 2;
    l.sub_depth = depth - l.lane_level;
    l.lanes = std::size_t{1} << l.lane_level;
    l.groups = (l.lanes + lane_count - 1) / lane_count;
    l.sub_vertices = t.vertex_count[static_cast<std::size_t>(l.sub_depth)];
    l.vertex.resize(l.groups * l.sub_vertices * lane_count);
    for (std::size_t slot = 0; slot < l.groups * lane_count; ++slot) {
        const auto root = static_cast<unsigned>(l.lanes + std::min(slot, l.lanes - 1));
        const auto at = [&](std::size_t v) -> std::uint16_t& {
            return l.vertex[(slot / lane_count * l.sub_vertices + v) * lane_count + slot % lane_count];
        };
        for (std::size_t k = 0; k < 3; ++k) at(k) = t.corners[root][k];
        for (unsigned u = 1; u < 1u << l.sub_depth; ++u) at(t.split_vertex[u]) = t.split_vertex[tile_cell(root, u)];
    }
    list_inside(l, t);
    return l;
}

const LaneLayout& lane_layout(int depth) {
    static const auto all = [] {
        std::array<LaneLayout, tile_levels + 1> made;
        for (int d = 1; d <= tile_levels; ++d) made[static_cast<std::size_t>(d)] = make_lanes(d);
        return made;
    }();
    return all[static_cast<std::size_t>(depth)];
}

// The vertices of a group of lanes.
struct LaneVertex {
    Lanes normal[3], point[3];
};
constexpr std::size_t most_sub_vertices = 45;
constexpr unsigned most_sub_cells = 64;

void gather(const TileLattice& lattice, const std::uint16_t* vertex, std::size_t count, LaneVertex* out) {
    for (std::size_t v = 0; v < count; ++v, vertex += lane_count)
        for (int axis = 0; axis < 3; ++axis) {
            const double *n = lattice.normals(axis), *p = lattice.positions(axis);
            out[v].normal[axis] = gather_lanes([&](std::size_t w) { return n[vertex[w]]; });
            out[v].point[axis] = gather_lanes([&](std::size_t w) { return p[vertex[w]]; });
        }
}

void plane_through(const Lanes* a, const Lanes* b, const Lanes* c, LanePlane& plane) {
    Lanes u[3], v[3];
    for (int k = 0; k < 3; ++k) {
        plane.corner[k] = a[k];
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    plane.normal[0] = u[1] * v[2] - v[1] * u[2];
    plane.normal[1] = u[2] * v[0] - v[2] * u[0];
    plane.normal[2] = u[0] * v[1] - v[0] * u[1];
}

inline NarrowLanes next_up(NarrowLanes v) {
    return reinterpret_cast<NarrowLanes>(reinterpret_cast<WholeNarrowLanes>(v) + 1);
}

// Numbers of the cells of one group of lanes, by sub cell.
using SubCells = std::array<NarrowLanes, most_sub_cells>;

void scatter(const LaneLayout& l, std::size_t group, int first_level, const SubCells& from, float* out) {
    for (std::size_t w = 0; w < lane_count && group * lane_count + w < l.lanes; ++w)
        for (int level = first_level; level < l.sub_depth; ++level) {
            const unsigned first = 1u << level;
            float* const to = out + tile_cell(static_cast<unsigned>(l.lanes + group * lane_count + w), first);
            for (unsigned u = 0; u < first; ++u) to[u] = from[first + u][w];
        }
}

// The cells below the lanes' roots: one a lane, each against its own vertices.
void deviation_below_lanes(const LaneLayout& l, const LaneVertex* vertex, SubCells& deviation) {
    const TileLayout& layout = tile_layout();
    for (unsigned u = 1; u < 1u << l.sub_depth; ++u) {
        const auto& corner = layout.corners[u];
        LanePlane plane;
        plane_through(vertex[corner[0]].point, vertex[corner[1]].point, vertex[corner[2]].point, plane);
        Lanes worst{};
        for (std::size_t k = l.first[u]; k < l.first[u + 1]; ++k) {
            const LaneVertex& v = vertex[l.inside[k]];
            // NaN, where a vertex does not exist, leaves the largest so far as it is.
            worst = larger(absolute(plane.over(v.point) / plane.under(v.normal)), worst);
        }
        deviation[u] = next_up(__builtin_convertvector(worst + deviation_rounding_m, NarrowLanes));
    }
}

// The cells above the lanes' roots: every lane tests its vertices against the cell that holds it.
void deviation_above_lanes(const LaneLayout& l, std::size_t group, const LaneVertex* vertex, const CellPlane* planes,
                           double* worst_of_cell) {
    for (int level = 0; level < l.lane_level; ++level) {
        unsigned cell[lane_count];
        for (std::size_t w = 0; w < lane_count; ++w)
            cell[w] = static_cast<unsigned>(l.lanes + std::min(group * lane_count + w, l.lanes - 1)) >>
                      (l.lane_level - level);
        LanePlane plane;
        for (int axis = 0; axis < 3; ++axis) {
            plane.corner[axis] = gather_lanes([&](std::size_t w) { return planes[cell[w]].corner[axis]; });
            plane.normal[axis] = gather_lanes([&](std::size_t w) { return planes[cell[w]].normal[axis]; });
        }
        Lanes worst{};
        for (std::size_t v = 0; v < l.sub_vertices; ++v)
            worst = larger(absolute(plane.over(vertex[v].point) / plane.under(vertex[v].normal)), worst);
        for (std::size_t w = 0; w < lane_count; ++w)
            worst_of_cell[cell[w]] = std::max(worst_of_cell[cell[w]], worst[w]);
    }
}

// Of the last level's cells: corner_distance(), rounded up.
void radius_of_last_cells(const LaneLayout& l, const LaneVertex* vertex, SubCells& radius) {
    const TileLayout& layout = tile_layout();
    for (unsigned u = 1u << (l.sub_depth - 1); u < 1u << l.sub_depth; ++u) {
        Lanes m[3], square{};
        for (int axis = 0; axis < 3; ++axis)
            m[axis] = __builtin_convertvector(
                __builtin_convertvector(vertex[layout.split_vertex[u]].point[axis], NarrowLanes), Lanes);
        for (const std::uint16_t corner : layout.corners[u]) {
            const Lanes* p = vertex[corner].point;
            const Lanes x = p[0] - m[0], y = p[1] - m[1], z = p[2] - m[2];
            square = larger(x * x + y * y + z * z, square);
        }
        radius[u] = next_up(__builtin_convertvector(square_root(square) * (1 + 0x1p-20), NarrowLanes));
    }
}

// Own deviations; and radii of the last level's cells where there is room for them.
void measure_cells(const TileLattice& lattice, std::span<float> deviation, float* radius) {
    const LaneLayout& l = lane_layout(lattice.depth());
    const TileLayout& layout = tile_layout();
    assert(deviation.size() == std::size_t{1} << lattice.depth() && l.sub_vertices <= most_sub_vertices);
    deviation[0] = 0;
    std::array<CellPlane, most_sub_cells> planes;
    for (std::size_t i = 1; i < l.lanes; ++i) {
        const auto& c = layout.corners[i];
        planes[i] = {lattice.position(c[0]), lattice.position(c[1]), lattice.position(c[2])};
    }
    std::array<double, most_sub_cells> worst{};
    std::array<LaneVertex, most_sub_vertices> vertex;
    SubCells cells;
    for (std::size_t group = 0; group < l.groups; ++group) {
        gather(lattice, &l.vertex[group * l.sub_vertices * lane_count], l.sub_vertices, vertex.data());
        deviation_below_lanes(l, vertex.data(), cells);
        scatter(l, group, 0, cells, deviation.data());
        deviation_above_lanes(l, group, vertex.data(), planes.data(), worst.data());
        if (radius == nullptr) continue;
        radius_of_last_cells(l, vertex.data(), cells);
        scatter(l, group, l.sub_depth - 1, cells, radius);
    }
    for (std::size_t i = 1; i < l.lanes; ++i) deviation[i] = certified_deviation(worst[i]);
}

}  // namespace

void own_deviation(const TileLattice& lattice, std::span<float> deviation) {
    measure_cells(lattice, deviation, nullptr);
}

void measure_leaf(const TileLattice& lattice, std::span<const std::uint8_t> exists, std::span<float> deviation,
                  std::span<float> radius) {
    const unsigned last = 1u << (lattice.depth() - 1);
    measure_cells(lattice, deviation, radius.data());
    std::fill_n(radius.begin(), last, 0.0f);
    if (std::memchr(exists.data() + 1, 0, exists.size() - 1) == nullptr) return;
    for (unsigned i = 1; i < last; ++i)
        if (exists[i] && !(exists[2 * i] & exists[2 * i + 1]))
            radius[i] = certified_radius(corner_distance(lattice, i));
    for (unsigned i = last; i < 2 * last; ++i) radius[i] = exists[i] ? radius[i] : 0.0f;
}

}  // namespace planet
