#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <filesystem>

#include "planet/elevation/image_driver.h"
#include "planet/error.h"

namespace planet {
namespace {

std::string format_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (extension == ".png") return "png";
    if (extension == ".jpg" || extension == ".jpeg") return "jpg";
    if (extension == ".tif" || extension == ".tiff") return "tif";
    if (extension == ".exr") return "exr";
    throw Error(Fault::bad_usage, path, "is not a picture format that is written", ".png, .jpg, .tif or .exr");
}

void check(const std::string& path, const SinkDescription& d) {
    const auto between = [&](const char* what, int value, int low, int high) {
        if (value < low || value > high)
            throw Error(Fault::bad_usage, path, std::string(what) + " " + std::to_string(value) + " is out of range",
                        std::to_string(low) + " to " + std::to_string(high));
    };
    const int largest = d.format == "jpg" ? 65500 : 65535;
    between("width", d.width, 1, largest);
    between("height", d.height, 1, largest);
    between("number of channels", d.channels, 3, d.format == "jpg" ? 3 : 4);
    between("PNG compression", d.options.png_compression, 0, 9);
    between("JPEG quality", d.options.jpeg_quality, 1, 100);
    const bool fits = d.format == "tif" || (d.format == "png" && d.type != SampleType::float32) ||
                      (d.format == "jpg" && d.type == SampleType::uint8) ||
                      (d.format == "exr" && d.type == SampleType::float32);
    if (!fits)
        throw Error(Fault::bad_usage, path, "the format does not hold these samples",
                    "8 bit .png .jpg .tif, 16 bit .png .tif, float .tif .exr");
}

// Beside the file, so that the rename stays on one file system; of its own for every writer.
std::filesystem::path temporary_beside(const std::filesystem::path& file) {
    static std::atomic<int> count{0};
    return file.parent_path() /
           file.filename().concat("." + std::to_string(getpid()) + "-" + std::to_string(count++) + ".part");
}

}  // namespace

struct ImageWriter::State {
    std::filesystem::path file, temporary;
    std::shared_ptr<void> made;
    std::string shown_as;
    std::unique_ptr<ImageSink> sink;
    int rows_left = 0;

    ~State() {
        sink.reset();
        std::error_code ignored;
        if (!temporary.empty()) std::filesystem::remove(temporary, ignored);
    }
};

ImageWriter::ImageWriter(const std::string& path, int width, int height, int channels, SampleType type,
                         const WriteOptions& options)
    : state_(std::make_unique<State>()) {
    SinkDescription d{format_of(path), {}, path, width, height, channels, type, options};
    check(path, d);
    std::error_code failed;
    state_->file = std::filesystem::weakly_canonical(std::filesystem::absolute(path), failed);  // a link stays one
    if (failed) state_->file = path;
    const auto status = std::filesystem::status(state_->file, failed);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Error(Fault::bad_usage, path, "is there and is not a file", "the name of a file");
    const auto folder = state_->file.parent_path();
    if (!std::filesystem::is_directory(folder, failed) || access(folder.c_str(), W_OK) != 0)
        throw Error(Fault::bad_usage, path, "cannot be written: no such folder, or no right to write in it",
                    "a file in a folder that can be written to");
    state_->shown_as = path;
    state_->rows_left = height;
    state_->temporary = temporary_beside(state_->file);
    d.file = state_->temporary.string();
    const ImageDriver& driver = image_driver(d.format);
    const auto make = [&] { state_->sink = driver.create(d); };
    if (options.make_file)
        state_->made = options.make_file(state_->temporary, make);
    else
        make();
}

ImageWriter::~ImageWriter() = default;
ImageWriter::ImageWriter(ImageWriter&&) noexcept = default;
ImageWriter& ImageWriter::operator=(ImageWriter&&) noexcept = default;

void ImageWriter::write_rows(const void* rows, int count) {
    assert(count >= 0 && count <= state_->rows_left);
    state_->sink->write_rows(rows, count);
    state_->rows_left -= count;
}

void ImageWriter::finish() {
    assert(state_->rows_left == 0);
    state_->sink->close();
    state_->sink.reset();
    std::error_code failed;
    std::filesystem::rename(state_->temporary, state_->file, failed);
    if (failed) throw Error(Fault::bad_usage, state_->shown_as, "cannot be written: " + failed.message());
    state_->temporary.clear();
    state_->made.reset();
}

namespace {

template <class Sample>
void write_whole(const std::string& path, const BasicImage<Sample>& image, SampleType type,
                 const WriteOptions& options) {
    assert(image.pixels.size() == image.row_size() * static_cast<std::size_t>(image.height));
    ImageWriter writer(path, image.width, image.height, image.channels, type, options);
    writer.write_rows(image.pixels.data(), image.height);
    writer.finish();
}

}  // namespace

void write_image(const std::string& path, const Image& image, const WriteOptions& options) {
    write_whole(path, image, SampleType::uint8, options);
}
void write_image(const std::string& path, const DeepImage& image, const WriteOptions& options) {
    write_whole(path, image, SampleType::uint16, options);
}
void write_image(const std::string& path, const FloatImage& image, const WriteOptions& options) {
    write_whole(path, image, SampleType::float32, options);
}

}  // namespace planet
