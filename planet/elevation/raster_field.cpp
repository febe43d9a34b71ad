#include "planet/elevation/raster_field.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "planet/parallel.h"

namespace planet {
namespace {

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return 2 * std::asin(std::min(1.0, 0.5 * glm::distance(a, b)));
}

// Heights in metres as Raster::at has them.
template <class Sample>
void to_metres(const RasterHeader& raster, const Sample* samples, std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float metres = static_cast<float>(raster.offset + raster.scale * static_cast<double>(samples[i]));
        if constexpr (std::is_same_v<Sample, std::int16_t>) {
            const float marked = samples[i] == void_sample ? std::numeric_limits<float>::quiet_NaN() : metres;
            out[i] = samples[i] == water_sample ? 0 : marked;
        } else {
            out[i] = std::isinf(samples[i]) ? 0 : metres;
        }
    }
}

// Two positions a side: those of every n-th side. @param sides  of the rows before, counted on
void keep_every(std::size_t every, std::size_t& sides, std::vector<glm::dvec2>& at) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < at.size(); i += 2) {
        if (sides++ % every != 0) continue;
        at[kept++] = at[i];
        at[kept++] = at[i + 1];
    }
    at.resize(kept);
}

}  // namespace

RasterField::RasterField(std::shared_ptr<const RasterSamples> samples, RasterSurvey survey, VerticalDatum datum,
                         bool datum_assumed, std::shared_ptr<const RasterMosaic> mosaic)
    : samples_(std::move(samples)),
      survey_(std::move(survey)),
      datum_(datum),
      datum_assumed_(datum_assumed),
      mosaic_(std::move(mosaic)),
      map_(samples_->header()),
      surface_(samples_->header(), survey_) {
    std::vector<RasterBlocks::Block> blocks(survey_.fill.size());
    parallel_for(static_cast<std::size_t>(survey_.block_rows), 0, [&](std::size_t row) {
        const auto columns = static_cast<std::size_t>(survey_.block_columns);
        for (std::size_t column = 0; column < columns; ++column)
            blocks[row * columns + column] = make_block(static_cast<int>(column), static_cast<int>(row));
    });
    blocks_ = RasterBlocks(survey_.block_columns, survey_.block_rows, blocks);
}

RasterField::RasterField(std::shared_ptr<const Raster> raster, VerticalDatum datum)
    : RasterField(std::make_shared<const WholeRaster>(raster), survey(WholeRaster(raster)), datum) {}

void RasterField::heights(std::span<const glm::dvec3> normals, std::span<float> out) const {
    heights_with_origins(normals, out, {});
}

void RasterField::heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                                       std::span<WeighedOrigin> origins) const {
    assert(out.size() == normals.size() && (origins.empty() || origins.size() == normals.size()));
    std::fill(origins.begin(), origins.end(), WeighedOrigin{{1, 1}, 1});
    std::vector<glm::ivec2> nearest(mosaic_ ? origins.size() : 0, glm::ivec2(-1));
    SampleCursor cursor(*samples_);
    glm::dvec2 at[256];
    for (std::size_t first = 0; first < normals.size(); first += std::size(at)) {
        const std::size_t n = std::min(std::size(at), normals.size() - first);
        map_.samples_from_normals(normals.subspan(first, n), {at, n});
        surface_.heights(cursor, {at, n}, out.subspan(first, n));
        for (std::size_t i = 0; i < n && !nearest.empty(); ++i)
            if (!std::isnan(out[first + i])) nearest[first + i] = nearest_sample(at[i]);
    }
    if (!nearest.empty()) find_origins(nearest, origins);
}

// Of a place with an answer. As RasterSurface rounds.
glm::ivec2 RasterField::nearest_sample(glm::dvec2 at) const {
    const glm::ivec2 below(glm::floor(at)), end(survey_.columns, raster().height);
    const glm::vec2 beyond(at - glm::dvec2(below));
    glm::ivec2 nearest = below + glm::ivec2(beyond.x < 0.5f ? 0 : 1, beyond.y < 0.5f ? 0 : 1);
    if (surface_.columns_around() > 0) nearest.x = (nearest.x + end.x) % end.x;
    return glm::clamp(nearest, glm::ivec2(0), end - 1);  // up to half a sample beyond the outer ones
}

// Places that are near each other, which nearly all are, look at the files together.
void RasterField::find_origins(std::span<const glm::ivec2> nearest, std::span<WeighedOrigin> origins) const {
    glm::ivec2 least(survey_.columns, raster().height), most(-1);
    for (const glm::ivec2& at : nearest) {
        if (at.x < 0) continue;
        least = glm::min(least, at);
        most = glm::max(most, at);
    }
    if (most.x < 0) return;
    constexpr int most_across = 128;
    const glm::ivec2 size = most - least + 1;
    const bool together = size.x <= most_across && size.y <= most_across;
    SampleWindow window{least.x, least.y, size.x, size.y};
    const std::optional<std::uint32_t> only = mosaic_->only_part(window);
    if (!together) window.columns = window.rows = 1;
    std::vector<std::uint32_t> parts(window.count());
    if (together && !only) mosaic_->find_parts(window, parts);
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        if (nearest[i].x < 0) continue;
        std::uint32_t part = only.value_or(0);
        if (!only && together) {
            const glm::ivec2 at = nearest[i] - least;
            part = parts[static_cast<std::size_t>(at.y * size.x + at.x)];
        } else if (!only) {
            window.column = nearest[i].x;
            window.row = nearest[i].y;
            mosaic_->find_parts(window, parts);
            part = parts[0];
        }
        origins[i].origin = {1 + part, 1 + part};
    }
}

double RasterField::spacing_at(glm::dvec2 sample) const {
    const glm::dvec2 at[4] = {sample - glm::dvec2(0.5, 0), sample + glm::dvec2(0.5, 0), sample - glm::dvec2(0, 0.5),
                              sample + glm::dvec2(0, 0.5)};
    glm::dvec3 n[4];
    map_.normals_from_samples(at, n);
    const double x = glm::distance(n[0], n[1]), y = glm::distance(n[2], n[3]);
    const double longer = std::max(x, y);
    return raster().radius_m * std::sqrt(longer * std::max(std::min(x, y), 0.25 * longer));
}

RasterBlocks::Block RasterField::make_block(int block_column, int block_row) const {
    RasterBlocks::Block block;
    if (survey_.fill_at(block_column, block_row) == RasterSurvey::Fill::none) return block;
    const int size = survey_.block_size;
    const int column = block_column * size, row = block_row * size;
    const int columns = std::min(size, survey_.columns - column), rows = std::min(size, raster().height - row);
    std::array<glm::dvec2, 25> at;
    std::array<glm::dvec3, 25> n;
    for (std::size_t k = 0; k < at.size(); ++k)
        at[k] = {column - 0.5 + columns * 0.25 * static_cast<double>(k % 5),
                 row - 0.5 + rows * 0.25 * static_cast<double>(k / 5)};
    map_.normals_from_samples(at, n);
    block.centre = n[12];
    for (std::size_t k = 0; k < at.size(); ++k) {
        block.angle = std::max(block.angle, angle_between(n[k], block.centre));
        // Half a sample in from the edge: the outer pixels' own spacing.
        const double s =
            spacing_at(glm::clamp(at[k], glm::dvec2(column, row), glm::dvec2(column + columns - 1, row + rows - 1)));
        if (s < block.spacing) block.spacing = s;
    }
    block.angle *= 1.1;                         // sides bulge between the 25 points
    if (!(block.angle < 0.5)) block.angle = 4;  // too wide for that, or cut: it meets every cap
    return block;
}

double RasterField::spacing(const Cap& cap) const {
    double least = std::numeric_limits<double>::infinity();
    blocks_.visit(cap, [&](int, int, double spacing) { return least = spacing; });
    return least;
}

// Rows in a small area are short: several at a time are given away.
void RasterField::sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const {
    const int size = survey_.block_size;
    const std::size_t most = 256 + static_cast<std::size_t>(size);
    SampleCursor cursor(*samples_);
    const auto normals = std::make_unique_for_overwrite<glm::dvec3[]>(most);
    const auto heights = std::make_unique_for_overwrite<float[]>(most);
    std::size_t held = 0;
    const auto give = [&] {
        if (held > 0) visit({normals.get(), held}, {heights.get(), held});
        held = 0;
    };
    blocks_.visit(area.cap, [&](int i, int j, double) {
        const int last_column = std::min((i + 1) * size, survey_.columns);
        const int last_row = std::min((j + 1) * size, raster().height);
        const SampleMap::RowsInArea in_area(map_, i * size, last_column - i * size, area);
        for (int row = j * size; row < last_row; ++row) {
            const auto [first, last] = in_area.find(row);
            const auto n = static_cast<std::size_t>(last - first);
            if (n == 0) continue;
            if (held + n > most) give();
            map_.normals_of_row(i * size + first, row, {normals.get() + held, n});
            heights_of_row(cursor, i * size + first, row, {heights.get() + held, n});
            held += n;
        }
        return std::numeric_limits<double>::infinity();
    });
    give();
}

// A row may lie in several views.
void RasterField::heights_of_row(SampleCursor& cursor, int column, int row, std::span<float> out) const {
    while (!out.empty()) {
        const SampleView& view = cursor.at(column, row);
        const auto n = std::min(out.size(), static_cast<std::size_t>(view.core.column + view.core.columns - column));
        const std::ptrdiff_t at = view.index(column, row);
        if (view.shorts)
            to_metres(raster(), view.shorts + at, out.first(n));
        else
            to_metres(raster(), view.floats + at, out.first(n));
        out = out.subspan(n);
        column += static_cast<int>(n);
    }
}

void RasterField::samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const {
    append_samples(*this, cap, normals, heights);
}

std::vector<SourceInfo> RasterField::sources() const {
    const RasterHeader& r = raster();
    const glm::dvec2 middle = 0.5 * glm::dvec2(r.width - 1, r.height - 1);
    SourceInfo info{r.name, r.checksum, r.crs, datum_, spacing_at(middle), datum_assumed_};
    if (mosaic_) info.files = mosaic_->file_names();
    return {std::move(info)};
}

bool RasterField::may_have_border(int column, int row) const {
    for (int j = row - 1; j <= row + 1; ++j)
        for (int i = column - 1; i <= column + 1; ++i) {
            if (i < 0 || j < 0 || i >= survey_.block_columns || j >= survey_.block_rows) return true;
            if (survey_.fill_at(i, j) != RasterSurvey::Fill::all) return true;
        }
    return false;
}

void RasterField::add_border_of_row(SampleCursor& cursor, int r, int first_column, int columns,
                                    std::vector<glm::dvec2>& at) const {
    const bool around = surface_.columns_around() > 0;
    const Poles poles = surface_.poles();
    const int w = survey_.columns, h = raster().height;
    const auto has = [&](int column, int row) {
        if (row < 0) return poles.first != PoleRow::none;
        if (row >= h) return poles.last != PoleRow::none;
        return (around || (column >= 0 && column < w)) && surface_.has_sample(cursor, column, row);
    };
    const auto side = [&](glm::dvec2 middle, glm::dvec2 along) {
        at.push_back(middle - 0.25 * along);
        at.push_back(middle + 0.25 * along);
    };
    constexpr double out = 0.499;
    for (int c = first_column; c < first_column + columns; ++c) {
        cursor.at(c, r);
        if (!has(c, r)) continue;
        if (!has(c - 1, r)) side({c - out, r}, {0, 1});
        if (!has(c + 1, r)) side({c + out, r}, {0, 1});
        if (!has(c, r - 1)) side({c, r - out}, {1, 0});
        if (!has(c, r + 1)) side({c, r + out}, {1, 0});
    }
}

// Row by row of the whole raster, so that the order does not depend on its blocks.
void RasterField::border(const Cap& cap, std::size_t every, std::vector<glm::dvec3>& normals) const {
    std::vector<std::pair<int, int>> found;  // row and column of blocks
    blocks_.visit(cap, [&](int column, int row, double) {
        if (may_have_border(column, row)) found.emplace_back(row, column);
        return std::numeric_limits<double>::infinity();
    });
    std::sort(found.begin(), found.end());
    const int size = survey_.block_size;
    const double most_chord = 2 * std::sin(0.5 * std::min(cap.angle, std::numbers::pi));
    SampleCursor cursor(*samples_);
    std::size_t sides = 0;
    std::vector<glm::dvec2> at;
    std::vector<glm::dvec3> n;
    for (auto first = found.begin(), last = first; first != found.end(); first = last) {
        last = std::find_if(first, found.end(), [&](const auto& f) { return f.first != first->first; });
        for (int r = first->first * size; r < std::min((first->first + 1) * size, raster().height); ++r) {
            at.clear();
            for (auto f = first; f != last; ++f)
                add_border_of_row(cursor, r, f->second * size, std::min(size, survey_.columns - f->second * size), at);
            keep_every(every, sides, at);
            n.resize(at.size());
            map_.normals_from_samples(at, n);
            for (const glm::dvec3& p : n)
                if (glm::distance(p, cap.centre) <= most_chord) normals.push_back(p);
        }
    }
}

std::shared_ptr<const RasterField> open_raster_field(const std::string& path, VerticalDatum datum,
                                                     const RasterOptions& options) {
    return std::make_shared<RasterField>(std::make_shared<const Raster>(read_raster(path, options)), datum);
}

}  // namespace planet
