#pragma once
// octaglobe view: the session of a window.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "planet/streaming/resident_tiles.h"
#include "render/app/picture/layer_report.h"
#include "render/app/picture/render_options.h"

namespace render {

struct ViewerOptions {
    RenderOptions render{};  ///< the first view; `size` is the window's
    bool full_screen = false;
    bool bare = false;                   ///< no panels
    int frames = 0;                      ///< leave after so many; 0: when the window is closed
    double turn = 0;                     ///< rad that each of them turns about the place in the middle
    std::filesystem::path screenshot{};  ///< of the window once it has settled, after the frames; then leave
};

struct ViewerReport {
    std::uint64_t frames = 0, gl_errors = 0;
    std::string first_gl_error;
    double frame_seconds_median = 0, frame_seconds_max = 0, update_seconds_median = 0;
    std::uint64_t triangles = 0, gpu_bytes = 0;
    /// Resident memory after a tenth of the frames, and after all.
    std::uint64_t memory_early_bytes = 0, memory_late_bytes = 0;
    planet::ResidentCounts tiles;
    double deviation_max_m = 0, pixel_deviation_max = 0;
    bool settled = false;
    std::string view;  ///< the command line of the last view
    std::vector<std::string> damage;
    std::vector<LayerReport> layers;
    std::string gl_version, gl_renderer, context;
};

/// Opens a window and shows the globe until it is closed. Throws planet::Error: no_graphics, bad_data, bad_usage.
ViewerReport view_globe(const ViewerOptions& options);

}  // namespace render
