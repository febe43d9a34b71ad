#pragma once
// What the module octaglobe_oiio implements; image_io.h is built on it.

#include <memory>
#include <string>

#include "planet/elevation/image_io.h"

namespace planet {

/// An open picture, read in rows from the top.
class ImageSource {
  public:
    virtual ~ImageSource() = default;
    int width = 0, height = 0;
    int channels = 0;     ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA
    bool deep = false;    ///< samples are handed over as floats, [0, 1] for integers; else 8 bit
    bool linear = false;  ///< in linear light; else sRGB
    /// The next rows, into room for them. Throws Error.
    virtual void read_rows(int count, void* out) = 0;
};

/// A picture being written to a file of its own.
class ImageSink {
  public:
    virtual ~ImageSink() = default;
    virtual void write_rows(const void* rows, int count) = 0;  ///< throws Error
    virtual void close() = 0;                                  ///< throws Error
};

struct SinkDescription {
    std::string format;    ///< "png", "jpg", "tif", "exr"
    std::string file;      ///< where to write
    std::string shown_as;  ///< the name for messages
    int width = 0, height = 0, channels = 0;
    SampleType type = SampleType::uint8;
    WriteOptions options;
};

class ImageDriver {
  public:
    virtual ~ImageDriver() = default;
    virtual std::unique_ptr<ImageSource> open(const std::string& path) const = 0;             ///< throws Error
    virtual std::unique_ptr<ImageSink> create(const SinkDescription& description) const = 0;  ///< throws Error
    virtual std::string version() const = 0;
};

/// For one format ("png", "jpg", ...; empty: any). PNG has a module of its own that is faster to open; where that is
/// missing OpenImageIO does it too. Throws Error if there is no module for it.
const ImageDriver& image_driver(const std::string& format);

}  // namespace planet
