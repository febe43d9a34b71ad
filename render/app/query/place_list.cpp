#include "render/app/query/place_list.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <utility>

#include "planet/elevation/features.h"
#include "planet/elevation/source_file.h"
#include "planet/error.h"
#include "render/app/values.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

constexpr std::string_view accepted =
    "a place a line, latitude -90 to 90 and longitude -180 to 360 in degrees, as 37.5,-105.4";

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

bool separates(char c) {
    return c == ',' || c == ';' || c == '\t' || c == ' ' || c == '\r';
}

/// The fields of a line. Blanks around a separator belong to it.
void split(std::string_view line, std::vector<std::string_view>& fields) {
    fields.clear();
    std::size_t at = 0;
    while (at < line.size()) {
        while (at < line.size() && (line[at] == ' ' || line[at] == '\r')) ++at;
        const std::size_t first = at;
        while (at < line.size() && !separates(line[at])) ++at;
        std::string_view field = line.substr(first, at - first);
        if (field.size() > 1 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
        fields.push_back(field);
        while (at < line.size() && (line[at] == ' ' || line[at] == '\r')) ++at;
        if (at < line.size() && separates(line[at])) ++at;
    }
}

std::optional<double> number(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

struct Columns {
    std::size_t latitude = 0, longitude = 1;
};

Columns columns_of(const std::string& where, const std::vector<std::string_view>& names) {
    const auto find = [&](std::initializer_list<std::string_view> accepted_names) {
        for (std::size_t i = 0; i < names.size(); ++i)
            for (const auto name : accepted_names)
                if (lower(names[i]) == name) return i;
        throw Error(Fault::bad_data, where, "its first line names no columns of latitude and longitude",
                    "lat,lon or latitude,longitude or y,x");
    };
    return {find({"lat", "latitude", "latitude_deg", "y"}),
            find({"lon", "lng", "long", "longitude", "longitude_deg", "x"})};
}

planet::Geodetic place_from(std::optional<double> latitude, std::optional<double> longitude, const std::string& where,
                            std::string_view shown_text) {
    if (!latitude || !longitude) throw Error(Fault::bad_data, where, shown(shown_text) + " is not a place", accepted);
    if (std::abs(*latitude) > 90) throw Error(Fault::bad_data, where, "latitude is out of range", accepted);
    if (!(*longitude >= -180 && *longitude <= 360))
        throw Error(Fault::bad_data, where, "longitude is out of range", accepted);
    if (*longitude > 180) *longitude -= 360;
    return {*latitude * planet::degrees, *longitude * planet::degrees, {}};
}

}  // namespace

std::vector<planet::Geodetic> places_from_table(const std::string& where, std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    std::vector<planet::Geodetic> places;
    std::vector<std::string_view> fields;
    Columns columns;
    bool first = true;
    for (std::size_t line_number = 1; !text.empty(); ++line_number) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        split(line, fields);
        if (fields.empty() || line.front() == '#') continue;
        if (std::exchange(first, false) && !number(fields.front()) && lower(fields.front()) != "nan") {
            columns = columns_of(where, fields);
            continue;
        }
        const auto field = [&](std::size_t i) { return i < fields.size() ? number(fields[i]) : std::nullopt; };
        places.push_back(place_from(field(columns.latitude), field(columns.longitude),
                                    where + " line " + std::to_string(line_number), line));
        if (places.size() > place_list_max)
            throw Error(Fault::bad_data, where, "holds too many places", "at most " + std::to_string(place_list_max));
    }
    if (places.empty()) throw Error(Fault::bad_data, where, "holds no place", accepted);
    return places;
}

std::vector<planet::Geodetic> read_places(const std::string& path) {
    if (path == "-")
        return places_from_table("standard input", std::string(std::istreambuf_iterator<char>(std::cin), {}));
    const std::string ending = lower(std::filesystem::path(path).extension().native());
    if (ending == ".csv" || ending == ".txt" || ending == ".tsv") {
        planet::check_source_file(path, "a table of places");
        std::ifstream in(path, std::ios::binary);
        const std::string text(std::istreambuf_iterator<char>(in), {});
        if (!in && !in.eof()) throw Error(Fault::bad_data, path, "cannot be read", "a table of places");
        return places_from_table(path, text);
    }
    const planet::Features features = planet::read_features(path);
    if (features.points.empty()) throw Error(Fault::bad_data, path, "holds no point", "points");
    std::vector<planet::Geodetic> places;
    places.reserve(features.points.size());
    for (const auto& p : features.points)
        places.push_back({p.y * planet::degrees, std::remainder(p.x, 360) * planet::degrees, {}});
    return places;
}

}  // namespace render
