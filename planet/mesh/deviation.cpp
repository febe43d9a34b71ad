#include "planet/mesh/deviation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

namespace planet {

namespace {

constexpr std::size_t width = 8;
// Eight doubles at a time; the compiler splits them where registers are narrower. Same bits either way.
typedef double Lanes __attribute__((vector_size(width * sizeof(double))));

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct LanePlane {
    Lanes corner[3], normal[3];
};

// acc = max(acc, |t|) lane by lane. NaN (a vertex that does not exist) compares false and leaves acc as it is.
inline void widen(Lanes& acc, const LanePlane& plane, const Lanes* normal, const Lanes* point) {
    const Lanes num = (plane.corner[0] - point[0]) * plane.normal[0] + (plane.corner[1] - point[1]) * plane.normal[1] +
                      (plane.corner[2] - point[2]) * plane.normal[2];
    const Lanes den = normal[0] * plane.normal[0] + normal[1] * plane.normal[1] + normal[2] * plane.normal[2];
    const Lanes t = num / den;
    acc = t > acc ? t : acc;
    acc = -t > acc ? -t : acc;
}

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
    l.groups = (l.lanes + width - 1) / width;
    l.sub_vertices = t.vertex_count[static_cast<std::size_t>(l.sub_depth)];
    l.vertex.resize(l.groups * l.sub_vertices * width);
    for (std::size_t slot = 0; slot < l.groups * width; ++slot) {
        const auto root = static_cast<unsigned>(l.lanes + std::min(slot, l.lanes - 1));
        const auto at = [&](std::size_t v) -> std::uint16_t& {
            return l.vertex[(slot / width * l.sub_vertices + v) * width + slot % width];
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

// The vertices of eight lanes, and the largest |t| found for the cells being tested.
struct LaneVertex {
    Lanes normal[3], point[3];
};

void gather(const TileLattice& lattice, const std::uint16_t* vertex, std::size_t count, LaneVertex* out) {
    for (std::size_t v = 0; v < count; ++v, vertex += width)
        for (int axis = 0; axis < 3; ++axis) {
            const double *n = lattice.normals(axis), *p = lattice.positions(axis);
            for (std::size_t w = 0; w < width; ++w) {
                out[v].normal[axis][w] = n[vertex[w]];
                out[v].point[axis][w] = p[vertex[w]];
            }
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

// The cells below the lanes' roots: eight at a time, each against its own vertices.
void deviation_below_lanes(const LaneLayout& l, std::size_t group, const LaneVertex* vertex, std::span<float> out) {
    const TileLayout& t = tile_layout();
    for (unsigned u = 1; u < 1u << l.sub_depth; ++u) {
        const auto& corner = t.corners[u];
        LanePlane plane{};
        plane_through(vertex[corner[0]].point, vertex[corner[1]].point, vertex[corner[2]].point, plane);
        Lanes worst{};
        for (std::size_t k = l.first[u]; k < l.first[u + 1]; ++k)
            widen(worst, plane, vertex[l.inside[k]].normal, vertex[l.inside[k]].point);
        for (std::size_t w = 0; w < width && group * width + w < l.lanes; ++w)
            out[tile_cell(static_cast<unsigned>(l.lanes + group * width + w), u)] = certified_deviation(worst[w]);
    }
}

// The cells above the lanes' roots: every lane tests its vertices against the cell that holds it.
void deviation_above_lanes(const LaneLayout& l, std::size_t group, const LaneVertex* vertex, const CellPlane* planes,
                           double* worst_of_cell) {
    for (int level = 0; level < l.lane_level; ++level) {
        LanePlane plane{};
        unsigned cell[width];
        for (std::size_t w = 0; w < width; ++w) {
            const std::size_t lane = std::min(group * width + w, l.lanes - 1);
            cell[w] = static_cast<unsigned>(l.lanes + lane) >> (l.lane_level - level);
            for (int axis = 0; axis < 3; ++axis) {
                plane.corner[axis][w] = planes[cell[w]].corner[axis];
                plane.normal[axis][w] = planes[cell[w]].normal[axis];
            }
        }
        Lanes worst{};
        for (std::size_t v = 0; v < l.sub_vertices; ++v) widen(worst, plane, vertex[v].normal, vertex[v].point);
        for (std::size_t w = 0; w < width; ++w) worst_of_cell[cell[w]] = std::max(worst_of_cell[cell[w]], worst[w]);
    }
}

}  // namespace

void TileLattice::set_normals(const Corners& root, int depth) {
    assert(depth >= 1 && depth <= tile_levels);
    const TileLayout& layout = tile_layout();
    depth_ = depth;
    size_ = layout.vertex_count[static_cast<std::size_t>(depth)];
    const std::size_t padded = (size_ + width - 1) / width * width;
    for (int axis = 0; axis < 3; ++axis) {
        n_[axis].assign(padded, nan);
        p_[axis].assign(padded, nan);
        n_[axis][0] = root.left[axis];
        n_[axis][1] = root.right[axis];
        n_[axis][2] = root.apex[axis];
    }
    double *x = n_[0].data(), *y = n_[1].data(), *z = n_[2].data();
    for (int level = 0; level < depth; ++level) {
        // The vertices of one level depend on earlier levels only. Bits as split_vertex().
        const std::size_t begin = layout.vertex_count[static_cast<std::size_t>(level)],
                          end = layout.vertex_count[static_cast<std::size_t>(level) + 1];
#pragma GCC ivdep
        for (std::size_t v = begin; v < end; ++v) {
            const std::size_t a = layout.ends[v][0], b = layout.ends[v][1];
            const double sx = x[a] + x[b], sy = y[a] + y[b], sz = z[a] + z[b];
            const double length = std::sqrt(sx * sx + sy * sy + sz * sz);
            x[v] = sx / length;
            y[v] = sy / length;
            z[v] = sz / length;
        }
    }
}

void TileLattice::set_positions(const Placement& placement, std::span<const float> height,
                                std::span<const GeoidUndulation> undulation, std::span<const std::uint8_t> exists) {
    assert(height.size() == size_);
    double *x = p_[0].data(), *y = p_[1].data(), *z = p_[2].data();
    rounded_.resize(size_);
    for (std::size_t v = 0; v < size_; ++v) {
        const GeoidUndulation N = undulation.empty() ? GeoidUndulation{} : undulation[v];
        const glm::dvec3 p = placement.ecef(normal(v), static_cast<double>(height[v]), N);
        x[v] = p.x;
        y[v] = p.y;
        z[v] = p.z;
        rounded_[v] = glm::vec3(p);
    }
    const TileLayout& layout = tile_layout();
    for (std::size_t i = 1; i < exists.size(); ++i)
        if (!exists[i]) x[layout.split_vertex[i]] = y[layout.split_vertex[i]] = z[layout.split_vertex[i]] = nan;
}

void own_deviation(const TileLattice& lattice, std::span<float> deviation) {
    const LaneLayout& l = lane_layout(lattice.depth());
    const TileLayout& t = tile_layout();
    assert(deviation.size() == std::size_t{1} << lattice.depth());
    deviation[0] = 0;
    std::vector<CellPlane> planes;
    planes.reserve(l.lanes);
    const auto at = [&](std::uint16_t v) { return lattice.position(v); };
    for (std::size_t i = 0; i < l.lanes; ++i) {
        const auto& c = t.corners[std::max<std::size_t>(i, 1)];
        planes.emplace_back(at(c[0]), at(c[1]), at(c[2]));
    }
    std::vector<double> worst(l.lanes, 0.0);
    std::array<LaneVertex, 45> vertex;
    assert(l.sub_vertices <= vertex.size());
    for (std::size_t group = 0; group < l.groups; ++group) {
        gather(lattice, &l.vertex[group * l.sub_vertices * width], l.sub_vertices, vertex.data());
        deviation_below_lanes(l, group, vertex.data(), deviation);
        deviation_above_lanes(l, group, vertex.data(), planes.data(), worst.data());
    }
    for (std::size_t i = 1; i < l.lanes; ++i) deviation[i] = certified_deviation(worst[i]);
}

double deviation_from(const TileLattice& lattice, const CellPlane& plane) {
    LanePlane wide{};
    for (int axis = 0; axis < 3; ++axis) {
        wide.corner[axis] = Lanes{} + plane.corner[axis];
        wide.normal[axis] = Lanes{} + plane.normal[axis];
    }
    Lanes worst{};
    for (std::size_t v = 0; v < lattice.size(); v += width) {
        LaneVertex lane;
        for (int axis = 0; axis < 3; ++axis) {
            std::memcpy(&lane.normal[axis], lattice.normals(axis) + v, sizeof(Lanes));
            std::memcpy(&lane.point[axis], lattice.positions(axis) + v, sizeof(Lanes));
        }
        if (v == 0)  // the root's corners
            for (std::size_t w = 0; w < 3; ++w) lane.point[0][w] = nan;
        widen(worst, wide, lane.normal, lane.point);
    }
    double most = 0;
    for (std::size_t w = 0; w < width; ++w) most = std::max(most, worst[w]);
    return most;
}

double corner_distance(const TileLattice& lattice, unsigned i) {
    const TileLayout& layout = tile_layout();
    const glm::dvec3 m(lattice.rounded()[layout.split_vertex[i]]);
    double square = 0;
    for (const std::uint16_t corner : layout.corners[i]) {
        const glm::dvec3 d = lattice.position(corner) - m;
        square = std::max(square, d.x * d.x + d.y * d.y + d.z * d.z);
    }
    return std::sqrt(square);
}

}  // namespace planet
