#pragma once
// Frames as a video, made by the program ffmpeg as a process of its own.

#include <sys/types.h>

#include <string>

#include "render/app/fly/frame_output.h"
#include "render/app/temporary_names.h"

namespace render {

class VideoEncoder : public FrameOutput {
  public:
    /// Starts ffmpeg; the codec is what it has for the name's ending. Throws planet::Error(bad_usage) if it is not in
    /// PATH, sides are odd (video halves colour) or the target cannot be written.
    VideoEncoder(std::filesystem::path target, PictureSize size, double fps);
    ~VideoEncoder() override;

    void write(long number, std::span<const std::uint8_t> rgb) override;
    void finish() override;

  private:
    void open_temporary();
    void start(const std::string& program, PictureSize size, double fps);
    int wait();
    void abandon() noexcept;
    [[noreturn]] void fail(const std::string& why) const;
    [[noreturn]] void fail_as_ffmpeg_says();

    std::filesystem::path target_, temporary_;
    TemporaryName listed_;
    pid_t process_ = 0;
    int frames_ = -1;    ///< to its standard input
    int messages_ = -1;  ///< a file in memory: its standard error
};

}  // namespace render
