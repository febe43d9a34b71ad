#include "planet/bake/sample_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "planet/lanes.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

constexpr int steps = 64;            // of the lattice, a side
constexpr double on_side = 1e-15;    // a sample this far outside counts: rounding of its normal
constexpr double least_bend = 1e-9;  // rounding of (u, v)
constexpr double widest_root = 0.1;  // above it nothing is estimated

// Position at relative level 12 of the cell in each quarter of each square of the lattice. Quarters are cut by both
// diagonals: bit 0 is set past the rising one (v > u within the square), bit 1 past the falling one (u + v > 1).
using SquareCells = std::array<std::uint16_t, steps * steps * 4>;

std::size_t quarter_at(double u, double v) {
    const auto i = static_cast<int>(u), j = static_cast<int>(v);
    const double s = u - i, t = v - j;
    return static_cast<std::size_t>((i * steps + j) * 4 + (t > s ? 1 : 0) + (s + t > 1 ? 2 : 0));
}

SquareCells make_square_cells() {
    SquareCells cells{};
    const TileLayout& layout = tile_layout();
    for (unsigned k = 0; k < tile_cells; ++k) {
        const auto& [left, right, apex] = layout.corners[tile_cells + k];
        const auto at = [&](std::uint16_t v) { return glm::dvec2(layout.lattice[v][0], layout.lattice[v][1]); };
        // A cell is two quarters of a square: beside either end of its split side.
        const glm::dvec2 middle = 0.5 * (at(left) + at(right));
        for (const std::uint16_t end : {left, right}) {
            const glm::dvec2 inside = (at(end) + at(apex) + middle) / 3.0;
            cells[quarter_at(inside.x, inside.y)] = static_cast<std::uint16_t>(k);
        }
    }
    return cells;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

double triple(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

}  // namespace

// Samples that are looked at together.
struct SampleDistance::Piece {
    static constexpr std::size_t most = 512;
    std::array<double, most> u, v;
    std::array<double, most> inside;         // of the root's sides
    std::array<double, most> from_side;      // of the nearest cell
    std::array<std::int32_t, most> quarter;  // index into square_cells()
    std::array<std::uint16_t, most> near;    // those that are not elsewhere
    std::array<double, most> off;  // of these, at a guess, metres; infinity: not certain; less than 0: elsewhere
    std::array<std::uint16_t, most> cell;  // of these, the finest; 0: not certain or another tile's
};

void SampleDistance::start(const Placement& placement, const Tile& tile, const TileLattice& lattice,
                           std::span<const std::uint8_t> exists, std::span<const std::uint8_t> covered) {
    placement_ = &placement;
    tile_ = &tile;
    lattice_ = &lattice;
    exists_ = exists;
    covered_ = covered;
    largest_ = 0;
    exact_ = 0;
    has_surface_ = exists[1] != 0;
    whole_ = std::memchr(exists.data() + 1, 0, exists.size() - 1) == nullptr;
    simple_ = whole_ && covered.empty();
    counter_clockwise_ = is_counter_clockwise(tile.root);
    const glm::dvec3 left = lattice.normal(0), right = lattice.normal(1), apex = lattice.normal(2);
    by_apex_ = glm::cross(left, right);
    by_left_ = glm::cross(right, apex);
    by_right_ = glm::cross(apex, left);
    if (!counter_clockwise_)
        for (glm::dvec3* side : {&by_apex_, &by_left_, &by_right_}) *side = -*side;
    if (!has_surface_) return;
    find_slack();
    find_finest();
}

// By (u, v) a sample's cell is certain unless it lies within bend_ of a side. With H the relief of the tile, the height
// of the surface in a cell is linear in (u, v) but for: the sag of a cell with sides up to s, below s^2 / 6 R; normals
// at heights that differ by H part by H / R, which moves a place by H s / R and so, in a cell three times as long as
// it is wide, a height by 3 H^2 / R; corners are bend_ away from where they should be, which moves it by bend_ H at
// each; and split vertices are lengthened to 1, which weighs them by up to root^2 / 8 more. All is taken more than once.
void SampleDistance::find_slack() {
    // Every two levels sides halve, but a root's apex may be farther from its split side than that is long: then the
    // split sides below are twice that way long.
    const glm::dvec3 left = lattice_->normal(0), right = lattice_->normal(1), apex = lattice_->normal(2);
    const double root = std::max({glm::distance(left, right), glm::distance(left, apex), glm::distance(right, apex),
                                  2 * glm::distance(apex, 0.5 * (left + right))});
    if (root > widest_root) {
        slack_ = bend_ = infinity;
        return;
    }
    bend_ = largest_bend() + least_bend;
    const auto [low, high] = least_and_most(tile_->height);
    const double relief = static_cast<double>(high) - static_cast<double>(low);
    const double radius = placement_->ellipsoid.b;
    const double side = 1.1 * root * (whole_ ? std::ldexp(1.0, -(tile_->depth / 2)) : 1.0) * radius;  // the longest
    slack_ = side * side / (4 * radius) + relief * (6 * relief / radius + 4 * bend_ + root * root) + 1e-3;
}

// How far a lattice vertex may be from where central projection puts it.
double SampleDistance::largest_bend() const {
    struct Lattice {
        std::array<double, tile_vertices + lane_count> u{}, v{};
    };
    static const Lattice lattice = [] {
        Lattice l;
        for (std::size_t k = 0; k < tile_vertices; ++k) {
            l.u[k] = tile_layout().lattice[k][0];
            l.v[k] = tile_layout().lattice[k][1];
        }
        return l;
    }();
    Lanes most{};
    for (std::size_t k = 0; k < lattice_->size(); k += lane_count) {  // NaN beyond the last, which is not larger
        Lanes u, v, sum;
        place(load_lanes(lattice_->normals(0) + k), load_lanes(lattice_->normals(1) + k),
              load_lanes(lattice_->normals(2) + k), u, v, sum);
        most = larger(absolute(u - load_lanes(lattice.u.data() + k)), most);
        most = larger(absolute(v - load_lanes(lattice.v.data() + k)), most);
    }
    double bend = 0;
    for (std::size_t w = 0; w < lane_count; ++w) bend = std::max(bend, most[w]);
    return bend;
}

// A cell at relative level 12 lies in the finest one whose parent is split.
void SampleDistance::find_finest() {
    if (simple_) return;
    finest_.resize(tile_cells);
    const int above = tile_levels - tile_->depth;
    for (unsigned k = 0; k < tile_cells; ++k) {
        unsigned local = (tile_cells + k) >> above;
        while (!exists_[local >> 1]) local >>= 1;
        const bool covered = local >> tile_->depth != 0 && !covered_.empty() && covered_[k >> above];
        finest_[k] = covered ? std::uint16_t{0} : static_cast<std::uint16_t>(local);
    }
}

template <class Number>
void SampleDistance::place(const Number& x, const Number& y, const Number& z, Number& u, Number& v, Number& sum) const {
    const Number left = x * by_left_.x + y * by_left_.y + z * by_left_.z;
    const Number right = x * by_right_.x + y * by_right_.y + z * by_right_.z;
    sum = left + right + (x * by_apex_.x + y * by_apex_.y + z * by_apex_.z);
    const Number scale = steps / sum;
    u = left * scale;
    v = right * scale;
}

// Where each sample is on the lattice, and by how much it is inside of the root's sides.
void SampleDistance::place(std::span<const glm::dvec3> n, Piece& piece) const {
    std::array<glm::dvec3, lane_count> few;
    for (std::size_t s = 0; s < n.size(); s += lane_count) {
        const glm::dvec3* from = n.data() + s;
        if (n.size() - s < lane_count) {
            few.fill(n[s]);
            std::copy(n.begin() + static_cast<std::ptrdiff_t>(s), n.end(), few.begin());
            from = few.data();
        }
        const auto axis = [&](int k) { return gather_lanes([&](std::size_t w) { return from[w][k]; }); };
        Lanes u, v, sum;
        place(axis(0), axis(1), axis(2), u, v, sum);
        store_lanes(u, piece.u.data() + s);
        store_lanes(v, piece.v.data() + s);
        store_lanes(sum > 0 ? smaller(smaller(u, v), steps - u - v) : Lanes{} - steps, piece.inside.data() + s);
        // Within the square, and folded into the quarter of a quarter at its origin.
        constexpr double end = steps - 1e-9;
        u = smaller(larger(u, Lanes{}), Lanes{} + end);
        v = smaller(larger(v, Lanes{}), Lanes{} + end);
        const WholeNarrowLanes i = __builtin_convertvector(u, WholeNarrowLanes),
                               j = __builtin_convertvector(v, WholeNarrowLanes);
        u -= __builtin_convertvector(i, Lanes);
        v -= __builtin_convertvector(j, Lanes);
        const Lanes a = smaller(u, 1 - u), b = smaller(v, 1 - v);
        store_lanes(smaller(smaller(a, b), 0.5 * absolute(a - b)), piece.from_side.data() + s);
        const Lanes past = (v > u ? Lanes{} + 1 : Lanes{}) + (u + v > 1 ? Lanes{} + 2 : Lanes{});
        const WholeNarrowLanes quarter = (i * steps + j) * 4 + __builtin_convertvector(past, WholeNarrowLanes);
        std::memcpy(piece.quarter.data() + s, &quarter, sizeof quarter);
    }
}

void SampleDistance::add(std::span<const glm::dvec3> normals, std::span<const float> heights) {
    assert(normals.size() == heights.size());
    if (!has_surface_) return;
    static const SquareCells square_cells = make_square_cells();
    Piece piece;
    for (std::size_t first = 0; first < normals.size(); first += Piece::most) {
        const std::size_t count = std::min(Piece::most, normals.size() - first);
        const auto n = normals.subspan(first, count);
        const auto h = heights.subspan(first, count);
        place(n, piece);
        std::size_t near = 0;
        for (std::size_t s = 0; s < count; ++s) {  // no branch: half of what a field gives lies elsewhere
            piece.near[near] = static_cast<std::uint16_t>(s);
            near += piece.inside[s] >= -bend_ && h[s] == h[s] ? 1 : 0;
        }
        // The one that is farthest off at a guess goes first: it spares most others.
        std::size_t farthest = 0;
        double most = 0;
        for (std::size_t k = 0; k < near; ++k) {
            const std::size_t s = piece.near[k];
            const bool certain = piece.inside[s] > 2 * bend_ && piece.from_side[s] > bend_;
            const unsigned cell = certain ? finest_at(square_cells[static_cast<std::size_t>(piece.quarter[s])]) : 0;
            const double off = cell != 0 ? estimate(cell, piece.u[s], piece.v[s], h[s])
                               : certain ? -infinity
                                         : infinity;
            piece.cell[k] = static_cast<std::uint16_t>(cell);
            piece.off[k] = off;
            const bool leads = off > most && off < infinity;
            most = leads ? off : most;
            farthest = leads ? k : farthest;
        }
        const auto add_exactly = [&](std::size_t k) {
            const std::size_t s = piece.near[k];
            if (piece.cell[k] != 0)
                add_in(piece.cell[k], n[s], h[s]);
            else
                add_anywhere(n[s], h[s]);
            piece.off[k] = -infinity;
        };
        if (most > 0 && most + slack_ >= largest_) add_exactly(farthest);
        for (std::size_t k = 0; k < near; ++k)
            if (piece.off[k] + slack_ >= largest_ && piece.off[k] >= 0) add_exactly(k);
    }
}

// @param position of a cell at relative level 12. @returns the local index of the one with the surface, 0: another tile's
unsigned SampleDistance::finest_at(unsigned position) const {
    return simple_ ? (tile_cells + position) >> (tile_levels - tile_->depth) : finest_[position];
}

double SampleDistance::estimate(unsigned local, double u, double v, float height) const {
    const TileLayout& layout = tile_layout();
    const auto& [left, right, apex] = layout.corners[local];
    const auto at = [&](std::uint16_t vertex) {
        return glm::dvec2(layout.lattice[vertex][0], layout.lattice[vertex][1]);
    };
    const glm::dvec2 a = at(apex), l = at(left) - a, r = at(right) - a, p = glm::dvec2(u, v) - a;
    const double square = (1u << relative_level(local)) * (1.0 / (steps * steps));  // 1 by that of a leg
    const double by_left = glm::dot(p, l) * square, by_right = glm::dot(p, r) * square;
    const auto h = [&](std::uint16_t vertex) { return static_cast<double>(tile_->height[vertex]); };
    const double there = h(apex) + by_left * (h(left) - h(apex)) + by_right * (h(right) - h(apex));
    return std::abs(static_cast<double>(height) - there);
}

void SampleDistance::add_in(unsigned local, const glm::dvec3& n, float height) {
    ++exact_;
    largest_ = std::max(largest_, std::abs(static_cast<double>(height) - surface(local, n)));
}

void SampleDistance::add_anywhere(const glm::dvec3& n, float height) {
    for (const glm::dvec3* side : {&by_apex_, &by_left_, &by_right_})
        if (glm::dot(*side, n) < -on_side) return;
    const unsigned local = finest_cell(n);
    if (local >> tile_->depth != 0 && !covered_.empty() && covered_[local - (1u << tile_->depth)]) return;
    add_in(local, n, height);
}

unsigned SampleDistance::finest_cell(const glm::dvec3& n) const {
    const TileLayout& layout = tile_layout();
    bool counter_clockwise = counter_clockwise_;
    unsigned local = 1;
    for (; local < exists_.size() && exists_[local]; counter_clockwise = !counter_clockwise) {
        // Left is on child 0's side of the plane through the centre, the split vertex and the apex.
        const double side = glm::dot(
            n, glm::cross(lattice_->normal(layout.split_vertex[local]), lattice_->normal(layout.corners[local][2])));
        local = 2 * local + ((counter_clockwise ? side >= 0 : side <= 0) ? 0u : 1u);
    }
    return local;
}

double SampleDistance::surface(unsigned local, const glm::dvec3& n) const {
    const auto& [left, right, apex] = tile_layout().corners[local];
    const glm::dvec3 corner = lattice_->position(left);
    const glm::dvec3 plane = glm::cross(lattice_->position(right) - corner, lattice_->position(apex) - corner);
    const glm::dvec3 foot = placement_->ecef(n, 0, {});
    const double h = glm::dot(corner - foot, plane) / glm::dot(n, plane);
    if (tile_->undulation.empty()) return h;
    const glm::dvec3 L = lattice_->normal(left), R = lattice_->normal(right), A = lattice_->normal(apex);
    const double l = triple(n, R, A), r = triple(n, A, L), a = triple(n, L, R);
    return h - (l * tile_->undulation[left].m + r * tile_->undulation[right].m + a * tile_->undulation[apex].m) /
                   (l + r + a);
}

float SampleDistance::largest() const {
    return largest_ > 0 ? std::nextafter(static_cast<float>(largest_), std::numeric_limits<float>::max()) : 0.0f;
}

}  // namespace planet
