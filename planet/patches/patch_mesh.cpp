#include "planet/patches/patch_mesh.h"

#include <algorithm>
#include <cmath>

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

std::size_t count_leaves(const PatchTriangulation& mesh) {
    std::size_t n = 0;
    mesh.for_each_leaf([&](CellCode) { ++n; });
    return n;
}

// One walk over all leaves, padding and void ones included: the stacks of the strip need them all.
class LeafWalk {
  public:
    LeafWalk(const PatchTriangulation& mesh, const PatchRaster& raster)
        : mesh_(mesh), raster_(raster), lattice_(raster.lattice()) {
        const std::size_t leaves = count_leaves(mesh);
        strip_.reserve(leaves + 4 * static_cast<std::size_t>(mesh.topology().root_count()));
        out_.vertices.reserve(leaves / 2 + 4 * static_cast<std::size_t>(mesh.topology().root_count()));
        out_.triangles.reserve(leaves);
        out_.cell.reserve(leaves);
        below_.assign(static_cast<std::size_t>(lattice_.width()), unknown);
        left_.assign(static_cast<std::size_t>(lattice_.patch_size()) + 1, unknown);
    }

    PatchMesh run() {
        const PatchGrid& grid = mesh_.topology();
        for (int row = 0; row < grid.rows(); ++row)
            for (int column = 0; column < grid.columns(); ++column) patch(column, row);
        return std::move(out_);
    }

  private:
    void patch(int column, int row) {
        const std::size_t size = static_cast<std::size_t>(lattice_.patch_size());
        south_west_ = glm::ivec2(column, row) * lattice_.patch_size();
        right_.assign(size + 1, unknown);
        above_.assign(size + 1, unknown);
        if (column == 0) left_.assign(size + 1, unknown);
        if (!out_.strip.empty()) out_.strip.push_back(strip_restart);
        if (mesh_.levels() == 0 || !mesh_.is_split(mesh_.topology().root_of_patch(column, row, 0)))
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
        const std::uint32_t left = add(c.left), right = add(c.right), apex = add(c.apex),
                            other = add(lattice_.root_corners(root + 1).apex);
        out_.triangles.push_back({left, right, apex});
        out_.triangles.push_back({right, left, other});
        out_.cell.insert(out_.cell.end(), {root, root + 1});
        out_.strip.insert(out_.strip.end(), {apex, left, right, other});
    }

    void loop(int column, int row) {
        const std::size_t begin = strip_.indices().size();
        strip_.end();
        for (int half = 0; half < 2; ++half) {
            const CellCode root = mesh_.topology().root_of_patch(column, row, half);
            cell(root, 0, lattice_.root_corners(root), state_of_half(half));
        }
        const auto indices = strip_.indices().span().subspan(begin);
        out_.strip.insert(out_.strip.end(), indices.begin(), indices.end());
    }

    void cell(CellCode code, int level, const LatticeCorners& c, unsigned state) {
        if (level < mesh_.levels() && mesh_.is_split(code)) {
            cell(code << 1, level + 1, PatchLattice::child(c, 0), strip_child_states[state][0]);
            cell(code << 1 | 1, level + 1, PatchLattice::child(c, 1), strip_child_states[state][1]);
            return;
        }
        const auto vertex = [&](std::size_t corner) {
            return add(corner == 0 ? c.left : corner == 1 ? c.right : c.apex);
        };
        std::uint32_t left, right;
        if (strip_.begun()) {
            left = strip_.gate_left();
            right = strip_.gate_right();
        } else {
            const auto gate = strip_first_gate(state);
            left = vertex(gate[0]);
            right = vertex(gate[1]);
            strip_.begin(left, right);
        }
        const StripStep step = strip_steps[state];
        const std::uint32_t third = strip_.step(step, [&] { return vertex(step.corner); });
        out_.triangles.push_back({left, right, third});
        out_.cell.push_back(code);
    }

    // A vertex on the side of a patch may be known from the patch before or below.
    std::uint32_t add(glm::ivec2 p) {
        const glm::ivec2 in = p - south_west_;
        const int size = lattice_.patch_size();
        if (in.x > 0 && in.y > 0 && in.x < size && in.y < size) return add_new(p);
        const auto x = static_cast<std::size_t>(in.x), y = static_cast<std::size_t>(in.y);
        std::uint32_t index = unknown;
        if (in.x == 0) index = left_[y];
        if (index == unknown && in.y == 0) index = below_[static_cast<std::size_t>(p.x)];
        if (index == unknown && in.x == size) index = right_[y];
        if (index == unknown && in.y == size) index = above_[x];
        if (index == unknown) index = add_new(p);
        if (in.x == 0) left_[y] = index;
        if (in.x == size) right_[y] = index;
        if (in.y == size) above_[x] = index;
        if (in.y == 0) below_[static_cast<std::size_t>(p.x)] = index;
        return index;
    }
    std::uint32_t add_new(glm::ivec2 p) {
        out_.vertices.push_back({p, static_cast<double>(raster_.at(p))});
        return static_cast<std::uint32_t>(out_.vertices.size() - 1);
    }

    const PatchTriangulation& mesh_;
    const PatchRaster& raster_;
    const PatchLattice& lattice_;
    StripWriter strip_;
    PatchMesh out_;
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

// The place in `next` of the corner that is not on the side it shares with `t`, or -1 if they share none.
int apex_across(const Triangle& t, const Triangle& next) {
    int apex = -1, shared = 0;
    for (int k = 0; k < 3; ++k)
        if (std::find(t.begin(), t.end(), next[static_cast<std::size_t>(k)]) != t.end())
            ++shared;
        else
            apex = k;
    return shared == 2 ? apex : -1;
}

}  // namespace

void append_strips(const std::vector<Triangle>& triangles, std::vector<std::uint32_t>& strip) {
    const auto corner = [](const Triangle& t, int k) { return t[static_cast<std::size_t>(k % 3)]; };
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        const int ahead = i + 1 < triangles.size() ? apex_across(t, triangles[i + 1]) : -1;
        const int apex = i > 0 ? apex_across(triangles[i - 1], t) : -1;
        // The last two indices are the gate into t, if the strip goes on.
        const std::uint32_t p = apex >= 0 ? strip[strip.size() - 2] : 0, q = apex >= 0 ? strip.back() : 0;
        const std::uint32_t a = corner(t, apex + 1), b = corner(t, apex + 2);
        if (apex >= 0 && ((a == p && b == q) || (a == q && b == p))) {
            // The next gate joins the apex and one end of this one; a turn of the strip keeps the earlier end.
            const bool keeps_p =
                ahead >= 0 && std::find(triangles[i + 1].begin(), triangles[i + 1].end(), p) != triangles[i + 1].end();
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
