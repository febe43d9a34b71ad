#include "render/sky/cube_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "planet/error.h"
#include "planet/frames.h"
#include "planet/parallel.h"

namespace render {
namespace {

using glm::dvec3;
using glm::vec4;
constexpr double pi = std::numbers::pi;

/// Calls work(row) for every row 0..rows-1; rows are independent.
template <typename Work>
void for_rows(int rows, unsigned threads, const Work& work) {
    planet::parallel_for(static_cast<std::size_t>(rows), std::clamp(threads, 1u, 16u),
                         [&](std::size_t row) { work(static_cast<int>(row)); });
}

double light_of_srgb(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// Bytes to light and back.
class Transfer {
  public:
    explicit Transfer(Encoding encoding) {
        for (std::size_t i = 0; i < 256; ++i) {
            const double v = static_cast<double>(i) / 255;
            light_[i] = static_cast<float>(encoding == Encoding::srgb ? light_of_srgb(v) : v);
        }
        for (std::size_t i = 0; i < byte_.size(); ++i) {  // the nearest byte to each of 65,536 lights
            const float v = static_cast<float>(i) / static_cast<float>(byte_.size() - 1);
            const auto up = std::lower_bound(light_.begin(), light_.end(), v) - light_.begin();
            const auto k = static_cast<std::size_t>(std::min<std::ptrdiff_t>(up, 255));
            byte_[i] = static_cast<std::uint8_t>(k > 0 && v - light_[k - 1] < light_[k] - v ? k - 1 : k);
        }
    }
    float light(std::uint8_t byte) const { return light_[byte]; }
    std::uint8_t byte(float light) const {
        return byte_[static_cast<std::size_t>(std::clamp(light, 0.0f, 1.0f) * 65535.0f + 0.5f)];
    }

  private:
    std::array<float, 256> light_{};
    std::array<std::uint8_t, 65536> byte_{};
};

std::uint8_t byte_of_fraction(float v) {
    return static_cast<std::uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f);
}

/// A texel of light, alpha included.
vec4 light_at(const std::uint8_t* p, int channels, const Transfer& transfer) {
    const float r = transfer.light(p[0]);
    if (channels <= 2) return {r, r, r, channels == 2 ? static_cast<float>(p[1]) / 255 : 1.0f};
    return {r, transfer.light(p[1]), transfer.light(p[2]), channels == 4 ? static_cast<float>(p[3]) / 255 : 1.0f};
}

/// Means of a picture in light, over boxes.
class Picture {
  public:
    Picture(const EquirectangularImage& image, Encoding encoding) : image_(image), transfer_(encoding) {}

    /// Mean over the box of texels around (cx, cy), fractions counted; columns wrap, rows clamp. Boxes are at least one
    /// texel a side, which makes this the linear filter where the cube is finer, and at most one turn wide. The boxes
    /// of a whole cube cover the picture about twice, poles included: a box is as many times wider as its row is
    /// shorter.
    vec4 mean(double cx, double cy, double across, double down) const {
        across = std::clamp(across, 1.0, static_cast<double>(std::max(image_.width, 1)));
        down = std::clamp(down, 1.0, static_cast<double>(std::max(image_.height, 1)));
        const double top = cy - down / 2, bottom = cy + down / 2;
        vec4 sum(0);
        for (int y = static_cast<int>(std::floor(top)); y < bottom; ++y) {
            const double w = std::min(bottom, y + 1.0) - std::max(top, static_cast<double>(y));
            sum +=
                static_cast<float>(w) * row_sum(std::clamp(y, 0, image_.height - 1), cx - across / 2, cx + across / 2);
        }
        return sum / static_cast<float>(down * across);
    }

  private:
    vec4 row_sum(int y, double left, double right) const {
        const auto channels = static_cast<std::size_t>(image_.channels), width = static_cast<std::size_t>(image_.width);
        const std::uint8_t* row = image_.texels.data() + static_cast<std::size_t>(y) * width * channels;
        vec4 sum(0);
        const int first = static_cast<int>(std::floor(left)), n = image_.width;
        int column = (first % n + n) % n;
        for (int x = first; x < right; ++x) {
            const double w = std::min(right, x + 1.0) - std::max(left, static_cast<double>(x));
            sum += static_cast<float>(w) *
                   light_at(row + static_cast<std::size_t>(column) * channels, image_.channels, transfer_);
            if (++column == n) column = 0;
        }
        return sum;
    }

    EquirectangularImage image_;
    Transfer transfer_;
};

/// The next coarser level. Faces average apart: seamless filtering of the hardware joins them.
template <typename Average>
CubeLevel half(const CubeLevel& fine, unsigned threads, const Average& average) {
    CubeLevel out{fine.side / 2, {}};
    const auto n = static_cast<std::size_t>(out.side), m = static_cast<std::size_t>(fine.side);
    out.texels.resize(6 * n * n * 4);
    for_rows(6 * out.side, threads, [&](int row) {
        const std::size_t face = static_cast<std::size_t>(row) / n, y = static_cast<std::size_t>(row) % n;
        for (std::size_t x = 0; x < n; ++x) {
            const std::uint8_t* p = &fine.texels[((face * m + 2 * y) * m + 2 * x) * 4];
            average(p, p + 4, p + m * 4, p + m * 4 + 4, &out.texels[((face * n + y) * n + x) * 4]);
        }
    });
    return out;
}

void check_side(int side) {
    if (side < 1 || side > 8192 || (side & (side - 1)) != 0)
        throw planet::Error(planet::Fault::bad_usage, "cube map", "side " + std::to_string(side),
                            "a power of two, 1 to 8192");
}

void check_image(const EquirectangularImage& image) {
    const bool sizes = image.width >= 1 && image.width <= 65535 && image.height >= 1 && image.height <= 65535 &&
                       image.channels >= 1 && image.channels <= 4;
    if (!sizes || image.texels.size() != static_cast<std::size_t>(image.width) *
                                             static_cast<std::size_t>(image.height) *
                                             static_cast<std::size_t>(image.channels))
        throw planet::Error(planet::Fault::bad_data, "picture",
                            std::to_string(image.width) + "x" + std::to_string(image.height) + " with " +
                                std::to_string(image.channels) + " channels in " + std::to_string(image.texels.size()) +
                                " bytes",
                            "1x1 to 65535x65535, 1 to 4 channels of 8 bits, complete");
}

/// One texel of the cube: the picture over its area, taken as a box in longitude and latitude.
vec4 area_mean(const Picture& picture, const EquirectangularImage& image, const dvec3& n, double angle) {
    const planet::Geodetic g = planet::geodetic_from_normal(n);
    const double x = (g.longitude / (2 * pi) + 0.5) * image.width, y = (0.5 - g.latitude / pi) * image.height;
    const double rows = angle / pi * image.height;
    const double columns = angle / (2 * pi) * image.width / std::max(std::hypot(n.x, n.y), 1e-9);
    return picture.mean(x, y, columns, rows);
}

}  // namespace

dvec3 cube_normal(int face, double s, double t) {
    const double u = 2 * s - 1, v = 2 * t - 1;
    switch (face) {
        case 0:
            return glm::normalize(dvec3(1, -v, -u));
        case 1:
            return glm::normalize(dvec3(-1, -v, u));
        case 2:
            return glm::normalize(dvec3(u, 1, v));
        case 3:
            return glm::normalize(dvec3(u, -1, -v));
        case 4:
            return glm::normalize(dvec3(u, -v, 1));
        default:
            return glm::normalize(dvec3(-u, -v, -1));
    }
}

CubeMap cube_from_equirectangular(const EquirectangularImage& image, int side, Encoding encoding, unsigned threads) {
    check_side(side);
    check_image(image);
    const Picture picture(image, encoding);
    const Transfer transfer(encoding);
    const auto n = static_cast<std::size_t>(side);
    CubeMap cube;
    cube.levels.push_back({side, std::vector<std::uint8_t>(6 * n * n * 4)});
    for_rows(6 * side, threads, [&](int row) {
        const int face = row / side, y = row % side;
        std::uint8_t* out = &cube.levels[0].texels[static_cast<std::size_t>(row) * n * 4];
        for (int x = 0; x < side; ++x, out += 4) {
            const double s = (x + 0.5) / side, t = (y + 0.5) / side;
            // A texel's solid angle on a cube face falls with the cube of the distance to the plane.
            const double plane = 1 + (2 * s - 1) * (2 * s - 1) + (2 * t - 1) * (2 * t - 1);
            const double angle = 2.0 / side * std::pow(plane, -0.75);
            const vec4 v = area_mean(picture, image, cube_normal(face, s, t), angle);
            for (int c = 0; c < 3; ++c) out[c] = transfer.byte(v[c]);
            out[3] = byte_of_fraction(v.w);
        }
    });
    while (cube.levels.back().side > 1)
        cube.levels.push_back(half(cube.levels.back(), threads, [&](auto* a, auto* b, auto* c, auto* d, auto* out) {
            for (int k = 0; k < 3; ++k)
                out[k] = transfer.byte(
                    (transfer.light(a[k]) + transfer.light(b[k]) + transfer.light(c[k]) + transfer.light(d[k])) / 4);
            out[3] = static_cast<std::uint8_t>((a[3] + b[3] + c[3] + d[3] + 2) / 4);
        }));
    return cube;
}

void set_alpha(CubeMap& into, const CubeMap& from) {
    assert(into.levels.size() == from.levels.size());
    for (std::size_t k = 0; k < into.levels.size(); ++k) {
        assert(into.levels[k].side == from.levels[k].side);
        for (std::size_t i = 0; i < into.levels[k].texels.size(); i += 4)
            into.levels[k].texels[i + 3] = from.levels[k].texels[i];
    }
}

void set_night_alpha(CubeMap& relief, const CubeMap& lights) {
    set_alpha(relief, lights);
    for (CubeLevel& level : relief.levels)
        for (std::size_t i = 3; i < level.texels.size(); i += 4)
            level.texels[i] = static_cast<std::uint8_t>((level.texels[i] * 127 + 127) / 255);
}

std::vector<std::uint8_t> lights_from_night_picture(std::span<const std::uint8_t> rgb) {
    std::vector<std::uint8_t> out(rgb.size() / 3 * 3);
    // Moonlit ground has red below 0.25 of blue; lamps are white in the picture.
    constexpr double color[3] = {1.0, 0.86, 0.66};  // of sodium light, as sRGB values
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const double lamp = std::clamp((rgb[i] - 0.25 * rgb[i + 2]) * 1.5, 0.0, 255.0);
        for (std::size_t c = 0; c < 3; ++c) out[i + c] = static_cast<std::uint8_t>(lamp * color[c] + 0.5);
    }
    return out;
}

namespace {

/// Offsets of one row of texels of a face, from heights at four points around each normal: no face edge is special.
void relief_row(const planet::ElevationField& field, int side, int row, double radius, bool sea_floor,
                std::uint8_t* out) {
    const auto n = static_cast<std::size_t>(side);
    std::vector<dvec3> points;
    points.reserve(4 * n);
    const double step = 2.0 / side * 0.75;  // rad: about a texel in the middle of a face and near its corners
    const auto axes = [&](int x) {
        const dvec3 up = cube_normal(row / side, (x + 0.5) / side, (row % side + 0.5) / side);
        const dvec3 a = glm::normalize(glm::cross(up, std::abs(up.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0)));
        return std::array<dvec3, 3>{up, a, glm::cross(up, a)};
    };
    for (int x = 0; x < side; ++x) {
        const auto [up, a, b] = axes(x);
        for (const dvec3& d : {a, -a, b, -b}) points.push_back(glm::normalize(up + step * d));
    }
    std::vector<float> heights(points.size());
    field.heights(points, heights);
    for (float& h : heights)
        if (!sea_floor && h < 0) h = 0;
    for (std::size_t x = 0; x < n; ++x, out += 4) {
        const auto [up, a, b] = axes(static_cast<int>(x));
        const float* h = &heights[4 * x];
        const double span = 2 * std::atan(step) * radius;
        const double da = (double(h[0]) - double(h[1])) / span, db = (double(h[2]) - double(h[3])) / span;
        const bool known = std::isfinite(da) && std::isfinite(db);
        const dvec3 off = known ? glm::normalize(up - da * a - db * b) - up : dvec3(0);
        for (int c = 0; c < 3; ++c)
            out[c] = static_cast<std::uint8_t>(
                static_cast<std::int8_t>(std::lround(std::clamp(2 * off[c], -1.0, 1.0) * 127)));
        out[3] = 127;
    }
}

}  // namespace

CubeMap relief_cube(const planet::ElevationField& field, int side, double radius, bool sea_floor, unsigned threads) {
    check_side(side);
    assert(radius > 0);
    const auto n = static_cast<std::size_t>(side);
    CubeMap cube;
    cube.levels.push_back({side, std::vector<std::uint8_t>(6 * n * n * 4)});
    for_rows(6 * side, threads, [&](int row) {
        relief_row(field, side, row, radius, sea_floor, &cube.levels[0].texels[static_cast<std::size_t>(row) * n * 4]);
    });
    while (cube.levels.back().side > 1)
        cube.levels.push_back(half(cube.levels.back(), threads, [](auto* a, auto* b, auto* c, auto* d, auto* out) {
            for (int k = 0; k < 4; ++k) {
                const int sum = static_cast<std::int8_t>(a[k]) + static_cast<std::int8_t>(b[k]) +
                                static_cast<std::int8_t>(c[k]) + static_cast<std::int8_t>(d[k]);
                out[k] = static_cast<std::uint8_t>(static_cast<std::int8_t>(std::lround(sum / 4.0)));
            }
        }));
    return cube;
}

}  // namespace render
