#include "planet/store/bake.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "planet/error.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/store/baked_tile.h"
#include "planet/store/resampling.h"
#include "planet/store/store_tables.h"

namespace planet {

namespace {

void check_range(std::string_view name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error(Fault::bad_usage, "bake", std::string(name) + " is " + std::to_string(value),
                std::to_string(least) + " to " + std::to_string(most));
}

void check(const BakeOptions& o) {
    check_range("the least level", o.least_level, 1, max_bisection_level);
    check_range("the finest level", o.finest_level, o.least_level, max_bisection_level);
    check_range("the number of extra levels", o.extra_levels, -max_bisection_level, max_bisection_level);
    if (o.quantum_m == 0) return;
    check_range("the quantum", o.quantum_m, least_quantum_m, most_quantum_m);
    int exponent;
    if (std::frexp(o.quantum_m, &exponent) != 0.5)
        throw Error(Fault::bad_usage, "bake", "the quantum is " + std::to_string(o.quantum_m), "a power of two");
}

// A quarter of a metre for sources of 30 m and coarser; halved whenever the spacing is.
double quantum_for(int finest_level, double mean_radius_m) {
    double quantum = 0.25, spacing = 30;
    while (quantum > least_quantum_m &&
           cell_metrics(finest_level).vertex_spacing * mean_radius_m < spacing / std::sqrt(2.0) / 2) {
        quantum /= 2;
        spacing /= 2;
    }
    return quantum;
}

class Bake {
  public:
    Bake(const ElevationField& field, const BakeOptions& options)
        : field_(field), options_(options), placement_{options.ellipsoid, 1.0} {
        check(options);
        has_undulation_ = options.undulation && field.datum() != VerticalDatum::ellipsoid;
    }

    BakeReport run(SqliteFile& file) {
        step("coverage", [&] { plan(); });
        step("heights", [&] { measure_all(); });
        step("settling", [&] {
            settle(tiles_);
            gather_height_ranges();
        });
        step("resampling", [&] {
            certify_resampling(field_, placement_, tiles_, [&](double fraction) { tell("resampling", fraction); });
        });
        step("writing", [&] { write(file); });
        return report_;
    }

  private:
    template <class Work>
    void step(const char* name, Work work) {
        const auto begin = std::chrono::steady_clock::now();
        tell(name, 0);
        work();
        tell(name, 1);
        report_.seconds.emplace_back(name,
                                     std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }

    void tell(std::string_view name, double fraction) const {
        if (options_.progress) options_.progress(name, fraction);
    }

    void plan() {
        const double radius = options_.ellipsoid.mean_radius();
        const auto planned = coverage(field_, {.mean_radius_m = radius,
                                               .least_level = options_.least_level,
                                               .finest_level = options_.finest_level,
                                               .extra_levels = options_.extra_levels,
                                               .memory_bytes = options_.memory_bytes});
        for (const PlannedTile& t : planned) {
            report_.finest_level = std::max(report_.finest_level, t.root.bisection_level() + t.depth);
            report_.planned_bytes += planned_bytes(t);
        }
        tiles_ = tie_tiles(planned);
        report_.tiles = tiles_.size();
        report_.quantum_m = options_.quantum_m > 0 ? options_.quantum_m : quantum_for(report_.finest_level, radius);
    }

    // Parents come first: a tile needs the heights of the cells above it.
    void measure_all() {
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            BakedTile& baked = tiles_[t];
            lattice_.set_normals(corners(baked.tile.root), baked.tile.depth);
            sample(baked);
            measure(baked);
            report_.vertices += baked.tile.height.size();
            if (t % 256 == 0) tell("heights", static_cast<double>(t) / static_cast<double>(tiles_.size()));
        }
    }

    // Heights and undulations. The root's corners are vertices of the tile above: taken from there.
    void sample(BakedTile& baked) {
        Tile& tile = baked.tile;
        normals_.resize(lattice_.size());
        for (std::size_t v = 0; v < normals_.size(); ++v) normals_[v] = lattice_.normal(v);
        tile.height.resize(normals_.size());
        field_.heights(normals_, tile.height);
        for (std::size_t v = 0; v < tile.height.size(); ++v) tile.height[v] = quantized(tile.height[v], normals_[v]);
        if (has_undulation_) sample_undulations(tile);
        if (baked.above < 0) return;
        const Tile& above = tiles_[static_cast<std::size_t>(baked.above)].tile;
        const auto& corner = tile_layout().corners[tile_cells | (tile.root.bits() & (tile_cells - 1))];
        for (std::size_t v = 0; v < 3; ++v) {
            tile.height[v] = above.height[corner[v]];
            if (has_undulation_) tile.undulation[v] = above.undulation[corner[v]];
        }
        if (has_undulation_) interpolate_undulations(tile.root, tile.depth, tile.undulation);
    }

    float quantized(float height, const glm::dvec3& normal) const {
        if (std::isnan(height)) return 0.0f;
        const double quanta = std::nearbyint(static_cast<double>(height) / report_.quantum_m);
        if (std::abs(quanta) > static_cast<double>(largest_height_quanta)) {
            const Geodetic g = geodetic_from_normal(normal);
            const double limit = static_cast<double>(largest_height_quanta) * report_.quantum_m;
            throw Error(Fault::bad_data, "bake",
                        "the height at " + std::to_string(g.latitude / degrees) + "," +
                            std::to_string(g.longitude / degrees) + " is " + std::to_string(height) + " m",
                        "at most " + std::to_string(limit) + " m up or down");
        }
        return static_cast<float>(quanta * report_.quantum_m);
    }

    void sample_undulations(Tile& tile) {
        tile.undulation.resize(tile.height.size());
        const std::size_t own = own_undulations(tile.root, tile.depth);
        undulations_.resize(own);
        options_.undulation(std::span(normals_).first(own), undulations_);
        for (std::size_t v = 0; v < own; ++v) {
            const double N = std::nearbyint(undulations_[v].m / undulation_quantum_m) * undulation_quantum_m;
            if (!(std::abs(N) < 1e4))
                throw Error(Fault::bad_data, "bake",
                            "the geoid's height is " + std::to_string(undulations_[v].m) + " m", "-10000 to 10000 m");
            tile.undulation[v].m = N;
        }
        interpolate_undulations(tile.root, tile.depth, tile.undulation);
    }

    // Own deviations, those of the cells above, and where radii start.
    void measure(BakedTile& baked) {
        Tile& tile = baked.tile;
        lattice_.set_positions(placement_, tile.height, tile.undulation, baked.exists);
        baked.rounded.assign(lattice_.rounded().begin(), lattice_.rounded().end());
        tile.deviation.resize(baked.exists.size());
        tile.radius.resize(baked.exists.size());
        own_deviation(lattice_, tile.deviation);
        lacks_below_.assign(tile_cells / 2, 1);
        if (baked.inner())
            for (std::size_t k = 0; k < lacks_below_.size(); ++k)
                lacks_below_[k] = !(exists_below(baked, 2 * k) && exists_below(baked, 2 * k + 1));
        corner_radii(lattice_, baked.exists, baked.inner(), lacks_below_, tile.radius);
        own_height_range(tile, baked.exists);
        measure_above(baked);
    }

    bool exists_below(const BakedTile& baked, std::size_t position) const {
        const std::int32_t below = baked.below[position];
        return below >= 0 && tiles_[static_cast<std::size_t>(below)].exists[1];
    }

    // This tile's vertices against every cell that holds its root.
    void measure_above(const BakedTile& baked) {
        const LocationCode root = baked.tile.root;
        const int levels = root.bisection_level();
        Corners c = face_corners(root.face());
        above_.clear();
        for (int level = 0; level < levels; ++level) {
            above_.push_back(c);
            c = child_corners(c, split_vertex(c), static_cast<int>(root.bits() >> (levels - 1 - level) & 1));
        }
        std::int32_t holder = baked.above;
        for (int level = levels - 1; level >= 0; --level) {
            const auto [tile_root, local] = cell_in_tile(root.ancestor(level));
            Tile& tile = tiles_[static_cast<std::size_t>(holder)].tile;
            const float found = certified_deviation(
                deviation_from(lattice_, plane_of(tile, local, above_[static_cast<std::size_t>(level)])));
            tile.deviation[local] = std::max(tile.deviation[local], found);
            if (local == 1) holder = tiles_[static_cast<std::size_t>(holder)].above;
        }
    }

    CellPlane plane_of(const Tile& tile, unsigned local, const Corners& c) const {
        const auto& vertex = tile_layout().corners[local];
        const auto at = [&](std::size_t k, const glm::dvec3& n) {
            const GeoidUndulation N = has_undulation_ ? tile.undulation[vertex[k]] : GeoidUndulation{};
            return placement_.ecef(n, static_cast<double>(tile.height[vertex[k]]), N);
        };
        return {at(0, c.left), at(1, c.right), at(2, c.apex)};
    }

    void gather_height_ranges() {
        for (std::size_t t = tiles_.size(); t-- > 0;) {
            const Tile& tile = tiles_[t].tile;
            if (tiles_[t].above < 0) continue;
            Tile& above = tiles_[static_cast<std::size_t>(tiles_[t].above)].tile;
            above.min_height = std::min(above.min_height, tile.min_height);
            above.max_height = std::max(above.max_height, tile.max_height);
        }
    }

    void write(SqliteFile& file) {
        for (const BakedTile& t : tiles_)
            report_.resampling_max_m = std::max(report_.resampling_max_m, static_cast<double>(t.tile.resampling));
        StoreMetadata m;
        m.ellipsoid = options_.ellipsoid;
        m.datum = field_.datum();
        if (has_undulation_) m.undulation = options_.undulation_name.empty() ? "unnamed" : options_.undulation_name;
        m.quantum_m = report_.quantum_m;
        m.finest_level = report_.finest_level;
        m.resampling_max_m = report_.resampling_max_m;
        m.tiles = report_.tiles;
        m.vertices = report_.vertices;
        m.sources = field_.sources();
        const TileScale scale = tile_scale(m);
        StoreWriter writer(file, m);
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            const std::vector<std::uint8_t> bytes = encode_tile(tiles_[t], scale);
            writer.write(tiles_[t].tile.root, bytes);
            report_.tile_bytes += bytes.size();
            if (t % 256 == 0) tell("writing", static_cast<double>(t) / static_cast<double>(tiles_.size()));
        }
        writer.finish();
    }

    const ElevationField& field_;
    const BakeOptions& options_;
    Placement placement_;
    bool has_undulation_ = false;
    BakeReport report_;
    std::vector<BakedTile> tiles_;
    TileLattice lattice_;
    std::vector<glm::dvec3> normals_;
    std::vector<GeoidUndulation> undulations_;
    std::vector<std::uint8_t> lacks_below_;
    std::vector<Corners> above_;
};

}  // namespace

BakeReport bake(const ElevationField& field, const BakeOptions& options, const std::filesystem::path& path) {
    Bake work(field, options);
    try {
        SqliteFile file(path, SqliteFile::Access::create);
        return work.run(file);
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        std::filesystem::remove(path.string() + "-journal", ignored);
        throw;
    }
}

ElevationStore bake_in_memory(const ElevationField& field, const BakeOptions& options, BakeReport* report) {
    Bake work(field, options);
    SqliteFile file({}, SqliteFile::Access::in_memory);
    const BakeReport done = work.run(file);
    if (report) *report = done;
    return ElevationStore(std::move(file));
}

}  // namespace planet
