#include "planet/mesh/segments.h"

#include <algorithm>
#include <cmath>

#include "planet/mesh/refine.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/parallel.h"

namespace planet {

namespace {

constexpr std::int64_t one = 32768;

struct Root {
    const PlacedTile* tile;
    unsigned local;
    double distance;
};

/// Collects the segment roots in view, in Sierpinski order.
class RootCollector {
  public:
    RootCollector(const TileSource& tiles, const SegmentView& view, std::vector<Root>& roots)
        : tiles_(tiles), view_(view), roots_(roots) {}

    void cell(const PlacedTile& t, unsigned i) {
        if (i >> t.depth) {
            // A leaf of this tile, unless a child tile goes on. Its parent was not hidden: draw it.
            const PlacedTile* child = t.depth == tile_levels ? t.child(tiles_, i - tile_cells, view_.test) : nullptr;
            if (child)
                cell(*child, 1);
            else
                roots_.push_back({&t, i, distance_to(t.split[i >> 1], radius_of(t, i >> 1))});
            return;
        }
        const SplitRecord& s = t.split[i];
        const glm::dvec3 m(s.x, s.y, s.z);
        const double radius = radius_of(t, i);
        if (view_.culling.hidden(m, radius)) return;
        const double leg = cell_metrics(code_of(t, i).bisection_level()).split_max * view_.radius_m / std::sqrt(2.0);
        const double reach = glm::distance(m, view_.test.eye) - leg;
        if (!view_.test(s) || leg < view_.segment_angle * reach) {
            roots_.push_back({&t, i, distance_to(s, radius)});
            return;
        }
        cell(t, 2 * i);
        cell(t, 2 * i + 1);
    }

  private:
    // Everything in a cell is within this of its split vertex. A diamond that does not exist has no radius: its cells
    // are flat, and their corners are the farthest.
    double radius_of(const PlacedTile& t, unsigned i) const {
        const SplitRecord& s = t.split[i];
        if (s.deviation > 0) return static_cast<double>(s.radius);
        double reach = 0;
        for (const std::uint16_t corner : tile_layout().corners[i])
            reach = std::max(reach, glm::distance(glm::dvec3(s.x, s.y, s.z), ecef_from_grid(t.position[corner])));
        return reach;
    }
    double distance_to(const SplitRecord& s, double radius) const {
        return std::max(0.0, glm::distance(glm::dvec3(s.x, s.y, s.z), view_.test.eye) - radius);
    }

    const TileSource& tiles_;
    const SegmentView& view_;
    std::vector<Root>& roots_;
};

/// A tile's lattice in the frame of a patch: u, v of its corners left, right, apex.
struct Frame {
    LocationCode tile;
    std::int64_t u[3], v[3];

    void at(int i, int j, std::int64_t& pu, std::int64_t& pv) const {
        pu = u[2] + ((u[0] - u[2]) * i + (u[1] - u[2]) * j) / 64;
        pv = v[2] + ((v[0] - v[2]) * i + (v[1] - v[2]) * j) / 64;
    }
};

/// The frame of a tile such that the apex, left and right of cell `half` are (0,0), (1,0), (0,1); or of the patch's far
/// half, where they are (1,1), (0,1), (1,0). One of the two cells contains the other.
Frame frame_of_tile(LocationCode tile, LocationCode half, bool far_half) {
    const TileLayout& layout = tile_layout();
    Frame f{.tile = tile, .u = {one, 0, 0}, .v = {0, one, 0}};
    const int below = half.bisection_level() - tile.bisection_level();
    if (below < 0) {  // from the half down to the tile: corners left, right, apex of each child
        for (int i = -below - 1; i >= 0; --i)
            for (std::int64_t* p : {f.u, f.v}) {
                const std::int64_t m = (p[0] + p[1]) / 2;
                p[tile.bits() >> i & 1 ? 0 : 1] = p[2];
                p[2] = m;
            }
    } else {
        const auto local = static_cast<std::size_t>((half.bits() ^ tile.bits() << below) | std::uint64_t{1} << below);
        const auto point = [&](std::size_t k) {
            const auto& p = layout.lattice[layout.corners[local][k]];
            return glm::ivec2(p[0], p[1]);
        };
        const glm::ivec2 left = point(0) - point(2), right = point(1) - point(2), apex = point(2);
        const int leg2 = left.x * left.x + left.y * left.y;  // the legs are equal and at right angles
        const glm::ivec2 tile_corners[3] = {{64, 0}, {0, 64}, {0, 0}};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::ivec2 p = tile_corners[k] - apex;
            f.u[k] = one * (p.x * left.x + p.y * left.y) / leg2;
            f.v[k] = one * (p.x * right.x + p.y * right.y) / leg2;
        }
    }
    if (far_half)
        for (std::size_t k = 0; k < 3; ++k) {
            f.u[k] = one - f.u[k];
            f.v[k] = one - f.v[k];
        }
    return f;
}

/// Builds segments one after the other into storage of its own.
class SegmentBuilder {
  public:
    SegmentBuilder(const TileSource& tiles, const SegmentView& view) : tiles_(tiles), view_(view) {}

    void build(const Root& root) {
        const LocationCode code = code_of(*root.tile, root.local);
        const LocationCode half = code.ancestor(std::min(code.bisection_level(), view_.finest_patch_level));
        const LocationCode patch = diamond(half);
        const auto first_index = static_cast<std::uint32_t>(strip_.indices().size());
        first_vertex_ = vertices.size();
        const auto first_leaf = static_cast<std::uint32_t>(leaf_levels.size());
        strip_.end();
        frames_.assign(1, frame_of_tile(root.tile->root, half, patch != half));
        room();
        Walk walk(tiles_, view_.test, *this);
        walk.cell(*root.tile, root.local, strip_state_of_segment(code));
        const int tile_level = root.tile->root.bisection_level();
        segments.push_back(
            {.root = code,
             .patch = patch,
             .distance_m = root.distance,
             .first_vertex = static_cast<std::uint32_t>(first_vertex_),
             .first_index = first_index,
             .index_count = static_cast<std::uint32_t>(strip_.indices().size()) - first_index,
             .leaves = static_cast<std::uint32_t>(leaf_levels.size()) - first_leaf,
             .first_leaf = first_leaf,
             .detailed = tile_level >= view_.detail_level ||
                         (tile_level + tile_levels >= view_.detail_level && root.tile->has_child_below(root.local))});
    }

    void tile(const PlacedTile& t) {
        room();
        if (frames_.size() > 1 && frames_[frames_.size() - 2].tile == t.root) {
            frames_.pop_back();
            return;
        }
        const Frame& above = frames_.back();
        const unsigned local =
            static_cast<unsigned>(t.root.bits() - (above.tile.bits() << tile_levels)) | unsigned{tile_cells};
        Frame f{.tile = t.root, .u = {}, .v = {}};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& p = layout_.lattice[layout_.corners[local][k]];
            above.at(p[0], p[1], f.u[k], f.v[k]);
        }
        frames_.push_back(f);
        ++tile_visits;
        damaged = damaged || t.damaged;
    }

    void leaf(const PlacedTile& t, unsigned i, unsigned state) {
        strip_.leaf(state, [&](std::size_t corner) { return add(t, layout_.corners[i][corner]); });
        leaf_levels.push_back(static_cast<std::uint8_t>(code_of(t, i).bisection_level()));
        if (!(i >> t.depth))
            certify(t.split[i]);
        else if (t.depth == tile_levels && !t.child_bound.empty())
            certify_unentered(t, i - tile_cells);
    }

    std::vector<Segment> segments;
    GrowingArray<SegmentVertex> vertices;
    std::vector<std::uint8_t> leaf_levels;
    std::size_t tile_visits = 0;
    bool damaged = false;
    double ratio_max = 0, deviation_max = 0;

    std::span<const std::uint32_t> indices() const { return strip_.indices().span(); }

  private:
    void room() {
        strip_.reserve(tile_cells + 1);
        vertices.reserve_more(tile_cells + 3);
    }

    std::uint32_t add(const PlacedTile& t, std::uint16_t vertex) {
        std::int64_t u = 0, v = 0;
        frames_.back().at(layout_.lattice[vertex][0], layout_.lattice[vertex][1], u, v);
        vertices.push(
            {t.position[vertex], static_cast<std::uint16_t>(u), static_cast<std::uint16_t>(v), t.height[vertex]});
        return static_cast<std::uint32_t>(vertices.size() - 1 - first_vertex_);
    }

    // A leaf where a tile below begins: that one's root is not split, known from its bound or from itself.
    void certify_unentered(const PlacedTile& t, unsigned k) {
        const PlacedTile* below = t.child(tiles_, k, view_.test);
        certify(below ? below->split[1] : t.child_bound[k]);
    }

    // An unsplit diamond: its deviation over what the test allows at the nearest point below it.
    void certify(const SplitRecord& s) {
        if (!(s.deviation > 0)) return;
        const double reach = glm::distance(glm::dvec3(s.x, s.y, s.z), view_.test.eye) - static_cast<double>(s.radius);
        deviation_max = std::max(deviation_max, static_cast<double>(s.deviation));
        ratio_max = std::max(ratio_max, view_.test.K * static_cast<double>(s.deviation) / reach);
    }

    const TileSource& tiles_;
    const SegmentView& view_;
    const TileLayout& layout_ = tile_layout();
    StripWriter strip_;
    std::vector<Frame> frames_;
    std::size_t first_vertex_ = 0;
};

}  // namespace

void Segments::build(const TileSource& tiles, const SegmentView& view, int threads) {
    std::vector<Root> roots;
    RootCollector collector(tiles, view, roots);
    for (int rank = 0; rank < face_count; ++rank) {
        const PlacedTile* face = tiles.tile(LocationCode::face_root(face_at_loop_rank(rank)));
        assert(face != nullptr);
        collector.cell(*face, 1);
    }

    // Runs of roots, each built into storage of its own and joined in order: the same result for any number of threads.
    constexpr std::size_t run = 32;
    std::vector<std::unique_ptr<SegmentBuilder>> runs((roots.size() + run - 1) / run);
    parallel_for(runs.size(), static_cast<unsigned>(std::max(threads, 1)), [&](std::size_t r) {
        runs[r] = std::make_unique<SegmentBuilder>(tiles, view);
        for (std::size_t i = r * run; i < std::min(roots.size(), (r + 1) * run); ++i) runs[r]->build(roots[i]);
    });

    segments_.clear();
    vertices_.clear();
    indices_.clear();
    leaf_levels_.clear();
    tiles_ = 0;
    damaged_ = false;
    ratio_max_ = deviation_max_ = 0;
    for (const auto& b : runs) {
        const auto vertex = static_cast<std::uint32_t>(vertices_.size());
        const auto index = static_cast<std::uint32_t>(indices_.size());
        const auto leaf = static_cast<std::uint32_t>(leaf_levels_.size());
        for (Segment s : b->segments) {
            s.first_vertex += vertex;
            s.first_index += index;
            s.first_leaf += leaf;
            segments_.push_back(s);
        }
        vertices_.insert(vertices_.end(), b->vertices.span().begin(), b->vertices.span().end());
        indices_.insert(indices_.end(), b->indices().begin(), b->indices().end());
        leaf_levels_.insert(leaf_levels_.end(), b->leaf_levels.begin(), b->leaf_levels.end());
        tiles_ += b->tile_visits;
        damaged_ = damaged_ || b->damaged;
        ratio_max_ = std::max(ratio_max_, b->ratio_max);
        deviation_max_ = std::max(deviation_max_, b->deviation_max);
    }
}

}  // namespace planet
