#include "planet/elevation/elevation_sources.h"

#include <glob.h>

#include <algorithm>
#include <filesystem>

#include "planet/elevation/blocked_raster.h"
#include "planet/elevation/raster_field.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr std::size_t least_cache = std::size_t{2} << 20;

/// A mosaic that becomes a layer.
struct Layer {
    std::vector<MosaicPart> parts;
    std::string name;
    VerticalDatum datum = VerticalDatum::egm96;
    bool datum_assumed = false;
};

bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

// What a file says; nothing if it says nothing.
std::optional<VerticalDatum> datum_of(const MosaicPart& part) {
    const std::string& said = part.header.vertical_crs;
    if (said.empty()) return std::nullopt;
    if (said == "ellipsoid" || contains(said, "llipsoid")) return VerticalDatum::ellipsoid;
    if (said == "EPSG:5773" || contains(said, "EGM96")) return VerticalDatum::egm96;
    throw Error(Fault::bad_data, part.path, "its heights are above " + said + ", which cannot be converted",
                "EGM96 (EPSG:5773) or the ellipsoid; --datum says which of them to take it for");
}

std::string name_of_file(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

// The files of a pattern, those on one grid together.
void add_layers(const SourceSpec& source, std::vector<Layer>& layers) {
    const std::size_t first = layers.size();
    for (const std::string& file : files_of_pattern(source.pattern)) {
        MosaicPart part = mosaic_part(file);
        const std::optional<VerticalDatum> said = source.datum ? source.datum : datum_of(part);
        const VerticalDatum datum = said.value_or(VerticalDatum::egm96);
        const auto same =
            std::find_if(layers.begin() + static_cast<std::ptrdiff_t>(first), layers.end(), [&](Layer& l) {
                return l.datum == datum && l.datum_assumed == !said && place_on_grid_of(l.parts.front(), part);
            });
        if (same != layers.end())
            same->parts.push_back(std::move(part));
        else
            layers.push_back({{std::move(part)}, name_of_file(file), datum, !said});
    }
    for (std::size_t i = first; i < layers.size(); ++i)
        if (layers[i].parts.size() > 1)
            layers[i].name = name_of_file(source.pattern) + " (" + std::to_string(layers[i].parts.size()) + " files)";
}

class Opener {
  public:
    explicit Opener(const SourceOptions& options) : options_(options) {}

    std::shared_ptr<const ElevationField> open(std::span<const SourceSpec> sources) {
        std::vector<Layer> layers;
        for (const SourceSpec& source : sources) add_layers(source, layers);
        std::vector<std::shared_ptr<const RasterMosaic>> mosaics;
        for (Layer& l : layers) {
            mosaics.push_back(std::make_shared<const RasterMosaic>(std::move(l.parts), l.name));
            samples_ += static_cast<double>(mosaics.back()->header().count());
        }
        share_memory(mosaics);
        std::vector<std::shared_ptr<const ElevationField>> fields;
        if (options_.base) fields.push_back(options_.base);
        for (std::size_t i = 0; i < layers.size(); ++i) {
            fields.push_back(in_memory_[i] ? whole_field(mosaics[i], layers[i]) : blocked_field(mosaics[i], layers[i]));
            samples_done_ += static_cast<double>(mosaics[i]->header().count());
        }
        return std::make_shared<LayeredField>(std::move(fields), options_.datum, options_.geoid, options_.radius_m,
                                              options_.memory_bytes / 16);
    }

  private:
    // First what GDAL must keep decoded, then small rasters, and the rest for blocks.
    void share_memory(const std::vector<std::shared_ptr<const RasterMosaic>>& mosaics) {
        const std::size_t all = options_.memory_bytes;
        std::size_t decoded = all / 16, whole = 0;
        for (const auto& mosaic : mosaics) {
            const RasterHeader& r = mosaic->header();
            const std::size_t bytes = r.count() * (mosaic->may_be_shorts() ? 2 : 4);
            in_memory_.push_back(bytes <= all / 8 && whole + bytes <= all / 4);
            if (in_memory_.back())
                whole += bytes;
            else
                decoded = std::max(decoded, decoded_bytes(*mosaic));
        }
        raster_driver().limit_cache(decoded);
        const std::size_t taken = decoded + whole + all / 16;
        cache_ = std::make_shared<BlockCache>(std::max(least_cache, all > taken ? all - taken : 0));
    }

    std::size_t decoded_bytes(const RasterMosaic& mosaic) const {
        std::size_t most = 0;
        for (const MosaicPart& part : mosaic.parts()) {
            if (part.decoded_bytes > options_.memory_bytes / 2)
                throw Error(Fault::bad_data, part.path,
                            "its compressed strips take " + std::to_string(part.decoded_bytes >> 20) +
                                " MiB to be read in windows",
                            "at least " + std::to_string((part.decoded_bytes >> 19) + 1) +
                                " MiB of memory, or a tiled or uncompressed file");
            most = std::max(most, part.decoded_bytes);
        }
        return most;
    }

    static std::shared_ptr<const RasterMosaic> if_of_files(const std::shared_ptr<const RasterMosaic>& mosaic) {
        return mosaic->parts().size() > 1 ? mosaic : nullptr;
    }

    std::shared_ptr<const ElevationField> whole_field(const std::shared_ptr<const RasterMosaic>& mosaic,
                                                      const Layer& layer) const {
        auto samples = std::make_shared<const WholeRaster>(std::make_shared<const Raster>(read_mosaic(*mosaic)));
        tell(1, samples->header());
        RasterSurvey found = survey(*samples);
        return std::make_shared<RasterField>(std::move(samples), std::move(found), layer.datum, layer.datum_assumed,
                                             if_of_files(mosaic));
    }

    std::shared_ptr<const ElevationField> blocked_field(const std::shared_ptr<const RasterMosaic>& mosaic,
                                                        const Layer& layer) const {
        auto samples = std::make_shared<const BlockedRaster>(
            mosaic, cache_, [&](double fraction) { tell(fraction, mosaic->header()); });
        const RasterSurvey& found = samples->survey();
        return std::make_shared<RasterField>(samples, found, layer.datum, layer.datum_assumed, if_of_files(mosaic));
    }

    void tell(double fraction, const RasterHeader& raster) const {
        if (options_.progress)
            options_.progress((samples_done_ + fraction * static_cast<double>(raster.count())) / samples_);
    }

    const SourceOptions& options_;
    std::shared_ptr<BlockCache> cache_;
    std::vector<bool> in_memory_;  // by layer
    double samples_ = 0, samples_done_ = 0;
};

}  // namespace

std::shared_ptr<const ElevationField> open_elevation_sources(std::span<const SourceSpec> sources,
                                                             const SourceOptions& options) {
    if (sources.empty()) throw Error(Fault::bad_usage, "elevation", "has no source", "at least one file or pattern");
    return Opener(options).open(sources);
}

std::vector<std::string> files_of_pattern(const std::string& pattern) {
    std::error_code failed;
    if (std::filesystem::exists(pattern, failed) || pattern.find_first_of("*?[") == std::string::npos) return {pattern};
    glob_t found{};
    std::vector<std::string> files;
    if (glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found) == 0)
        for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
    globfree(&found);
    std::erase_if(files, [&](const std::string& f) { return std::filesystem::is_directory(f, failed); });
    if (files.empty())
        throw Error(Fault::bad_data, pattern, "matches no file", "a pattern of elevation files, e.g. 'tiles/*.hgt'");
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace planet
