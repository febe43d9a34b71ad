#include "planet/patches/patch_mesh.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <cmath>
#include <memory>

#include "planet/mesh/strip.h"
#include "planet/mesh/surface_mesh.h"

namespace planet {

namespace {

constexpr std::uint32_t unknown = 0xffffffffu;

// Both halves are entered and left through the diagonal (topology.h).
constexpr unsigned state_of_half(int half) {
    using S = StripState;
    return S::entry_split | S::exit_split | (half == 1 ? S::split_visited : 0u);
}

// A place in the lattice as one word, x below y: a midpoint is a sum and a shift. Sums are even and below 2^31.
using Place = std::uint64_t;

Place place_of(glm::ivec2 p) {
    return static_cast<Place>(p.y) << 32 | static_cast<Place>(p.x);
}
glm::ivec2 lattice_at(Place p) {
    return {static_cast<std::int32_t>(p), static_cast<std::int32_t>(p >> 32)};
}
Place midpoint(Place a, Place b) {
    return (a + b) >> 1;
}

// Room in large pages, where the system gives them for the asking: first touches of small ones take as long as the walk.
template <class T>
void reserve_large(std::vector<T>& array, std::size_t count) {
    array.reserve(count);
#ifdef MADV_HUGEPAGE
    constexpr std::uintptr_t page = 4096;
    const auto begin = reinterpret_cast<std::uintptr_t>(array.data());
    const std::uintptr_t first = (begin + page - 1) / page * page, end = (begin + count * sizeof(T)) / page * page;
    if (end > first) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
#endif
}

// One walk over all leaves, padding and void ones included: the stacks of the strip need them all. StripWriter's steps,
// without a branch a leaf that cannot be foreseen, and with the triangles. What a few leaves give is written together, so
// that heights, which lie far apart, are read at once.
class LeafWalk {
  public:
    LeafWalk(const PatchTriangulation& mesh, const PatchRaster& raster)
        : mesh_(mesh), raster_(raster), lattice_(raster.lattice()) {
        const auto roots = static_cast<std::size_t>(mesh.topology().root_count());
        const std::size_t leaves = roots + mesh.split_cells().count();              // a split adds one
        left_stack_ = std::make_unique_for_overwrite<std::uint32_t[]>(leaves + 3);  // one beyond the top is scratch
        right_stack_ = std::make_unique_for_overwrite<std::uint32_t[]>(leaves + 3);
        reserve_large(out_.vertices,
                      leaves / 2 + static_cast<std::size_t>(lattice_.width() + lattice_.height()));  // Euler
        reserve_large(out_.triangles, leaves);
        reserve_large(out_.cell, leaves);
        reserve_large(out_.strip, leaves / 3 * 5 + 4 * roots);
        below_.assign(static_cast<std::size_t>(lattice_.width()), unknown);
        left_.assign(static_cast<std::size_t>(lattice_.patch_size()) + 1, unknown);
    }

    PatchMesh run() {
        const PatchGrid& grid = mesh_.topology();
        for (int row = 0; row < grid.rows(); ++row)
            for (int column = 0; column < grid.columns(); ++column) patch(column, row);
        flush();
        return std::move(out_);
    }

  private:
    static constexpr std::size_t batch = 1024;  // leaves

    void patch(int column, int row) {
        const std::size_t size = static_cast<std::size_t>(lattice_.patch_size());
        south_west_ = glm::ivec2(column, row) * lattice_.patch_size();
        right_.assign(size + 1, unknown);
        above_.assign(size + 1, unknown);
        if (column == 0) left_.assign(size + 1, unknown);
        if (vertices_ != 0) strip_[strip_size_++] = strip_restart;
        if (!mesh_.is_split(mesh_.topology().root_of_patch(column, row, 0)))
            two_triangles(column, row);
        else
            loop(column, row);
        // The borders for the next patch of the row, and of the next row. The corners belong to both.
        left_.swap(right_);
        std::copy(above_.begin(), above_.end(), below_.begin() + static_cast<std::ptrdiff_t>(south_west_.x));
    }

    // The halves share one side only: no curve enters and leaves through it.
    void two_triangles(int column, int row) {
        const CellCode root = mesh_.topology().root_of_patch(column, row, 0);
        const LatticeCorners c = lattice_.root_corners(root);
        const std::uint32_t left = add(place_of(c.left)), right = add(place_of(c.right)), apex = add(place_of(c.apex)),
                            other = add(place_of(lattice_.root_corners(root + 1).apex));
        for (const std::uint32_t v : {apex, left, right, other}) strip_[strip_size_++] = v;
        add_triangle({left, right, apex}, root);
        add_triangle({right, left, other}, root + 1);
    }

    // Both roots are split, for they are one diamond.
    void loop(int column, int row) {
        for (int half = 0; half < 2; ++half) {
            const CellCode root = mesh_.topology().root_of_patch(column, row, half);
            const LatticeCorners c = lattice_.root_corners(root);
            if (half == 0) begin(root, c);
            halves(root, place_of(c.left), place_of(c.right), place_of(c.apex), state_of_half(half));
        }
    }

    // Starts a strip at the gate of the first leaf.
    void begin(CellCode code, LatticeCorners c) {
        unsigned state = state_of_half(0);
        for (; mesh_.is_split(code); code <<= 1) {
            c = PatchLattice::child(c, 0);
            state = strip_child_states[state][0];
        }
        const glm::ivec2 corner[] = {c.left, c.right, c.apex};
        const auto gate = strip_first_gate(state);
        left_top_ = left_stack_.get();
        right_top_ = right_stack_.get();
        strip_[strip_size_++] = *left_top_ = add(place_of(corner[gate[0]]));
        strip_[strip_size_++] = *right_top_ = add(place_of(corner[gate[1]]));
        last_left_ = false;
    }

    // Of a split cell. Both halves are looked up before either is walked.
    void halves(CellCode code, Place left, Place right, Place apex, unsigned state) {
        const CellCode first = code << 1, second = first | 1;
        const bool first_is_split = mesh_.is_split(first), second_is_split = mesh_.is_split(second);
        const Place split = midpoint(left, right);
        const auto [first_state, second_state] = strip_child_states[state];
        if (first_is_split)
            halves(first, left, apex, split, first_state);
        else
            leaf(first, apex, split, first_state);
        if (second_is_split)
            halves(second, apex, right, split, second_state);
        else
            leaf(second, right, split, second_state);
    }

    void leaf(CellCode code, Place right, Place apex, unsigned state) {
        const StripStep step = strip_steps[state];
        const Place corner = step.corner == 1 ? right : apex;
        const std::uint32_t gate_left = *left_top_, gate_right = *right_top_;
        std::uint32_t next = vertices_;
        if (on_side_of_patch(corner) && !step.pop) next = number_on_side(corner);
        const bool is_new = !step.pop && next == vertices_;
        pending_[pending_size_] = corner;
        pending_size_ += is_new;
        vertices_ += is_new;

        strip_[strip_size_] = step.left_side ? gate_right : gate_left;  // the pivot, kept only by two steps on one side
        strip_size_ += step.left_side == last_left_;
        last_left_ = step.left_side;
        std::uint32_t* moving = step.left_side ? left_top_ : right_top_;
        moving[1] = next;  // kept only by a push
        moving += step.pop ? -1 : 1;
        left_top_ = step.left_side ? moving : left_top_;
        right_top_ = step.left_side ? right_top_ : moving;
        strip_[strip_size_++] = *moving;
        add_triangle({gate_left, gate_right, *moving}, code);
    }

    void add_triangle(const std::array<std::uint32_t, 3>& triangle, CellCode code) {
        triangle_[leaves_] = triangle;
        cell_[leaves_] = code;
        if (++leaves_ >= batch) flush();
    }

    void flush() {
        for (std::size_t i = 0; i < pending_size_; ++i) {
            const glm::ivec2 at = lattice_at(pending_[i]);
            vertex_[i] = {at, static_cast<double>(raster_.at(at))};
        }
        const auto append = [](auto& to, const auto& from, std::size_t count) {
            to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
        };
        append(out_.vertices, vertex_, pending_size_);
        append(out_.triangles, triangle_, leaves_);
        append(out_.cell, cell_, leaves_);
        append(out_.strip, strip_, strip_size_);
        pending_size_ = leaves_ = strip_size_ = 0;
    }

    bool on_side_of_patch(Place p) const {
        const auto mask = static_cast<Place>(lattice_.patch_size()) - 1;
        return (p & mask) == 0 || (p >> 32 & mask) == 0;
    }
    std::uint32_t add(Place p) {
        const std::uint32_t index = on_side_of_patch(p) ? number_on_side(p) : vertices_;
        if (index == vertices_) {
            pending_[pending_size_++] = p;
            ++vertices_;
        }
        return index;
    }
    // A vertex on the side of a patch may be known from the patch before or below; else it is the next.
    std::uint32_t number_on_side(Place p) {
        const glm::ivec2 in = lattice_at(p) - south_west_;
        const int size = lattice_.patch_size();
        const auto x = static_cast<std::size_t>(in.x), y = static_cast<std::size_t>(in.y),
                   x_in_row = x + static_cast<std::size_t>(south_west_.x);
        std::uint32_t index = unknown;
        if (in.x == 0) index = left_[y];
        if (index == unknown && in.y == 0) index = below_[x_in_row];
        if (index == unknown && in.x == size) index = right_[y];
        if (index == unknown && in.y == size) index = above_[x];
        if (index == unknown) index = vertices_;
        if (in.x == 0) left_[y] = index;
        if (in.x == size) right_[y] = index;
        if (in.y == size) above_[x] = index;
        if (in.y == 0) below_[x_in_row] = index;
        return index;
    }

    const PatchTriangulation& mesh_;
    const PatchRaster& raster_;
    const PatchLattice& lattice_;
    PatchMesh out_;
    std::uint32_t vertices_ = 0;  ///< numbered so far

    // The strip: the ends of the gate on both sides of the curve, topmost last.
    std::unique_ptr<std::uint32_t[]> left_stack_, right_stack_;
    std::uint32_t *left_top_ = nullptr, *right_top_ = nullptr;
    bool last_left_ = false;

    // Not yet in out_. A patch of two leaves has most of all: four vertices, five indices.
    std::size_t leaves_ = 0, pending_size_ = 0, strip_size_ = 0;
    std::array<std::array<std::uint32_t, 3>, batch> triangle_;
    std::array<CellCode, batch> cell_;
    std::array<Place, 2 * batch + 8> pending_;  ///< places of new vertices
    std::array<LatticeVertex, 2 * batch + 8> vertex_;
    std::array<std::uint32_t, 3 * batch + 8> strip_;

    glm::ivec2 south_west_{0};
    // Vertices on the sides of the present patch, by distance from its south-western corner; below: of the whole row.
    std::vector<std::uint32_t> left_, right_, above_, below_;
};

// Leaves out what is void or padding, cuts what crosses the border, and numbers what is left anew.
class Trim {
  public:
    Trim(const PatchRaster& raster, const PatchMesh& all)
        : raster_(raster),
          all_(all),
          index_(all.vertices.size(), unknown),
          on_right_(static_cast<std::size_t>(raster.height()), unknown),
          on_top_(static_cast<std::size_t>(raster.width()), unknown) {}

    PatchMesh run() {
        // Clipping adds no more than it leaves out, but at the border.
        const auto border = static_cast<std::size_t>(raster_.width() + raster_.height());
        reserve_large(out_.vertices, all_.vertices.size() + border);
        reserve_large(out_.triangles, all_.triangles.size() + border);
        reserve_large(out_.cell, all_.triangles.size() + border);
        reserve_large(out_.strip, all_.strip.size() + 2 * border);
        for (std::size_t i = 0; i < all_.triangles.size(); ++i) {
            const auto& t = all_.triangles[i];
            const LatticeVertex &a = all_.vertices[t[0]], &b = all_.vertices[t[1]], &c = all_.vertices[t[2]];
            if (std::isnan(a.height) || std::isnan(b.height) || std::isnan(c.height)) continue;
            if (raster_.outside({a.at, b.at, c.at})) continue;
            if (raster_.inside({a.at, b.at, c.at}))
                add({kept(t[0]), kept(t[1]), kept(t[2])}, all_.cell[i]);
            else
                add_clipped(t, clip(raster_, {a, b, c}), all_.cell[i]);
        }
        append_strips(out_.triangles, out_.strip);
        return std::move(out_);
    }

  private:
    void add(const std::array<std::uint32_t, 3>& triangle, CellCode cell) {
        out_.triangles.push_back(triangle);
        out_.cell.push_back(cell);
    }

    void add_clipped(const std::array<std::uint32_t, 3>& t, const ClippedTriangle& polygon, CellCode cell) {
        std::array<std::uint32_t, 5> corner{};
        for (std::size_t k = 0; k < polygon.count; ++k) {
            const auto* original = std::find_if(
                t.begin(), t.end(), [&](std::uint32_t v) { return all_.vertices[v].at == polygon.corner[k].at; });
            corner[k] = original != t.end() ? kept(*original) : cut(polygon.corner[k]);
        }
        for (std::size_t k = 2; k < polygon.count; ++k) add({corner[0], corner[k - 1], corner[k]}, cell);
    }

    std::uint32_t kept(std::uint32_t v) {
        if (index_[v] == unknown) index_[v] = add_vertex(all_.vertices[v]);
        return index_[v];
    }
    // Cuts lie on the right or the top border, each at a sample of its own.
    std::uint32_t cut(const LatticeVertex& v) {
        std::uint32_t& index = v.at.x == raster_.width() - 1 ? on_right_[static_cast<std::size_t>(v.at.y)]
                                                             : on_top_[static_cast<std::size_t>(v.at.x)];
        if (index == unknown) index = add_vertex(v);
        return index;
    }
    std::uint32_t add_vertex(const LatticeVertex& v) {
        out_.vertices.push_back(v);
        return static_cast<std::uint32_t>(out_.vertices.size() - 1);
    }

    const PatchRaster& raster_;
    const PatchMesh& all_;
    std::vector<std::uint32_t> index_, on_right_, on_top_;
    PatchMesh out_;
};

using Triangle = std::array<std::uint32_t, 3>;

bool has(const Triangle& t, std::uint32_t vertex) {
    return (t[0] == vertex) | (t[1] == vertex) | (t[2] == vertex);
}

// The place in `next` of the corner that is not on the side it shares with `t`, or -1 if they share none.
int apex_across(const Triangle& t, const Triangle& next) {
    const int shared = has(t, next[0]) + 2 * has(t, next[1]) + 4 * has(t, next[2]);
    return shared == 6 ? 0 : shared == 5 ? 1 : shared == 3 ? 2 : -1;
}

}  // namespace

void append_strips(const std::vector<Triangle>& triangles, std::vector<std::uint32_t>& strip) {
    const auto corner = [](const Triangle& t, int k) { return t[static_cast<std::size_t>(k % 3)]; };
    int ahead = -1;  // the next triangle's apex, across the side it shares with t
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        const int apex = ahead;
        ahead = i + 1 < triangles.size() ? apex_across(t, triangles[i + 1]) : -1;
        // The last two indices are the gate into t, if the strip goes on.
        const std::uint32_t p = apex >= 0 ? strip[strip.size() - 2] : 0, q = apex >= 0 ? strip.back() : 0;
        const std::uint32_t a = corner(t, apex + 1), b = corner(t, apex + 2);
        if (apex >= 0 && ((a == p && b == q) || (a == q && b == p))) {
            // The next gate joins the apex and one end of this one; a turn of the strip keeps the earlier end.
            const bool keeps_p = ahead >= 0 && has(triangles[i + 1], p);
            if (keeps_p) strip.push_back(p);
            strip.push_back(corner(t, apex));
            continue;
        }
        if (!strip.empty()) strip.push_back(strip_restart);
        // Ends with the side that the next triangle shares.
        const int first = ahead >= 0 ? apex_across(triangles[i + 1], t) : 0;
        for (int k = 0; k < 3; ++k) strip.push_back(corner(t, first + k));
    }
}

void turn_strips(std::vector<std::uint32_t>& strip) {
    std::vector<std::uint32_t> turned;
    turned.reserve(strip.size() + strip.size() / 64 + 1);
    for (std::size_t i = 0; i < strip.size(); ++i) {
        if (i == 0 || strip[i - 1] == strip_restart) turned.push_back(strip[i]);
        turned.push_back(strip[i]);
    }
    strip = std::move(turned);
}

PatchMesh extract(const PatchTriangulation& mesh, const PatchRaster& raster) {
    PatchMesh all = LeafWalk(mesh, raster).run();
    const PatchLattice& lattice = raster.lattice();
    if (!raster.has_void() && lattice.width() == raster.width() && lattice.height() == raster.height()) return all;
    return Trim(raster, all).run();
}

}  // namespace planet
