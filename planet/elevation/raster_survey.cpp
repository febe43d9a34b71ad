#include "planet/elevation/raster_survey.h"

#include <algorithm>
#include <array>

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

class Surveyor {
  public:
    explicit Surveyor(const RasterSamples& samples)
        : raster_(samples.header()), cursor_(samples), around_(columns_around(raster_)), poles_(poles_of(raster_)) {
        out_.columns = around_ > 0 ? around_ : raster_.width;
        out_.block_size = block_size_for(out_.columns, raster_.height);
        out_.block_columns = (out_.columns + out_.block_size - 1) / out_.block_size;
        out_.block_rows = (raster_.height + out_.block_size - 1) / out_.block_size;
        held_.resize(static_cast<std::size_t>(out_.block_columns) * static_cast<std::size_t>(out_.block_rows));
    }

    // A square of survey_step samples or what is left of one; all of it and its neighbours are in one view.
    void add_square(int first_column, int first_row) {
        cursor_.at(first_column, first_row);
        const int columns = std::min(survey_step, out_.columns - first_column);
        const int rows = std::min(survey_step, raster_.height - first_row);
        line(first_row - 1, first_column, columns, above_);
        line(first_row, first_column, columns, here_);
        for (int row = first_row; row < first_row + rows; ++row) {
            line(row + 1, first_column, columns, below_);
            add_line(row, first_column, columns);
            std::swap(above_, here_);
            std::swap(here_, below_);
        }
    }

    RasterSurvey finish() {
        for (std::size_t i = 0; i < held_.size(); ++i) {
            const int size = out_.block_size;
            const auto column = static_cast<int>(i % static_cast<std::size_t>(out_.block_columns)) * size;
            const auto row = static_cast<int>(i / static_cast<std::size_t>(out_.block_columns)) * size;
            const std::int64_t all = std::int64_t{std::min(size, out_.columns - column)} *
                                     std::int64_t{std::min(size, raster_.height - row)};
            out_.fill.push_back(held_[i] == 0     ? RasterSurvey::Fill::none
                                : held_[i] == all ? RasterSurvey::Fill::all
                                                  : RasterSurvey::Fill::some);
        }
        if (poles_.first != PoleRow::none) out_.first_mean = mean_of_row(0);
        if (poles_.last != PoleRow::none) out_.last_mean = mean_of_row(raster_.height - 1);
        return std::move(out_);
    }

  private:
    // Whether samples hold a height: of the columns, with one more on both sides, and how many.
    struct Line {
        std::array<std::uint8_t, survey_step + 2> held;
        int count = 0;  // without the two
    };

    void line(int row, int first_column, int columns, Line& line) const {
        const auto n = static_cast<std::size_t>(columns);
        const bool beyond_pole =
            (row < 0 && poles_.first != PoleRow::none) || (row >= raster_.height && poles_.last != PoleRow::none);
        if (row < 0 || row >= raster_.height) {
            line.held.fill(beyond_pole ? 1 : 0);
            line.count = beyond_pole ? columns : 0;
            return;
        }
        const SampleView& view = cursor_.view();
        const std::ptrdiff_t first = view.index(first_column, row);
        std::uint8_t* const held = line.held.data() + 1;
        if (view.shorts)
            for (std::size_t i = 0; i < n; ++i)
                held[i] = view.shorts[first + static_cast<std::ptrdiff_t>(i)] != void_sample;
        else
            for (std::size_t i = 0; i < n; ++i) {
                const float f = view.floats[first + static_cast<std::ptrdiff_t>(i)];
                held[i] = f == f;
            }
        line.count = 0;
        for (std::size_t i = 0; i < n; ++i) line.count += held[i];
        line.held[0] = neighbour(first_column - 1, row);
        held[n] = neighbour(first_column + columns, row);
    }

    std::uint8_t neighbour(int column, int row) const {
        if (around_ > 0) column = (column + around_) % around_;
        return column >= 0 && column < out_.columns && !std::isnan(cursor_.raw(column, row));
    }

    void add_line(int row, int first_column, int columns) {
        const auto n = static_cast<std::size_t>(columns);
        if (here_.count == 0) return;
        const bool whole = here_.count == columns;
        if (!(whole && above_.count == columns && below_.count == columns && here_.held[0] && here_.held[n + 1]))
            for (std::size_t i = 1; i <= n; ++i)
                if (here_.held[i])
                    out_.border_sides += static_cast<std::size_t>(4 - here_.held[i - 1] - here_.held[i + 1] -
                                                                  above_.held[i] - below_.held[i]);
        std::int64_t* const blocks = held_.data() + static_cast<std::size_t>(row / out_.block_size) *
                                                        static_cast<std::size_t>(out_.block_columns);
        for (int column = first_column; column < first_column + columns;) {
            const int block = column / out_.block_size;
            const int end = std::min((block + 1) * out_.block_size, first_column + columns);
            int count = whole ? end - column : 0;
            for (; !whole && column < end; ++column)
                count += here_.held[static_cast<std::size_t>(column - first_column) + 1];
            column = end;
            blocks[block] += count;
        }
    }

    float mean_of_row(int row) {
        const float zero = static_cast<float>(-raster_.offset / raster_.scale);
        double total = 0;
        int count = 0;
        for (int column = 0; column < around_; ++column) {
            const float v = cursor_.at(column, row).raw(column, row);
            if (std::isnan(v)) continue;
            total += static_cast<double>(std::isinf(v) ? zero : v);
            ++count;
        }
        return count > 0 ? static_cast<float>(total / count) : std::numeric_limits<float>::quiet_NaN();
    }

    const RasterHeader& raster_;
    SampleCursor cursor_;
    int around_;
    Poles poles_;
    RasterSurvey out_;
    std::vector<std::int64_t> held_;  // by block: how many samples hold a height
    Line above_, here_, below_;
};

}  // namespace

bool RasterSurvey::empty() const {
    return std::all_of(fill.begin(), fill.end(), [](Fill f) { return f == Fill::none; });
}

RasterSurvey survey(const RasterSamples& samples, const SurveyOrder& order,
                    const std::function<void(double)>& progress) {
    Surveyor surveyor(samples);
    const RasterHeader& raster = samples.header();
    const int around = columns_around(raster);
    const int columns = around > 0 ? around : raster.width;
    const std::int64_t across = std::int64_t{order.columns} * survey_step,
                       down = std::int64_t{order.rows} * survey_step;
    for (std::int64_t row = 0; row < raster.height; row += down) {
        for (std::int64_t column = 0; column < columns; column += across)
            for (std::int64_t r = row; r < std::min<std::int64_t>(row + down, raster.height); r += survey_step)
                for (std::int64_t c = column; c < std::min<std::int64_t>(column + across, columns); c += survey_step)
                    surveyor.add_square(static_cast<int>(c), static_cast<int>(r));
        if (progress) progress(static_cast<double>(std::min<std::int64_t>(row + down, raster.height)) / raster.height);
    }
    return surveyor.finish();
}

}  // namespace planet
