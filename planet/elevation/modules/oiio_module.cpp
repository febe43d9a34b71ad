// The module octaglobe_oiio: pictures through OpenImageIO.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "planet/elevation/image_driver.h"
#include "planet/error.h"

namespace planet {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr const char* a_picture = "a picture, e.g. a PNG, JPEG, TIFF or OpenEXR";

// OpenImageIO reports some damage only as a message beside a successful read; it counts as damage here.
class OiioSource : public ImageSource {
  public:
    OiioSource(std::unique_ptr<ImageInput> input, const std::string& path) : input_(std::move(input)), path_(path) {
        const ImageSpec& spec = input_->spec();
        width = spec.width;
        height = spec.height;
        channels = std::min(spec.nchannels, spec.alpha_channel == 3 ? 4 : 3);
        if (spec.nchannels <= 2) channels = spec.nchannels == 2 && spec.alpha_channel == 1 ? 2 : 1;
        deep = spec.format.basetype != TypeDesc::UINT8;
        linear = spec.get_string_attribute("oiio:ColorSpace") == "Linear" ||
                 (spec.format.is_floating_point() && spec.get_string_attribute("oiio:ColorSpace") != "sRGB");
        if (width < 1 || height < 1 || spec.depth > 1)
            throw Error(Fault::bad_data, path_, "is not a flat picture", a_picture);
    }

    void read_rows(int count, void* out) override {
        const ImageSpec& spec = input_->spec();
        const TypeDesc type = deep ? TypeDesc::FLOAT : TypeDesc::UINT8;
        if (spec.tile_width > 0) return read_from_tiles(count, static_cast<char*>(out), type);
        const int y = spec.y + next_row_;
        check(input_->read_scanlines(0, 0, y, y + count, 0, 0, channels, type, out));
        next_row_ += count;
    }

  private:
    void read_from_tiles(int count, char* out, TypeDesc type) {
        const ImageSpec& spec = input_->spec();
        const std::size_t row_bytes = static_cast<std::size_t>(width * channels) * type.size();
        for (int i = 0; i < count; ++i, ++next_row_, out += row_bytes) {
            const int band = next_row_ / spec.tile_height;
            if (band != band_) {
                band_ = band;
                tiles_.resize(row_bytes * static_cast<std::size_t>(spec.tile_height));
                const int y = spec.y + band * spec.tile_height;
                check(input_->read_tiles(0, 0, spec.x, spec.x + width, y,
                                         std::min(y + spec.tile_height, spec.y + height), spec.z, spec.z + 1, 0,
                                         channels, type, tiles_.data()));
            }
            std::memcpy(out, tiles_.data() + static_cast<std::size_t>(next_row_ % spec.tile_height) * row_bytes,
                        row_bytes);
        }
    }

    void check(bool good) {
        if (good && !input_->has_error()) return;
        throw Error(Fault::bad_data, path_, "is damaged or cut short: " + input_->geterror(), a_picture);
    }

    std::unique_ptr<ImageInput> input_;
    std::string path_;
    int next_row_ = 0;
    int band_ = -1;
    std::vector<char> tiles_;
};

class OiioSink : public ImageSink {
  public:
    OiioSink(std::unique_ptr<ImageOutput> output, const SinkDescription& d)
        : output_(std::move(output)), shown_as_(d.shown_as), type_(type_of(d.type)) {
        ImageSpec spec(d.width, d.height, d.channels, type_);
        spec.attribute("oiio:ColorSpace", d.type == SampleType::float32 ? "Linear" : "sRGB");
        spec.attribute("oiio:UnassociatedAlpha", 1);
        spec.attribute("DateTime", "1970:01:01 00:00:00");  // or it would add the present one
        if (d.format == "png") spec.attribute("png:compressionLevel", d.options.png_compression);
        if (d.format == "jpg") spec.attribute("Compression", "jpeg:" + std::to_string(d.options.jpeg_quality));
        if (d.format == "tif" || d.format == "exr") spec.attribute("Compression", "zip");
        // Offsets of 32 bits reach 4 GiB; what does not compress grows.
        constexpr OIIO::imagesize_t classic_tiff_bytes = 3'900'000'000;
        if (d.format == "tif" && spec.image_bytes() > classic_tiff_bytes) spec.attribute("tiff:bigtiff", 1);
        check(output_->open(d.file, spec));
    }

    void write_rows(const void* rows, int count) override {
        const int y = output_->spec().y + next_row_;
        check(output_->write_scanlines(y, y + count, 0, type_, rows));
        next_row_ += count;
    }
    void close() override { check(output_->close()); }

  private:
    static TypeDesc type_of(SampleType type) {
        return type == SampleType::uint8    ? TypeDesc::UINT8
               : type == SampleType::uint16 ? TypeDesc::UINT16
                                            : TypeDesc::FLOAT;
    }
    void check(bool good) {
        if (good && !output_->has_error()) return;
        throw Error(Fault::bad_usage, shown_as_, "cannot be written: " + output_->geterror());
    }

    std::unique_ptr<ImageOutput> output_;
    std::string shown_as_;
    TypeDesc type_;
    int next_row_ = 0;
};

class OiioDriver : public ImageDriver {
  public:
    std::unique_ptr<ImageSource> open(const std::string& path) const override {
        ImageSpec wish;
        wish.attribute("oiio:UnassociatedAlpha", 1);
        auto input = ImageInput::open(path, &wish);
        if (!input) throw Error(Fault::bad_data, path, "cannot be read: " + OIIO::geterror(), a_picture);
        return std::make_unique<OiioSource>(std::move(input), path);
    }

    std::unique_ptr<ImageSink> create(const SinkDescription& d) const override {
        auto output = ImageOutput::create(d.format);
        if (!output)
            throw Error(Fault::bad_usage, d.shown_as, "OpenImageIO was built without this format: " + OIIO::geterror());
        return std::make_unique<OiioSink>(std::move(output), d);
    }

    std::string version() const override { return "OpenImageIO " OIIO_VERSION_STRING; }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::ImageDriver* octaglobe_oiio_1() {
    static const planet::OiioDriver driver;
    return &driver;
}
