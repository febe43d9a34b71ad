#include "render/app/fly/frame_output.h"

#include <algorithm>
#include <cstdio>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "render/app/fly/video_encoder.h"
#include "render/app/output_folder.h"

namespace render {

namespace {

constexpr const char* accepted = "a folder's name without ending, for PNGs; or .mp4, .webm, .mkv, .mov";

class FolderOutput : public FrameOutput {
  public:
    FolderOutput(const std::filesystem::path& target, PictureSize size) : folder_("--output", target), size_(size) {}

    void write(long number, std::span<const std::uint8_t> rgb) override {
        char name[32];
        std::snprintf(name, sizeof name, "frame_%06ld.png", number);
        planet::ImageWriter writer((folder_.path() / name).native(), size_.width, size_.height, 3,
                                   planet::SampleType::uint8);
        writer.write_rows(rgb.data(), size_.height);
        writer.finish();
    }
    void finish() override { folder_.commit(); }

  private:
    OutputFolder folder_;
    PictureSize size_;
};

}  // namespace

bool is_video(const std::filesystem::path& target) {
    const std::string ending = target.extension().native();
    for (const char* known : {".mp4", ".webm", ".mkv", ".mov"})
        if (ending == known) return true;
    if (!ending.empty() || target.empty())
        throw planet::Error(planet::Fault::bad_usage, "--output", shown(target.native()) + " is no video", accepted);
    return false;
}

std::unique_ptr<FrameOutput> make_frame_output(const std::filesystem::path& target, PictureSize size, double fps) {
    if (is_video(target)) return std::make_unique<VideoEncoder>(target, size, fps);
    return std::make_unique<FolderOutput>(target, size);
}

}  // namespace render
