#pragma once
// A picture's file, band by band.

#include <cstdint>
#include <future>
#include <utility>
#include <vector>

#include "planet/elevation/image_io.h"
#include "render/app/picture/render_options.h"
#include "render/app/picture/steps.h"
#include "render/app/temporary_names.h"

namespace render {

/// The output, encoded beside the drawing: one band behind.
class BandWriter {
  public:
    BandWriter(const RenderOptions& options, Steps& steps)
        : threads_(options.thread_count()),
          steps_(steps),
          writer_(options.output.string(), options.drawn().width, options.drawn().height, 3, planet::SampleType::uint8,
                  {.make_file = make_listed}) {}

    /// @param band rows of RGB, top down
    void write(std::vector<std::uint8_t> band, int rows) {
        if (writing_.valid()) writing_.get();
        writing_ = beside(threads_, [this, rows, pixels = std::move(band)] {
            steps_.time("write", [&] { writer_.write_rows(pixels.data(), rows); });
        });
    }
    /// Makes the file appear.
    void finish() {
        if (writing_.valid()) writing_.get();
        steps_.time("write", [&] { writer_.finish(); });
    }

  private:
    unsigned threads_;
    Steps& steps_;
    planet::ImageWriter writer_;
    std::future<void> writing_;
};

}  // namespace render
