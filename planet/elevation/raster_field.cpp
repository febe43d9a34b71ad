#include "planet/elevation/raster_field.h"

#include <algorithm>
#include <cassert>
#include <numbers>

namespace planet {
namespace {

constexpr std::size_t max_border = std::size_t{4} << 20;

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return 2 * std::asin(std::min(1.0, 0.5 * glm::distance(a, b)));
}

}  // namespace

RasterField::RasterField(std::shared_ptr<const Raster> raster, VerticalDatum datum)
    : raster_(std::move(raster)), datum_(datum), map_(*raster_), surface_(*raster_) {
    build_blocks();
}

void RasterField::heights(std::span<const glm::dvec3> normals, std::span<float> out) const {
    assert(out.size() == normals.size());
    glm::dvec2 at[256];
    for (std::size_t first = 0; first < normals.size(); first += std::size(at)) {
        const std::size_t n = std::min(std::size(at), normals.size() - first);
        map_.samples_from_normals(normals.subspan(first, n), {at, n});
        for (std::size_t i = 0; i < n; ++i) surface_.prefetch(at[i]);
        for (std::size_t i = 0; i < n; ++i) out[first + i] = surface_(at[i]);
    }
}

int RasterField::columns_without_repeat() const {
    return surface_.columns_around() > 0 ? surface_.columns_around() : raster_->width;
}

double RasterField::spacing_at(glm::dvec2 sample) const {
    const glm::dvec2 at[4] = {sample - glm::dvec2(0.5, 0), sample + glm::dvec2(0.5, 0), sample - glm::dvec2(0, 0.5),
                              sample + glm::dvec2(0, 0.5)};
    glm::dvec3 n[4];
    map_.normals_from_samples(at, n);
    const double x = glm::distance(n[0], n[1]), y = glm::distance(n[2], n[3]);
    const double longer = std::max(x, y);
    return raster_->radius_m * std::sqrt(longer * std::max(std::min(x, y), 0.25 * longer));
}

RasterField::Block RasterField::make_block(int column, int row, int columns, int rows) const {
    Block block{{0, 0, 0}, 0, std::numeric_limits<double>::infinity()};
    bool any = false;
    for (int r = row; r < row + rows && !any; ++r)
        for (int c = column; c < column + columns && !any; ++c) any = surface_.has_sample(c, r);
    if (!any) return block;
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

RasterField::Block RasterField::make_group(int column, int row) const {
    Block group{{0, 0, 0}, 0, std::numeric_limits<double>::infinity()};
    const int columns = std::min(column + group_size, block_columns_), rows = std::min(row + group_size, block_rows_);
    for (int j = row; j < rows; ++j)
        for (int i = column; i < columns; ++i) {
            const Block& b = block(i, j);
            if (std::isinf(b.spacing)) continue;
            if (std::isinf(group.spacing)) group.centre = b.centre;
            group.angle = std::max(group.angle, angle_between(b.centre, group.centre) + b.angle);
            group.spacing = std::min(group.spacing, b.spacing);
        }
    return group;
}

void RasterField::build_blocks() {
    const int w = columns_without_repeat(), h = raster_->height;
    block_size_ =
        std::clamp(std::max(w, h) / 32, 8, max_block);  // a coarse raster of the planet: still some 10 degrees
    block_columns_ = (w + block_size_ - 1) / block_size_;
    block_rows_ = (h + block_size_ - 1) / block_size_;
    blocks_.reserve(static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_));
    for (int j = 0; j < h; j += block_size_)
        for (int i = 0; i < w; i += block_size_)
            blocks_.push_back(make_block(i, j, std::min(block_size_, w - i), std::min(block_size_, h - j)));
    for (int j = 0; j < block_rows_; j += group_size)
        for (int i = 0; i < block_columns_; i += group_size) groups_.push_back(make_group(i, j));
}

template <class Visit>
void RasterField::visit_blocks(const Cap& cap, Visit visit) const {
    double wanted = std::numeric_limits<double>::infinity();
    const auto meets = [&](const Block& b) {
        return b.spacing < wanted && angle_between(b.centre, cap.centre) <= b.angle + cap.angle;
    };
    std::size_t group = 0;
    for (int row = 0; row < block_rows_; row += group_size)
        for (int column = 0; column < block_columns_; column += group_size) {
            if (!meets(groups_[group++])) continue;
            for (int j = row; j < std::min(row + group_size, block_rows_); ++j)
                for (int i = column; i < std::min(column + group_size, block_columns_); ++i)
                    if (meets(block(i, j))) wanted = visit(i, j, block(i, j));
        }
}

double RasterField::spacing(const Cap& cap) const {
    double least = std::numeric_limits<double>::infinity();
    visit_blocks(cap, [&](int, int, const Block& b) { return least = b.spacing; });
    return least;
}

void RasterField::samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const {
    const double least_cosine = std::cos(std::min(cap.angle, std::numbers::pi));
    visit_blocks(cap, [&](int i, int j, const Block&) {
        samples_of_block(i * block_size_, j * block_size_, cap, least_cosine, normals, heights);
        return std::numeric_limits<double>::infinity();
    });
}

void RasterField::samples_of_block(int column, int row, const Cap& cap, double least_cosine,
                                   std::vector<glm::dvec3>& normals, std::vector<float>& heights) const {
    const int columns = std::min(block_size_, columns_without_repeat() - column);
    const int rows = std::min(block_size_, raster_->height - row);
    std::array<glm::dvec3, max_block> line;
    for (int r = row; r < row + rows; ++r) {
        const auto n = static_cast<std::size_t>(columns);
        map_.normals_of_row(column, r, {line.data(), n});
        for (std::size_t i = 0; i < n; ++i) {
            const int c = column + static_cast<int>(i);
            if (!(glm::dot(line[i], cap.centre) >= least_cosine) || !surface_.has_sample(c, r)) continue;
            normals.push_back(line[i]);
            heights.push_back(static_cast<float>(raster_->at(c, r)));
        }
    }
}

std::vector<SourceInfo> RasterField::sources() const {
    const glm::dvec2 middle = 0.5 * glm::dvec2(raster_->width - 1, raster_->height - 1);
    return {{raster_->name, raster_->checksum, raster_->crs, datum_, spacing_at(middle)}};
}

void RasterField::border(std::vector<glm::dvec3>& normals) const {
    const bool around = surface_.columns_around() > 0;
    const Poles poles = surface_.poles();
    const int w = columns_without_repeat(), h = raster_->height;
    std::vector<glm::dvec2> at;
    const auto has = [&](int c, int r) {
        if (r < 0) return poles.first != PoleRow::none;
        if (r >= h) return poles.last != PoleRow::none;
        return (around || (c >= 0 && c < w)) && surface_.has_sample(c, r);
    };
    std::size_t stride = 1, sides = 0;
    const auto side = [&](glm::dvec2 middle, glm::dvec2 along) {
        if (sides++ % stride != 0) return;
        at.push_back(middle - 0.25 * along);
        at.push_back(middle + 0.25 * along);
        if (at.size() < max_border) return;
        stride *= 2;  // too many: keep every other one from here on and of those found
        std::size_t kept = 0;
        for (std::size_t i = 0; i < at.size(); i += 2) at[kept++] = at[i];
        at.resize(kept);
    };
    constexpr double out = 0.499;
    for (int r = 0; r < h; ++r)
        for (int c = 0; c < w; ++c) {
            if (!surface_.has_sample(c, r)) continue;
            if (!has(c - 1, r)) side({c - out, r}, {0, 1});
            if (!has(c + 1, r)) side({c + out, r}, {0, 1});
            if (!has(c, r - 1)) side({c, r - out}, {1, 0});
            if (!has(c, r + 1)) side({c, r + out}, {1, 0});
        }
    const std::size_t first = normals.size();
    normals.resize(first + at.size());
    map_.normals_from_samples(at, std::span(normals).subspan(first));
}

std::shared_ptr<const RasterField> open_raster_field(const std::string& path, VerticalDatum datum,
                                                     const RasterOptions& options) {
    return std::make_shared<RasterField>(std::make_shared<const Raster>(read_raster(path, options)), datum);
}

}  // namespace planet
