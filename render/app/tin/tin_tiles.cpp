// octaglobe tin --tile: a folder of meshes whose borders match bit for bit, of rasters of any size.
//
// What both tiles of a border must agree on follows from its samples and one bound: its vertices, and the grid on which
// a .glb rounds. Where a tile needs another vertex on its border, as a sample is too far in a frame that curves, or where
// features cross, it becomes one of both tiles, which are made again.

#include <cmath>
#include <iostream>
#include <map>
#include <mutex>
#include <set>
#include <unordered_map>

#include "planet/error.h"
#include "planet/parallel.h"
#include "planet/tin/tiled_features.h"
#include "render/app/figures.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/output_folder.h"
#include "render/app/temporary_names.h"
#include "render/app/tin/tin_budget.h"
#include "render/app/tin/tin_tile.h"
#include "render/app/tin/tin_tile_samples.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

/// What became of a tile.
struct TileFigures {
    std::size_t triangles = 0;  ///< of the TIN: without the walls and the floor of a solid
    std::size_t written_triangles = 0, vertices = 0, bytes = 0, mended = 0;
    SampleCount samples;
    planet::FeatureReport features;
    double max = 0, angle = std::numeric_limits<double>::infinity();
    bool kept = true;  ///< the tolerance

    TileFigures& operator+=(const TileFigures& other) {
        triangles += other.triangles;
        written_triangles += other.written_triangles;
        vertices += other.vertices;
        bytes += other.bytes;
        mended += other.mended;
        samples += other.samples;
        features += other.features;
        max = std::max(max, other.max);
        angle = std::min(angle, other.angle);
        kept = kept && other.kept;
        return *this;
    }
};

class TinFolder {
  public:
    TinFolder(const TinCommand& command, Report& report)
        : command_(command),
          report_(report),
          folder_("--output", *command.output),
          source_(command),
          maker_(command, source_),
          tiling_(maker_.tiling()),
          figures_(tiling_.count()) {
        if (command.error_grid)
            error_grid_ =
                std::make_unique<planet::RasterWriter>(command.error_grid->string(), *source_.raster(), make_listed);
        samples_.emplace(tiling_, error_grid_.get());
    }

    void run() {
        read_features();
        {
            const auto step = report_.step("survey");
            maker_.survey(progress_);
        }
        const TileAim aim = command_.max_triangles ? aim_for_budget() : TileAim{*command_.max_deviation};
        {
            const auto step = report_.step("tiles");
            make_all(aim, true);
        }
        check_budget();
        if (error_grid_) {
            samples_->write_the_rest();
            error_grid_->finish();
        }
        folder_.commit();
        fill_report();
        tell();
    }

  private:
    using Needs = std::unordered_map<std::size_t, planet::TinTileNeeds>;

    // ---- what tiles must have ----

    void read_features() {
        if (!command_.features.empty()) {
            const auto step = report_.step("features");
            const planet::TinFeatures features = source_.features();
            features_outside_ = features.outside;
            needs_ = planet::cut_into_tiles(features, tiling_);
        }
        if (curves(maker_.frame()))
            for (const glm::ivec2 p : source_.pole_samples()) need(needs_, p);
    }
    /// @return tiles
    std::vector<std::size_t> need(Needs& needs, glm::ivec2 sample) const {
        std::vector<std::size_t> tiles = tiling_.tiles_at(sample);
        for (const std::size_t tile : tiles) needs[tile].border.push_back(sample);
        return tiles;
    }

    // ---- the budget ----

    /// By making all tiles several times, unwritten.
    TileAim aim_for_budget() {
        const auto step = report_.step("search");
        const std::size_t budget = *command_.max_triangles;
        const auto triangles = [&](double length) {
            make_all(aim_of(length), false);
            return all_.triangles;
        };
        const double least = command_.measure.plain() ? command_.max_deviation.value_or(0) : 0;
        if (command_.max_deviation && triangles(least) <= budget) return aim_of(least);
        by_budget_ = true;
        constexpr double most = 1e7;
        const BudgetFit found = fit_to_budget(triangles, budget, least, most);
        report_.set("search_trials", found.trials);
        if (found.triangles > budget)
            throw Error(Fault::bad_usage, "--max-triangles", std::to_string(budget) + " are fewer than the tiles need",
                        std::to_string(found.triangles) + " or more, or larger tiles");
        return aim_of(found.tolerance);
    }
    /// For the search, which looks for a length: a tolerance; or, as triangles fall alike with it on most terrain, the square
    /// root of the distances in a triangle, the cube root of their squares.
    TileAim aim_of(double length) const {
        if (command_.measure.plain()) return {length};
        const bool squares = command_.measure.in_tiles() == planet::TinMetric::rms;
        return {command_.max_deviation.value_or(0), squares ? length * length * length : length * length};
    }
    void check_budget() const {
        if (by_budget_ && all_.triangles > *command_.max_triangles)
            throw Error(Fault::check_failed, "the tiles", "have more triangles than when they were tried");
    }

    // ---- tiles ----

    /// The same figures whenever called with an aim.
    void make_all(const TileAim& aim, bool written) {
        Needs needs = needs_;
        std::vector<std::size_t> todo(tiling_.count());
        for (std::size_t i = 0; i < todo.size(); ++i) todo[i] = i;
        remade_ = 0;
        shared_ = 0;
        for (double done = 0; !todo.empty();) {
            std::mutex mutex;
            std::set<std::pair<int, int>> needed;  // row, column
            planet::parallel_for(todo.size(), 0, [&](std::size_t i) {
                const auto own = needs.find(todo[i]);
                const std::vector<glm::ivec2> found =
                    make(todo[i], own == needs.end() ? planet::TinTileNeeds{} : own->second, aim, written);
                const std::lock_guard lock(mutex);
                for (const glm::ivec2 p : found) needed.insert({p.y, p.x});
                progress_.update(written ? "triangulating" : "trying", ++done / static_cast<double>(tiling_.count()));
            });
            std::set<std::size_t> again;
            for (const auto& [y, x] : needed)
                for (const std::size_t tile : need(needs, {x, y})) again.insert(tile);
            todo.assign(again.begin(), again.end());
            remade_ += todo.size();
            shared_ += needed.size();
        }
        all_ = {};
        for (const TileFigures& figures : figures_) all_ += figures;
        if (all_.triangles == 0) maker_.refuse_void();
    }

    /// @return samples on its border that it needs to share: if there are any, nothing is written
    std::vector<glm::ivec2> make(std::size_t tile, const planet::TinTileNeeds& needs, const TileAim& aim,
                                 bool written) {
        const TileWindow w = maker_.read(tile);
        TileFigures& figures = figures_[tile] = {};
        std::optional<MadeTile> made = maker_.make(w, needs, aim);
        if (!made) {
            if (written) figures.samples = samples_->count(tile, w, {});
            return {};
        }
        if (!made->needed.empty()) return std::move(made->needed);
        const WrittenTin& tin = made->tin;
        if (!tin.kept && !by_budget_) refuse_bound(aim.tolerance, tin.deviation_max, command_.tile_format);
        figures.triangles = tin.mesh.triangles.size();
        figures.written_triangles = tin.surface.triangles.size();
        figures.vertices = tin.surface.vertices.size();
        figures.mended = tin.inserted;
        figures.features = made->features;
        figures.max = tin.deviation_max;
        figures.angle = tin.deviation.angle_min;
        figures.kept = tin.kept;
        if (!written) return {};
        figures.samples = samples_->count(tile, w, tin.deviation.by_sample);
        figures.bytes = write(tile, w, tin);
        return {};
    }

    /// @return bytes
    std::size_t write(std::size_t tile, const TileWindow& w, const WrittenTin& tin) const {
        const std::string name = name_of(tile);
        if (tin.rounding.step != maker_.grid_step())
            throw Error(Fault::check_failed, name, "does not lie on the grid that all tiles share");
        if (command_.base) check_closed(tin.surface, maker_.frame().reference().frame);
        OutputFile file("--output", folder_.path() / name, *command_.output / name);
        const std::size_t bytes =
            write_checked(file, tin, maker_.frame().reference(), command_.tile_format, maker_.looks(tin, w));
        file.commit();
        return bytes;
    }

    std::string name_of(std::size_t tile) const {
        const auto columns = static_cast<std::size_t>(tiling_.columns());
        const auto number = [](std::size_t i, int last) {
            const std::string text = std::to_string(i);
            return std::string(std::to_string(last).size() - text.size(), '0') + text;
        };
        constexpr const char* endings[] = {".glb", ".ply", ".obj", ".stl"};
        return "row" + number(tile / columns, tiling_.rows() - 1) + "_column" +
               number(tile % columns, tiling_.columns() - 1) + endings[static_cast<std::size_t>(command_.tile_format)];
    }

    // ---- what is told ----

    double rms() const { return std::sqrt(all_.samples.squares / static_cast<double>(all_.samples.covered)); }
    std::size_t tiles_written() const {
        return static_cast<std::size_t>(std::ranges::count_if(figures_, [](const auto& f) { return f.triangles > 0; }));
    }

    void fill_report() {
        report_.set("tiles", tiles_written());
        report_.set("tiles_void", tiling_.count() - tiles_written());
        report_.set("tile_rows", tiling_.rows());
        report_.set("tile_columns", tiling_.columns());
        report_.set("tile_samples", command_.tile);
        report_.set("tiles_remade", remade_);
        report_.set("triangles", all_.written_triangles);
        report_.set("vertices", all_.vertices);
        report_reference(maker_.frame().reference(), report_);
        report_.set("deviation_max_m", all_.max);
        report_.set("deviation_rms_m", rms());
        if (command_.max_deviation) report_.set("tolerance_m", *command_.max_deviation);
        report_.set("stopped_by", stopped_by());
        report_.set("angle_min_deg", all_.angle / planet::degrees);
        report_.set("samples", all_.samples.covered);
        report_.set("samples_uncovered", all_.samples.uncovered);
        report_.set("samples_void", all_.samples.voids);
        report_.set("samples_mended", all_.mended + shared_);
        report_.set("rounding_step", maker_.grid_step());
        report_.set("exaggeration", command_.exaggeration);
        if (command_.base) {
            report_.set("base_m", *command_.base);
            report_.set("closed", true);
        }
        if (!command_.features.empty()) report_features(all_.features, features_outside_, report_);
        report_.set("output", command_.output->string());
        report_.set("output_bytes", all_.bytes);
        if (command_.error_grid) report_.set("error_grid", command_.error_grid->string());
        report_.set("source", source_.raster()->name);
        report_.set("columns", tiling_.width());
        report_.set("rows", tiling_.height());
    }

    std::string stopped_by() const { return by_budget_ ? "triangles" : "deviation"; }

    void tell() {
        progress_.clear();
        std::cout << grouped(tiles_written()) << " tiles of " << grouped(all_.written_triangles)
                  << " triangles; deviation at most " << four_digits(all_.max) << " m, rms " << four_digits(rms())
                  << " m over " << grouped(all_.samples.covered) << " samples; stopped by the " << stopped_by() << "\n";
    }

    const TinCommand& command_;
    Report& report_;
    Progress progress_;
    OutputFolder folder_;
    const TinSource source_;
    TileMaker maker_;
    const planet::TinTiling& tiling_;
    std::unique_ptr<planet::RasterWriter> error_grid_;
    std::optional<TileSamples> samples_;
    Needs needs_;  ///< of features and poles
    std::size_t features_outside_ = 0;
    bool by_budget_ = false;  ///< else by the deviation
    std::vector<TileFigures> figures_;
    TileFigures all_;
    std::size_t remade_ = 0;  ///< tiles
    std::size_t shared_ = 0;  ///< samples on borders that tiles asked for
};

}  // namespace

void tin_tiles(const TinCommand& command, Report& report) {
    TinFolder(command, report).run();
}

}  // namespace render
