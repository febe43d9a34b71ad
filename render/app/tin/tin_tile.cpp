#include "render/app/tin/tin_tile.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <tuple>

#include "planet/error.h"
#include "planet/parallel.h"
#include "render/app/mesh/raster_frames.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::HeightGrid;
using planet::MeshFormat;

bool before(glm::ivec2 p, glm::ivec2 q) {
    return std::tie(p.y, p.x) < std::tie(q.y, q.x);
}

/// What holds the solids of all tiles.
TinFloor lower(const TinFloor& a, const TinFloor& b) {
    TinFloor floor{std::min(a.height, b.height), a.z};
    if (b.z && !(floor.z < b.z)) floor.z = b.z;
    return floor;
}

}  // namespace

TileMaker::TileMaker(const TinCommand& command, const TinSource& source)
    : command_(command),
      source_(source),
      frame_(source.frame(command.frame.value_or(usual_frame(command.tile_format)), command.tile_format)),
      tiling_(make_tiling()),
      map_(*source.raster(), command.drape ? command.drape->string() : "") {
    if (curves(frame_)) {
        tangent_.emplace(source.tangent_frame());
        scale_ = command.exaggeration * share_above_plane(*tangent_, {tiling_.width(), tiling_.height()});
    } else if (!frame_.affine()) {
        scale_ = 1 - curve_spare;
    }
    if (command.drape) drape_.emplace(*command.drape);
}

planet::TinTiling TileMaker::make_tiling() const {
    constexpr std::size_t most = 1'000'000;
    const planet::TinTiling tiling(source_.raster()->width, source_.raster()->height, command_.tile);
    if (tiling.count() > most)
        throw Error(Fault::bad_usage, "--tile", std::to_string(tiling.count()) + " tiles are too many",
                    "at most " + std::to_string(most) + ": larger ones");
    return tiling;
}

void TileMaker::refuse_void() const {
    throw Error(Fault::bad_data, source_.raster()->name, "holds no heights: every sample is nodata or masked",
                "one band of heights");
}

void TileMaker::survey(Progress& progress) {
    const bool rounds = command_.tile_format == MeshFormat::glb || command_.tile_format == MeshFormat::stl;
    if (!rounds && !command_.base) return;
    constexpr double none = std::numeric_limits<double>::infinity();
    glm::dvec2 range(none, -none);
    std::atomic<std::size_t> done = 0;
    std::mutex mutex;
    planet::parallel_for(tiling_.count(), 0, [&](std::size_t i) {
        const HeightGrid tile = source_.heights(tiling_.low(i), tiling_.high(i));
        const glm::dvec2 own = height_range(tile);
        progress.update("reading", static_cast<double>(++done) / static_cast<double>(tiling_.count()));
        if (own.x > own.y) return;
        std::optional<TinFloor> floor;
        if (command_.base) floor = floor_below(tile, frame_.window(tiling_.low(i)), *command_.base);
        const std::lock_guard lock(mutex);
        range = {std::min(range.x, own.x), std::max(range.y, own.y)};
        if (floor) floor_ = floor_ ? lower(*floor_, *floor) : *floor;
    });
    if (range.x > range.y) refuse_void();
    if (!rounds) return;
    for (std::size_t i = 0; i < tiling_.count(); ++i) {
        PlacedBox box =
            box_of_window(frame_, tiling_.low(i), tiling_.high(i), floor_ ? floor_->height : range.x, range.y);
        if (floor_ && floor_->z) box.low.z = std::min(box.low.z, *floor_->z);
        const glm::dvec3 spare = 0.01 * (box.high - box.low);  // the box is about right
        const auto bound =
            planet::rounding_bound(box.low - spare, box.high + spare, frame_.reference(), command_.tile_format);
        grid_step_ = std::max(grid_step_, bound.step);
        rounding_ = std::max(rounding_, bound.z / command_.exaggeration + bound.xy);
    }
}

TileWindow TileMaker::read(std::size_t tile) const {
    const glm::ivec2 low = tiling_.low(tile), high = tiling_.high(tile), end(tiling_.width() - 1, tiling_.height() - 1);
    const glm::ivec2 first = glm::max(low - ground_reach, 0), last = glm::min(high + ground_reach, end);
    HeightGrid window = source_.heights(first, last);
    HeightGrid inner(window, low - first, high - first);
    return {low, high, first, std::move(window), std::move(inner)};
}

std::optional<MadeTile> TileMaker::make(const TileWindow& w, const planet::TinTileNeeds& needs,
                                        const TileAim& aim) const {
    planet::TiledTinOptions how;
    how.tolerance = scale_ * std::max(0.5 * aim.tolerance, aim.tolerance - rounding_);  // what that leaves is mended
    how.quality = command_.quality;
    how.metric = command_.measure.in_tiles();
    how.least_priority = aim.least_priority;
    std::optional<HeightGrid> over_plane;
    if (tangent_) over_plane.emplace(planet::heights_above_tangent_plane(w.window, tangent_->window(w.first), 1));
    const HeightGrid& grid = over_plane ? *over_plane : w.window;

    planet::TinTileNeeds moved{needs.border, planet::moved(needs.features, -w.first)};
    for (glm::ivec2& p : moved.border) p -= w.first;
    const glm::ivec2 low = w.low - w.first, high = w.high - w.first;
    planet::TinTile tile = planet::tin_tile(grid, low, high, how, w.first - w.low, moved);
    if (tile.mesh.triangles.empty()) return std::nullopt;

    TinGoal goal;
    if (aim.least_priority == 0) goal.tolerance = aim.tolerance;
    goal.format = command_.tile_format;
    goal.least_step = grid_step_;
    goal.threads = 1;
    goal.by_sample = true;
    goal.border_is_shared = true;
    goal.floor = floor_;
    MadeTile made{as_written(std::move(tile.mesh), w.tile, frame_.window(w.low), goal), tile.features, {}};

    for (const glm::ivec2 p : made.tin.border_samples) made.needed.push_back(p + w.low);
    std::vector<glm::ivec2> agreed = planet::tile_border(grid, low, high, how.bound(), moved.border);
    std::ranges::sort(agreed, before);
    for (const glm::ivec2 p : made.tin.mesh.vertices)
        if (tiling_.tiles_at(p + w.low).size() > 1 && !std::ranges::binary_search(agreed, p + low, before))
            made.needed.push_back(p + w.low);
    return made;
}

planet::MeshLooks TileMaker::looks(const WrittenTin& tin, const TileWindow& w) const {
    planet::MeshLooks looks;
    if (command_.tile_format != MeshFormat::glb || command_.base) return looks;
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
    const std::vector<glm::dvec2> places = map_.at(tin.mesh.vertices, w.low);
    Drape::Part part;
    if (drape_) part = drape_->part(places);
    looks.uv = texture_coordinates(places, part);
    looks.picture = std::move(part.bytes);
    return looks;
}

}  // namespace render
