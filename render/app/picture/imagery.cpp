#include "render/app/picture/imagery.h"

#include <bit>
#include <cstring>
#include <numbers>

#include "planet/elevation/image_io.h"

#include "planet/elevation/sha256.h"
#include "planet/error.h"
#include "planet/geodesy/ellipsoid.h"
#include "render/app/data_path.h"
#include "render/app/mapped_file.h"
#include "render/app/output_file.h"
#include "render/sky/cube_map.h"

namespace render {

namespace {

// The cache file: this header, then the levels of day, night and relief, each cube from its finest level down to 1.
struct Header {
    char magic[16] = "octaglobe cubes";
    std::uint32_t version = 1;
    std::uint32_t sides[3] = {};
};
static_assert(sizeof(Header) == 32);

constexpr const char* day_file = "blue_marble.jpg";
constexpr const char* night_file = "night_lights.jpg";
constexpr const char* water_file = "water_mask.png";

std::size_t cube_bytes(std::uint32_t side) {
    std::size_t bytes = 0;
    for (std::size_t n = side; n > 0; n /= 2) bytes += 6 * n * n * 4;
    return bytes;
}

/// Cuts stored bytes into cubes; false if they are not what the header says.
bool cut(std::span<const std::byte> bytes, Imagery& imagery) {
    Header header, expected;
    if (bytes.size() < sizeof header) return false;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (std::memcmp(header.magic, expected.magic, sizeof header.magic) != 0 || header.version != expected.version)
        return false;
    std::size_t total = sizeof header;
    for (const std::uint32_t side : header.sides) {
        if (!std::has_single_bit(side) || side > 16384) return false;
        total += cube_bytes(side);
    }
    if (bytes.size() != total) return false;
    std::size_t at = sizeof header;
    Imagery::Cube* cubes[] = {&imagery.day, &imagery.night, &imagery.relief};
    for (std::size_t c = 0; c < 3; ++c) {
        cubes[c]->side = static_cast<int>(header.sides[c]);
        cubes[c]->levels.clear();
        for (std::size_t n = header.sides[c]; n > 0; n /= 2) {
            cubes[c]->levels.push_back(bytes.subspan(at, 6 * n * n * 4));
            at += 6 * n * n * 4;
        }
    }
    return true;
}

/// A side that keeps the detail of a picture of that width.
int side_for(int width) {
    return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(width / 4, 1))));
}

planet::Image read_globe(const std::filesystem::path& path) {
    planet::Image image = planet::read_image(path.string(), {.max_width = 16384});
    if (image.width != 2 * image.height)
        throw planet::Error(
            planet::Fault::bad_data, path.string(),
            std::to_string(image.width) + "x" + std::to_string(image.height) + " is no picture of a globe",
            "a picture twice as wide as high, -180..180 by 90..-90 degrees");
    return image;
}

EquirectangularImage view_of(const planet::Image& image) {
    return {image.width, image.height, image.channels, image.pixels};
}

/// The pictures over each other by their alpha, at the size of the widest.
CubeMap day_cube(const std::vector<std::filesystem::path>& pictures, unsigned threads) {
    CubeMap day;
    for (const auto& path : pictures) {
        const planet::Image image = read_globe(path);
        CubeMap layer = cube_from_equirectangular(view_of(image), side_for(image.width), Encoding::srgb, threads);
        const bool covers = image.channels < 4 || day.levels.empty();
        if (covers || layer.levels.size() != day.levels.size()) {
            if (!covers)
                throw planet::Error(planet::Fault::bad_data, path.string(),
                                    "its size is not that of the picture below it",
                                    "pictures with alpha of the same size as those they lie on");
            day = std::move(layer);
            continue;
        }
        for (std::size_t l = 0; l < day.levels.size(); ++l)
            for (std::size_t i = 0; i < day.levels[l].texels.size(); i += 4) {
                const int a = layer.levels[l].texels[i + 3];
                for (std::size_t k = 0; k < 3; ++k) {
                    std::uint8_t& below = day.levels[l].texels[i + k];
                    below =
                        static_cast<std::uint8_t>((layer.levels[l].texels[i + k] * a + below * (255 - a) + 127) / 255);
                }
            }
    }
    return day;
}

std::string make(const std::vector<std::filesystem::path>& pictures, const planet::ElevationField& heights,
                 unsigned threads, const std::function<void(std::string_view, double)>& progress) {
    progress("imagery", 0);
    CubeMap day = day_cube(pictures, threads);
    const int side = day.levels.front().side;
    progress("imagery", 0.4);
    const planet::Image water = read_globe(data_file(water_file));
    set_alpha(day, cube_from_equirectangular(view_of(water), side, Encoding::linear, threads));
    progress("imagery", 0.6);
    planet::Image night = read_globe(data_file(night_file));
    const auto lights = lights_from_night_picture(night.pixels);
    const CubeMap night_cube = cube_from_equirectangular(
        {night.width, night.height, 3, lights}, std::min(side_for(night.width), 1024), Encoding::srgb, threads);
    progress("imagery", 0.8);
    const CubeMap relief = relief_cube(heights, 1024, planet::wgs84.mean_radius(), false, threads);

    Header header;
    const CubeMap* cubes[] = {&day, &night_cube, &relief};
    for (std::size_t c = 0; c < 3; ++c) header.sides[c] = static_cast<std::uint32_t>(cubes[c]->levels.front().side);
    std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
    for (const CubeMap* cube : cubes)
        for (const CubeLevel& level : cube->levels)
            bytes.append(reinterpret_cast<const char*>(level.texels.data()), level.texels.size());
    progress("imagery", 1);
    return bytes;
}

std::string name_of_cache(const std::vector<std::filesystem::path>& pictures, const EarthSources& earth,
                          ChecksumIndex& index) {
    std::string text = earth_checksum(earth, index);
    for (const auto& picture : pictures) text += index.sha256(picture);
    for (const char* file : {night_file, water_file}) text += index.sha256(data_file(file));
    planet::Sha256 sum;
    sum.add(text.data(), text.size());
    return "imagery-" + sum.hex().substr(0, 32) + "-v" + std::to_string(Header{}.version) + ".cubes";
}

}  // namespace

double Imagery::texel_m(double radius) const {
    return 2.0 * radius / day.side;
}

Imagery open_imagery(const std::vector<std::filesystem::path>& pictures, const EarthSources& earth,
                     ChecksumIndex& index,
                     const std::function<std::shared_ptr<const planet::ElevationField>()>& heights, unsigned threads,
                     const std::function<void(std::string_view, double)>& progress) {
    const std::vector<std::filesystem::path> day = pictures.empty() ? std::vector{data_file(day_file)} : pictures;
    Imagery imagery;
    const auto folder = cache_folder();
    std::filesystem::path file;
    if (folder) {
        file = *folder / name_of_cache(day, earth, index);
        if (auto mapped = MappedFile::open(file); mapped && cut(mapped->bytes(), imagery)) {
            imagery.storage = std::make_shared<const MappedFile>(std::move(*mapped));
            return imagery;
        }
    }
    const auto bytes = std::make_shared<const std::string>(make(day, *heights(), threads, progress));
    if (folder) {
        try {
            OutputFile(file.string(), file).commit(*bytes);
        } catch (const planet::Error&) {
            // A full disk costs the next start some time, not this picture.
        }
    }
    cut(std::as_bytes(std::span(*bytes)), imagery);
    imagery.storage = bytes;
    return imagery;
}

Texture upload_cube(const Imagery::Cube& cube, GLenum internal_format) {
    Texture t = Texture::make_cube(internal_format, cube.side, static_cast<int>(cube.levels.size()));
    for (int level = 0; level < t.levels(); ++level) t.upload(level, cube.levels[static_cast<std::size_t>(level)]);
    return t;
}

}  // namespace render
