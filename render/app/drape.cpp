#include "render/app/drape.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "planet/elevation/georeference.h"
#include "planet/elevation/image_io.h"
#include "planet/error.h"

namespace render {
namespace {

namespace fs = std::filesystem;

std::string bytes_of_file(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A name for a file that is written to be read at once, and then gone.
class ScratchName {
  public:
    explicit ScratchName(const char* ending) {
        static std::atomic<int> count{0};
        path_ = fs::temp_directory_path() /
                ("octaglobe-drape-" + std::to_string(::getpid()) + "-" + std::to_string(count++) + ending);
    }
    ScratchName(const ScratchName&) = delete;
    ScratchName& operator=(const ScratchName&) = delete;
    ~ScratchName() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

}  // namespace

DrapeMap::DrapeMap(const planet::Raster& raster, const std::string& picture) : raster_(raster), name_(picture) {
    if (picture.empty()) return;
    picture_ = planet::georeference_of(picture);
    if (picture_ && raster.plain && !picture_->plain)
        throw planet::Error(planet::Fault::bad_data, picture, "has a place on the planet, and " + raster.name + " none",
                            "a picture without a georeference, which covers it from edge to edge");
}

void DrapeMap::to_picture_crs(std::vector<glm::dvec2>& places) const {
    if (picture_->plain || picture_->crs == raster_.crs) return;
    if (raster_.transform) raster_.transform->geodetic_from_crs(places);
    if (picture_->transform) picture_->transform->crs_from_geodetic(places);
}

std::vector<glm::dvec2> DrapeMap::edge_to_edge(const std::vector<glm::ivec2>& samples, glm::ivec2 first) const {
    const bool columns_run_west = raster_.grid.per_column.x < 0;
    const bool rows_run_north = raster_.grid.per_row.y > 0;
    std::vector<glm::dvec2> places;
    places.reserve(samples.size());
    for (const glm::ivec2 p : samples) {
        const glm::dvec2 share = (glm::dvec2(p + first) + 0.5) / glm::dvec2(raster_.width, raster_.height);
        places.emplace_back(columns_run_west ? 1 - share.x : share.x, rows_run_north ? 1 - share.y : share.y);
    }
    return places;
}

std::vector<glm::dvec2> DrapeMap::at(const std::vector<glm::ivec2>& samples, glm::ivec2 first) const {
    if (!picture_) return edge_to_edge(samples, first);
    std::vector<glm::dvec2> places;
    places.reserve(samples.size());
    for (const glm::ivec2 p : samples) places.push_back(raster_.grid.crs_from_sample(glm::dvec2(p + first)));
    to_picture_crs(places);
    const glm::dvec2 size(picture_->width, picture_->height);
    const planet::SampleGrid& grid = picture_->grid;
    const glm::dmat2 pixel_from_crs = glm::inverse(glm::dmat2(grid.per_column, grid.per_row));
    const double middle = grid.crs_from_sample(0.5 * size).x;
    const bool in_degrees = picture_->plain ? raster_.geographic() : picture_->geographic();
    for (glm::dvec2& p : places) {
        if (in_degrees) p.x += 360 * std::round((middle - p.x) / 360);
        const glm::dvec2 pixel = pixel_from_crs * (p - grid.origin) + 0.5;
        if (!(glm::all(glm::greaterThan(pixel, glm::dvec2(-0.5))) && glm::all(glm::lessThan(pixel, size + 0.5))))
            throw planet::Error(planet::Fault::bad_data, name_, "does not cover all of " + raster_.name,
                                "a picture that does, --mask with what it covers, or one without a georeference");
        p = glm::clamp(pixel / size, 0.0, 1.0);
    }
    return places;
}

Drape::Drape(fs::path path) : path_(std::move(path)), image_(planet::read_image(path_.string())) {
    char start[4] = {};
    std::ifstream(path_, std::ios::binary).read(start, sizeof start);
    const std::string_view magic(start, sizeof start);
    png_ = magic == "\x89PNG";
    jpeg_ = magic.starts_with("\xff\xd8\xff");
}

std::string Drape::whole() const {
    return png_ || jpeg_ ? bytes_of_file(path_) : encoded(image_);
}

Drape::Part Drape::part(const std::vector<glm::dvec2>& places) const {
    glm::dvec2 low(1), high(0);
    for (const glm::dvec2 p : places) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::dvec2 size(image_.width, image_.height);
    constexpr double beside = 2;  // pixels: what filters look at
    const glm::ivec2 first(glm::max(glm::floor(low * size) - beside, glm::dvec2(0))),
        end(glm::min(glm::ceil(high * size) + beside, size));
    planet::Image cut{end.x - first.x, end.y - first.y, image_.channels, {}};
    for (int y = first.y; y < end.y; ++y) {
        const auto* row = image_.pixel(first.x, y);
        cut.pixels.insert(cut.pixels.end(), row, row + cut.row_size());
    }
    return {encoded(cut), glm::dvec2(first) / size, glm::dvec2(end) / size};
}

std::string Drape::encoded(const planet::Image& image) const {
    const ScratchName file(png_ || image.channels == 4 ? ".png" : ".jpg");
    planet::write_image(file.path().string(), image);
    return bytes_of_file(file.path());
}

std::vector<glm::vec2> texture_coordinates(const std::vector<glm::dvec2>& places, const Drape::Part& part) {
    std::vector<glm::vec2> uv;
    uv.reserve(places.size());
    for (const glm::dvec2 p : places) uv.emplace_back((p - part.low) / (part.high - part.low));
    return uv;
}

}  // namespace render
