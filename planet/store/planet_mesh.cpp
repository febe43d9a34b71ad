#include "planet/store/planet_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "planet/error.h"
#include "planet/mesh/strip.h"
#include "planet/quadtree/triangulation.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

using Cells = Triangulation<OctahedronTopology, SparseSplitSet>;

/// Splits cells until every leaf deviates at most by the tolerance, the worst one first if triangles are limited.
///
/// Whatever is split has to be: a leaf with too large a deviation, or what such a split needs to conform. So in either
/// order the result is the least mesh. Worst first passes through the least meshes of all tolerances, from the coarsest
/// down: each time the worst leaf is better than any split before, one is complete.
class Refinement {
  public:
    Refinement(PlanetLattice& lattice, const PlanetMeshOptions& options)
        : lattice_(lattice),
          options_(options),
          cells_({}, lattice.store().metadata().finest_level),
          limited_(options.max_triangles > 0) {}

    const Cells& cells() const { return cells_; }
    std::size_t triangles() const { return triangles_; }

    /// Returns the tolerance that was met.
    double run() {
        for (int face = 0; face < face_count; ++face) fresh_.push_back(LocationCode::face_root(face).bits());
        for (const glm::dvec3& n : options_.keep) keep(n);
        if (limited_ && triangles_ > options_.max_triangles)
            throw Error(Fault::bad_usage, "mesh of the planet",
                        std::to_string(options_.max_triangles) + " triangles are fewer than what is to be kept takes",
                        "at least " + std::to_string(triangles_));
        undone_.clear();
        consider_fresh();
        while (const std::optional<Candidate> worst = next()) {
            if (cells_.is_split(worst->cell)) continue;
            if (const double deviation = worst->deviation; limited_ && deviation < complete_at_) {
                complete_at_ = deviation;
                undone_.clear();
            }
            split(worst->cell);
            if (limited_ && triangles_ > options_.max_triangles) {
                take_back();
                return complete_at_;
            }
            consider_fresh();
        }
        return options_.max_deviation;
    }

  private:
    struct Candidate {
        float deviation;  // own; of a cell in a tile that is not loaded a bound
        CellCode cell;
        bool operator<(const Candidate& other) const {
            return deviation != other.deviation ? deviation < other.deviation : cell > other.cell;
        }
    };

    void split(CellCode cell) {
        triangles_ += 2 * static_cast<std::size_t>(cells_.split(cell, [&](CellCode c, CellCode beyond) {
                          if (limited_) undone_.push_back(c);
                          for (const CellCode parent : {c, beyond}) {
                              fresh_.push_back(parent << 1);
                              fresh_.push_back(parent << 1 | 1);
                          }
                      }));
    }

    void take_back() {
        triangles_ -= 2 * undone_.size();
        for (; !undone_.empty(); undone_.pop_back()) {
            const bool merged = cells_.merge(undone_.back());
            assert(merged);
            static_cast<void>(merged);
        }
    }

    // The nearest vertex may belong to a cell beside the one that holds the direction.
    void keep(const glm::dvec3& direction) {
        const double square = glm::dot(direction, direction);
        if (!std::isfinite(square) || !(square > 0))
            throw Error(Fault::bad_usage, "mesh of the planet", "what is to be kept is not a direction");
        const glm::dvec3 n = direction / std::sqrt(square);
        const LocationCode finest = lattice_.finest_cell(n);
        if (finest.bisection_level() > 0) split(finest.parent().bits());
        if (const std::optional<LocationCode> cell = lattice_.nearest_split(n)) split(cell->bits());
    }

    void consider_fresh() {
        for (const CellCode cell : fresh_)
            if (!cells_.is_split(cell)) consider(LocationCode(cell));
        fresh_.clear();
    }

    void consider(LocationCode cell) {
        const auto [root, local] = cell_in_tile(cell, lattice_.layers());
        if (LatticeTile* tile = lattice_.find(root)) {
            if (local >> tile->depth == 0) consider(*tile, local);
            return;
        }
        if (root.bisection_level() == 0) {
            consider(*lattice_.tile(root), local);
            return;
        }
        const LatticeTile* above = lattice_.tile(lattice_.layers().above(root));
        if (!above || !above->below) return;
        // Saturated, and that of the root: not less than the own deviation of any cell below.
        const float bound = above->below->deviation[lattice_.layers().position(root)];
        if (bound > 0 && static_cast<double>(bound) + options_.rounding * most_stretch > options_.max_deviation)
            push(waiting_, {bound, cell.bits()});
    }

    void consider(LatticeTile& tile, unsigned local) {
        const double slack = options_.rounding * static_cast<double>(tile.stretch);
        const auto too_large = [&](float deviation) {
            return deviation > 0 && static_cast<double>(deviation) + slack > options_.max_deviation;
        };
        if (!too_large(tile.bound(local))) return;
        float own = tile.deviation[local];
        if (limited_ || !too_large(own)) own = lattice_.own_deviation(tile, local);
        if (too_large(own)) push(ready_, {own, cell_code(tile.root, local).bits()});
    }

    // Heaps if the order matters, else stacks.
    void push(std::vector<Candidate>& list, const Candidate& c) const {
        list.push_back(c);
        if (limited_) std::push_heap(list.begin(), list.end());
    }
    Candidate pop(std::vector<Candidate>& list) const {
        if (limited_) std::pop_heap(list.begin(), list.end());
        const Candidate c = list.back();
        list.pop_back();
        return c;
    }

    std::optional<Candidate> next() {
        while (!waiting_.empty() && (ready_.empty() || (limited_ && !surely_worst()))) load_waiting();
        if (ready_.empty()) return std::nullopt;
        return pop(ready_);
    }

    // Whether the worst that is known is worse than anything in tiles not loaded.
    bool surely_worst() const { return ready_.front().deviation > waiting_.front().deviation; }

    // Many tiles at once, so that they load in parallel; when triangles are limited, those most likely to be needed.
    void load_waiting() {
        constexpr std::size_t batch = 256;
        std::vector<Candidate> cells;
        while (!waiting_.empty() && (!limited_ || cells.size() < batch)) cells.push_back(pop(waiting_));
        std::vector<LocationCode> roots;
        for (const Candidate& c : cells) roots.push_back(cell_in_tile(LocationCode(c.cell), lattice_.layers()).root);
        std::sort(roots.begin(), roots.end());
        roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
        lattice_.load(roots);
        for (const Candidate& c : cells)
            if (!cells_.is_split(c.cell)) consider(LocationCode(c.cell));
    }

    // Of the facets of cells in tiles that are not loaded, the roots of these as a rule: 89 degrees steep.
    static constexpr double most_stretch = 64;

    PlanetLattice& lattice_;
    const PlanetMeshOptions& options_;
    Cells cells_;
    bool limited_;
    std::size_t triangles_ = face_count;
    double complete_at_ = std::numeric_limits<double>::infinity();
    std::vector<CellCode> fresh_;     // leaves that have not been looked at
    std::vector<CellCode> undone_;    // diamonds split since a mesh was complete
    std::vector<Candidate> ready_;    // leaves that deviate too much
    std::vector<Candidate> waiting_;  // leaves in tiles that are not loaded
};

/// Writes the leaves of the planet in the order of the curve, with places for their corners.
class MeshBuilder {
  public:
    MeshBuilder(PlanetLattice& lattice, std::size_t triangles) : lattice_(lattice) {
        made_.mesh.vertices.reserve(triangles / 2 + 2);
        made_.mesh.triangles.reserve(triangles);
        made_.mesh.level.reserve(triangles);
        made_.cells.reserve(triangles);
        strip_.reserve(triangles);
    }

    /// @param is_split of a cell
    template <class IsSplit>
    PlanetMesh build(const IsSplit& is_split) {
        for (int rank = 0; rank < face_count; ++rank) {
            const int face = face_at_loop_rank(rank);
            const LatticeTile& tile = *lattice_.tile(LocationCode::face_root(face));
            const Corners n = face_corners(face);
            const Corners p{place(tile, 0, n.left), place(tile, 1, n.right), place(tile, 2, n.apex)};
            walk({LocationCode::face_root(face), n, p, &tile, 1, nullptr, strip_state_of_face(face)}, is_split);
        }
        made_.mesh.strip.assign(strip_.indices().span().begin(), strip_.indices().span().end());
        return std::move(made_);
    }

  private:
    struct Cell {
        LocationCode code;
        Corners normal, place;
        const LatticeTile* tile;   // that holds its corners
        unsigned local;            // in it
        const CellPlane* surface;  // of the finest cell that holds this one, once the store has ended
        unsigned strip_state;
    };

    glm::dvec3 place(const LatticeTile& tile, std::size_t v, const glm::dvec3& n) const {
        return lattice_.placement().ecef(n, static_cast<double>(tile.height[v]), {tile.undulation_at(v)});
    }

    template <class IsSplit>
    void walk(const Cell& c, const IsSplit& is_split) {
        if (!is_split(c.code)) return leaf(c);
        if (c.surface == nullptr) {
            const LatticeTile* tile = c.tile;
            unsigned local = c.local;
            if (local >> tile->depth != 0 && tile->below) {
                if (const LatticeTile* below = lattice_.tile(c.code)) {
                    tile = below;
                    local = 1;
                }
            }
            if (tile->exists(local)) {
                const glm::dvec3 n = split_vertex(c.normal);
                return walk_children(c, n, place(*tile, tile_layout().split_vertex[local], n), tile, local, nullptr,
                                     is_split);
            }
            const CellPlane surface(c.place.left, c.place.right, c.place.apex);
            return walk_beyond(c, surface, is_split);
        }
        walk_beyond(c, *c.surface, is_split);
    }

    // Where the store has ended: the split vertex lies in the plane of its finest cell.
    template <class IsSplit>
    void walk_beyond(const Cell& c, const CellPlane& surface, const IsSplit& is_split) {
        const glm::dvec3 n = split_vertex(c.normal);
        const glm::dvec3 foot = ecef_from_normal(lattice_.placement().ellipsoid, n);
        walk_children(c, n, foot + surface.above(foot, n) * n, c.tile, c.local, &surface, is_split);
    }

    template <class IsSplit>
    void walk_children(const Cell& c, const glm::dvec3& n, const glm::dvec3& p, const LatticeTile* tile, unsigned local,
                       const CellPlane* surface, const IsSplit& is_split) {
        for (int i = 0; i < 2; ++i)
            walk({c.code.child(i), child_corners(c.normal, n, i), child_corners(c.place, p, i), tile,
                  2 * local + static_cast<unsigned>(i), surface,
                  strip_child_states[c.strip_state][static_cast<std::size_t>(i)]},
                 is_split);
    }

    void leaf(const Cell& c) {
        const bool first = !strip_.begun();
        const std::uint32_t l = first ? 0 : strip_.gate_left(), r = first ? 1 : strip_.gate_right();
        const std::uint32_t next = strip_.leaf(c.strip_state, [&](unsigned corner) {
            made_.mesh.vertices.push_back(corner == 0 ? c.place.left : corner == 1 ? c.place.right : c.place.apex);
            return static_cast<std::uint32_t>(made_.mesh.vertices.size() - 1);
        });
        made_.mesh.triangles.push_back({l, r, next});
        made_.mesh.level.push_back(static_cast<std::uint8_t>(c.code.bisection_level()));
        made_.cells.push_back(c.code);
    }

    PlanetLattice& lattice_;
    PlanetMesh made_;
    StripWriter strip_;
};

void check(const PlanetMeshOptions& o) {
    const auto refuse = [](const std::string& what, const char* accepted) {
        throw Error(Fault::bad_usage, "mesh of the planet", what, accepted);
    };
    if (!(o.max_deviation >= 0) || !std::isfinite(o.max_deviation))
        refuse("the deviation is " + std::to_string(o.max_deviation) + " m", "0 m or more");
    if (!(o.rounding >= 0) || !std::isfinite(o.rounding))
        refuse("the rounding is " + std::to_string(o.rounding) + " m", "0 m or more");
    if (o.max_triangles != 0 && o.max_triangles < face_count)
        refuse("at most " + std::to_string(o.max_triangles) + " triangles", "8 or more");
}

}  // namespace

PlanetMesh planet_mesh(PlanetLattice& lattice, const PlanetMeshOptions& options) {
    check(options);
    Refinement refinement(lattice, options);
    const double tolerance = refinement.run();
    const Cells& cells = refinement.cells();
    PlanetMesh made =
        MeshBuilder(lattice, refinement.triangles()).build([&](LocationCode c) { return cells.is_split(c.bits()); });
    made.tolerance = tolerance;
    return made;
}

PlanetMesh uniform_planet_mesh(PlanetLattice& lattice, int bisection_level) {
    if (bisection_level < 0 || bisection_level > finest_uniform_level)
        throw Error(Fault::bad_usage, "mesh of the planet", "the bisection level is " + std::to_string(bisection_level),
                    "0 to " + std::to_string(finest_uniform_level));
    PlanetMesh made = MeshBuilder(lattice, std::size_t{8} << bisection_level).build([&](LocationCode c) {
        return c.bisection_level() < bisection_level;
    });
    made.tolerance = std::numeric_limits<double>::infinity();
    return made;
}

}  // namespace planet
