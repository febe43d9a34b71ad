#pragma once
// Where the frames of a flight go: a folder of PNGs, or the program ffmpeg, which makes a video of them.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "render/app/values.h"

namespace render {

/// Appears whole in finish(), or not at all.
class FrameOutput {
  public:
    virtual ~FrameOutput() = default;
    /// @param number of the frame in the whole flight, ascending @param rgb top row first
    virtual void write(long number, std::span<const std::uint8_t> rgb) = 0;
    virtual void finish() = 0;
    /// Whether a frame was there from the beginning, drawn before the flight was killed.
    virtual bool has(long) const { return false; }
};

/// Whether a name is that of a video: it ends in .mp4, .webm, .mkv or .mov. One without an ending is a folder. Throws
/// planet::Error(bad_usage) for others, naming --output.
bool is_video(const std::filesystem::path& target);

/// How a flight that was killed goes on.
struct FlightResumption {
    bool wanted = false;
    std::string flight{};  ///< what its frames depend on: only those of the same are kept
};

/// Refuses at once, by planet::Error(bad_usage), what cannot be written: a folder that is there and not empty, a video
/// without ffmpeg in PATH or of odd sides.
/// Also to go on with a video, or with frames of another flight. Where there are frames of a flight that was killed and
/// going on is not wanted, a line on standard error says so.
std::unique_ptr<FrameOutput> make_frame_output(const std::filesystem::path& target, PictureSize size, double fps,
                                               const FlightResumption& resumption);

}  // namespace render
