#include "render/app/fly/flight_plan.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "planet/elevation/features.h"
#include "planet/elevation/source_file.h"
#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/local_frame.h"
#include "render/app/picture/daylight.h"
#include "render/app/values.h"

namespace render {

namespace {

using nlohmann::json;
using planet::degrees;
using planet::Error;
using planet::Fault;
using planet::wgs84;

constexpr std::string_view a_plan =
    R"({"keys": [{"at": [LAT, LON], "range": METRES, ...}, ...]}, or a file with a line)";
constexpr double longest_flight_s = 1e6;

/// A value as it would stand on the command line.
std::string text_of(const json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump();
    std::string list;
    for (const json& each : value) list.append(list.empty() ? "" : ",").append(each.dump());
    return list;
}

/// Takes over one word of a key. Throws as the parsers of the command line do.
void set_word(PlannedKey& key, const std::string& word, std::string_view where, const std::string& text) {
    if (word == "at") {
        key.at = parse_place(where, text);
    } else if (word == "range") {
        key.range = parse_distance(where, text, {1, 1e9});
        key.height.reset();
    } else if (word == "height") {
        key.height = parse_distance(where, text, {0.1, 1e9});
        key.range.reset();
    } else if (word == "heading") {
        key.heading = parse_angle(where, text, {-360, 360});
    } else if (word == "pitch") {
        key.pitch = parse_angle(where, text, {-90, 90});
    } else if (word == "exaggeration") {
        key.exaggeration = parse_number(where, text, {0, 100});
    } else if (word == "time") {
        key.time = planet::utc_from_iso8601(text, where);
    } else if (word == "seconds") {
        key.seconds = parse_number(where, text, {0, longest_flight_s}, "seconds");
    } else if (word == "speed") {
        key.speed = parse_number(where, text, {0.001, 1000});
    } else {
        throw Error(Fault::bad_data, where, "is unknown",
                    "at, range, height, heading, pitch, exaggeration, time, seconds, speed");
    }
}

PlannedKey key_from(const json& object, PlannedKey key, bool first, const std::string& where) {
    if (!object.is_object()) throw Error(Fault::bad_data, where, "is no object", a_plan);
    if (object.contains("range") && object.contains("height"))
        throw Error(Fault::bad_data, where, "has a range and a height", "one of them");
    key.seconds.reset();
    key.speed = 1;
    for (const auto& [word, value] : object.items()) set_word(key, word, where + " " + shown(word), text_of(value));
    if (first && !object.contains("at")) throw Error(Fault::bad_data, where, "has no place", "\"at\": [LAT, LON]");
    if (!key.range && !key.height) throw Error(Fault::bad_data, where, "has no distance", "\"range\" or \"height\"");
    if (first && key.height && !object.contains("pitch")) key.pitch = 0;  // as `render` has it
    return key;
}

FlightPlan plan_from(const json& file, const PlannedKey& usual) {
    for (const auto& [word, value] : file.items())
        if (word != "keys") throw Error(Fault::bad_data, shown(word), "is unknown", "keys");
    const json& keys = file.at("keys");
    if (!keys.is_array()) throw Error(Fault::bad_data, "keys", "is no list", a_plan);
    if (keys.size() < 2 || keys.size() > most_flight_keys)
        throw Error(Fault::bad_data, "keys", "holds " + std::to_string(keys.size()),
                    "2 to " + std::to_string(most_flight_keys));
    FlightPlan plan;
    PlannedKey key = usual;
    double reached = -1;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const std::string where = "key " + std::to_string(i + 1);
        key = key_from(keys[i], key, i == 0, where);
        plan.keys.push_back(key);
        if (i == 0) reached = key.seconds.value_or(0);
        if (i == 0 || !key.seconds) continue;
        if (!(*key.seconds > reached))
            throw Error(Fault::bad_data, where, "is reached no later than one before it", "seconds that grow");
        reached = *key.seconds;
    }
    return plan;
}

/// What is in a file of keys; nothing if it is another file.
std::optional<json> keys_of(const std::filesystem::path& file) {
    if (file.extension() != ".json") return {};
    std::ifstream in(file, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    json content;
    try {
        content = json::parse(text);
    } catch (const json::parse_error& error) {
        throw Error(Fault::bad_data, file.native() + " byte " + std::to_string(error.byte), "is no JSON", a_plan);
    }
    if (content.is_object() && content.contains("keys")) return content;
    if (content.is_object() && content.contains("type")) return {};
    throw Error(Fault::bad_data, file.native(), "holds no keys", a_plan);
}

/// Places along a line, by the distance from its beginning.
class Line {
  public:
    Line(const std::vector<glm::dvec3>& vertices) {
        for (const glm::dvec3& v : vertices) {
            const glm::dvec3 normal = planet::normal_from_geodetic(v.y * degrees, v.x * degrees);
            const double step = normals_.empty() ? 0 : distance(normals_.back(), normal);
            if (!normals_.empty() && step < 1e-3) continue;
            reached_.push_back(normals_.empty() ? 0 : reached_.back() + step);
            normals_.push_back(normal);
        }
    }
    double length() const { return reached_.back(); }
    glm::dvec3 at(double metres) const {
        const auto after = std::upper_bound(reached_.begin(), reached_.end(), metres) - reached_.begin();
        const auto i = static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(after - 1, 0, static_cast<std::ptrdiff_t>(reached_.size()) - 2));
        const double part = (metres - reached_[i]) / (reached_[i + 1] - reached_[i]);
        return GreatCircle(normals_[i], normals_[i + 1]).at(std::clamp(part, 0.0, 1.0));
    }
    /// The middle of what is within a distance on both sides: corners are cut, the ends stay.
    glm::dvec3 smooth(double metres, double reach) const {
        const double r = std::min({reach, metres, length() - metres});
        glm::dvec3 sum(0);
        for (int i = -8; i <= 8; ++i) sum += at(metres + r * i / 8);
        return glm::normalize(sum);
    }

  private:
    static double distance(const glm::dvec3& a, const glm::dvec3& b) {
        return GreatCircle(a, b).angle() * wgs84.mean_radius();
    }
    std::vector<glm::dvec3> normals_;
    std::vector<double> reached_;
};

FlightPlan plan_along(const Line& line, const PlannedKey& usual, const LineFollowing& following) {
    constexpr double key_s = 2;
    const double wanted = std::ceil(line.length() / (key_s * following.speed_m_s));
    const double legs = std::clamp(wanted, 1.0, static_cast<double>(most_flight_keys - 1));
    const double step = line.length() / legs;
    FlightPlan plan{{}, true};
    for (double i = 0; i <= legs; ++i) {
        PlannedKey key = usual;
        const glm::dvec3 normal = line.smooth(i * step, step),
                         ahead = line.smooth(std::min(i + 0.5, legs) * step, step),
                         behind = line.smooth(std::max(i - 0.5, 0.0) * step, step);
        key.at = planet::geodetic_from_normal(normal);
        const glm::dmat3 enu = planet::ecef_from_enu(normal);
        const glm::dvec3 course = ahead - behind;
        key.heading = std::atan2(glm::dot(course, enu[0]), glm::dot(course, enu[1]));
        key.height = following.height;
        key.pitch = following.pitch;
        key.seconds = i * step / following.speed_m_s;
        plan.keys.push_back(key);
    }
    return plan;
}

FlightPlan plan_of_line(const std::string& file, const PlannedKey& usual, const LineFollowing& following) {
    const planet::Features features = planet::read_features(file);
    if (features.lines.size() != 1)
        throw Error(Fault::bad_data, file, "holds " + std::to_string(features.lines.size()) + " lines", "one line");
    const Line line(features.lines.front());
    if (!(line.length() > 1)) throw Error(Fault::bad_data, file, "holds a line shorter than 1 m", "a line to follow");
    return plan_along(line, usual, following);
}

double distance_of(const PlannedKey& key) {
    return key.range ? *key.range : *key.height;
}

FlightKey flight_key(const PlannedKey& key, const DrawnSurface& surface, About about, planet::UtcTime usual_time) {
    const glm::dvec3 normal = planet::normal_from_geodetic(key.at.latitude, key.at.longitude);
    FlightKey flown;
    flown.seconds = key.seconds;
    flown.pace = key.speed;
    flown.view = {{normal, surface.ground(normal, key.exaggeration), distance_of(key), key.heading, key.pitch},
                  key.exaggeration,
                  key.time.value_or(usual_time)};
    if (about == About::eye && key.range) {
        const Pose pose = pose_of(flown.view.sight);
        const double ground = surface.ground(pose.normal, key.exaggeration);
        flown.view.sight = {pose.normal, ground, std::max(pose.h - ground, least_clearance_m), pose.heading,
                            pose.pitch};
    }
    return flown;
}

/// Over hills and valleys evenly: what the ground is at most within some keys, and that on average.
void even_out(std::vector<FlightKey>& keys) {
    constexpr std::ptrdiff_t reach = 3;
    const auto count = static_cast<std::ptrdiff_t>(keys.size());
    const auto over_near = [&](auto&& take_in) {
        std::vector<double> heights;
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            double value = 0, weight = 0;
            for (std::ptrdiff_t k = i - reach; k <= i + reach; ++k)
                take_in(keys[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, count - 1))].view.sight.h, value,
                        weight);
            heights.push_back(value / weight);
        }
        for (std::size_t i = 0; i < heights.size(); ++i) keys[i].view.sight.h = heights[i];
    };
    over_near([](double h, double& value, double& weight) {
        value = weight > 0 ? std::max(value, h) : h;
        weight = 1;
    });
    over_near([](double h, double& value, double& weight) {
        value += h;
        ++weight;
    });
}

}  // namespace

FlightPlan read_flight_plan(const std::filesystem::path& file, const PlannedKey& usual, const LineFollowing& line) {
    planet::check_source_file(file.native(), a_plan);
    const auto keys = keys_of(file);
    if (!keys) return plan_of_line(file.native(), usual, line);
    try {
        return plan_from(*keys, usual);
    } catch (const Error& error) {
        throw Error(Fault::bad_data, file.native(), error.what());
    }
}

planet::UtcTime FlightPlan::usual_time() const {
    for (const PlannedKey& key : keys)
        if (key.time) return *key.time;
    const PlannedKey& nearest = *std::ranges::min_element(keys, {}, distance_of);
    return morning_at(nearest.at, distance_of(nearest));
}

FlightPath flight_path(const FlightPlan& plan, const DrawnSurface& surface) {
    const bool places = std::ranges::all_of(plan.keys, [](const PlannedKey& key) { return key.range.has_value(); });
    const About about = places ? About::place : About::eye;
    const planet::UtcTime usual_time = plan.usual_time();
    std::vector<FlightKey> keys;
    for (const PlannedKey& key : plan.keys) keys.push_back(flight_key(key, surface, about, usual_time));
    if (plan.follows_line) even_out(keys);
    return {std::move(keys), about};
}

}  // namespace render
