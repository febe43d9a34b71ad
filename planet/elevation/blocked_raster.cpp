#include "planet/elevation/blocked_raster.h"

#include <algorithm>

#include "planet/elevation/mosaic_digest.h"
#include "planet/error.h"

namespace planet {
namespace {

struct DoesNotFit {};  // a value that is no 16-bit sample

}  // namespace

BlockedRaster::BlockedRaster(std::shared_ptr<const RasterMosaic> mosaic, std::shared_ptr<BlockCache> cache,
                             const std::function<void(double)>& progress)
    : mosaic_(std::move(mosaic)),
      cache_(std::move(cache)),
      header_(mosaic_->header()),
      block_columns_((header_.width + survey_step - 1) / survey_step),
      id_(cache_->new_user()),
      shorts_(mosaic_->may_be_shorts()) {
    SurveyOrder order;
    for (const MosaicPart& part : mosaic_->parts()) {
        order.columns = std::max(order.columns, part.natural_columns / survey_step);
        order.rows = std::max(order.rows, part.natural_rows / survey_step);
    }
    MosaicDigest digest(*mosaic_);
    const auto advance = [&](double fraction) {
        digest.advance(fraction);
        if (progress) progress(fraction);
    };
    try {
        survey_ = planet::survey(*this, order, advance);
    } catch (const DoesNotFit&) {
        shorts_ = false;
        id_ = cache_->new_user();
        survey_ = planet::survey(*this, order, advance);
    }
    if (survey_.empty())
        throw Error(Fault::bad_data, header_.name, "holds no heights: every sample is nodata", "heights");
    header_.checksum = digest.finish();
    if (header_.checksum.empty()) header_.checksum = checksum_of_samples();
}

std::string BlockedRaster::checksum_of_samples() const {
    Sha256 sum;
    const int rows_at_once = std::max(1, (1 << 20) / header_.width);
    for (int row = 0; row < header_.height; row += rows_at_once) {
        const SampleWindow window{0, row, header_.width, std::min(rows_at_once, header_.height - row)};
        const SampleBlock rows = read_window(window);
        sum.add(std::as_bytes(std::span(rows.shorts)));
        sum.add(std::as_bytes(std::span(rows.floats)));
    }
    add_to_checksum(header_, sum);
    return sum.hex();
}

SampleView BlockedRaster::view(int column, int row) const {
    const int i = column / survey_step, j = row / survey_step;
    const auto block = cache_->get(std::uint64_t{id_} << 32 | static_cast<std::uint32_t>(j * block_columns_ + i),
                                   [&] { return read_block(i * survey_step, j * survey_step); });
    SampleView view;
    view.window = block->window;
    view.core = {i * survey_step, j * survey_step, std::min(survey_step, header_.width - i * survey_step),
                 std::min(survey_step, header_.height - j * survey_step)};
    if (shorts_)
        view.shorts = block->shorts.data();
    else
        view.floats = block->floats.data();
    view.owner = block;
    return view;
}

SampleBlock BlockedRaster::read_block(int column, int row) const {
    SampleWindow w;
    w.column = std::max(column - 1, 0);
    w.row = std::max(row - 1, 0);
    w.columns = std::min(column + survey_step + 2, header_.width) - w.column;
    w.rows = std::min(row + survey_step + 2, header_.height) - w.row;
    return read_window(w);
}

SampleBlock BlockedRaster::read_window(const SampleWindow& window) const {
    SampleBlock block;
    block.window = window;
    if (shorts_) {
        block.shorts.resize(window.count());
        if (!mosaic_->read(window, block.shorts)) throw DoesNotFit();
    } else {
        block.floats.resize(window.count());
        mosaic_->read(window, block.floats);
    }
    return block;
}

}  // namespace planet
