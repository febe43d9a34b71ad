// octaglobe tin --tile: a folder of meshes whose borders match bit for bit, of rasters of any size.
//
// What both tiles of a border must agree on follows from its samples and one tolerance: its vertices, and the grid on which
// a .glb rounds. Where a frame curves, a sample on a border may still be too far from the triangles of either tile: then it
// becomes a vertex of both, which are made again.

#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <mutex>
#include <set>

#include "planet/elevation/raster_writer.h"
#include "planet/error.h"
#include "planet/parallel.h"
#include "render/app/figures.h"
#include "render/app/output_folder.h"
#include "render/app/progress.h"
#include "render/app/tin_looks.h"
#include "render/app/tin_source.h"
#include "render/app/tin_written.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::HeightGrid;
using planet::MeshFormat;
using planet::MeshFrame;

/// What became of a tile.
struct TileFigures {
    std::size_t triangles = 0, vertices = 0, bytes = 0, samples = 0, uncovered = 0, voids = 0, mended = 0;
    double max = 0, squares = 0, angle = std::numeric_limits<double>::infinity();
};

/// A tile's samples, those beside them, and the frame of both.
struct TileWindow {
    glm::ivec2 low, high;  ///< of the tile, in the raster
    glm::ivec2 first;      ///< of the window
    HeightGrid window, tile;
};

class TileMaker {
  public:
    TileMaker(const TinCommand& command, Report& report)
        : command_(command),
          report_(report),
          format_(command.tile_format),
          folder_("--output", *command.output),
          source_(command),
          frame_(source_.frame(frame_kind(), format_)),
          tiling_(make_tiling()),
          end_(tiling_.width() - 1, tiling_.height() - 1),
          map_(*source_.raster()),
          figures_(tiling_.count()) {
        if (curves(frame_)) {
            tangent_.emplace(source_.tangent_frame());
            scale_ = command.exaggeration * share_above_plane(*tangent_, {tiling_.width(), tiling_.height()});
        }
        if (command.error_grid)
            error_grid_ = std::make_unique<planet::RasterWriter>(command.error_grid->string(), *source_.raster());
        if (command.drape) drape_.emplace(*command.drape);
    }

    void run() {
        survey();
        make_all();
        total();
        finish_error_grid();
        folder_.commit();
        fill_report();
        tell();
    }

  private:
    using Sample = std::pair<int, int>;  // row, column

    planet::TinTiling make_tiling() const {
        constexpr std::size_t most = 1'000'000;
        const planet::TinTiling tiling(source_.raster()->width, source_.raster()->height, command_.tile);
        if (tiling.count() > most)
            throw Error(Fault::bad_usage, "--tile", std::to_string(tiling.count()) + " tiles are too many",
                        "at most " + std::to_string(most) + ": larger ones");
        return tiling;
    }
    MeshFrame frame_kind() const {
        if (command_.frame) return *command_.frame;
        return format_ == MeshFormat::glb || format_ == MeshFormat::stl ? MeshFrame::enu : MeshFrame::source;
    }

    // ---- what all tiles have in common ----

    /// By how much the format moves a vertex at most, and a .glb's grid for all tiles: that of the largest.
    void survey() {
        if (format_ == MeshFormat::ply || format_ == MeshFormat::obj) return;
        const auto step = report_.step("survey");
        const glm::dvec2 range = range_of_heights();
        for (std::size_t i = 0; i < tiling_.count(); ++i) {
            PlacedBox box = box_of_window(frame_, tiling_.low(i), tiling_.high(i), range.x, range.y);
            const glm::dvec3 spare = 0.01 * (box.high - box.low);  // the box is about right
            const auto bound = planet::rounding_bound(box.low - spare, box.high + spare, frame_.reference(), format_);
            grid_step_ = std::max(grid_step_, bound.step);
            rounding_ = std::max(rounding_, bound.z / command_.exaggeration + bound.xy);
        }
    }
    glm::dvec2 range_of_heights() {
        std::vector<glm::dvec2> ranges(tiling_.count());
        std::atomic<std::size_t> done = 0;
        planet::parallel_for(tiling_.count(), 0, [&](std::size_t i) {
            ranges[i] = height_range(source_.heights(tiling_.low(i), tiling_.high(i)));
            progress_.update("reading", static_cast<double>(++done) / static_cast<double>(tiling_.count()));
        });
        glm::dvec2 all = ranges.front();
        for (const glm::dvec2 r : ranges) all = {std::min(all.x, r.x), std::max(all.y, r.y)};
        if (all.x > all.y) refuse_void();
        return all;
    }
    [[noreturn]] void refuse_void() const {
        throw Error(Fault::bad_data, source_.raster()->name, "holds no heights: every sample is nodata or masked",
                    "one band of heights");
    }

    // ---- tiles ----

    void make_all() {
        const auto step = report_.step("tiles");
        std::vector<std::size_t> todo(tiling_.count());
        for (std::size_t i = 0; i < todo.size(); ++i) todo[i] = i;
        if (tangent_)
            for (const glm::ivec2 p : source_.pole_samples()) inserted_.insert({p.y, p.x});
        for (double done = 0; !todo.empty();) {
            std::mutex mutex;
            std::set<Sample> too_far;
            planet::parallel_for(todo.size(), 0, [&](std::size_t i) {
                const std::vector<glm::ivec2> found = make(todo[i]);
                const std::lock_guard lock(mutex);
                for (const glm::ivec2 p : found) too_far.insert({p.y, p.x});
                progress_.update("triangulating", ++done / static_cast<double>(tiling_.count()));
            });
            inserted_.insert(too_far.begin(), too_far.end());
            todo = tiles_with(too_far);
            remade_ += todo.size();
        }
    }

    TileWindow read(std::size_t tile) const {
        const glm::ivec2 low = tiling_.low(tile), high = tiling_.high(tile);
        const glm::ivec2 first = glm::max(low - ground_reach, 0), last = glm::min(high + ground_reach, end_);
        HeightGrid window = source_.heights(first, last);
        HeightGrid inner(window, low - first, high - first);
        return {low, high, first, std::move(window), std::move(inner)};
    }

    planet::TinMesh triangulate(const TileWindow& w) const {
        const double bound = *command_.max_deviation;
        planet::TiledTinOptions how;
        how.tolerance = scale_ * std::max(0.5 * bound, bound - rounding_);
        how.quality = command_.quality;
        std::optional<HeightGrid> over_plane;
        if (tangent_) over_plane.emplace(planet::heights_above_tangent_plane(w.window, tangent_->window(w.first), 1));
        planet::TinMesh mesh = planet::tin_tile(over_plane ? *over_plane : w.window, w.low - w.first, w.high - w.first,
                                                how, w.first - w.low)
                                   .mesh;
        std::vector<glm::ivec2> more;
        for (const auto& [y, x] : inserted_)
            if (w.tile.inside(glm::ivec2(x, y) - w.low)) more.push_back(glm::ivec2(x, y) - w.low);
        return more.empty() ? mesh : planet::with_samples(mesh, w.tile, more, {});
    }

    /// Makes a tile and writes it. @return samples on its border that are too far: if there are any, nothing is written
    std::vector<glm::ivec2> make(std::size_t tile) {
        const TileWindow w = read(tile);
        TileFigures& figures = figures_[tile] = {};
        planet::TinMesh mesh = triangulate(w);
        if (mesh.triangles.empty()) {
            count_samples(tile, w, {}, figures);
            return {};
        }
        TinGoal goal;
        goal.tolerance = *command_.max_deviation;
        goal.format = format_;
        goal.least_step = grid_step_;
        goal.threads = 1;
        goal.by_sample = true;
        goal.border_is_shared = true;
        WrittenTin tin = as_written(std::move(mesh), w.tile, frame_.window(w.low), goal);
        if (!tin.border_samples.empty()) {
            for (glm::ivec2& p : tin.border_samples) p += w.low;
            return std::move(tin.border_samples);
        }
        if (!tin.kept) refuse_bound(tin.deviation_max);
        if (tin.rounding.step != grid_step_)
            throw Error(Fault::check_failed, name_of(tile), "does not lie on the grid that all tiles share");
        figures.triangles = tin.surface.triangles.size();
        figures.vertices = tin.surface.vertices.size();
        figures.max = tin.deviation_max;
        figures.angle = tin.deviation.angle_min;
        figures.mended = tin.inserted;
        count_samples(tile, w, tin.deviation.by_sample, figures);
        OutputFile file("--output", folder_.path() / name_of(tile));
        figures.bytes = write_checked(file, tin, frame_.reference(), format_, looks(tin, w));
        file.commit();
        return {};
    }

    [[noreturn]] void refuse_bound(double possible) const {
        throw Error(Fault::bad_usage, "--max-deviation",
                    four_digits(*command_.max_deviation) + " m cannot be kept in such tiles, which round",
                    four_digits(possible) + " m or more, or --format ply");
    }

    planet::MeshLooks looks(const WrittenTin& tin, const TileWindow& w) const {
        planet::MeshLooks looks;
        if (format_ != MeshFormat::glb) return looks;
        looks.normals = normals_of(tin.surface);
        std::vector<std::size_t> vertices;  // on the border: neighbours must agree
        std::vector<glm::ivec2> samples;
        for (std::size_t v = 0; v < tin.mesh.vertices.size(); ++v) {
            const glm::ivec2 p = tin.mesh.vertices[v], last = w.high - w.low;
            if (p.x != 0 && p.y != 0 && p.x != last.x && p.y != last.y) continue;
            vertices.push_back(v);
            samples.push_back(p + w.low - w.first);
        }
        const std::vector<glm::vec3> ground = ground_normals(w.window, frame_.window(w.first), samples);
        for (std::size_t i = 0; i < vertices.size(); ++i) looks.normals[vertices[i]] = ground[i];
        Drape::Part part;
        if (drape_) {
            const glm::dvec2 a = map_.at(glm::dvec2(w.low)), b = map_.at(glm::dvec2(w.high));
            part = drape_->part(glm::min(a, b), glm::max(a, b));
        }
        looks.uv = texture_coordinates(tin.mesh.vertices, w.low, map_, part);
        looks.picture = std::move(part.bytes);
        return looks;
    }

    // ---- samples, each counted once ----

    /// Whether a tile has a triangle at a sample: a unit square of it there has three valid corners, the sample one of them.
    bool covers(std::size_t tile, glm::ivec2 p, const TileWindow& w) const {
        const glm::ivec2 low = tiling_.low(tile), high = tiling_.high(tile);
        const auto valid = [&](int x, int y) { return w.window.valid(glm::ivec2(x, y) - w.first); };
        for (int y = std::max(low.y, p.y - 1); y < std::min(high.y, p.y + 1); ++y)
            for (int x = std::max(low.x, p.x - 1); x < std::min(high.x, p.x + 1); ++x)
                if (valid(x, y) + valid(x + 1, y) + valid(x, y + 1) + valid(x + 1, y + 1) >= 3) return valid(p.x, p.y);
        return false;
    }

    /// A sample on a border counts in the last tile that covers it; one that none does, in the last that has it.
    void count_samples(std::size_t tile, const TileWindow& w, const std::vector<float>& deviation,
                       TileFigures& figures) {
        std::size_t i = 0;
        for (int y = w.low.y; y <= w.high.y; ++y)
            for (int x = w.low.x; x <= w.high.x; ++x, ++i) {
                const double d = deviation.empty() ? std::nan("") : static_cast<double>(deviation[i]);
                const bool on_border = x == w.low.x || y == w.low.y || x == w.high.x || y == w.high.y;
                if (on_border && !counts_here(tile, {x, y}, !std::isnan(d), w)) continue;
                count({x, y}, d, w, figures);
                const bool next_tiles = (x == w.high.x && x < end_.x) || (y == w.high.y && y < end_.y);
                if (error_grid_ && next_tiles && !std::isnan(d)) keep_deviation({y, x}, deviation[i]);
            }
        write_deviations(w, deviation);
    }
    bool counts_here(std::size_t tile, glm::ivec2 p, bool covered, const TileWindow& w) const {
        for (const std::size_t other : tiles_at(p)) {
            if (other == tile) continue;
            if (covers(other, p, w) ? other > tile || !covered : other > tile && !covered) return false;
        }
        return true;
    }
    static void count(glm::ivec2 p, double deviation, const TileWindow& w, TileFigures& figures) {
        if (!w.window.valid(p - w.first)) {
            ++figures.voids;
        } else if (std::isnan(deviation)) {
            ++figures.uncovered;
        } else {
            ++figures.samples;
            figures.squares += deviation * deviation;
        }
    }
    /// Of a sample that the next tile has too, but no triangle at it.
    void keep_deviation(Sample p, float deviation) {
        const std::lock_guard lock(error_grid_mutex_);
        kept_deviations_[p] = deviation;
    }
    void finish_error_grid() {
        if (!error_grid_) return;
        for (const auto& [p, deviation] : kept_deviations_)
            error_grid_->write({p.second, p.first, 1, 1}, std::span(&deviation, 1));
        error_grid_->finish();
    }
    void write_deviations(const TileWindow& w, const std::vector<float>& deviation) {
        if (!error_grid_) return;
        const glm::ivec2 size = w.high - w.low + 1;
        const planet::SampleWindow own{w.low.x, w.low.y, size.x - (w.high.x < end_.x), size.y - (w.high.y < end_.y)};
        std::vector<float> samples;
        for (int y = 0; y < own.rows && !deviation.empty(); ++y) {
            const auto row = deviation.begin() + std::ptrdiff_t{y} * size.x;
            samples.insert(samples.end(), row, row + own.columns);
        }
        samples.resize(own.count(), std::nanf(""));
        const std::lock_guard lock(error_grid_mutex_);
        error_grid_->write(own, samples);
    }

    // ---- the tiling ----

    std::vector<std::size_t> tiles_at(glm::ivec2 p) const {
        std::vector<std::size_t> tiles;
        const int step = command_.tile;
        for (int row = std::max(0, (p.y - 1) / step); row <= std::min(tiling_.rows() - 1, p.y / step); ++row)
            for (int column = std::max(0, (p.x - 1) / step); column <= std::min(tiling_.columns() - 1, p.x / step);
                 ++column)
                tiles.push_back(static_cast<std::size_t>(row) * static_cast<std::size_t>(tiling_.columns()) +
                                static_cast<std::size_t>(column));
        return tiles;
    }
    std::vector<std::size_t> tiles_with(const std::set<Sample>& samples) const {
        std::set<std::size_t> tiles;
        for (const auto& [y, x] : samples)
            for (const std::size_t tile : tiles_at({x, y})) tiles.insert(tile);
        return {tiles.begin(), tiles.end()};
    }

    std::string name_of(std::size_t tile) const {
        const auto columns = static_cast<std::size_t>(tiling_.columns());
        const auto number = [](std::size_t i, int last) {
            const std::string text = std::to_string(i);
            return std::string(std::to_string(last).size() - text.size(), '0') + text;
        };
        constexpr const char* endings[] = {".glb", ".ply", ".obj", ".stl"};
        return "row" + number(tile / columns, tiling_.rows() - 1) + "_column" +
               number(tile % columns, tiling_.columns() - 1) + endings[static_cast<std::size_t>(format_)];
    }

    // ---- what is told ----

    void total() {
        for (const TileFigures& f : figures_) {
            all_.triangles += f.triangles;
            all_.vertices += f.vertices;
            all_.bytes += f.bytes;
            all_.samples += f.samples;
            all_.uncovered += f.uncovered;
            all_.voids += f.voids;
            all_.mended += f.mended;
            all_.squares += f.squares;
            all_.max = std::max(all_.max, f.max);
            all_.angle = std::min(all_.angle, f.angle);
            written_ += f.triangles > 0;
        }
        if (written_ == 0) refuse_void();
    }
    double rms() const { return std::sqrt(all_.squares / static_cast<double>(all_.samples)); }

    void fill_report() {
        constexpr std::string_view frames[] = {"source", "utm", "enu", "ecef"};
        const planet::MeshReference& reference = frame_.reference();
        report_.set("tiles", written_);
        report_.set("tiles_void", tiling_.count() - written_);
        report_.set("tile_rows", tiling_.rows());
        report_.set("tile_columns", tiling_.columns());
        report_.set("tile_samples", command_.tile);
        report_.set("tiles_remade", remade_);
        report_.set("triangles", all_.triangles);
        report_.set("vertices", all_.vertices);
        report_.set("frame", frames[static_cast<std::size_t>(reference.frame)]);
        report_.set("crs", reference.crs);
        report_.set("vertical_datum", reference.vertical_datum);
        report_.set("deviation_max_m", all_.max);
        report_.set("deviation_rms_m", rms());
        report_.set("tolerance_m", *command_.max_deviation);
        report_.set("stopped_by", "deviation");
        report_.set("angle_min_deg", all_.angle / planet::degrees);
        report_.set("samples", all_.samples);
        report_.set("samples_uncovered", all_.uncovered);
        report_.set("samples_void", all_.voids);
        report_.set("samples_mended", all_.mended + inserted_.size());
        report_.set("rounding_step", grid_step_);
        report_.set("exaggeration", command_.exaggeration);
        report_.set("output", command_.output->string());
        report_.set("output_bytes", all_.bytes);
        if (command_.error_grid) report_.set("error_grid", command_.error_grid->string());
        report_.set("source", source_.raster()->name);
        report_.set("columns", tiling_.width());
        report_.set("rows", tiling_.height());
    }

    void tell() {
        progress_.clear();
        std::cout << grouped(written_) << " tiles of " << grouped(all_.triangles) << " triangles; deviation at most "
                  << four_digits(all_.max) << " m, rms " << four_digits(rms()) << " m over " << grouped(all_.samples)
                  << " samples\n";
    }

    const TinCommand& command_;
    Report& report_;
    Progress progress_;
    const MeshFormat format_;
    OutputFolder folder_;
    const TinSource source_;
    const planet::RasterFrame frame_;
    std::optional<planet::RasterFrame> tangent_;
    const planet::TinTiling tiling_;
    const glm::ivec2 end_;  ///< the last sample
    const DrapeMap map_;
    std::optional<Drape> drape_;
    std::unique_ptr<planet::RasterWriter> error_grid_;
    std::mutex error_grid_mutex_;
    std::map<Sample, float> kept_deviations_;

    double grid_step_ = 0, rounding_ = 0;
    double scale_ = 1;           ///< of the tolerance, for heights above a plane
    std::set<Sample> inserted_;  ///< on borders; changes between passes only
    std::vector<TileFigures> figures_;
    TileFigures all_;
    std::size_t written_ = 0, remade_ = 0;
};

}  // namespace

void tin_tiles(const TinCommand& command, Report& report) {
    TileMaker(command, report).run();
}

}  // namespace render
