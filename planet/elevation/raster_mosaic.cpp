#include "planet/elevation/raster_mosaic.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "planet/error.h"

namespace planet {
namespace {

constexpr std::size_t most_idle = 16;     // open files that nobody reads from
constexpr std::size_t most_checked = 16;  // files of a part that are looked at whenever it is read
constexpr int window_columns = 260;       // of a block of samples with those beside it
constexpr double slack = 0.02;            // samples; georeferences are written with few digits

template <class Sample>
Sample void_mark() {
    if constexpr (std::is_same_v<Sample, std::int16_t>)
        return void_sample;
    else
        return std::numeric_limits<float>::quiet_NaN();
}

template <class Sample>
bool is_void(Sample s) {
    if constexpr (std::is_same_v<Sample, std::int16_t>)
        return s == void_sample;
    else
        return std::isnan(s);
}

SampleWindow intersection(const SampleWindow& a, const SampleWindow& b) {
    const int column = std::max(a.column, b.column), row = std::max(a.row, b.row);
    return {column, row, std::min(a.column + a.columns, b.column + b.columns) - column,
            std::min(a.row + a.rows, b.row + b.rows) - row};
}

bool meet(const SampleWindow& a, const SampleWindow& b) {
    const SampleWindow common = intersection(a, b);
    return common.columns > 0 && common.rows > 0;
}

/// For each sample of a window that is part of another one: its index there and its own.
template <class Visit>
void for_each_in(const SampleWindow& whole, const SampleWindow& part, Visit visit) {
    std::size_t from = 0;
    for (int row = part.row; row < part.row + part.rows; ++row) {
        std::size_t to = static_cast<std::size_t>(row - whole.row) * static_cast<std::size_t>(whole.columns) +
                         static_cast<std::size_t>(part.column - whole.column);
        for (int i = 0; i < part.columns; ++i) visit(to++, from++);
    }
}

bool near_vectors(glm::dvec2 a, glm::dvec2 b, int samples) {
    // Over all samples of a part they stay within the slack.
    return glm::distance(a, b) * samples <= slack * glm::length(a);
}

}  // namespace

MosaicPart mosaic_part(const std::string& path, const RasterOptions& options) {
    const auto reader = open_raster(path, options);
    MosaicPart part;
    part.path = path;
    part.header = reader->header();
    part.window = {0, 0, part.header.width, part.header.height};
    part.files = reader->files();
    part.may_be_shorts = reader->may_be_shorts();
    part.decoded_bytes = reader->decoded_bytes(window_columns);
    part.natural_columns = reader->natural_columns();
    part.natural_rows = reader->natural_rows();
    return part;
}

bool place_on_grid_of(const MosaicPart& other, MosaicPart& part) {
    const RasterHeader &a = other.header, &b = part.header;
    const int longest = std::max({a.width, a.height, b.width, b.height});
    if (a.crs != b.crs || a.plain != b.plain || a.reduction != b.reduction ||
        !near_vectors(a.grid.per_column, b.grid.per_column, longest) ||
        !near_vectors(a.grid.per_row, b.grid.per_row, longest))
        return false;
    const glm::dvec2 d = b.grid.origin - a.grid.origin;
    const glm::dvec2 at = glm::dvec2(d.x * a.grid.per_row.y - d.y * a.grid.per_row.x,
                                     a.grid.per_column.x * d.y - a.grid.per_column.y * d.x) /
                          a.grid.determinant();
    const glm::dvec2 whole = glm::round(at);
    if (glm::any(glm::greaterThan(glm::abs(at - whole), glm::dvec2(slack)))) return false;
    const glm::dvec2 first = whole + glm::dvec2(other.window.column, other.window.row);
    if (glm::any(glm::greaterThan(glm::abs(first), glm::dvec2(1 << 29)))) return false;
    part.window.column = static_cast<int>(first.x);
    part.window.row = static_cast<int>(first.y);
    return true;
}

/// A reader that this thread opened, given back when it is done.
class RasterMosaic::Borrowed {
  public:
    Borrowed(const RasterMosaic& mosaic, const MosaicPart& part) : mosaic_(mosaic), part_(part) {
        {
            const std::lock_guard lock(mosaic.mutex_);
            const auto found = std::find_if(mosaic.idle_.rbegin(), mosaic.idle_.rend(), [&](const Idle& idle) {
                return idle.part == &part && idle.opened_by == std::this_thread::get_id();
            });
            if (found != mosaic.idle_.rend()) {
                reader_ = std::move(found->reader);
                mosaic.idle_.erase(std::next(found).base());
                return;
            }
        }
        reader_ = open_raster(part.path, mosaic.options_);
    }
    ~Borrowed() {
        const std::lock_guard lock(mosaic_.mutex_);
        mosaic_.idle_.push_back({&part_, std::this_thread::get_id(), std::move(reader_)});
        if (mosaic_.idle_.size() > most_idle) mosaic_.idle_.erase(mosaic_.idle_.begin());
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    RasterReader* operator->() const { return reader_.get(); }

  private:
    const RasterMosaic& mosaic_;
    const MosaicPart& part_;
    std::unique_ptr<RasterReader> reader_;
};

RasterMosaic::RasterMosaic(std::vector<MosaicPart> parts, std::string name, RasterOptions options)
    : parts_(std::move(parts)), options_(std::move(options)) {
    assert(!parts_.empty());
    int left = parts_[0].window.column, top = parts_[0].window.row, right = left, bottom = top;
    may_be_shorts_ = true;
    for (const MosaicPart& p : parts_) {
        left = std::min(left, p.window.column);
        top = std::min(top, p.window.row);
        right = std::max(right, p.window.column + p.window.columns);
        bottom = std::max(bottom, p.window.row + p.window.rows);
        may_be_shorts_ = may_be_shorts_ && p.may_be_shorts;
        in_metres_ =
            in_metres_ || p.header.scale != parts_[0].header.scale || p.header.offset != parts_[0].header.offset;
        for (const std::string& file : p.files)
            if (const auto stamp = stamp_of(file)) stamps_.emplace(file, *stamp);
    }
    header_ = parts_[0].header;
    header_.name = std::move(name);
    header_.grid.origin =
        header_.grid.crs_from_sample(glm::dvec2(left - parts_[0].window.column, top - parts_[0].window.row));
    header_.width = right - left;
    header_.height = bottom - top;
    if (in_metres_) {
        header_.scale = 1;
        header_.offset = 0;
        may_be_shorts_ = false;
    }
    for (MosaicPart& p : parts_) {
        p.window.column -= left;
        p.window.row -= top;
    }
    index_parts();
}

void RasterMosaic::index_parts() {
    for (const MosaicPart& p : parts_) {
        cell_columns_ = std::max(cell_columns_, p.window.columns);
        cell_rows_ = std::max(cell_rows_, p.window.rows);
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {  // a part meets at most four cells
        const SampleWindow& w = parts_[i].window;
        for (int row = w.row / cell_rows_; row <= (w.row + w.rows - 1) / cell_rows_; ++row)
            for (int column = w.column / cell_columns_; column <= (w.column + w.columns - 1) / cell_columns_; ++column)
                index_[{row, column}].push_back(static_cast<std::uint32_t>(i));
    }
}

std::vector<std::uint32_t> RasterMosaic::parts_in(const SampleWindow& w) const {
    std::vector<std::uint32_t> found;
    for (int row = w.row / cell_rows_; row <= (w.row + w.rows - 1) / cell_rows_; ++row)
        for (int column = w.column / cell_columns_; column <= (w.column + w.columns - 1) / cell_columns_; ++column) {
            const auto cell = index_.find({row, column});
            if (cell != index_.end()) found.insert(found.end(), cell->second.begin(), cell->second.end());
        }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::erase_if(found, [&](std::uint32_t i) { return !meet(w, parts_[i].window); });
    return found;
}

bool RasterMosaic::read(const SampleWindow& window, std::span<std::int16_t> out) const {
    return may_be_shorts_ && read_samples(window, out);
}

void RasterMosaic::read(const SampleWindow& window, std::span<float> out) const {
    read_samples(window, out);
}

template <class Sample>
bool RasterMosaic::read_samples(const SampleWindow& window, std::span<Sample> out) const {
    assert(out.size() == window.count());
    const std::vector<std::uint32_t> parts = parts_in(window);
    const bool one = parts.size() == 1 && intersection(window, parts_[parts[0]].window).count() == window.count();
    if (one) return read_part(parts_[parts[0]], window, out);
    std::fill(out.begin(), out.end(), void_mark<Sample>());
    std::vector<Sample> piece;
    for (const std::uint32_t i : parts) {
        const SampleWindow common = intersection(window, parts_[i].window);
        piece.resize(common.count());
        if (!read_part(parts_[i], common, std::span(piece))) return false;
        for_each_in(window, common, [&](std::size_t to, std::size_t from) {
            if (!is_void(piece[from])) out[to] = piece[from];
        });
    }
    return true;
}

std::optional<std::uint32_t> RasterMosaic::only_part(const SampleWindow& window) const {
    const std::vector<std::uint32_t> parts = parts_in(window);
    return parts.size() == 1 ? std::optional(parts[0]) : std::nullopt;
}

void RasterMosaic::find_parts(const SampleWindow& window, std::span<std::uint32_t> out) const {
    assert(out.size() == window.count());
    const std::vector<std::uint32_t> parts = parts_in(window);
    if (!parts.empty()) std::fill(out.begin(), out.end(), parts[0]);
    std::vector<float> piece;
    for (std::size_t p = 1; p < parts.size(); ++p) {
        const MosaicPart& part = parts_[parts[p]];
        const SampleWindow common = intersection(window, part.window);
        const bool over_others = std::any_of(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(p),
                                             [&](std::uint32_t q) { return meet(common, parts_[q].window); });
        piece.assign(common.count(), 0);
        if (over_others) read_part(part, common, std::span(piece));
        for_each_in(window, common, [&](std::size_t to, std::size_t from) {
            if (!is_void(piece[from])) out[to] = parts[p];
        });
    }
}

std::vector<std::string> RasterMosaic::file_names() const {
    std::filesystem::path shared = std::filesystem::path(parts_[0].path).parent_path();
    for (const MosaicPart& part : parts_) {
        const std::filesystem::path folder = std::filesystem::path(part.path).parent_path();
        const auto differ = std::mismatch(shared.begin(), shared.end(), folder.begin(), folder.end());
        std::filesystem::path both;
        for (auto name = shared.begin(); name != differ.first; ++name) both /= *name;
        shared = std::move(both);
    }
    std::vector<std::string> names;
    for (const MosaicPart& part : parts_)
        names.push_back(shared.empty() ? part.path
                                       : std::filesystem::path(part.path).lexically_relative(shared).native());
    return names;
}

template <class Sample>
bool RasterMosaic::read_part(const MosaicPart& part, const SampleWindow& window, std::span<Sample> out) const {
    check_unchanged(part);
    SampleWindow own = window;
    own.column -= part.window.column;
    own.row -= part.window.row;
    const Borrowed reader(*this, part);
    if constexpr (std::is_same_v<Sample, std::int16_t>) {
        return reader->read(own, out);
    } else {
        reader->read(own, out);
        if (in_metres_)
            for (float& f : out)
                f = static_cast<float>(part.header.offset + part.header.scale * static_cast<double>(f));
        return true;
    }
}

std::optional<RasterMosaic::Stamp> RasterMosaic::stamp_of(const std::string& file) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(file, failed)) return std::nullopt;
    const Stamp stamp{std::filesystem::file_size(file, failed), std::filesystem::last_write_time(file, failed)};
    if (failed) return std::nullopt;
    return stamp;
}

void RasterMosaic::check_unchanged(const MosaicPart& part) const {
    for (std::size_t i = 0; i < std::min(part.files.size(), most_checked); ++i) {
        const auto known = stamps_.find(part.files[i]);
        if (known == stamps_.end()) continue;
        const auto now = stamp_of(part.files[i]);
        if (!now) throw Error(Fault::bad_data, part.files[i], "has vanished while it was in use", "a file that stays");
        if (*now != known->second)
            throw Error(Fault::bad_data, part.files[i], "has changed while it was in use",
                        "a file that stays as it is");
    }
}

Raster read_mosaic(const RasterMosaic& mosaic) {
    Raster raster;
    static_cast<RasterHeader&>(raster) = mosaic.header();
    const SampleWindow all{0, 0, raster.width, raster.height};
    std::vector<std::string> files;
    for (const MosaicPart& part : mosaic.parts()) files.insert(files.end(), part.files.begin(), part.files.end());
    std::vector<std::int16_t> shorts(mosaic.may_be_shorts() ? raster.count() : 0);
    if (mosaic.may_be_shorts() && mosaic.read(all, shorts)) {
        raster.samples = std::move(shorts);
    } else {
        std::vector<float> floats(raster.count());
        mosaic.read(all, floats);
        raster.samples = std::move(floats);
    }
    if (!holds_a_height(raster))
        throw Error(Fault::bad_data, raster.name, "holds no heights: every sample is nodata", "one band of heights");
    raster.checksum = checksum_of(raster, std::move(files));
    return raster;
}

}  // namespace planet
