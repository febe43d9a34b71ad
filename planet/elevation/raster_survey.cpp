#include "planet/elevation/raster_survey.h"

#include <algorithm>

namespace planet {
namespace {

constexpr int most_blocks = 512;  // a side

// A coarse raster of the planet has blocks of some 10 degrees; a large raster at most 512 x 512 of them, a power of two
// wide.
int block_size_for(int columns, int rows) {
    const int longer = std::max(columns, rows);
    int size = std::clamp(longer / 32, 8, 64);
    while (size >= 64 && (longer - 1) / size >= most_blocks) size *= 2;
    return size;
}

bool is_held(std::int16_t s) {
    return s != void_sample;
}
bool is_held(float f) {
    return f == f;
}

template <class Sample>
void mark_samples(const Sample* samples, std::span<std::uint8_t> held) {
    for (std::size_t i = 0; i < held.size(); ++i) held[i] = is_held(samples[i]) ? 1 : 0;
}

std::size_t sum(std::span<const std::uint8_t> held) {
    std::size_t count = 0;
    for (const std::uint8_t h : held) count += h;
    return count;
}

}  // namespace

Surveyor::Surveyor(const RasterHeader& raster)
    : raster_(raster), around_(columns_around(raster)), poles_(poles_of(raster)) {
    out_.columns = around_ > 0 ? around_ : raster.width;
    out_.block_size = block_size_for(out_.columns, raster.height);
    out_.block_columns = (out_.columns + out_.block_size - 1) / out_.block_size;
    out_.block_rows = (raster.height + out_.block_size - 1) / out_.block_size;
    counts_.resize(static_cast<std::size_t>(out_.block_columns) * static_cast<std::size_t>(out_.block_rows));
    row_above_.assign(static_cast<std::size_t>(out_.columns), poles_.first != PoleRow::none ? 1 : 0);
}

void Surveyor::add(const SampleView& view) {
    const SampleWindow& w = view.window;
    const int columns = std::min(w.columns, out_.columns - w.column);
    if (columns <= 0) return;
    const auto n = static_cast<std::size_t>(columns), rows = static_cast<std::size_t>(w.rows);
    held_.resize(n);
    if (w.column == 0) {
        left_.assign(rows, 0);
        first_.assign(rows, 0);
    }
    for (std::size_t r = 0; r < rows; ++r) {
        const int row = w.row + static_cast<int>(r);
        mark(view, row, held_);
        if (w.column == 0) {
            first_[r] = held_[0];
            if (around_ > 0) left_[r] = held_[0];  // its true neighbour is compared at the other end
        }
        out_.border_sides += left_[r] != held_[0] ? 1 : 0;
        left_[r] = held_[n - 1];
        if (w.column + columns == out_.columns) {
            const std::uint8_t beyond = around_ > 0 ? first_[r] : 0;
            out_.border_sides += beyond != held_[n - 1] ? 1 : 0;
        }
        count_border(w.column, row, held_);
        count_blocks(w.column, row, held_);
        add_to_means(view, row);
    }
}

void Surveyor::mark(const SampleView& view, int row, std::span<std::uint8_t> held) const {
    const std::ptrdiff_t first = view.index(view.window.column, row);
    if (view.shorts)
        mark_samples(view.shorts + first, held);
    else
        mark_samples(view.floats + first, held);
}

// Sides between neighbours of a row, and to the row above.
void Surveyor::count_border(int column, int row, std::span<const std::uint8_t> held) {
    const std::span<std::uint8_t> above = std::span(row_above_).subspan(static_cast<std::size_t>(column), held.size());
    std::size_t sides = 0;
    for (std::size_t i = 1; i < held.size(); ++i) sides += held[i] ^ held[i - 1];
    for (std::size_t i = 0; i < held.size(); ++i) sides += held[i] ^ above[i];
    if (row == raster_.height - 1 && poles_.last == PoleRow::none) sides += sum(held);
    // Beyond a pole the raster goes on: there is no side, whatever is there.
    if (row == 0 && poles_.first != PoleRow::none) sides -= held.size() - sum(held);
    std::copy(held.begin(), held.end(), above.begin());
    out_.border_sides += sides;
}

void Surveyor::count_blocks(int column, int row, std::span<const std::uint8_t> held) {
    std::int64_t* const counts =
        counts_.data() + static_cast<std::size_t>(row / out_.block_size) * static_cast<std::size_t>(out_.block_columns);
    for (std::size_t i = 0; i < held.size();) {
        const int at = column + static_cast<int>(i), block = at / out_.block_size;
        const auto end = std::min(held.size(), i + static_cast<std::size_t>((block + 1) * out_.block_size - at));
        counts[block] += static_cast<std::int64_t>(sum(held.subspan(i, end - i)));
        i = end;
    }
}

void Surveyor::add_to_means(const SampleView& view, int row) {
    const bool first = row == 0 && poles_.first != PoleRow::none;
    const bool last = row == raster_.height - 1 && poles_.last != PoleRow::none;
    if (!first && !last) return;
    const float zero = static_cast<float>(-raster_.offset / raster_.scale);
    Mean& mean = first ? first_mean_ : last_mean_;
    const SampleWindow& w = view.window;
    for (int column = w.column; column < std::min(w.column + w.columns, out_.columns); ++column) {
        const float v = view.raw(column, row);
        if (std::isnan(v)) continue;
        mean.sum += static_cast<double>(std::isinf(v) ? zero : v);
        ++mean.count;
    }
}

RasterSurvey Surveyor::finish() {
    for (int j = 0; j < out_.block_rows; ++j)
        for (int i = 0; i < out_.block_columns; ++i) {
            const int size = out_.block_size;
            const std::int64_t held = counts_[out_.fill.size()];
            const std::int64_t all = std::int64_t{std::min(size, out_.columns - i * size)} *
                                     std::int64_t{std::min(size, raster_.height - j * size)};
            out_.fill.push_back(held == 0     ? RasterSurvey::Fill::none
                                : held == all ? RasterSurvey::Fill::all
                                              : RasterSurvey::Fill::some);
        }
    const auto mean = [](const Mean& m) {
        return m.count > 0 ? static_cast<float>(m.sum / m.count) : std::numeric_limits<float>::quiet_NaN();
    };
    out_.first_mean = mean(first_mean_);
    out_.last_mean = mean(last_mean_);
    return std::move(out_);
}

bool RasterSurvey::empty() const {
    return std::all_of(fill.begin(), fill.end(), [](Fill f) { return f == Fill::none; });
}

RasterSurvey survey(const RasterSamples& whole) {
    Surveyor surveyor(whole.header());
    surveyor.add(whole.view(0, 0));
    return surveyor.finish();
}

}  // namespace planet
