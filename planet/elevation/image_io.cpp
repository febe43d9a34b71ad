// Reading. Writing is in image_writer.cpp.

#include "planet/elevation/image_io.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>

#include "planet/elevation/image_driver.h"
#include "planet/elevation/module.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr const char* a_picture = "a picture, e.g. a PNG, JPEG, TIFF or OpenEXR";

// IEC 61966-2-1.
float linear_from_srgb(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
float srgb_from_linear(float v) {
    return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}
std::uint8_t byte_from_unit(float v) {
    return v > 0 ? static_cast<std::uint8_t>(std::min(v, 1.0f) * 255 + 0.5f) : std::uint8_t{0};  // NaN: 0
}
const std::array<float, 256>& linear_table() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (std::size_t i = 0; i < t.size(); ++i) t[i] = linear_from_srgb(static_cast<float>(i) / 255);
        return t;
    }();
    return table;
}

// A row of the source as RGB or RGBA in linear light.
class LinearRows {
  public:
    explicit LinearRows(ImageSource& source)
        : source_(source),
          channels_(source.channels % 2 == 0 ? 4 : 3),
          raw_(static_cast<std::size_t>(source.width * source.channels) * (source.deep ? 4u : 1u)) {}

    int channels() const { return channels_; }

    void read(float* out) {
        source_.read_rows(1, raw_.data());
        for (int x = 0; x < source_.width; ++x)
            for (int c = 0; c < channels_; ++c) *out++ = sample(x, c);
    }

  private:
    float sample(int x, int c) const {
        const bool grey = source_.channels < 3, alpha = c == 3;
        const int from = grey ? (alpha ? 1 : 0) : c;
        const std::size_t i = static_cast<std::size_t>(x * source_.channels + from);
        if (!source_.deep) {
            const auto byte = static_cast<std::uint8_t>(raw_[i]);
            return alpha ? static_cast<float>(byte) / 255 : linear_table()[byte];
        }
        float v;
        std::memcpy(&v, raw_.data() + 4 * i, 4);
        return alpha || source_.linear ? v : linear_from_srgb(v);
    }

    ImageSource& source_;
    int channels_;
    std::vector<std::byte> raw_;
};

bool is_png(const std::string& path) {
    char start[8] = {};
    std::ifstream(path, std::ios::binary).read(start, sizeof start);
    return std::memcmp(start, "\x89PNG\r\n\x1a\n", sizeof start) == 0;
}

std::unique_ptr<ImageSource> open_source(const std::string& path) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) throw Error(Fault::bad_data, path, "no such file", a_picture);
    if (!std::filesystem::is_regular_file(status)) throw Error(Fault::bad_data, path, "is not a file", a_picture);
    if (std::filesystem::file_size(path, failed) == 0) throw Error(Fault::bad_data, path, "is empty", a_picture);
    return image_driver(is_png(path) ? "png" : "").open(path);
}

int reduction_of(const ImageSource& source, const ImageOptions& options, const std::string& path) {
    const int n = options.max_width > 0 ? (source.width - 1) / options.max_width + 1 : 1;
    const std::int64_t pixels = std::int64_t{(source.width - 1) / n + 1} * ((source.height - 1) / n + 1);
    if (pixels > options.max_pixels || source.width > (1 << 20))
        throw Error(Fault::bad_data, path,
                    std::to_string(source.width) + "x" + std::to_string(source.height) + " pixels are too many",
                    "at most " + std::to_string(options.max_pixels) + " pixels");
    return n;
}

// Means of n x n pixels in linear light.
FloatImage read_linear(ImageSource& source, int n) {
    LinearRows rows(source);
    FloatImage image{(source.width - 1) / n + 1, (source.height - 1) / n + 1, rows.channels(), {}};
    image.pixels.resize(image.row_size() * static_cast<std::size_t>(image.height));
    const std::size_t channels = static_cast<std::size_t>(image.channels);
    std::vector<float> line(static_cast<std::size_t>(source.width) * channels);
    for (int y = 0; y < source.height; ++y) {
        rows.read(line.data());
        float* const out = image.pixels.data() + static_cast<std::size_t>(y / n) * image.row_size();
        const int high = std::min(n, source.height - y / n * n);
        for (int x = 0; x < source.width; ++x) {
            const int wide = std::min(n, source.width - x / n * n);
            const float share = 1.0f / static_cast<float>(wide * high);
            for (std::size_t c = 0; c < channels; ++c)
                out[static_cast<std::size_t>(x / n) * channels + c] +=
                    share * line[static_cast<std::size_t>(x) * channels + c];
        }
    }
    return image;
}

// The common case of 8-bit RGB or RGBA as it is.
Image read_bytes(ImageSource& source) {
    Image image{source.width, source.height, source.channels % 2 == 0 ? 4 : 3, {}};
    const auto pixels = static_cast<std::size_t>(source.width) * static_cast<std::size_t>(source.height);
    image.pixels.resize(pixels * static_cast<std::size_t>(image.channels));
    if (source.channels >= 3) {
        source.read_rows(source.height, image.pixels.data());
        return image;
    }
    std::vector<std::uint8_t> grey(pixels * static_cast<std::size_t>(source.channels));
    source.read_rows(source.height, grey.data());
    std::uint8_t* out = image.pixels.data();
    for (std::size_t i = 0; i < grey.size(); i += static_cast<std::size_t>(source.channels)) {
        for (int c = 0; c < 3; ++c) *out++ = grey[i];
        if (source.channels == 2) *out++ = grey[i + 1];
    }
    return image;
}

Image bytes_from_linear(const FloatImage& linear) {
    Image image{linear.width, linear.height, linear.channels, {}};
    image.pixels.reserve(linear.pixels.size());
    for (std::size_t i = 0; i < linear.pixels.size(); ++i) {
        const bool alpha = linear.channels == 4 && i % 4 == 3;
        image.pixels.push_back(byte_from_unit(alpha ? linear.pixels[i] : srgb_from_linear(linear.pixels[i])));
    }
    return image;
}

template <class Read>
auto with_memory(const std::string& path, Read read) {
    try {
        return read();
    } catch (const std::bad_alloc&) {
        throw Error(Fault::bad_data, path, "does not fit into memory");
    }
}

}  // namespace

const ImageDriver& image_driver(const std::string& format) {
    using Factory = const ImageDriver* (*)();
    constexpr const char* what = "reading and writing pictures";
    static const ImageDriver* const png =
        has_module("octaglobe_png")
            ? reinterpret_cast<Factory>(module_symbol("octaglobe_png", "octaglobe_png_1", what))()
            : nullptr;
    if (format == "png" && png) return *png;
    static const ImageDriver* const any =
        reinterpret_cast<Factory>(module_symbol("octaglobe_oiio", "octaglobe_oiio_1", what))();
    return *any;
}

Image read_image(const std::string& path, const ImageOptions& options) {
    return with_memory(path, [&] {
        const auto source = open_source(path);
        const int n = reduction_of(*source, options, path);
        if (n == 1 && !source->deep && !source->linear) return read_bytes(*source);
        return bytes_from_linear(read_linear(*source, n));
    });
}

Image read_image_bytes(std::string_view bytes, const std::string& known_as, const ImageOptions& options) {
    // Libraries read files: this one is in memory.
    struct MemoryFile {
        int descriptor = ::memfd_create("picture", MFD_CLOEXEC);
        ~MemoryFile() {
            if (descriptor >= 0) ::close(descriptor);
        }
    } const file;
    const auto refuse = [&](const char* why) { throw Error(Fault::bad_data, known_as, why, a_picture); };
    for (std::string_view rest = bytes; !rest.empty();) {
        const auto written = ::write(file.descriptor, rest.data(), rest.size());
        if (written < 0) refuse("does not fit into memory");
        rest.remove_prefix(static_cast<std::size_t>(written));
    }
    try {
        return read_image("/proc/self/fd/" + std::to_string(file.descriptor), options);
    } catch (const Error&) {
        refuse("is no picture that can be read");
        throw;
    }
}

FloatImage read_float_image(const std::string& path, const ImageOptions& options) {
    return with_memory(path, [&] {
        const auto source = open_source(path);
        return read_linear(*source, reduction_of(*source, options, path));
    });
}

std::string image_library_version() {
    return image_driver("").version();
}

}  // namespace planet
