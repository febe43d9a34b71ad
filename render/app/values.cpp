#include "render/app/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "planet/error.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Takes a decimal number off the front of the text; nothing if there is none. Infinity where it does not fit a double.
std::optional<double> take_number(std::string_view& text) {
    std::string_view rest = text;
    if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
    const std::string_view digits =
        !rest.empty() && rest.front() == '-' && rest.data() == text.data() ? rest.substr(1) : rest;
    // from_chars would read "inf" and "nan".
    if (digits.empty() || !(digits.front() == '.' || (digits.front() >= '0' && digits.front() <= '9'))) return {};
    double value = 0;
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (failure == std::errc::invalid_argument) return {};
    if (failure == std::errc::result_out_of_range) value = HUGE_VAL;
    text = std::string_view(end, static_cast<std::size_t>(text.data() + text.size() - end));
    return value;
}

std::string text_of(double value) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return {buffer.data(), end};
}

std::string text_of(Range range) {
    return text_of(range.low) + " to " + text_of(range.high);
}

bool within(double value, Range range) {
    return value >= range.low && value <= range.high;
}

std::string joined(const std::vector<std::string_view>& names) {
    std::string text;
    for (const auto name : names) text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

struct Unit {
    std::string_view name;
    double m;
};
// International foot, mile and nautical mile, exact by definition.
constexpr std::array units{Unit{"", 1},        Unit{"m", 1},         Unit{"km", 1000},
                           Unit{"ft", 0.3048}, Unit{"mi", 1609.344}, Unit{"nmi", 1852}};

}  // namespace

double parse_number(std::string_view where, std::string_view text, Range range, std::string_view unit) {
    std::string accepted = "a number " + text_of(range);
    if (!unit.empty()) accepted.append(" ").append(unit);
    std::string_view rest = trimmed(text);
    const auto value = take_number(rest);
    if (!value || !rest.empty()) throw Error(Fault::bad_usage, where, shown(text) + " is not a number", accepted);
    if (!within(*value, range)) throw Error(Fault::bad_usage, where, shown(text) + " is out of range", accepted);
    return *value + 0.0;  // -0 becomes 0
}

long parse_whole(std::string_view where, std::string_view text, long low, long high) {
    const std::string accepted = "a whole number " + std::to_string(low) + " to " + std::to_string(high);
    const std::string_view digits = trimmed(text);
    long value = 0;
    const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (failure == std::errc::invalid_argument || end != digits.data() + digits.size())
        throw Error(Fault::bad_usage, where, shown(text) + " is not a whole number", accepted);
    if (failure == std::errc::result_out_of_range || value < low || value > high)
        throw Error(Fault::bad_usage, where, shown(text) + " is out of range", accepted);
    return value;
}

double parse_distance(std::string_view where, std::string_view text, Range range) {
    const std::string accepted = text_of(range) + " m, as 500m, 60km, 1000ft, 3mi, 12nmi or 2e7 (metres)";
    std::string_view rest = trimmed(text);
    const auto value = take_number(rest);
    const auto unit = std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.name == trimmed(rest); });
    if (!value || unit == units.end())
        throw Error(Fault::bad_usage, where, shown(text) + " is not a distance", accepted);
    if (!within(*value * unit->m, range))
        throw Error(Fault::bad_usage, where, shown(text) + " is out of range", accepted);
    return *value * unit->m;
}

std::size_t parse_memory(std::string_view where, std::string_view text, std::size_t low, std::size_t high) {
    constexpr std::string_view letters = "KMGT";
    const auto mebi = [](std::size_t bytes) { return std::to_string(bytes >> 20) + "MiB"; };
    const std::string accepted = mebi(low) + " to " + mebi(high) + ", as 512MiB, 1.5GiB or 2000MB";
    std::string_view rest = trimmed(text);
    const auto value = take_number(rest);
    rest = trimmed(rest);
    double factor = 1;
    if (const auto power = rest.empty() ? rest.npos : letters.find(rest.front()); power != letters.npos) {
        rest.remove_prefix(1);
        factor = std::pow(rest == "B" ? 1000.0 : 1024.0, static_cast<double>(power + 1));
        if (rest == "iB") rest = {};
    }
    if (rest == "B") rest = {};
    if (!value || !rest.empty())
        throw Error(Fault::bad_usage, where, shown(text) + " is not an amount of memory", accepted);
    if (!within(*value * factor, {static_cast<double>(low), static_cast<double>(high)}))
        throw Error(Fault::bad_usage, where, shown(text) + " is out of range", accepted);
    return static_cast<std::size_t>(*value * factor);
}

planet::Geodetic parse_place(std::string_view where, std::string_view text) {
    constexpr std::string_view accepted = "LAT,LON in degrees, latitude -90 to 90, longitude -180 to 360";
    std::string_view rest = trimmed(text);
    const auto latitude = take_number(rest);
    rest = trimmed(rest);
    const bool comma = !rest.empty() && rest.front() == ',';
    if (comma) rest = trimmed(rest.substr(1));
    auto longitude = take_number(rest);
    if (!latitude || !comma || !longitude || !rest.empty())
        throw Error(Fault::bad_usage, where, shown(text) + " is not a place", accepted);
    if (!within(*latitude, {-90, 90}))
        throw Error(Fault::bad_usage, where, "latitude " + text_of(*latitude) + " is out of range", accepted);
    if (!within(*longitude, {-180, 360}))
        throw Error(Fault::bad_usage, where, "longitude " + text_of(*longitude) + " is out of range", accepted);
    if (*longitude > 180) *longitude -= 360;
    return {*latitude * planet::degrees, *longitude * planet::degrees, {}};
}

double parse_angle(std::string_view where, std::string_view text, Range range) {
    return parse_number(where, text, range, "degrees") * planet::degrees;
}

PictureSize parse_size(std::string_view where, std::string_view text) {
    const std::string side = std::to_string(picture_side_max);
    const std::string accepted = "WIDTHxHEIGHT in pixels, 1x1 to " + side + "x" + side;
    const std::string_view whole = trimmed(text);
    const auto take = [](std::string_view& rest) -> std::optional<long> {
        long value = 0;
        if (rest.empty() || rest.front() == '-') return {};
        const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
        if (failure == std::errc::invalid_argument) return {};
        if (failure == std::errc::result_out_of_range) value = picture_side_max + 1L;
        rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
        return value;
    };
    std::string_view rest = whole;
    const auto width = take(rest);
    const bool cross = !rest.empty() && (rest.front() == 'x' || rest.front() == 'X');
    if (cross) rest.remove_prefix(1);
    const auto height = take(rest);
    if (!width || !cross || !height || !rest.empty())
        throw Error(Fault::bad_usage, where, shown(text) + " is not a size", accepted);
    const auto fits = [](long value) { return value >= 1 && value <= picture_side_max; };
    if (!fits(*width) || !fits(*height))
        throw Error(Fault::bad_usage, where, shown(text) + " is out of range", accepted);
    return {static_cast<std::int32_t>(*width), static_cast<std::int32_t>(*height)};
}

PictureCrop parse_crop(std::string_view where, std::string_view text) {
    const auto first = text.find(','), second = first == text.npos ? first : text.find(',', first + 1);
    if (second == text.npos)
        throw Error(Fault::bad_usage, where, shown(text) + " is not a part of a picture",
                    "X,Y,WIDTHxHEIGHT in pixels from the top left, as 1000,200,640x480");
    const auto place = [&](std::string_view number) {
        return static_cast<std::int32_t>(parse_whole(where, number, 0, picture_side_max - 1));
    };
    const PictureSize size = parse_size(where, text.substr(second + 1));
    return {place(text.substr(0, first)), place(text.substr(first + 1, second - first - 1)), size.width, size.height};
}

std::size_t parse_choice(std::string_view where, std::string_view text, const std::vector<std::string_view>& names) {
    const auto found = std::find(names.begin(), names.end(), trimmed(text));
    if (found == names.end()) throw Error(Fault::bad_usage, where, shown(text) + " is unknown", joined(names));
    return static_cast<std::size_t>(found - names.begin());
}

std::vector<std::size_t> parse_choices(std::string_view where, std::string_view text,
                                       const std::vector<std::string_view>& names) {
    std::vector<std::size_t> chosen;
    for (std::string_view rest = text;;) {
        const auto comma = rest.find(',');
        const std::string_view name = trimmed(rest.substr(0, comma));
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw Error(Fault::bad_usage, where, shown(name) + " is unknown", joined(names) + ", separated by commas");
        const auto index = static_cast<std::size_t>(found - names.begin());
        if (std::find(chosen.begin(), chosen.end(), index) != chosen.end())
            throw Error(Fault::bad_usage, where, shown(name) + " is given twice", "each of " + joined(names) + " once");
        chosen.push_back(index);
        if (comma == std::string_view::npos) return chosen;
        rest.remove_prefix(comma + 1);
    }
}

std::vector<std::size_t> parse_wholes(std::string_view where, std::string_view text, long low, long high) {
    std::vector<std::size_t> numbers;
    for (std::string_view rest = text;;) {
        const auto comma = rest.find(',');
        numbers.push_back(static_cast<std::size_t>(parse_whole(where, trimmed(rest.substr(0, comma)), low, high)));
        if (comma == std::string_view::npos) return numbers;
        rest.remove_prefix(comma + 1);
    }
}

std::filesystem::path parse_picture_name(std::string_view where, std::string_view text) {
    if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
    std::filesystem::path path = text;
    std::string ending = path.extension().native();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const char* known : {".png", ".jpg", ".jpeg", ".tif", ".tiff"})
        if (ending == known) return path;
    throw Error(Fault::bad_usage, where, shown(text) + " has no ending of a picture", ".png, .jpg or .tif");
}

std::string shown(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string line = "'";
    for (const char c : text.substr(0, longest)) line.push_back(c >= ' ' && c <= '~' ? c : '?');
    return line.append(text.size() > longest ? "...'" : "'");
}

}  // namespace render
