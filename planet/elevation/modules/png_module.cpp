// The module octaglobe_png: PNG through libpng alone. Most runs of the program write one PNG and read none but their
// own; this module opens in a millisecond where OpenImageIO takes a hundred and more.

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "planet/elevation/image_driver.h"
#include "planet/error.h"

namespace planet {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// libpng reports failure by a jump: every call into it is made between a setjmp and a return, in a frame that owns
// nothing. The message is kept for ours.
struct PngState {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string message;
};

void keep_error(png_structp png, png_const_charp text) {
    static_cast<PngState*>(png_get_error_ptr(png))->message = text;
    png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

template <class Call>
bool guarded(PngState& state, Call call) {
    if (setjmp(png_jmpbuf(state.png)) != 0) return false;
    call(state.png, state.info);
    return true;
}

class PngSource : public ImageSource {
  public:
    explicit PngSource(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb"), std::fclose) {
        if (!file_) throw Error(Fault::bad_data, path, "cannot be opened");
        state_.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state_, keep_error, ignore_warning);
        if (state_.png) state_.info = png_create_info_struct(state_.png);
        if (!state_.info) throw std::bad_alloc();
        if (!guarded(state_, [this](png_structp png, png_infop info) { read_header(png, info); })) fail();
        width = static_cast<int>(png_get_image_width(state_.png, state_.info));
        height = static_cast<int>(png_get_image_height(state_.png, state_.info));
        channels = png_get_channels(state_.png, state_.info);
    }
    ~PngSource() override { png_destroy_read_struct(&state_.png, &state_.info, nullptr); }

    void read_rows(int count, void* out) override {
        const std::size_t samples = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
        auto* bytes = static_cast<unsigned char*>(out);
        for (int i = 0; i < count; ++i, ++next_row_)
            if (deep)
                deepen(row(), reinterpret_cast<float*>(bytes) + static_cast<std::size_t>(i) * samples, samples);
            else if (interlaced_)
                std::memcpy(bytes + static_cast<std::size_t>(i) * samples, row(), samples);
            else
                read_row(bytes + static_cast<std::size_t>(i) * samples);
        if (next_row_ == height && !guarded(state_, [](png_structp png, png_infop) { png_read_end(png, nullptr); }))
            fail();
    }

  private:
    void read_header(png_structp png, png_infop info) {
        png_init_io(png, file_.get());
        png_set_user_limits(png, 1 << 20, 1 << 20);
        png_read_info(png, info);
        png_set_expand(png);  // palettes, transparent colours, fewer than 8 bits
        deep = png_get_bit_depth(png, info) == 16;
        if (deep) png_set_swap(png);
        interlaced_ = png_set_interlace_handling(png) > 1;
        png_read_update_info(png, info);
    }

    void read_row(unsigned char* out) {
        if (!guarded(state_, [out](png_structp png, png_infop) { png_read_row(png, out, nullptr); })) fail();
    }

    // The next row in the file's depth; interlaced pictures are decoded as a whole first.
    const unsigned char* row() {
        const std::size_t size = png_get_rowbytes(state_.png, state_.info);
        if (interlaced_) {
            if (whole_.empty()) read_whole();
            return whole_.data() + static_cast<std::size_t>(next_row_) * size;
        }
        line_.resize(size);
        read_row(line_.data());
        return line_.data();
    }

    void read_whole() {
        const std::size_t size = png_get_rowbytes(state_.png, state_.info);
        whole_.resize(size * static_cast<std::size_t>(height));
        std::vector<unsigned char*> rows;
        for (int y = 0; y < height; ++y) rows.push_back(whole_.data() + static_cast<std::size_t>(y) * size);
        if (!guarded(state_, [&rows](png_structp png, png_infop) { png_read_image(png, rows.data()); })) fail();
    }

    static void deepen(const unsigned char* row, float* out, std::size_t samples) {
        for (std::size_t i = 0; i < samples; ++i) {
            std::uint16_t v;
            std::memcpy(&v, row + 2 * i, 2);
            out[i] = static_cast<float>(v) / 65535;
        }
    }

    [[noreturn]] void fail() const {
        throw Error(Fault::bad_data, path_, "is damaged or cut short: " + state_.message, "a whole PNG");
    }

    std::string path_;
    File file_;
    PngState state_;
    bool interlaced_ = false;
    int next_row_ = 0;
    std::vector<unsigned char> line_, whole_;
};

class PngSink : public ImageSink {
  public:
    explicit PngSink(const SinkDescription& d)
        : shown_as_(d.shown_as),
          row_bytes_(static_cast<std::size_t>(d.width) * static_cast<std::size_t>(d.channels) *
                     (d.type == SampleType::uint16 ? 2 : 1)),
          file_(std::fopen(d.file.c_str(), "wb"), std::fclose) {
        if (!file_) throw Error(Fault::bad_usage, shown_as_, std::string("cannot be written: ") + std::strerror(errno));
        state_.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &state_, keep_error, ignore_warning);
        if (state_.png) state_.info = png_create_info_struct(state_.png);
        if (!state_.info) throw std::bad_alloc();
        if (!guarded(state_, [&](png_structp png, png_infop info) { write_header(png, info, d); })) fail();
    }
    ~PngSink() override { png_destroy_write_struct(&state_.png, &state_.info); }

    void write_rows(const void* rows, int count) override {
        const auto* row = static_cast<const unsigned char*>(rows);
        const bool good = guarded(state_, [=, this](png_structp png, png_infop) {
            for (int i = 0; i < count; ++i) png_write_row(png, row + static_cast<std::size_t>(i) * row_bytes_);
        });
        if (!good) fail();
    }

    void close() override {
        if (!guarded(state_, [](png_structp png, png_infop) { png_write_end(png, nullptr); })) fail();
        if (std::fclose(file_.release()) != 0) {
            state_.message = std::strerror(errno);
            fail();
        }
    }

  private:
    void write_header(png_structp png, png_infop info, const SinkDescription& d) {
        png_init_io(png, file_.get());
        const bool deep = d.type == SampleType::uint16;
        png_set_compression_level(png, d.options.png_compression);
        png_set_compression_buffer_size(png, 1 << 16);
        // One filter for all rows: choosing among five for each row takes longer than deflating it.
        png_set_filter(png, 0, d.options.png_compression == 0 ? PNG_FILTER_NONE : PNG_FILTER_SUB);
        png_set_IHDR(png, info, static_cast<png_uint_32>(d.width), static_cast<png_uint_32>(d.height), deep ? 16 : 8,
                     d.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
        png_write_info(png, info);
        if (deep) png_set_swap(png);
    }

    [[noreturn]] void fail() const { throw Error(Fault::bad_usage, shown_as_, "cannot be written: " + state_.message); }

    std::string shown_as_;
    std::size_t row_bytes_;
    File file_;
    PngState state_;
};

class PngDriver : public ImageDriver {
  public:
    std::unique_ptr<ImageSource> open(const std::string& path) const override {
        return std::make_unique<PngSource>(path);
    }
    std::unique_ptr<ImageSink> create(const SinkDescription& d) const override { return std::make_unique<PngSink>(d); }
    std::string version() const override { return "libpng " PNG_LIBPNG_VER_STRING; }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::ImageDriver* octaglobe_png_1() {
    static const planet::PngDriver driver;
    return &driver;
}
