#pragma once
// A walk over the cells of the ground: from the faces down to the finest cells of a store, and beyond, in halves of these
// at interpolated heights, as far as a visitor asks for.

#include <algorithm>
#include <bit>
#include <memory>
#include <vector>

#include "planet/mesh/tile_layout.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/store/tile_reader.h"

namespace planet {

/// A cell that the ground is linear in: one of the finest, or a part of one.
struct GroundCell {
    Corners normal;         ///< unit
    glm::dvec3 h{0};        ///< of left, right and apex above the ellipsoid, metres
    double resampling = 0;  ///< Tile::resampling
    bool counter_clockwise = true;
};

/// Everything within this chord of a cell's centre is within it of the cell: directions, not metres.
struct CellReach {
    explicit CellReach(const Corners& c) : centre(glm::normalize(c.left + c.right + c.apex)) {
        for (const glm::dvec3* corner : {&c.left, &c.right, &c.apex})
            chord = std::max(chord, glm::length(*corner - centre));
    }
    glm::dvec3 centre;  ///< unit
    double chord = 0;   ///< to the farthest corner
};

/// Where a walk can begin: a cell that was entered.
struct GroundPart {
    std::shared_ptr<const Tile> tile;  ///< that knows it
    unsigned local;                    ///< its number there: 1 is the root, 2 n and 2 n + 1 the halves of n
    Corners corners;
    bool counter_clockwise;
};

/// A Visitor has
///     bool enter(const Corners&)        whether to look at what is in a cell; if so, leave() follows
///     void leave()
///     bool halve(const GroundCell&)     whether to go on below one of the finest
///     void visit(const GroundCell&)     one that is not halved
template <class Visitor>
class GroundWalk {
  public:
    /// @param tiles must outlive the walk
    GroundWalk(const TileReader& tiles, Visitor& visitor) : tiles_(tiles), visitor_(visitor) {}

    void planet() {
        for (int face = 0; face < face_count; ++face) {
            const Corners corners = face_corners(face);
            if (!visitor_.enter(corners)) continue;
            if (const auto tile = tiles_.tile(LocationCode::face_root(face))) below(*tile, 1, corners, true);
            visitor_.leave();
        }
    }

    /// The planet as `least` parts or more, unless there are fewer, that planet() goes through one behind the other.
    /// For visitors that only look at the cell in enter(), and in leave() at nothing.
    std::vector<GroundPart> parts(std::size_t least) {
        std::vector<GroundPart> parts, next;
        for (int face = 0; face < face_count; ++face)
            if (visitor_.enter(face_corners(face)))
                if (const auto tile = tiles_.tile(LocationCode::face_root(face)))
                    parts.push_back({tile, 1, face_corners(face), true});
        for (bool more = true; more && parts.size() < least; std::swap(parts, next)) {
            more = false;
            next.clear();
            for (const GroundPart& part : parts) more |= split(part, next);
        }
        return parts;
    }
    void part(const GroundPart& p) { below(*p.tile, p.local, p.corners, p.counter_clockwise); }

  private:
    // The tile that goes on where one ends, if there is one.
    std::shared_ptr<const Tile> tile_below(const Tile& tile, unsigned local) const {
        const unsigned position = local - (1u << tile.depth);
        if (!tile.child_exists[position] || !(tile.child_deviation[position] > 0)) return nullptr;
        const int level = static_cast<int>(std::bit_width(local)) - 1;
        auto next = tiles_.tile(LocationCode(tile.root.bits() << level | (local ^ 1u << level)));
        return next && !next->damaged && next->deviation[1] > 0 ? next : nullptr;
    }

    // The next step of a walk. @return false for one of the finest cells, which stays as it is
    bool split(const GroundPart& p, std::vector<GroundPart>& into) {
        if (p.local >> p.tile->depth) {
            auto next = tile_below(*p.tile, p.local);
            into.push_back(next ? GroundPart{std::move(next), 1, p.corners, p.counter_clockwise} : p);
            return into.back().tile != p.tile;
        }
        if (!(p.tile->deviation[p.local] > 0)) {
            into.push_back(p);
            return false;
        }
        const glm::dvec3 m = split_vertex(p.corners);
        for (unsigned child = 0; child < 2; ++child) {
            const Corners c = child_corners(p.corners, m, static_cast<int>(child));
            if (visitor_.enter(c)) into.push_back({p.tile, 2 * p.local + child, c, !p.counter_clockwise});
        }
        return true;
    }

    // All of these are called inside enter() of the cell.
    void below(const Tile& tile, unsigned local, const Corners& corners, bool counter_clockwise) {
        if (local >> tile.depth) {
            if (const auto next = tile_below(tile, local)) {
                below(*next, 1, corners, counter_clockwise);
                return;
            }
        } else if (tile.deviation[local] > 0) {
            const glm::dvec3 m = split_vertex(corners);
            for (int child = 0; child < 2; ++child) {
                const Corners c = child_corners(corners, m, child);
                if (!visitor_.enter(c)) continue;
                below(tile, 2 * local + static_cast<unsigned>(child), c, !counter_clockwise);
                visitor_.leave();
            }
            return;
        }
        GroundCell cell{corners, {}, static_cast<double>(tile.resampling), counter_clockwise};
        const auto& vertex = tile_layout().corners[local];
        for (int k = 0; k < 3; ++k) {
            const std::size_t v = vertex[static_cast<std::size_t>(k)];
            cell.h[k] = static_cast<double>(tile.height[v]) + (tile.undulation.empty() ? 0 : tile.undulation[v].m);
        }
        finest(cell);
    }

    void finest(const GroundCell& cell) {
        if (!visitor_.halve(cell)) {
            visitor_.visit(cell);
            return;
        }
        const glm::dvec3 m = split_vertex(cell.normal);
        const double h = 0.5 * (cell.h[0] + cell.h[1]);
        for (int child = 0; child < 2; ++child) {
            GroundCell half = cell;
            half.normal = child_corners(cell.normal, m, child);
            half.h = child == 0 ? glm::dvec3(cell.h[0], cell.h[2], h) : glm::dvec3(cell.h[2], cell.h[1], h);
            half.counter_clockwise = !cell.counter_clockwise;
            if (!visitor_.enter(half.normal)) continue;
            finest(half);
            visitor_.leave();
        }
    }

    const TileReader& tiles_;
    Visitor& visitor_;
};

}  // namespace planet
