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
      block_columns_((header_.width + block_size - 1) / block_size),
      id_(cache_->new_user()),
      shorts_(mosaic_->may_be_shorts()) {
    MosaicDigest digest(*mosaic_);
    const auto advance = [&](double fraction) {
        digest.advance(fraction);
        if (progress) progress(fraction);
    };
    try {
        survey_all(advance);
    } catch (const DoesNotFit&) {
        shorts_ = false;
        survey_all(advance);
    }
    if (survey_.empty())
        throw Error(Fault::bad_data, header_.name, "holds no heights: every sample is nodata", "one band of heights");
    header_.checksum = digest.finish();
    if (header_.checksum.empty()) header_.checksum = checksum_of_samples();
}

// In windows of about a million samples that match what the files decode at once.
void BlockedRaster::survey_all(const std::function<void(double)>& progress) {
    constexpr std::int64_t enough = 1 << 20;
    std::int64_t natural_columns = 1, natural_rows = 1;
    for (const MosaicPart& part : mosaic_->parts()) {
        natural_columns = std::max<std::int64_t>(natural_columns, part.natural_columns);
        natural_rows = std::max<std::int64_t>(natural_rows, part.natural_rows);
    }
    const auto multiple = [](std::int64_t of, std::int64_t least) { return (least + of - 1) / of * of; };
    const std::int64_t columns = std::min<std::int64_t>(multiple(natural_columns, 1024), header_.width);
    const std::int64_t rows = multiple(natural_rows, std::max<std::int64_t>(1, enough / columns));
    Surveyor surveyor(header_);
    for (std::int64_t row = 0; row < header_.height; row += rows) {
        const int down = static_cast<int>(std::min(rows, header_.height - row));
        for (std::int64_t column = 0; column < header_.width; column += columns) {
            const SampleBlock block = read_window({static_cast<int>(column), static_cast<int>(row),
                                                   static_cast<int>(std::min(columns, header_.width - column)), down});
            SampleView view;
            view.window = block.window;
            if (shorts_)
                view.shorts = block.shorts.data();
            else
                view.floats = block.floats.data();
            surveyor.add(view);
        }
        progress(static_cast<double>(row + down) / header_.height);
    }
    survey_ = surveyor.finish();
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
    const int i = column / block_size, j = row / block_size;
    const auto block = cache_->get(std::uint64_t{id_} << 32 | static_cast<std::uint32_t>(j * block_columns_ + i),
                                   [&] { return read_block(i * block_size, j * block_size); });
    SampleView view;
    view.window = block->window;
    view.core = {i * block_size, j * block_size, std::min(block_size, header_.width - i * block_size),
                 std::min(block_size, header_.height - j * block_size)};
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
    w.columns = std::min(column + block_size + 2, header_.width) - w.column;
    w.rows = std::min(row + block_size + 2, header_.height) - w.row;
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
