#include "render/sky/stars.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>

#include "planet/error.h"
#include "planet/frames.h"

namespace render {
namespace {

/// Planck's law in one band, up to a factor.
double planck(double wavelength, double temperature) {
    return 1 / (std::pow(wavelength, 5) * std::expm1(0.0143877 / (wavelength * temperature)));
}

glm::vec3 color_of(double b_v) {
    const double i = 0.92 * std::clamp(b_v, -0.4, 2.0);
    const double temperature = 4600 * (1 / (i + 1.7) + 1 / (i + 0.62));
    constexpr double white = 6600;
    glm::dvec3 color;
    constexpr std::array<double, 3> bands{640e-9, 550e-9, 455e-9};
    for (int c = 0; c < 3; ++c) {
        const double w = bands[static_cast<std::size_t>(c)];
        color[c] = planck(w, temperature) / planck(w, white);
    }
    return color / color.g;
}

/// The next number in a line, or nothing; moves `at` past it.
std::optional<double> next_number(const char*& at, const char* end) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == ',' || *at == ';')) ++at;
    if (at != end && *at == '+') ++at;
    double value = 0;
    const auto [stop, problem] = std::from_chars(at, end, value);
    if (problem != std::errc() || !std::isfinite(value)) return std::nullopt;
    at = stop;
    return value;
}

std::optional<std::array<double, 4>> parse_row(const std::string& line) {
    std::array<double, 4> row{};
    const char* at = line.data();
    const char* end = at + line.size();
    for (double& value : row) {
        const std::optional<double> number = next_number(at, end);
        if (!number) return std::nullopt;
        value = *number;
    }
    if (row[0] < 0 || row[0] > 360 || std::abs(row[1]) > 90 || std::abs(row[2]) > 40) return std::nullopt;
    return row;
}

}  // namespace

Star make_star(double right_ascension, double declination, double magnitude, double b_v) {
    const glm::vec3 direction = planet::normal_from_geodetic(declination, right_ascension);
    return {direction, color_of(b_v) * static_cast<float>(std::pow(10, -0.3 * magnitude))};
}

std::vector<Star> read_stars(const std::filesystem::path& file) {
    const auto bad = [&](std::size_t line, const char* what) {
        return planet::Error(planet::Fault::bad_data, file.string() + ":" + std::to_string(line), what,
                             "right ascension 0..360, declination -90..90 (degrees), V, B-V on every line");
    };
    std::error_code unreadable;
    const auto size = std::filesystem::file_size(file, unreadable);
    std::ifstream in(file);
    if (unreadable || !in) throw planet::Error(planet::Fault::bad_data, file.string(), "cannot be read");
    if (size > (16u << 20)) throw planet::Error(planet::Fault::bad_data, file.string(), "too large", "up to 16 MiB");
    std::vector<Star> stars;
    std::string line;
    bool header_allowed = true;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        const std::size_t first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#') continue;
        if (const auto row = parse_row(line)) {
            stars.push_back(make_star((*row)[0] * planet::degrees, (*row)[1] * planet::degrees, (*row)[2], (*row)[3]));
        } else if (!header_allowed) {
            throw bad(number, "not a star");
        }
        header_allowed = false;
    }
    if (stars.empty()) throw bad(1, "no stars");
    return stars;
}

}  // namespace render
