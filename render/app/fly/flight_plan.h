#pragma once
// What `octaglobe fly` follows: a JSON file of views, or a line of any vector file.
//
//     {"keys": [
//         {"at": [37.58, -105.49], "range": "2000km"},
//         {"range": "40km", "heading": 30, "pitch": -25, "speed": 2},
//         {"at": "37.6,-105.4", "range": 15000, "heading": 80, "seconds": 20, "time": "2026-06-21T16:00:00Z"}]}
//
// The words are those of `octaglobe render`: at, range or height, heading, pitch, exaggeration, time. What a key leaves
// out is as in the key before; the first needs a place and a range or a height. `seconds` says when a key is reached,
// `speed` how much faster than a quiet pace it is flown to.

#include <filesystem>
#include <optional>
#include <vector>

#include "planet/geodesy/utc_time.h"
#include "render/app/picture/drawn_surface.h"
#include "render/viewer/flight_path.h"

namespace render {

inline constexpr std::size_t most_flight_keys = 10'000;

/// A key as it is in the file.
struct PlannedKey {
    planet::Geodetic at{};
    std::optional<double> range{};   ///< m, from the ground at `at`; else
    std::optional<double> height{};  ///< m, over the ground at `at`
    double heading = 0, pitch = -90 * planet::degrees;
    double exaggeration = 1;
    std::optional<planet::UtcTime> time{};  ///< see FlightPlan::usual_time
    std::optional<double> seconds{};
    double speed = 1;
};

struct FlightPlan {
    std::vector<PlannedKey> keys;
    bool follows_line = false;

    /// Of keys that have none: that of the first key that has one, else morning at the place that is seen from nearest.
    planet::UtcTime usual_time() const;
};

/// How a line is followed.
struct LineFollowing {
    double height = 500;                   ///< m over the ground
    double pitch = -15 * planet::degrees;  ///< rad
    double speed_m_s = 100;
};

/// Reads a plan. A file that ends in .json and holds no GeoJSON is one of keys; any other is read as features, of which
/// there must be one line. Throws planet::Error(bad_data), naming file and key.
/// @param usual what keys have that say nothing else: exaggeration and, if it was given, time
FlightPlan read_flight_plan(const std::filesystem::path& file, const PlannedKey& usual, const LineFollowing& line);

/// The flight over the drawn ground. If each key is a range it is about the places that are looked at, else about the eye.
FlightPath flight_path(const FlightPlan& plan, const DrawnSurface& surface);

}  // namespace render
