#include "render/app/tin/tin_source.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "planet/elevation/elevation_sources.h"
#include "planet/error.h"
#include "planet/tin/mosaic_grid.h"
#include "render/app/mesh/mesh_keep.h"
#include "render/app/mesh/raster_frames.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFrame;

/// 4 GB of heights.
constexpr std::size_t most_samples = std::size_t{1} << 30;

/// What GDAL keeps of a file's blocks.
constexpr std::size_t least_cache = std::size_t{32} << 20, most_cache = std::size_t{512} << 20;

planet::RasterOptions raster_options() {
    planet::RasterOptions how;
    how.plain = true;
    return how;
}

/// Of compressed files a row of tiles is kept, so that it need not be decoded again for each.
std::size_t cache_for(const planet::MosaicPart& part, int tile) {
    constexpr int columns = 260;  // that a part's decoded_bytes are for
    return std::min(most_cache, part.decoded_bytes * static_cast<std::size_t>(1 + tile / columns));
}

std::unique_ptr<const planet::RasterMosaic> open_mosaic(const std::vector<std::string>& patterns, int tile) {
    std::vector<planet::MosaicPart> parts;
    std::size_t cache = least_cache;
    for (const std::string& pattern : patterns)
        for (const std::string& file : planet::files_of_pattern(pattern)) {
            planet::MosaicPart part = planet::mosaic_part(file, raster_options());
            if (!parts.empty() && !planet::place_on_grid_of(parts.front(), part))
                throw Error(Fault::bad_data, file, "is not on the grid of " + parts.front().path,
                            "rasters of one CRS and one sample distance, a whole number of samples apart");
            cache = std::max(cache, cache_for(part, tile));
            parts.push_back(std::move(part));
        }
    planet::raster_driver().limit_cache(cache);
    std::string name = std::filesystem::path(parts.front().path).filename().string();
    if (parts.size() > 1) name += " and " + std::to_string(parts.size() - 1) + " more";
    return std::make_unique<const planet::RasterMosaic>(std::move(parts), name, raster_options());
}

std::shared_ptr<const planet::Raster> without_samples(const planet::RasterHeader& header) {
    auto raster = std::make_shared<planet::Raster>();
    static_cast<planet::RasterHeader&>(*raster) = header;
    return raster;
}

}  // namespace

TinSource::TinSource(const TinCommand& command)
    : command_(command),
      mosaic_(open_mosaic(command.sources, command.tile)),
      raster_(without_samples(mosaic_->header())) {
    if (raster_->width < 2 || raster_->height < 2)
        throw Error(Fault::bad_data, raster_->name,
                    std::to_string(raster_->width) + "x" + std::to_string(raster_->height) + " samples have no area",
                    "2x2 samples or more");
    for (const std::string& file : command.masks) {
        planet::Features found = planet::read_features(file, *raster_);
        if (found.polygons.empty()) throw Error(Fault::bad_data, file, "has no polygon to keep", "polygons");
        std::ranges::move(found.polygons, std::back_inserter(mask_));
    }
}

planet::VerticalDatum TinSource::datum() const {
    if (command_.datum) return *command_.datum;
    const bool ellipsoid = raster_->vertical_crs.find("llipsoid") != std::string::npos;
    return ellipsoid ? planet::VerticalDatum::ellipsoid : planet::VerticalDatum::egm96;
}

planet::HeightGrid TinSource::heights() const {
    planet::HeightGrid grid = planet::heights_of(*mosaic_, most_samples);
    planet::raster_driver().limit_cache(least_cache / 16);
    if (!mask_.empty()) planet::keep_within(grid, *raster_, mask_);
    return grid;
}

planet::HeightGrid TinSource::heights(glm::ivec2 first, glm::ivec2 last) const {
    const glm::ivec2 size = last - first + 1;
    planet::HeightGrid grid = planet::heights_of(*mosaic_, planet::SampleWindow{first.x, first.y, size.x, size.y});
    if (!mask_.empty()) planet::keep_window_within(grid, first, *raster_, mask_);
    return grid;
}

planet::RasterFrame TinSource::frame(MeshFrame kind, planet::MeshFormat format) const {
    planet::RasterFrame frame = frame_of_raster(raster_, kind, datum(), command_.exaggeration);
    planet::check_frame(frame.reference(), format);
    if (!frame.affine()) check_reach(frame, *raster_);
    return frame;
}

planet::RasterFrame TinSource::tangent_frame() const {
    return frame_of_raster(raster_, MeshFrame::enu, datum(), command_.exaggeration);
}

planet::TinFeatures TinSource::features() const {
    planet::TinFeatures all;
    for (const std::string& file : command_.features) {
        planet::TinFeatures found = planet::features_at_samples(planet::read_features(file, *raster_), *raster_);
        if (found.empty())
            throw Error(Fault::bad_data, file, "has nothing on the raster", "features within " + raster_->name);
        std::ranges::move(found.points, std::back_inserter(all.points));
        std::ranges::move(found.lines, std::back_inserter(all.lines));
        all.outside += found.outside;
    }
    return all;
}

std::vector<glm::ivec2> TinSource::pole_samples() const {
    return samples_at_poles(*raster_);
}

void report_features(const planet::FeatureReport& found, std::size_t outside, Report& report) {
    report.set("feature_points", found.points);
    report.set("feature_sides", found.line_sides + found.around_voids);
    report.set("feature_duplicates", found.duplicates);
    report.set("feature_crossings", found.crossings);
    report.set("features_outside", outside);
    report.set("features_over_voids", found.over_voids);
    report.set("features_dropped", found.dropped);
}

double share_above_plane(const planet::RasterFrame& tangent, glm::ivec2 size) {
    const glm::dvec2 last(size - 1);
    std::vector<glm::dvec2> at;
    for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 0.5, 1.0}) at.push_back(last * glm::dvec2(x, y));
    const std::vector<double> heights(at.size());
    std::vector<glm::dvec3> placed(at.size());
    std::vector<glm::vec3> up(at.size());
    tangent.place(at, heights, placed, up);
    double least = 1;
    for (const glm::vec3& u : up) least = std::min(least, static_cast<double>(u.z));
    return std::max(0.94, least - curve_spare);
}

PlacedBox box_of_window(const planet::RasterFrame& frame, glm::ivec2 first, glm::ivec2 last, double lowest,
                        double highest) {
    constexpr int places = 16;  // along each side
    std::vector<glm::dvec2> at;
    std::vector<double> heights;
    for (int i = 0; i <= places; ++i)
        for (int j = 0; j <= places; ++j)
            for (const double h : {lowest, highest}) {
                at.push_back(glm::mix(glm::dvec2(first), glm::dvec2(last), glm::dvec2(i, j) / double{places}));
                heights.push_back(h);
            }
    std::vector<glm::dvec3> placed(at.size());
    frame.place(at, heights, placed, {});
    PlacedBox box{placed.front(), placed.front()};
    for (const glm::dvec3& p : placed) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

glm::dvec2 height_range(const planet::HeightGrid& grid) {
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    for (int y = 0; y < grid.height(); ++y)
        for (const float h : std::span(grid.row(y), static_cast<std::size_t>(grid.width()))) {
            lowest = h < lowest ? h : lowest;  // false for NaN
            highest = h > highest ? h : highest;
        }
    return {static_cast<double>(lowest), static_cast<double>(highest)};
}

}  // namespace render
