#include "render/viewer/place_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "planet/error.h"
#include "planet/geodesy/utm.h"

namespace render {

namespace {

using planet::degrees;

constexpr double metres_per_degree = 111'320;
// UTF-8.
constexpr const char *degree = "\xc2\xb0", *minute = "\xe2\x80\xb2", *second = "\xe2\x80\xb3";

std::string number(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

/// "12 345.6", "-1 234"
std::string grouped_number(double value, int decimals) {
    std::string text = number(value, decimals);
    if (text.find_first_of("123456789") == std::string::npos && text.front() == '-') text.erase(0, 1);
    const std::size_t first = text.front() == '-' ? 1 : 0;
    for (std::size_t at = std::min(text.find('.'), text.size()); at > first + 3;) text.insert(at -= 3, " ");
    return text;
}

std::string in_degrees(double angle, double pixel_m, char positive, char negative) {
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(pixel_m / metres_per_degree))), 1, 7);
    return number(std::abs(angle) / degrees, decimals) + degree + " " + (angle < 0 ? negative : positive);
}

std::string in_seconds(double angle, double pixel_m, char positive, char negative) {
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(pixel_m * 3600 / metres_per_degree))), 0, 3);
    const double step = std::pow(10, -decimals);
    // Rounded once, before it is taken apart: 59.99 seconds must not become 60.
    const double seconds = std::round(std::abs(angle) / degrees * 3600 / step) * step;
    const auto whole = static_cast<long>(seconds / 60 + 1e-9);
    char text[32];
    std::snprintf(text, sizeof text, "%0*.*f", decimals > 0 ? decimals + 3 : 2, decimals,
                  std::max(0.0, seconds - 60.0 * static_cast<double>(whole)));
    char minutes[8];
    std::snprintf(minutes, sizeof minutes, "%02d", static_cast<int>(whole % 60));
    return std::to_string(whole / 60) + degree + " " + minutes + minute + " " + text + second + " " +
           (angle < 0 ? negative : positive);
}

std::string in_utm(const planet::Geodetic& place) {
    const planet::Utm utm = planet::utm_from_geodetic(place);
    const std::string zone = utm.zone == 0 ? "UPS " : std::to_string(utm.zone);
    return zone + (utm.north ? "N " : "S ") + grouped_number(utm.easting, 0) + " E " + grouped_number(utm.northing, 0) +
           " N";
}

}  // namespace

std::string place_text(const planet::Geodetic& place, PlaceFormat format, double pixel_m) {
    switch (format) {
        case PlaceFormat::minutes_seconds:
            return in_seconds(place.latitude, pixel_m, 'N', 'S') + "  " +
                   in_seconds(place.longitude, pixel_m, 'E', 'W');
        case PlaceFormat::utm:
            return in_utm(place);
        case PlaceFormat::mgrs:
            return planet::mgrs_from_geodetic(place,
                                              std::clamp(5 - static_cast<int>(std::floor(std::log10(pixel_m))), 0, 5));
        default:
            return in_degrees(place.latitude, pixel_m, 'N', 'S') + "  " +
                   in_degrees(place.longitude, pixel_m, 'E', 'W');
    }
}

std::string heights_text(planet::OrthometricHeight H, planet::EllipsoidalHeight h, double pixel_m) {
    const int decimals = pixel_m < 1 ? 2 : pixel_m < 100 ? 1 : 0;
    return "H " + grouped_number(H.m, decimals) + " m   h " + grouped_number(h.m, decimals) + " m";
}

std::string length_text(double metres) {
    const bool far = std::abs(metres) >= 999.5;
    const double value = far ? metres / 1000 : metres;
    const double size = std::abs(value);
    return grouped_number(value, size < 9.995 ? 2 : size < 99.95 ? 1 : 0) + (far ? " km" : " m");
}

ScaleBar scale_bar(double pixel_m, double most_pixels) {
    const double most = pixel_m * most_pixels, power = std::pow(10, std::floor(std::log10(most)));
    const double metres = power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
    const double shown = metres >= 1000 ? metres / 1000 : metres;
    return {metres, metres / pixel_m,
            grouped_number(shown, shown < 1 ? static_cast<int>(std::ceil(-std::log10(shown))) : 0) +
                (metres >= 1000 ? " km" : " m")};
}

planet::Geodetic place_from_text(const std::string& text) {
    const auto number_at = [&](const char*& at, double& value) {
        while (std::isspace(static_cast<unsigned char>(*at)) || *at == ',') ++at;
        char* end = nullptr;
        value = std::strtod(at, &end);
        const bool found = end != at && std::isfinite(value);
        at = end;
        return found;
    };
    const char* at = text.c_str();
    double latitude = 0, longitude = 0;
    if (number_at(at, latitude) && number_at(at, longitude)) {
        while (std::isspace(static_cast<unsigned char>(*at))) ++at;
        if (*at == '\0' && std::abs(latitude) <= 90 && longitude >= -180 && longitude <= 360)
            return {latitude * degrees, std::remainder(longitude, 360) * degrees, {}};
    }
    try {
        return planet::geodetic_from_mgrs(text);
    } catch (const planet::Error&) {
        throw planet::Error(planet::Fault::bad_usage, "place", "\"" + text + "\" is none",
                            "latitude, longitude in degrees, or an MGRS square such as 10TES9489");
    }
}

}  // namespace render
