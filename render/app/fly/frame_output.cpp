#include "render/app/fly/frame_output.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <set>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "render/app/fly/video_encoder.h"
#include "render/app/output_folder.h"

namespace render {

namespace {

constexpr const char* accepted = "a folder's name without ending, for PNGs; or .mp4, .webm, .mkv, .mov";

/// In the temporary folder only, beside the frames.
constexpr const char* flight_file = "flight";

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The number of a frame by its name; nothing for other files, and for pictures without an end.
std::optional<long> whole_frame(const std::filesystem::path& file) {
    long number = 0;
    int length = 0;
    const std::string name = file.filename();
    if (std::sscanf(name.c_str(), "frame_%6ld.png%n", &number, &length) != 1 || length != static_cast<int>(name.size()))
        return {};
    constexpr std::string_view end = "IEND\xae\x42\x60\x82";
    if (!bytes_of(file).ends_with(end)) return {};
    return number;
}

std::optional<std::filesystem::path> frames_to_go_on_with(const std::filesystem::path& target,
                                                          const FlightResumption& resumption) {
    const auto begun = OutputFolder::left_behind(target);
    if (!begun) return {};
    if (!resumption.wanted) {
        std::cerr << "octaglobe: note: " << begun->native()
                  << " holds frames of a flight that was killed; --resume goes on with them\n";
        return {};
    }
    if (bytes_of(*begun / flight_file) != resumption.flight)
        throw planet::Error(planet::Fault::bad_usage, "--resume",
                            shown(begun->native()) + " holds frames of another flight, or of other options",
                            "the command that was killed, with --resume; or that folder removed");
    return begun;
}

class FolderOutput : public FrameOutput {
  public:
    FolderOutput(const std::filesystem::path& target, PictureSize size, const FlightResumption& resumption)
        : folder_("--output", target, frames_to_go_on_with(target, resumption)), size_(size) {
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
            if (const auto number = whole_frame(entry.path()))
                there_.insert(*number);
            else
                std::filesystem::remove(entry.path());
        std::ofstream(folder_.path() / flight_file, std::ios::binary) << resumption.flight;
    }

    void write(long number, std::span<const std::uint8_t> rgb) override {
        char name[32];
        std::snprintf(name, sizeof name, "frame_%06ld.png", number);
        planet::ImageWriter writer((folder_.path() / name).native(), size_.width, size_.height, 3,
                                   planet::SampleType::uint8);
        writer.write_rows(rgb.data(), size_.height);
        writer.finish();
    }
    bool has(long number) const override { return there_.contains(number); }
    void finish() override {
        std::filesystem::remove(folder_.path() / flight_file);
        folder_.commit();
    }

  private:
    OutputFolder folder_;
    PictureSize size_;
    std::set<long> there_;
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

std::unique_ptr<FrameOutput> make_frame_output(const std::filesystem::path& target, PictureSize size, double fps,
                                               const FlightResumption& resumption) {
    if (!is_video(target)) return std::make_unique<FolderOutput>(target, size, resumption);
    if (resumption.wanted)
        throw planet::Error(planet::Fault::bad_usage, "--resume", "a video cannot be gone on with", accepted);
    return std::make_unique<VideoEncoder>(target, size, fps);
}

}  // namespace render
