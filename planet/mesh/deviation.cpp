#include "planet/mesh/deviation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "planet/mesh/lane_plane.h"

namespace planet {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t padding = 8;
constexpr double rounding_m = 1e-7;  // more than that of any coordinate or distance here, on planets up to 10,000 km

}  // namespace

void TileLattice::set_normals(const Corners& root, int depth) {
    assert(depth >= 1 && depth <= tile_levels);
    const TileLayout& layout = tile_layout();
    depth_ = depth;
    size_ = layout.vertex_count[static_cast<std::size_t>(depth)];
    const std::size_t padded = (size_ + padding - 1) / padding * padding;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::vector<double>* of : {&n_[axis], &p_[axis]}) {
            of->resize(padded);
            std::fill(of->begin() + static_cast<std::ptrdiff_t>(size_), of->end(), nan);
        }
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
    rounded_.resize(size_);
    // Placement::ecef, in loops without a branch.
    const double exaggeration = placement.exaggeration;
    const Ellipsoid& e = placement.ellipsoid;
    const auto place = [&](auto undulation_at) {
        const double *nx = n_[0].data(), *ny = n_[1].data(), *nz = n_[2].data();
        double *x = p_[0].data(), *y = p_[1].data(), *z = p_[2].data();
        const float* h = height.data();
#pragma GCC ivdep
        for (std::size_t v = 0; v < size_; ++v) {
            const glm::dvec3 p = ecef_from_normal(e, {nx[v], ny[v], nz[v]},
                                                  {static_cast<double>(h[v]) * exaggeration + undulation_at(v)});
            x[v] = p.x;
            y[v] = p.y;
            z[v] = p.z;
        }
    };
    if (undulation.empty())
        place([](std::size_t) { return 0.0; });
    else
        place([N = undulation.data()](std::size_t v) { return N[v].m; });
    double *x = p_[0].data(), *y = p_[1].data(), *z = p_[2].data();
    for (std::size_t v = 0; v < size_; ++v) rounded_[v] = glm::vec3(glm::dvec3(x[v], y[v], z[v]));
    const TileLayout& layout = tile_layout();
    for (std::size_t i = 1; i < exists.size(); ++i)
        if (!exists[i]) x[layout.split_vertex[i]] = y[layout.split_vertex[i]] = z[layout.split_vertex[i]] = nan;
}

double deviation_from(const TileLattice& lattice, const CellPlane& plane) {
    LanePlane wide;
    for (int axis = 0; axis < 3; ++axis) {
        wide.corner[axis] = Lanes{} + plane.corner[axis];
        wide.normal[axis] = Lanes{} + plane.normal[axis];
    }
    Lanes worst{};
    for (std::size_t v = 0; v < lattice.size(); v += lane_count) {
        Lanes normal[3], point[3];
        for (int axis = 0; axis < 3; ++axis) {
            normal[axis] = load_lanes(lattice.normals(axis) + v);
            point[axis] = load_lanes(lattice.positions(axis) + v);
        }
        Lanes t = absolute(wide.over(point) / wide.under(normal));
        for (std::size_t w = 0; w < lane_count && v + w < 3; ++w) t[w] = 0;  // the root's corners
        worst = larger(t, worst);
    }
    double most = 0;
    for (std::size_t w = 0; w < lane_count; ++w) most = std::max(most, worst[w]);
    return most;
}

TileHull::TileHull(const TileLattice& lattice) {
    for (std::size_t k = 0; k < 3; ++k) {
        corner_[k] = lattice.position(k);
        normal_[k] = lattice.normal(k);
    }
    const glm::dvec3 right = corner_[1] - corner_[0], apex = corner_[2] - corner_[0], up = glm::cross(right, apex);
    const double square = glm::dot(up, up);
    up_ = up / std::sqrt(square);
    // Barycentric coordinates are linear: those of the right corner and the apex, and one less both.
    const glm::dvec3 by_right = glm::cross(apex, up) / square, by_apex = glm::cross(up, right) / square;
    Lanes off{}, outside{};
    for (std::size_t v = 0; v < lattice.size(); v += lane_count) {
        const Lanes x = load_lanes(lattice.positions(0) + v) - corner_[0].x,
                    y = load_lanes(lattice.positions(1) + v) - corner_[0].y,
                    z = load_lanes(lattice.positions(2) + v) - corner_[0].z;
        const Lanes r = x * by_right.x + y * by_right.y + z * by_right.z,
                    a = x * by_apex.x + y * by_apex.y + z * by_apex.z;
        off = larger(absolute(x * up_.x + y * up_.y + z * up_.z), off);
        outside = larger(r + a - 1, larger(-r, larger(-a, outside)));
    }
    for (std::size_t w = 0; w < lane_count; ++w) {
        off_plane_ = std::max(off_plane_, off[w]);
        outside_ = std::max(outside_, outside[w]);
    }
    off_plane_ += rounding_m;
    outside_ += rounding_m / std::sqrt(std::sqrt(square));
}

// A vertex is P = sum of l_k A_k + d up, with l_k >= -o and of sum 1: so l_k = (1 + 3 o) m_k - o with m_k >= 0 of sum 1.
// With s_k = (C - A_k) . N then |(C - P) . N| <= (1 + 3 o) max |s_k| + o |sum of s_k| + |d up . N|. Its normal is
// a sum of the corners' with weights >= 0 of sum >= 1, so n . N is at least the least of theirs.
double TileHull::deviation_bound(const CellPlane& plane) const {
    double farthest = 0, sum = 0, least = std::numeric_limits<double>::infinity(), most = -least;
    for (int k = 0; k < 3; ++k) {
        const double s = glm::dot(plane.corner - corner_[k], plane.normal);
        farthest = std::max(farthest, std::abs(s));
        sum += s;
        const double under = glm::dot(normal_[k], plane.normal);
        least = std::min(least, under);
        most = std::max(most, under);
    }
    const double under = least > 0 ? least : -most;
    if (!(under > 0)) return std::numeric_limits<double>::infinity();
    const double over =
        (1 + 3 * outside_) * farthest + outside_ * std::abs(sum) + off_plane_ * std::abs(glm::dot(up_, plane.normal));
    return over / under * (1 + 1e-9) + rounding_m;
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

void corner_radii(const TileLattice& lattice, std::span<const std::uint8_t> exists, bool inner,
                  std::span<const std::uint8_t> lacks_below, std::span<float> radius) {
    const unsigned last = 1u << (lattice.depth() - 1);
    radius[0] = 0;
    for (unsigned i = 1; i < 2 * last; ++i) {
        const bool lacks = i < last ? !(exists[2 * i] && exists[2 * i + 1]) : !inner || lacks_below[i - last];
        radius[i] = exists[i] && lacks ? certified_radius(corner_distance(lattice, i)) : 0.0f;
    }
}

}  // namespace planet
