#include "render/app/figures.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace render {

std::string grouped(std::size_t number) {
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, " ");
    return text;
}

std::string four_digits(double number) {
    if (!(number >= 1e-6)) return "0";  // a micrometre: the rounding of sums
    if (!std::isfinite(number)) return "infinite";
    const int exponent = static_cast<int>(std::floor(std::log10(number)));
    // What exceeds a digit by less than a thousandth of it is taken for the rounding of sums.
    const double last = std::pow(10.0, exponent - 3), rounded = std::ceil(number / last - 1e-3) * last;
    if (exponent >= 3) return grouped(static_cast<std::size_t>(std::llround(rounded)));
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", rounded);
    return text;
}

std::string exact(double value) {
    char text[400];
    const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed);
    return {text, end.ptr};
}

std::string fixed(double value, int decimals) {
    char text[400];
    const int length = std::snprintf(text, sizeof text, "%.*f", decimals, value);
    const std::string number(text, static_cast<std::size_t>(length));
    return number.find_first_of("123456789") == std::string::npos && number.front() == '-' ? number.substr(1) : number;
}

std::string bytes_text(std::size_t bytes) {
    if (bytes < 10'000) return grouped(bytes) + " bytes";
    double value = static_cast<double>(bytes) / 1000;
    std::size_t unit = 0;
    constexpr const char* units[] = {"kB", "MB", "GB", "TB"};
    for (; value >= 999.5 && unit < 3; ++unit) value /= 1000;
    return fixed(value, value < 9.95 ? 1 : 0) + " " + units[unit];
}

}  // namespace render
