#pragma once
// What a picture is of: everything `octaglobe render` can be told. The same options give the same bytes, so nothing in
// here may default to the clock, the machine or chance.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "planet/frames.h"
#include "planet/geodesy/utc_time.h"
#include "render/app/picture/earth.h"
#include "render/app/picture/layer_options.h"
#include "render/app/values.h"
#include "render/gl/context.h"

namespace CLI {
class App;
}

namespace render {

/// What --show adds to a picture. The bits of RenderOptions::show.
enum class Overlay : std::uint32_t {
    mesh = 1,         ///< the sides of the triangles
    levels = 2,       ///< a colour for each level
    curve = 4,        ///< the Sierpinski curve through the triangles
    segments = 8,     ///< a colour for each segment: what is drawn and kept as one
    deviations = 16,  ///< a colour for how far a triangle is at most from the finest surface
    graticule = 32,   ///< parallels and meridians
    coastlines = 64,
    borders = 128,  ///< of countries
    relief = 256,   ///< colours of heights instead of the imagery
};

/// As --show names them.
struct OverlayName {
    std::string_view name;
    Overlay overlay;
};
inline constexpr OverlayName overlay_names[] = {{"mesh", Overlay::mesh},
                                                {"levels", Overlay::levels},
                                                {"curve", Overlay::curve},
                                                {"segments", Overlay::segments},
                                                {"deviations", Overlay::deviations},
                                                {"graticule", Overlay::graticule},
                                                {"coastlines", Overlay::coastlines},
                                                {"borders", Overlay::borders},
                                                {"relief", Overlay::relief}};

struct RenderOptions {
    /// The place the picture is about, h = 0. What "ground" means below is the drawn surface there: the terrain with
    /// its exaggeration, or the sea. Default: the middle of the land hemisphere's southern half, which shows Africa,
    /// Europe and the Atlantic.
    planet::Geodetic at{12 * planet::degrees, 12 * planet::degrees, {}};

    /// Where the eye is. With `height`: above `at`, that many metres over the ground. Else `range` metres from the
    /// ground at `at`, so placed that it looks at it. With neither: the range at which the whole globe fits.
    std::optional<double> range{};   ///< m, 1..1e9
    std::optional<double> height{};  ///< m, 0.1..1e9
    double heading = 0;  ///< rad clockwise from north, 0..2 pi: where the eye looks (straight down: what is up)
    double pitch = -90 * planet::degrees;  ///< rad, -pi/2 (straight down)..pi/2
    double fov = 40 * planet::degrees;     ///< rad, across the shorter side of the picture, 1..150 degrees
    PictureSize size{1920, 1080};

    /// Places the sun and the stars. Default 2026-06-21T09:00:00Z: the June solstice, morning over Africa. Commands take
    /// morning_at() for a place that is given without a time.
    planet::UtcTime time = std::chrono::sys_days{std::chrono::year{2026} / 6 / 21} + std::chrono::hours{9};

    double exaggeration = 1;                     ///< of heights, 0..100
    double max_pixel_deviation = 0.5;            ///< pixels, 0.05..100: the certified bound on what the mesh may be off
    std::optional<std::size_t> max_triangles{};  ///< >= 1: coarser than max_pixel_deviation asks for, if it takes more
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< of elevation tiles; what the picture needs is drawn anyway
    bool measure_frames = false;                      ///< what a next frame would cost, for the report
    std::uint32_t show = 0;                           ///< Overlay bits
    std::optional<double> scale{};  ///< of the widths of lines, marks and letters, 0.5..4; without: 1, in a window that
                                    ///< of its display
    int samples = 0;                ///< a pixel: 1, 2, 4 or 8, at most what the context has; 0: 4 where ridges can
                                    ///< stand against the sky, 1 from afar, where the air hides the edge
    int threads = 0;                ///< 1..256; 0: as many as there are processors. Changes no byte
    BackendChoice backend = BackendChoice::automatic;

    EarthSources earth{};
    std::optional<std::filesystem::path> store{};  ///< a baked store instead of the default Earth
    std::vector<std::filesystem::path> imagery{};  ///< pictures of the whole globe, later on top

    std::vector<LayerOptions> layers{};  ///< over the terrain, later on top

    /// Pixels, 96 or more: larger pictures are drawn in parts. No option says another: for tests.
    int part_side = 2048;
    std::optional<PictureCrop> crop{};  ///< only these pixels of the picture, just as they are in the whole
    std::filesystem::path output = "globe.png";

    /// Told how far a step is, 0..1 or NaN, from any thread. Never null.
    std::function<void(std::string_view step, double fraction)> progress = [](std::string_view, double) {};

    /// `threads`, with 0 resolved: at least 1.
    unsigned thread_count() const {
        return threads > 0 ? static_cast<unsigned>(threads) : std::max(1u, std::thread::hardware_concurrency());
    }
    /// What of the picture is drawn.
    PictureCrop drawn() const { return crop.value_or(PictureCrop{0, 0, size.width, size.height}); }
    bool has_layers() const { return !layers.empty() || shows(Overlay::coastlines) || shows(Overlay::borders); }
    double drawn_scale() const { return scale.value_or(1); }
    bool shows(Overlay overlay) const { return (show & static_cast<std::uint32_t>(overlay)) != 0; }
};

/// Adds --elevation and --elevation-datum. What the options are put into must live as long as the parser. Values are
/// checked while parsing (planet::Error, bad_usage).
void add_elevation_options(CLI::App& command, EarthSources& sources);

/// Adds --fov, --size and --time.
void add_lens_options(CLI::App& command, RenderOptions& options);

/// Adds --at to --time.
void add_view_options(CLI::App& command, RenderOptions& options);

/// After parsing: what follows from options that were given for those of add_view_options() that were not.
void complete_view_options(const CLI::App& command, RenderOptions& options);

/// Adds what is drawn and how well, and the sources: all the others but --output and --json.
void add_look_options(CLI::App& command, RenderOptions& options);

void add_backend_option(CLI::App& command, RenderOptions& options);

/// Adds all options of a picture but --json.
void add_picture_options(CLI::App& command, RenderOptions& options);

}  // namespace render
