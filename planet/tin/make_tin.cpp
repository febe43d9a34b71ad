#include "planet/tin/make_tin.h"

#include <chrono>

#include "planet/error.h"
#include "planet/tin/prune.h"
#include "planet/tin/triangle_scan.h"
#include "planet/tin/void_border.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class Steps {
  public:
    explicit Steps(TinResult& result) : result_(result) {}
    void done(const char* step) {
        const auto now = std::chrono::steady_clock::now();
        result_.seconds.emplace_back(step, std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }

  private:
    TinResult& result_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

GreedyOptions greedy_options(const TinOptions& options, TinMeasure* measure) {
    GreedyOptions out;
    out.tolerance = options.tolerance;
    out.max_triangles = options.max_triangles;
    out.measure = measure;
    out.stages = options.stages;
    out.at_stage = options.at_stage;
    return out;
}

// Under a budget, pruning at the deviation that was reached makes room, which is filled again, and so on: each round
// ends in the best state of its own, so none is worse than the one before.
void improve_within_budget(Delaunay& mesh, const HeightGrid& grid, GreedyOptions options, GreedyReport& report,
                           std::size_t required, TinQuality quality, TinResult& result) {
    options.stages.clear();
    const int rounds = quality == TinQuality::best ? 12 : 2;
    for (int round = 0; round < rounds && report.end == GreedyEnd::budget; ++round) {
        Delaunay pruned = mesh;
        const std::size_t removed =
            prune(pruned, grid, {report.deviation_max, 1, std::vector<std::uint8_t>(required, 1)});
        if (removed == 0) break;
        Delaunay next = pruned.compacted();
        const GreedyReport now = insert_greedily(next, grid, options);
        if (!(now.deviation_max < report.deviation_max)) break;
        const bool worth_more = now.deviation_max < 0.995 * report.deviation_max;
        result.pruned += removed;
        result.insertions += now.insertions - now.taken_back + now.filled_up;
        mesh = std::move(next);
        report = now;
        if (!worth_more) break;
    }
}

void make_as_one(const HeightGrid& grid, const TinOptions& options, TinResult& result) {
    Steps steps(result);
    Delaunay mesh = coarsest_tin(grid);
    result.features = insert_features(mesh, grid, options.features);
    const std::size_t required = mesh.vertex_slots();
    steps.done("features");
    std::unique_ptr<TinMeasure> own;
    if (!options.measure && options.metric != TinMetric::local) own = make_measure(options.metric, grid);
    const GreedyOptions greedy = greedy_options(options, options.measure ? options.measure : own.get());
    GreedyReport report = insert_greedily(mesh, grid, greedy);
    result.insertions = report.insertions - report.taken_back + report.filled_up;
    steps.done("insertion");
    if (options.quality != TinQuality::fast) {
        const bool by_deviation = !greedy.measure || !greedy.measure->adds_up();
        if (report.end == GreedyEnd::tolerance) {
            const int passes = options.quality == TinQuality::best ? 8 : 1;
            result.pruned = prune(mesh, grid, {options.tolerance, passes, std::vector<std::uint8_t>(required, 1)});
        } else if (by_deviation) {
            improve_within_budget(mesh, grid, greedy, report, required, options.quality, result);
        }
        steps.done("pruning");
    }
    result.end = report.end;
    result.mesh = triangles_over_samples(mesh, grid);
}

// A tile has two triangles at least, however large the tolerance.
bool is_mostly_borders(const TinMesh& mesh, const TinTiling& tiling) {
    constexpr std::size_t few = 10;  // triangles a tile: about there tiles and one mesh come to the same number
    return tiling.count() > 1 && mesh.triangles.size() < few * tiling.count();
}

}  // namespace

TinResult make_tin(const HeightGrid& grid, const TinOptions& options) {
    if (!(options.tolerance >= 0))
        throw Error(Fault::bad_usage, "the tolerance", std::to_string(options.tolerance) + " m", "0 or more");
    TinResult result;
    const bool in_tiles = options.max_triangles == std::numeric_limits<std::size_t>::max() &&
                          options.features.empty() && options.metric == TinMetric::local && !options.measure &&
                          options.stages.empty();
    const auto make_whole = [&](TinResult& out) {
        if (options.heights)
            make_as_one(options.heights({0, 0}, {grid.width() - 1, grid.height() - 1}), options, out);
        else
            make_as_one(grid, options, out);
    };
    if (!in_tiles) {
        make_whole(result);
        return result;
    }
    Steps steps(result);
    const TiledTinOptions how{options.tolerance, options.quality, options.threads};
    const TinTiling tiling(grid.width(), grid.height(), tiled_tin_step);
    if (options.heights) {
        std::vector<TinTile> tiles;
        tin_tiles(tiling, options.heights, how, [&](TinTile&& tile) { tiles.push_back(std::move(tile)); });
        result.mesh = joined(std::move(tiles));
    } else {
        result.mesh = tiled_tin(grid, how);
    }
    steps.done("insertion");
    if (is_mostly_borders(result.mesh, tiling)) {
        TinResult whole;
        make_whole(whole);
        if (whole.mesh.triangles.size() < result.mesh.triangles.size()) return whole;
    }
    return result;
}

}  // namespace planet
