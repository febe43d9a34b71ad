#include "planet/mesh/smooth_ellipsoid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "planet/octahedron/cell_metrics.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// --- bounds -------------------------------------------------------------------------------------------------------

/// How far the unit sphere rises over the plane of a triangle of sides up to `side`: 1 - cos of the angle that its
/// circle (radius at most side / sqrt 3) or, if it is obtuse, half its longest side subtends.
double rise(double side) {
    return 1 - std::sqrt(std::max(0.0, 1 - side * side / 3));
}

/// The longest side of cells of a level as an arc on the sphere of normals, times the largest radius of curvature,
/// a^2/b at the poles: no two points of the ellipsoid with normals that near are farther apart.
double longest_side(const Ellipsoid& e, int level) {
    return 2 * std::asin(std::min(1.0, 0.5 * cell_metrics(level).side_max)) * (e.a * e.a / e.b);
}

// --- blocks: all cells a few levels below one, made at once ---------------------------------------------------------

//  In a block of equal level vertices and strip are always the same, but for the state at its entry. Vertices: 0 left,
//  1 right, 2 apex, 3 the split vertex, then those of the levels below in the order in which they come up.

constexpr int block_levels = 4;
constexpr unsigned block_leaves = 1u << block_levels;
constexpr unsigned block_vertices = 15;

struct BlockLayout {
    std::array<std::array<std::uint8_t, 3>, 2 * block_leaves> corners{};  // by local index: left, right, apex
    std::array<std::array<std::uint8_t, 2>, block_vertices> ends{};       // whose midpoint a vertex is
};

constexpr BlockLayout make_block_layout() {
    BlockLayout b;
    unsigned vertices = 3;
    b.corners[1] = {0, 1, 2};
    for (unsigned i = 1; i < block_leaves; ++i) {
        const auto [l, r, a] = b.corners[i];
        std::uint8_t m = 0;
        for (unsigned k = 3; k < vertices; ++k)
            if ((b.ends[k][0] == l && b.ends[k][1] == r) || (b.ends[k][0] == r && b.ends[k][1] == l))
                m = static_cast<std::uint8_t>(k);
        if (m == 0) {
            m = static_cast<std::uint8_t>(vertices++);
            b.ends[m] = {l, r};
        }
        b.corners[2 * i] = {l, a, m};
        b.corners[2 * i + 1] = {a, r, m};
    }
    return b;
}
constexpr BlockLayout block_layout = make_block_layout();

/// The strip of a block by the state of its root.
struct BlockStrip {
    std::array<StripStep, block_leaves> steps{};
    std::array<std::uint8_t, block_leaves> fresh{};  // the vertices that are new, in order
    unsigned fresh_count = 0;
};

constexpr std::array<BlockStrip, StripState::count> make_block_strips() {
    std::array<BlockStrip, StripState::count> strips{};
    for (unsigned root = 0; root < StripState::count; ++root)
        for (unsigned leaf = 0; leaf < block_leaves; ++leaf) {
            unsigned state = root;
            for (int i = block_levels - 1; i >= 0; --i) state = strip_child_states[state][leaf >> i & 1];
            BlockStrip& b = strips[root];
            const StripStep step = strip_steps[state];
            b.steps[leaf] = step;
            if (!step.pop) b.fresh[b.fresh_count++] = block_layout.corners[block_leaves + leaf][step.corner];
        }
    return strips;
}
constexpr auto block_strips = make_block_strips();

// --- the walk -------------------------------------------------------------------------------------------------------

/// Squared distances from the eye, by level of a cell.
struct Limits {
    double split = -1;             // split iff nearer
    double block_near = infinity;  // a block if no corner and not the split vertex is nearer,
    double block_far = -1;         // and all are nearer than this
};

double signed_square(double v) {
    return v <= 0 ? -1 : v * v;
}

std::vector<Limits> limits_of(const Ellipsoid& e, std::span<const LevelBounds> bounds, double K) {
    const std::size_t levels = bounds.size();
    // Reach 0 stands for "never": also for all levels below the table.
    std::vector<double> reach(levels + block_levels + 1, 0.0);
    for (std::size_t i = 0; i < levels; ++i)
        if (bounds[i].deviation > 0) reach[i] = bounds[i].radius + K * bounds[i].deviation;
    std::vector<Limits> limits(levels + 1);
    for (std::size_t i = 0; i < levels; ++i) {
        const int level = static_cast<int>(i);
        limits[i].split = signed_square(reach[i]);
        // A point of the cell lies within `bulge` of the plane triangle; a point of that lies no farther than a corner,
        // and within longest side / sqrt 3 of a vertex of the half it is in.
        const double side = cell_metrics(level).side_max * e.a / e.b;
        const double bulge = side * side < 3 ? e.a * rise(side) + 1e-6 : infinity;
        const double cover = longest_side(e, level + 1) * 0.57736 + bulge;
        const double after = reach[i + block_levels];
        limits[i].block_far = signed_square(reach[i + block_levels - 1] - bulge);
        limits[i].block_near = after > 0 ? (after + cover) * (after + cover) : -1;
    }
    return limits;
}

/// A split vertex: its normal, and the squared distance of its place from the eye.
struct Vertex {
    double x, y, z, distance2;
};

/// N midpoints at once: lane k is that of a[k] and b[k]. split_vertex() to the bit.
template <int N>
struct Lanes {
    double x[N], y[N], z[N];

    void midpoints(const Lanes& a, const Lanes& b) {
        for (int k = 0; k < N; ++k) {
            const double sx = a.x[k] + b.x[k], sy = a.y[k] + b.y[k], sz = a.z[k] + b.z[k];
            const double length = std::sqrt(sx * sx + sy * sy + sz * sz);
            x[k] = sx / length;
            y[k] = sy / length;
            z[k] = sz / length;
        }
    }
};

class EllipsoidWalk {
  public:
    EllipsoidWalk(const Ellipsoid& e, std::span<const Limits> limits, const glm::dvec3& eye,
                  GrowingArray<GridPosition>& vertices, StripWriter& strip)
        : a2_(e.a * e.a), b2_(e.b * e.b), limits_(limits), eye_(eye), vertices_(vertices), strip_(strip) {}

    void planet() {
        for (int rank = 0; rank < face_count; ++rank) {
            const int face = face_at_loop_rank(rank);
            const Corners c = face_corners(face);
            const Vertex l = place(c.left), r = place(c.right), a = place(c.apex), m = place(split_vertex(c));
            if (rank == 0) begin(c);
            cell(l, r, a, m, 0, strip_state_of_face(face));
        }
        flush();
    }

  private:
    static constexpr unsigned batch = 1024;  // leaves

    Vertex place(const glm::dvec3& n) const { return {n.x, n.y, n.z, distance2(n.x, n.y, n.z)}; }

    /// Of the foot (ellipsoid.h) from the eye.
    double distance2(double x, double y, double z) const {
        const double w = std::sqrt(a2_ * (x * x + y * y) + b2_ * (z * z));
        const double equatorial = a2_ / w, polar = b2_ / w;
        const double dx = eye_.x - equatorial * x, dy = eye_.y - equatorial * y, dz = eye_.z - polar * z;
        return dx * dx + dy * dy + dz * dz;
    }

    /// Starts the strip with the gate of the first leaf.
    void begin(Corners c) {
        unsigned state = strip_state_of_face(0), level = 0;
        for (glm::dvec3 m = split_vertex(c); place(m).distance2 < limits_[level].split; m = split_vertex(c), ++level) {
            c = child_corners(c, m, 0);
            state = strip_child_states[state][0];
        }
        const glm::dvec3* corners[] = {&c.left, &c.right, &c.apex};
        room();
        for (const auto i : strip_first_gate(state)) append(corners[i]->x, corners[i]->y, corners[i]->z, 1);
        strip_.begin(0, 1);
        next_ = 2;
    }

    void cell(const Vertex& l, const Vertex& r, const Vertex& a, const Vertex& m, unsigned level, unsigned state) {
        const Limits& limits = limits_[level];
        if (!(m.distance2 < limits.split)) {
            leaf(r, a, state);
            return;
        }
        const double far = std::max(std::max(l.distance2, r.distance2), std::max(a.distance2, m.distance2));
        const double near = std::min(std::min(l.distance2, r.distance2), std::min(a.distance2, m.distance2));
        if (far < limits.block_far && near >= limits.block_near)
            block(l, r, a, m, state);
        else
            halves(l, r, a, m, level, state);
    }

    void halves(const Vertex& l, const Vertex& r, const Vertex& a, const Vertex& m, unsigned level, unsigned state) {
        const Lanes<2> ends{{l.x, r.x}, {l.y, r.y}, {l.z, r.z}}, apex{{a.x, a.x}, {a.y, a.y}, {a.z, a.z}};
        Lanes<2> mid;
        mid.midpoints(ends, apex);
        double d[2];
        for (int k = 0; k < 2; ++k) d[k] = distance2(mid.x[k], mid.y[k], mid.z[k]);
        const Vertex m0{mid.x[0], mid.y[0], mid.z[0], d[0]}, m1{mid.x[1], mid.y[1], mid.z[1], d[1]};
        cell(l, a, m, m0, level + 1, strip_child_states[state][0]);
        cell(a, r, m, m1, level + 1, strip_child_states[state][1]);
    }

    void leaf(const Vertex& r, const Vertex& a, unsigned state) {
        const StripStep step = strip_steps[state];
        const Vertex& v = step.corner == 1 ? r : a;
        append(v.x, v.y, v.z, !step.pop);
        next_ = strip_.run(&step, 1, next_);
        count(1);
    }

    /// The midpoints first .. last of a block, N lanes wide: lanes beyond the last repeat it.
    template <int N, unsigned first, unsigned last>
    static void block_midpoints(Lanes<20>& v) {
        Lanes<N> a, b, m;
        for (unsigned k = 0; k < N; ++k) {
            const auto [i, j] = block_layout.ends[std::min(first + k, last)];
            a.x[k] = v.x[i], a.y[k] = v.y[i], a.z[k] = v.z[i];
            b.x[k] = v.x[j], b.y[k] = v.y[j], b.z[k] = v.z[j];
        }
        m.midpoints(a, b);
        for (unsigned k = 0; k < N; ++k) v.x[first + k] = m.x[k], v.y[first + k] = m.y[k], v.z[first + k] = m.z[k];
    }

    void block(const Vertex& l, const Vertex& r, const Vertex& a, const Vertex& m, unsigned state) {
        Lanes<20> v;
        const Vertex* given[] = {&l, &r, &a, &m};
        for (unsigned k = 0; k < 4; ++k) v.x[k] = given[k]->x, v.y[k] = given[k]->y, v.z[k] = given[k]->z;
        block_midpoints<2, 4, 5>(v);
        block_midpoints<4, 6, 8>(v);
        block_midpoints<8, 9, 14>(v);
        const BlockStrip& strip = block_strips[state];
        for (unsigned k = 0; k < block_leaves; ++k) {
            const unsigned i = strip.fresh[k];
            x_[pending_ + k] = v.x[i], y_[pending_ + k] = v.y[i], z_[pending_ + k] = v.z[i];
        }
        pending_ += strip.fresh_count;
        next_ = strip_.run(strip.steps.data(), block_leaves, next_);
        count(block_leaves);
    }

    void append(double x, double y, double z, unsigned kept) {
        x_[pending_] = x, y_[pending_] = y, z_[pending_] = z;
        pending_ += kept;
    }

    // A leaf adds at most one vertex, and between two flushes there are batch leaves and at most a block's more.
    void room() {
        vertices_.reserve_more(batch + block_leaves + 2);
        strip_.reserve(batch + block_leaves);
    }

    void count(unsigned leaves) {
        leaves_ += leaves;
        if (leaves_ >= batch) flush();
    }

    // Places the new vertices on the ellipsoid and the grid: ecef_from_normal and grid_from_ecef to the bit. Adding
    // 1.5 * 2^52 leaves a number below 2^51, rounded to nearest, in the low bits: vector units without a conversion to
    // 64-bit integers can do it.
    void flush() {
        constexpr double shift = 6755399441055744.0;
        const auto bits = [&](double v) {
            return std::bit_cast<std::uint64_t>(v * 262144.0 + shift) - std::bit_cast<std::uint64_t>(shift);
        };
        GridPosition* out = vertices_.end();
        for (unsigned i = 0; i < pending_; ++i) {
            const double nx = x_[i], ny = y_[i], nz = z_[i];
            const double w = std::sqrt(a2_ * (nx * nx + ny * ny) + b2_ * (nz * nz));
            const double equatorial = a2_ / w;
            const std::uint64_t x = bits(equatorial * nx), y = bits(equatorial * ny), z = bits(b2_ / w * nz);
            out[i] = {static_cast<std::uint32_t>(x >> 10), static_cast<std::uint32_t>(y >> 10),
                      static_cast<std::uint32_t>(z >> 10),
                      static_cast<std::uint32_t>((x & 1023) | (y & 1023) << 10 | (z & 1023) << 20)};
        }
        vertices_.set_end(out + pending_);
        pending_ = leaves_ = 0;
        room();
    }

    double a2_, b2_;
    std::span<const Limits> limits_;
    glm::dvec3 eye_;
    GrowingArray<GridPosition>& vertices_;
    StripWriter& strip_;
    std::uint32_t next_ = 0;
    unsigned pending_ = 0, leaves_ = 0;
    // Normals of new vertices that have no place yet.
    alignas(64) double x_[batch + 2 * block_leaves], y_[batch + 2 * block_leaves], z_[batch + 2 * block_leaves];
};

}  // namespace

std::vector<LevelBounds> smooth_bounds(const Ellipsoid& e, int finest_level, double roughness) {
    assert(finest_level >= 0 && finest_level <= max_bisection_level && roughness >= 0);
    std::vector<LevelBounds> bounds(static_cast<std::size_t>(finest_level));
    // The ellipsoid is a sphere stretched along axes: directions become steeper, and lengths change, by up to a / b.
    const double stretch = e.a / e.b;
    LevelBounds below;
    for (int level = finest_level - 1; level >= 0; --level) {
        const double side = cell_metrics(level).side_max;
        const double deviation = e.a * stretch * rise(side * stretch) + roughness * side * e.a;
        // From a diamond's split vertex to that of a child diamond is a median of a cell of the level between: no
        // longer than the longer side beside it.
        below = {std::max(deviation, below.deviation), below.radius + longest_side(e, level + 1)};
        bounds[static_cast<std::size_t>(level)] = below;
    }
    return bounds;
}

void SmoothEllipsoid::refine(std::span<const LevelBounds> bounds, const glm::dvec3& eye, double K) {
    vertices_.clear();
    strip_.clear();
    EllipsoidWalk(ellipsoid_, limits_of(ellipsoid_, bounds, K), eye, vertices_, strip_).planet();
}

void SmoothEllipsoid::refine_to_level(int bisection_level) {
    assert(bisection_level >= 0 && bisection_level <= 26);
    const std::vector<LevelBounds> all(static_cast<std::size_t>(bisection_level), {1, infinity});
    refine(all, glm::dvec3(0), 0);
}

}  // namespace planet
