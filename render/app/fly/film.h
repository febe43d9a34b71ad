#pragma once
// A flight as settled frames: each has the pixels of the picture that `octaglobe render` draws of its view, whatever was
// drawn before it and however many threads there are.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planet/streaming/resident_tiles.h"
#include "render/app/fly/flight_plan.h"
#include "render/app/fly/frame_output.h"
#include "render/app/picture/layer_report.h"
#include "render/app/picture/render_options.h"

namespace render {

struct FilmOptions {
    RenderOptions render;  ///< but for the view, which is the flight's
    double fps = 30;
    std::optional<std::pair<long, long>> frames{};  ///< first and last; without: all
};

struct FilmReport {
    double flight_seconds = 0;
    long first_frame = 0, last_frame = 0, frames_of_flight = 0;
    long drawn_frames = 0;  ///< fewer than these where others were there from before
    std::size_t triangles_max = 0;
    double deviation_max_m = 0;      ///< certified, of all frames
    double pixel_deviation_max = 0;  ///< the same
    planet::ResidentCounts tiles;
    std::vector<LayerReport> layers;
    std::vector<std::string> damage;
    std::string backend, gl_version, gl_renderer;
    std::vector<std::pair<std::string, double>> seconds;  ///< by step
};

inline constexpr long most_frames = 1'000'000;
inline constexpr int film_side_max = 8192;  ///< pixels: a frame is in memory as a whole

/// Draws the frames. Throws planet::Error as draw_picture() does, and bad_usage if FilmOptions::frames are not in the
/// flight or it has more than most_frames.
FilmReport draw_film(const FilmOptions& options, const FlightPlan& plan, FrameOutput& output);

}  // namespace render
