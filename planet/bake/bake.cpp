#include "planet/bake/bake.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "planet/bake/coverage.h"
#include "planet/bake/file.h"
#include "planet/bake/run.h"
#include "planet/bake/tiles.h"
#include "planet/error.h"
#include "planet/octahedron/cell_metrics.h"

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
    check_range("the first tile level", o.first_tile_level, 0, tile_levels);
    check_range("the number of tiles in a transaction", o.transaction_tiles, 1, 1e6);
    check_range("the number of threads", o.threads, 0, 4096);
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
    Bake(const ElevationField& field, const BakeOptions& options) : field_(field), options_(options) {
        check(options);
        metadata_.ellipsoid = options.ellipsoid;
        metadata_.datum = field.datum();
        if (options.undulation && field.datum() != VerticalDatum::ellipsoid)
            metadata_.undulation = options.undulation_name.empty() ? "unnamed" : options.undulation_name;
        metadata_.sources = field.sources();
        metadata_.settings = {options.least_level, options.finest_level, options.extra_levels, options.quantum_m};
    }

    /// What is known without looking at the field.
    const StoreMetadata& metadata() const { return metadata_; }

    /// Which tiles there are; completes the metadata.
    void plan() {
        tell("coverage", 0);
        const auto begin = std::chrono::steady_clock::now();
        const double radius = options_.ellipsoid.mean_radius();
        plan_ = coverage(field_, {.mean_radius_m = radius,
                                  .least_level = options_.least_level,
                                  .finest_level = options_.finest_level,
                                  .extra_levels = options_.extra_levels,
                                  .first_tile_level = options_.first_tile_level,
                                  .memory_bytes = options_.memory_bytes / 2});
        if (!has_memory_for(options_, plan_)) refuse_memory(options_);
        metadata_.layers = plan_.layers();
        metadata_.finest_level = plan_.finest_level();
        metadata_.quantum_m = options_.quantum_m > 0 ? options_.quantum_m : quantum_for(metadata_.finest_level, radius);
        metadata_.tiles = plan_.tiles();
        metadata_.vertices = plan_.vertices();
        metadata_.vertices_by_level = plan_.vertices_by_level();
        report_.seconds.emplace_back("coverage",
                                     std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        tell("coverage", 1);
    }

    /// @returns the connection, if the store is in memory
    std::optional<SqliteFile> run(BakeFile& file) {
        const BakeScene scene{field_, options_, plan_, tile_scale(metadata_)};
        BakeRun tiles(scene, plan_, file);
        tell("tiles", 0);
        tiles.run();
        tell("tiles", 1);
        report(metadata_);
        report_.resampling_max_m = tiles.resampling_max_m();
        report_.tile_bytes = file.tile_bytes();
        report_.vertices_resumed = tiles.vertices_resumed();
        report_.memory_bytes = tiles.most_memory_bytes();
        const auto& seconds = tiles.seconds();
        constexpr const char* names[bake_steps] = {"resampling", "deviation", "settling", "certifying", "compression"};
        for (std::size_t s = 0; s < bake_steps; ++s) report_.seconds.emplace_back(names[s], seconds[s]);
        const auto begin = std::chrono::steady_clock::now();
        tell("finishing", 0);
        std::optional<SqliteFile> finished = file.finish();
        tell("finishing", 1);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        report_.seconds.emplace_back("writing", tiles.writing_seconds() + took.count());
        return finished;
    }

    BakeReport& report(const StoreMetadata& m) {
        report_.tiles = m.tiles;
        report_.vertices = m.vertices;
        report_.layers = m.layers;
        report_.finest_level = m.finest_level;
        report_.quantum_m = m.quantum_m;
        report_.resampling_max_m = m.resampling_max_m;
        return report_;
    }
    const BakeReport& report() const { return report_; }

  private:
    void tell(std::string_view name, double fraction) const {
        if (options_.progress) options_.progress(name, fraction);
    }

    const ElevationField& field_;
    const BakeOptions& options_;
    StoreMetadata metadata_;
    TilePlan plan_;
    BakeReport report_;
};

}  // namespace

BakeReport bake(const ElevationField& field, const BakeOptions& options, const std::filesystem::path& path) {
    if (const auto store = store_of_leftover(path); !store.empty())
        throw Error(Fault::bad_usage, path.string(), "is what a bake into " + store.string() + " may leave",
                    "another name");
    Bake work(field, options);
    if (options.resume && !options.replace) {
        if (const auto finished = BakeFile::finished(path, work.metadata())) {
            BakeReport& done = work.report(*finished);
            done.vertices_resumed = finished->vertices;
            return done;
        }
    } else if (!options.replace && std::filesystem::exists(path)) {
        throw Error(Fault::bad_usage, path.string(), "the file is there already",
                    "another name, --replace, or --resume for a store that is not finished");
    }
    work.plan();
    const auto file = options.resume && !options.replace ? BakeFile::resume(path, work.metadata())
                                                         : BakeFile::begin(path, work.metadata());
    work.run(*file);
    return work.report();
}

ElevationStore bake_in_memory(const ElevationField& field, const BakeOptions& options, BakeReport* report) {
    Bake work(field, options);
    work.plan();
    BakeFile file(SqliteFile({}, SqliteFile::Access::in_memory), work.metadata());
    std::optional<SqliteFile> finished = work.run(file);
    if (report) *report = work.report();
    return ElevationStore(std::move(*finished));
}

}  // namespace planet
