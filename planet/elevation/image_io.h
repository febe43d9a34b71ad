#pragma once
// Reading and writing pictures through OpenImageIO, which is in a module of its own (module.h).

#include <memory>
#include <string>
#include <string_view>

#include "planet/elevation/image.h"
#include "planet/elevation/make_file.h"

namespace planet {

struct ImageOptions {
    std::int64_t max_pixels = std::int64_t{256} << 20;  ///< kept in memory, after reduction
    /// If above 0: reduced by the least whole factor that makes it at most this wide. Pixels are means, in linear
    /// light, of factor x factor pixels (fewer at the right and bottom); memory stays that of the reduced picture.
    int max_width = 0;
};

/// Reads any picture OpenImageIO reads. Grey becomes RGB; further channels than alpha are dropped; 16-bit and float
/// samples are rounded, and linear light is encoded, to 8-bit sRGB. Throws Error for a file that is missing, empty,
/// damaged, cut short, no picture, or too large.
Image read_image(const std::string& path, const ImageOptions& options = {});
/// The same of a file's bytes. @param known_as its name in errors
Image read_image_bytes(std::string_view bytes, const std::string& known_as, const ImageOptions& options = {});
/// The same in linear light.
FloatImage read_float_image(const std::string& path, const ImageOptions& options = {});

struct WriteOptions {
    int png_compression = 2;  ///< 0..9
    int jpeg_quality = 92;    ///< 1..100
    MakeFile make_file{};     ///< makes the temporary file
};

enum class SampleType { uint8, uint16, float32 };

/// Writes a picture in rows from the top, so that it need never be in memory as a whole. The file appears under its
/// name, whole, at finish(); before that it is a temporary file beside it, which is removed if the writer is destroyed
/// first. The same pixels give the same bytes: no times are written.
class ImageWriter {
  public:
    /// The format is that of the extension: .png (8, 16 bit), .jpg/.jpeg (8 bit RGB), .tif/.tiff (all), .exr (float).
    /// Throws Error for another one, a wrong sample type, a size outside 1..65535, or a place that cannot be written.
    ImageWriter(const std::string& path, int width, int height, int channels, SampleType type,
                const WriteOptions& options = {});
    ~ImageWriter();
    ImageWriter(ImageWriter&&) noexcept;
    ImageWriter& operator=(ImageWriter&&) noexcept;

    /// The next rows, samples of the type given, interleaved, tightly packed. Throws Error if they cannot be written.
    void write_rows(const void* rows, int count);
    /// After the last row: the file is there. Throws Error if it cannot be.
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

void write_image(const std::string& path, const Image& image, const WriteOptions& options = {});
void write_image(const std::string& path, const DeepImage& image, const WriteOptions& options = {});
void write_image(const std::string& path, const FloatImage& image, const WriteOptions& options = {});

/// "OpenImageIO 2.4.7"; throws Error if the module cannot be loaded.
std::string image_library_version();

}  // namespace planet
