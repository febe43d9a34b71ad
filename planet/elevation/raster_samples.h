#pragma once
// The samples of a raster, wherever they are: all in memory, or in blocks that come and go.

#include <memory>

#include "planet/elevation/raster.h"
#include "planet/elevation/raster_io.h"

namespace planet {

/// Samples of a raster in memory, kept alive by the view.
struct SampleView {
    SampleWindow window;  ///< the samples that are there
    /// Positions (column, row) for which the samples (column - 1 .. column + 2, row - 1 .. row + 2) are there, as far as
    /// the raster has them.
    SampleWindow core;
    /// Of the window's first sample; row-major, window.columns apart. One of them is null.
    const std::int16_t* shorts = nullptr;
    const float* floats = nullptr;
    std::shared_ptr<const void> owner;

    bool covers(int column, int row) const { return is_in(core, column, row); }
    bool holds(int column, int row) const { return is_in(window, column, row); }
    std::ptrdiff_t index(int column, int row) const {
        return static_cast<std::ptrdiff_t>(row - window.row) * window.columns + (column - window.column);
    }
    /// In the units of scale and offset; NaN where void, -infinity on water. The view must hold it.
    float raw(int column, int row) const {
        if (!shorts) return floats[index(column, row)];
        const std::int16_t s = shorts[index(column, row)];
        return s == void_sample    ? std::numeric_limits<float>::quiet_NaN()
               : s == water_sample ? -std::numeric_limits<float>::infinity()
                                   : s;
    }

  private:
    static bool is_in(const SampleWindow& w, int column, int row) {
        return static_cast<unsigned>(column - w.column) < static_cast<unsigned>(w.columns) &&
               static_cast<unsigned>(row - w.row) < static_cast<unsigned>(w.rows);
    }
};

/// Safe from several threads.
class RasterSamples {
  public:
    virtual ~RasterSamples() = default;
    virtual const RasterHeader& header() const = 0;
    /// A view that covers a column and row of the raster. Throws Error if it cannot be read.
    virtual SampleView view(int column, int row) const = 0;
};

/// All in memory.
class WholeRaster final : public RasterSamples {
  public:
    explicit WholeRaster(std::shared_ptr<const Raster> raster) : raster_(std::move(raster)) {
        view_.window = view_.core = {0, 0, raster_->width, raster_->height};
        if (const auto* shorts = std::get_if<std::vector<std::int16_t>>(&raster_->samples))
            view_.shorts = shorts->data();
        else
            view_.floats = std::get<std::vector<float>>(raster_->samples).data();
    }
    const RasterHeader& header() const override { return *raster_; }
    SampleView view(int, int) const override { return view_; }

  private:
    std::shared_ptr<const Raster> raster_;
    SampleView view_;  // without an owner: no view outlives the field that holds this
};

/// One thread's way through the samples of a raster, fastest where it stays near.
class SampleCursor {
  public:
    explicit SampleCursor(const RasterSamples& samples) : samples_(&samples) {}

    /// The view that covers a column and row of the raster.
    const SampleView& at(int column, int row) {
        if (!view_.covers(column, row)) view_ = samples_->view(column, row);
        return view_;
    }
    /// As SampleView::raw, of any sample of the raster. Does not move the cursor.
    float raw(int column, int row) const {
        return view_.holds(column, row) ? view_.raw(column, row) : samples_->view(column, row).raw(column, row);
    }
    const SampleView& view() const { return view_; }

  private:
    const RasterSamples* samples_;
    SampleView view_;
};

}  // namespace planet
