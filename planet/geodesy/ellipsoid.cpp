#include "planet/geodesy/ellipsoid.h"

#include <array>
#include <cctype>
#include <charconv>

#include "planet/error.h"

namespace planet {
namespace {

constexpr std::string_view accepted = "wgs84, moon, mars, sphere, sphere:RADIUS with 1 to 1e9 metres";
constexpr std::string_view sphere_prefix = "sphere:";

double parse_radius(std::string_view text, std::string_view name) {
    double radius = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), radius);
    if (fault != std::errc{} || end != text.data() + text.size() || !(radius >= 1 && radius <= 1e9))
        throw Error(Fault::bad_usage, "ellipsoid", "\"" + std::string(name) + "\" has no usable radius", accepted);
    return radius;
}

}  // namespace

Ellipsoid ellipsoid_from_name(std::string_view name) {
    std::string lower(name);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const Ellipsoid& e : {wgs84, moon, mars, sphere()})
        if (lower == e.name) return e;
    if (lower.starts_with(sphere_prefix)) return sphere(parse_radius(lower.substr(sphere_prefix.size()), name));
    throw Error(Fault::bad_usage, "ellipsoid", "\"" + std::string(name) + "\" is not known", accepted);
}

std::string to_string(const Ellipsoid& e) {
    if (e.name != "sphere" || e == sphere()) return std::string(e.name);
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), e.a).ptr;
    return std::string(sphere_prefix).append(digits.data(), end);
}

}  // namespace planet
