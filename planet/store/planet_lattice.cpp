#include "planet/store/planet_lattice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "planet/error.h"
#include "planet/parallel.h"
#include "planet/store/tile_sides.h"

namespace planet {

namespace {

// The normal of a vertex on a side of a cell meets the cell's plane a little outside it, for normals of an ellipsoid that
// differ do not meet each other. The weights of the corners there add up to 1, their absolute values to less than these:
// of any cell, and of cells of bisection level 12 and more, which are at most 1/20 radius across.
constexpr double weights_at_most = 1.02, weights_below = 1.001;

// |N| / (n . N) is the most by which a plane moves along n for a metre across it.
float largest_stretch(const TileLattice& lattice, std::span<const float> deviation) {
    const TileLayout& layout = tile_layout();
    double most = 1;
    for (std::size_t i = 1; i < deviation.size(); ++i) {
        if (!(deviation[i] > 0)) continue;
        const auto& c = layout.corners[i];
        const CellPlane plane(lattice.position(c[0]), lattice.position(c[1]), lattice.position(c[2]));
        const double a = std::abs(glm::dot(lattice.normal(c[0]), plane.normal)),
                     b = std::abs(glm::dot(lattice.normal(c[1]), plane.normal)),
                     d = std::abs(glm::dot(lattice.normal(c[2]), plane.normal));
        const double least = std::min({a, b, d});
        const double square = glm::dot(plane.normal, plane.normal);
        // Compared squared: a square root a tile, not a cell.
        if (square > most * least * least) most = square / (least * least);
    }
    return next_up(static_cast<float>(std::sqrt(most) * weights_at_most));
}

}  // namespace

PlanetLattice::PlanetLattice(const ElevationStore& store, unsigned threads)
    : store_(&store), placement_{store.metadata().ellipsoid, 1.0}, threads_(threads) {
    if (!store.metadata().complete)
        throw Error(Fault::bad_data, store.where(), "its bake did not come to its end", "a complete store");
}

LatticeTile* PlanetLattice::find(LocationCode root) const {
    const auto found = tiles_.find(root.bits());
    return found == tiles_.end() ? nullptr : found->second.get();
}

LatticeTile* PlanetLattice::tile(LocationCode root) {
    if (LatticeTile* found = find(root)) return found;
    if (root.bisection_level() > 0) {
        const LatticeTile* above = tile(layers().above(root));
        if (!above || !above->below || !above->below->exists[layers().position(root)]) return nullptr;
    }
    return tiles_.emplace(root.bits(), read_with_own_deviations(root)).first->second.get();
}

void PlanetLattice::load(std::span<const LocationCode> roots) {
    if (std::all_of(roots.begin(), roots.end(), [&](LocationCode r) { return find(r) != nullptr; })) return;
    std::vector<std::unique_ptr<LatticeTile>> loaded(roots.size());
    parallel_for(roots.size(), threads_, [&](std::size_t i) {
        if (!find(roots[i])) loaded[i] = read_with_own_deviations(roots[i]);
    });
    for (std::size_t i = 0; i < roots.size(); ++i)
        if (loaded[i]) tiles_.emplace(roots[i].bits(), std::move(loaded[i]));
}

std::unique_ptr<LatticeTile> PlanetLattice::read(LocationCode root) const {
    std::optional<Tile> stored = store_->read(root);
    if (!stored) throw Error(Fault::bad_data, store_->where(), "tile " + to_string(root) + " is missing");
    auto tile = std::make_unique<LatticeTile>();
    tile->root = root;
    tile->depth = stored->depth;
    tile->height = std::move(stored->height);
    tile->undulation.reserve(stored->undulation.size());
    // Stored undulations are whole 1/32 m or floats (README.md): nothing is lost.
    for (const GeoidUndulation N : stored->undulation) tile->undulation.push_back(static_cast<float>(N.m));
    tile->deviation = std::move(stored->deviation);
    if (stored->child_exists.any()) {
        tile->below = std::make_unique<LatticeTile::Below>();
        tile->below->exists = stored->child_exists;
        tile->below->deviation = std::move(stored->child_deviation);
        tile->below->bound = tile->deviation;
    }
    return tile;
}

std::unique_ptr<LatticeTile> PlanetLattice::read_with_own_deviations(LocationCode root) const {
    static thread_local LatticeScratch scratch;
    std::unique_ptr<LatticeTile> tile = read(root);
    place(*tile, scratch);
    planet::own_deviation(scratch.lattice, tile->deviation);
    for (std::size_t i = 1; i < tile->deviation.size(); ++i)
        if (!scratch.exists[i]) tile->deviation[i] = 0;
    tile->stretch = largest_stretch(scratch.lattice, tile->deviation);
    if (tile->below) tile->below->lattice = scratch.lattice;
    return tile;
}

void PlanetLattice::place(const LatticeTile& tile, LatticeScratch& scratch) const {
    scratch.exists.resize(tile.deviation.size());
    for (std::size_t i = 0; i < tile.deviation.size(); ++i) scratch.exists[i] = tile.deviation[i] > 0;
    scratch.undulation.resize(tile.undulation.size());
    for (std::size_t v = 0; v < tile.undulation.size(); ++v)
        scratch.undulation[v].m = static_cast<double>(tile.undulation[v]);
    scratch.lattice.set_normals(corners(tile.root), tile.depth);
    scratch.lattice.set_positions(placement_, tile.height, scratch.undulation, scratch.exists);
}

bool PlanetLattice::exists(LocationCode cell) {
    const auto [root, local] = cell_in_tile(cell, layers());
    const LatticeTile* holder = tile(root);
    return holder && holder->exists(local);
}

LocationCode PlanetLattice::finest_cell(const glm::dvec3& normal) {
    const LocationCode path = cell_at(normal, store_->metadata().finest_level);
    int level = 0;
    while (level < path.bisection_level() && exists(path.ancestor(level))) ++level;
    return path.ancestor(level);
}

struct PlanetLattice::Nearest {
    glm::dvec3 normal;
    double distance;  // chord on the unit sphere
    std::optional<LocationCode> split;
};

// No vertex in a cell is farther from its split vertex than the farthest corner: what lies too far away is left out.
void PlanetLattice::search(LocationCode cell, const Corners& c, Nearest& nearest) {
    const glm::dvec3 m = split_vertex(c);
    const double d = glm::distance(m, nearest.normal);
    const double reach = std::max({glm::distance(m, c.left), glm::distance(m, c.right), glm::distance(m, c.apex)});
    if (d - reach > nearest.distance || !exists(cell)) return;
    if (d < nearest.distance) {
        nearest.distance = d;
        nearest.split = cell;
    }
    // The child on the direction's side first.
    const int first = glm::distance(c.left, nearest.normal) <= glm::distance(c.right, nearest.normal) ? 0 : 1;
    for (const int i : {first, 1 - first}) search(cell.child(i), child_corners(c, m, i), nearest);
}

std::optional<LocationCode> PlanetLattice::nearest_split(const glm::dvec3& normal) {
    Nearest nearest{normal, std::numeric_limits<double>::infinity(), std::nullopt};
    for (int face = 0; face < face_count; ++face) {
        const Corners c = face_corners(face);
        for (const glm::dvec3& corner : {c.left, c.right, c.apex})
            nearest.distance = std::min(nearest.distance, glm::distance(corner, normal));
    }
    const int first = cell_at(normal, 0).face();
    for (int i = 0; i < face_count; ++i) {
        const int face = first ^ i;
        search(LocationCode::face_root(face), face_corners(face), nearest);
    }
    return nearest.split;
}

float PlanetLattice::own_deviation(LatticeTile& tile, unsigned local) {
    float& own = tile.deviation[local];
    if (tile.below && own < tile.below->bound[local]) own = tile.below->bound[local] = settle(tile, local);
    return own;
}

float PlanetLattice::settle(const LatticeTile& tile, unsigned local) {
    const auto& c = tile_layout().corners[local];
    const TileLattice& lattice = tile.below->lattice;
    const CellPlane plane(lattice.position(c[0]), lattice.position(c[1]), lattice.position(c[2]));
    const int levels = tile.depth - relative_level(local);
    const unsigned cells = 1u << tile.depth;
    float worst = tile.deviation[local];
    raise_below(tile, (local << levels) - cells, ((local + 1) << levels) - cells, plane, worst);
    return worst;
}

// The tiles below at positions first to end, and those below them.
void PlanetLattice::raise_below(const LatticeTile& tile, unsigned first, unsigned end, const CellPlane& plane,
                                float& worst) {
    std::vector<LocationCode> roots;
    for (unsigned k = first; k < end; ++k)
        if (tile.below->deviation[k] > 0 && bound_below(tile, k, plane) > worst)
            roots.push_back(layers().below(tile.root, k));
    load(roots);
    for (const LocationCode root : roots) {
        const LatticeTile& below = *find(root);
        place(below, scratch_);
        worst = std::max(worst, certified_deviation(deviation_from(scratch_.lattice, plane)));
        if (below.below) raise_below(below, 0, 1u << below.depth, plane, worst);
    }
}

// No vertex in the tile below at position k is farther from the plane. It is within the saturated deviation d of the plane
// of the root there. Along its normal n the two planes part by the sum of w t (n_c . N) / (n . N) over that root's
// corners: t how far each is from the plane, n_c its normal, w its weight.
float PlanetLattice::bound_below(const LatticeTile& tile, unsigned position, const CellPlane& plane) const {
    const TileLattice& lattice = tile.below->lattice;
    double most = 0, least_facing = 1e300, most_facing = 0;
    for (const std::uint16_t v : tile_layout().corners[(1u << tile.depth) + position]) {
        const double facing = std::abs(glm::dot(lattice.normal(v), plane.normal));
        least_facing = std::min(least_facing, facing);
        most_facing = std::max(most_facing, facing);
        most = std::max(most, std::abs(plane.above(lattice.position(v), lattice.normal(v))));
    }
    const double weights = tile.root.bisection_level() + tile.depth >= 12 ? weights_below : weights_at_most;
    const double apart = weights * most * most_facing / least_facing;
    return certified_deviation(apart + static_cast<double>(tile.below->deviation[position]));
}

}  // namespace planet
