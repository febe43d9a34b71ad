#include "planet/elevation/raster_surface.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

namespace planet {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// Four floats that the compiler keeps in one register; plain IEEE arithmetic, lane by lane.
using Four = float __attribute__((vector_size(16)));
using FourShorts = std::int16_t __attribute__((vector_size(8)));

Four load(const std::int16_t* p) {
    FourShorts s;
    std::memcpy(&s, p, sizeof s);
    return __builtin_convertvector(s, Four);
}
Four load(const float* p) {
    Four f;
    std::memcpy(&f, p, sizeof f);
    return f;
}

Four weights(float t) {
    const float u = 1 - t;
    return Four{-0.5f * t * u * u, 1 - t * t * (2.5f - 1.5f * t), 1 - u * u * (2.5f - 1.5f * u), -0.5f * u * t * t};
}

float sum(Four v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

// Whether 16 samples are all plain heights.
bool plain(const Four& a, const Four& b, const Four& c, const Four& d, std::int16_t) {
    const auto smaller = [](Four p, Four q) { return p < q ? p : q; };
    const Four least = smaller(smaller(a, b), smaller(c, d));
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3])) > water_sample;
}
bool plain(const Four& a, const Four& b, const Four& c, const Four& d, float) {
    return std::isfinite(sum((a + b) + (c + d)));  // an infinity or NaN stays one
}

// Eight places at once, one a lane: the arithmetic of one place, operation by operation, so the same bits.
constexpr std::size_t lanes = 8;
using Floats = float __attribute__((vector_size(4 * lanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * lanes)));
using Doubles = double __attribute__((vector_size(8 * lanes)));
using Longs = std::int64_t __attribute__((vector_size(8 * lanes)));
using PlaceRow = std::array<Floats, 4>;  // by column: samples beside the places

template <class Vector, class Read>
Vector each_lane(Read read) {
    return Vector{read(0), read(1), read(2), read(3), read(4), read(5), read(6), read(7)};
}

PlaceRow load_row(const std::array<const std::int16_t*, lanes>& first, std::ptrdiff_t along) {
    const Longs four = each_lane<Longs>([&](std::size_t w) {
        std::int64_t samples;
        std::memcpy(&samples, first[w] + along, sizeof samples);
        return samples;
    });
    const auto halves = std::bit_cast<std::array<Ints, 2>>(four);
    const Ints low = __builtin_shufflevector(halves[0], halves[1], 0, 2, 4, 6, 8, 10, 12, 14);
    const Ints high = __builtin_shufflevector(halves[0], halves[1], 1, 3, 5, 7, 9, 11, 13, 15);
    const auto number = [](Ints whole) { return __builtin_convertvector(whole, Floats); };
    return {number(low << 16 >> 16), number(low >> 16), number(high << 16 >> 16), number(high >> 16)};
}
PlaceRow load_row(const std::array<const float*, lanes>& first, std::ptrdiff_t along) {
    PlaceRow row;
    for (std::ptrdiff_t i = 0; i < 4; ++i)
        row[static_cast<std::size_t>(i)] = each_lane<Floats>([&](std::size_t w) { return first[w][along + i]; });
    return row;
}

PlaceRow weights(const Floats& t) {
    const Floats u = 1 - t;
    return {-0.5f * t * u * u, 1 - t * t * (2.5f - 1.5f * t), 1 - u * u * (2.5f - 1.5f * u), -0.5f * u * t * t};
}

// By lane, whether 16 samples are all plain heights: plain() of one place.
Ints plain(const std::array<PlaceRow, 4>& r, std::int16_t) {
    Floats least = r[0][0];
    for (const PlaceRow& row : r)
        for (const Floats& f : row) least = f < least ? f : least;
    return least > static_cast<float>(water_sample);
}
Ints plain(const std::array<PlaceRow, 4>& r, float) {
    PlaceRow s;
    for (std::size_t i = 0; i < 4; ++i) s[i] = (r[0][i] + r[1][i]) + (r[2][i] + r[3][i]);
    const Floats all = (s[0] + s[1]) + (s[2] + s[3]);
    constexpr float most = std::numeric_limits<float>::max();
    return (all >= -most) & (all <= most);
}

bool all_of(const Longs& mask) {
    std::int64_t all = -1;
    for (std::size_t w = 0; w < lanes; ++w) all &= mask[w];
    return all != 0;
}

// Central, one-sided or no difference; NaN marks a missing neighbour.
float slope(float before, float here, float after) {
    if (std::isnan(before)) return std::isnan(after) ? 0 : after - here;
    return std::isnan(after) ? here - before : 0.5f * (after - before);
}

}  // namespace

RasterSurface::RasterSurface(const RasterHeader& raster, const RasterSurvey& survey)
    : width_(raster.width),
      height_(raster.height),
      scale_(raster.scale),
      offset_(raster.offset),
      around_(planet::columns_around(raster)),
      poles_(poles_of(raster)),
      zero_(static_cast<float>(-raster.offset / raster.scale)),
      first_pole_(survey.first_mean),
      last_pole_(survey.last_mean) {
    if (std::isnan(first_pole_)) poles_.first = PoleRow::none;
    if (std::isnan(last_pole_)) poles_.last = PoleRow::none;
}

float RasterSurface::fetch(const SampleCursor& cursor, int column, int row, bool& water) const {
    water = false;
    const int h = height_;
    if (row < 0 && poles_.first != PoleRow::none) {
        row = poles_.first == PoleRow::at_row ? -row : -row - 1;
        column += around_ / 2;
    } else if (row >= h && poles_.last != PoleRow::none) {
        row = 2 * (h - 1) - row + (poles_.last == PoleRow::at_row ? 0 : 1);
        column += around_ / 2;
    }
    if (around_ > 0) column = ((column % around_) + around_) % around_;
    if (row < 0 || row >= h || column < 0 || column >= width_) return nan;
    const float v = cursor.raw(column, row);
    if (std::isinf(v)) {
        water = true;
        return zero_;
    }
    if (row == 0 && poles_.first == PoleRow::at_row) return first_pole_;
    if (row == h - 1 && poles_.last == PoleRow::at_row) return last_pole_;
    return v;
}

bool RasterSurface::has_sample(const SampleCursor& cursor, int column, int row) const {
    if (around_ > 0) column = ((column % around_) + around_) % around_;
    if (row < 0 || row >= height_ || column < 0 || column >= width_) return false;
    return !std::isnan(cursor.raw(column, row));
}

RasterSurface::Corner RasterSurface::corner(const Neighbourhood& n, int column, int row) const {
    const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
    const auto& h = n.height;
    const float f = h[r][c];
    if (std::isnan(f) || n.water[r][c]) return {f, 0, 0, 0};
    Corner out{f, slope(h[r][c - 1], f, h[r][c + 1]), slope(h[r - 1][c], f, h[r + 1][c]), 0};
    bool coast = false;
    for (std::size_t j = r - 1; j <= r + 1; ++j)
        for (std::size_t i = c - 1; i <= c + 1; ++i) coast |= n.water[j][i];
    if (coast) {
        const float limit = 1.5f * std::abs(f - zero_);
        out.fx = std::clamp(out.fx, -limit, limit);
        out.fy = std::clamp(out.fy, -limit, limit);
        return out;
    }
    const float twist = 0.25f * ((h[r + 1][c + 1] - h[r + 1][c - 1]) - (h[r - 1][c + 1] - h[r - 1][c - 1]));
    if (!std::isnan(twist)) out.fxy = twist;
    return out;
}

float RasterSurface::careful(const SampleCursor& cursor, int column, int row, float s, float t) const {
    Neighbourhood n{};
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            const auto r = static_cast<std::size_t>(j), c = static_cast<std::size_t>(i);
            bool water = false;
            n.height[r][c] = fetch(cursor, column - 1 + i, row - 1 + j, water);
            n.water[r][c] = water;
        }
    const std::size_t near_c = s < 0.5f ? 1 : 2, near_r = t < 0.5f ? 1 : 2;
    if (std::isnan(n.height[near_r][near_c])) return nan;
    if (n.water[1][1] && n.water[1][2] && n.water[2][1] && n.water[2][2]) return zero_;

    Corner k[4];
    int known = 0;
    Corner from_known{0, 0, 0, 0};
    for (int q = 0; q < 4; ++q) {
        k[q] = corner(n, 1 + (q & 1), 1 + (q >> 1));
        if (std::isnan(k[q].f)) continue;
        ++known;
        from_known = {0, from_known.fx + k[q].fx, from_known.fy + k[q].fy, 0};
    }
    for (int q = 0; q < 4; ++q) {  // void corners continue the known ones linearly
        if (!std::isnan(k[q].f)) continue;
        float total = 0;
        for (int p = 0; p < 4; ++p)
            if (!std::isnan(k[p].f) &&
                std::isfinite(n.height[static_cast<std::size_t>(1 + (p >> 1))][static_cast<std::size_t>(1 + (p & 1))]))
                total += k[p].f + static_cast<float>((q & 1) - (p & 1)) * k[p].fx +
                         static_cast<float>((q >> 1) - (p >> 1)) * k[p].fy;
        const float m = static_cast<float>(known);
        k[q] = {total / m, from_known.fx / m, from_known.fy / m, 0};
        n.height[static_cast<std::size_t>(1 + (q >> 1))][static_cast<std::size_t>(1 + (q & 1))] = nan;
    }

    const float u = 1 - s, v = 1 - t;
    const float value_x[2] = {u * u * (1 + 2 * s), s * s * (3 - 2 * s)}, slope_x[2] = {s * u * u, -s * s * u};
    const float value_y[2] = {v * v * (1 + 2 * t), t * t * (3 - 2 * t)}, slope_y[2] = {t * v * v, -t * t * v};
    float h = 0;
    for (int q = 0; q < 4; ++q) {
        const int i = q & 1, j = q >> 1;
        h += value_y[j] * (value_x[i] * k[q].f + slope_x[i] * k[q].fx) +
             slope_y[j] * (value_x[i] * k[q].fy + slope_x[i] * k[q].fxy);
    }
    return h;
}

float RasterSurface::lead_to_pole(double row, float value) const {
    const bool first = row < 0 && poles_.first == PoleRow::at_edge;
    const bool last = row > height_ - 1 && poles_.last == PoleRow::at_edge;
    if (!first && !last) return value;
    const double rows = first ? row + 0.5 : height_ - 0.5 - row;  // to the pole
    const float d = static_cast<float>(std::clamp(2 * rows, 0.0, 1.0));
    const float pole = first ? first_pole_ : last_pole_;
    return pole + (value - pole) * (d * d * (3 - 2 * d));
}

template <class Sample>
float RasterSurface::fast_or_careful(const SampleCursor& cursor, const Sample* samples, int c, int r,
                                     glm::dvec2 at) const {
    const float s = static_cast<float>(at.x - c), t = static_cast<float>(at.y - r);
    if (c < 1 || r < 1 || c + 2 >= width_ || r + 2 >= height_ || (r == 1 && poles_.first == PoleRow::at_row) ||
        (r + 3 == height_ && poles_.last == PoleRow::at_row))
        return lead_to_pole(at.y, careful(cursor, c, r, s, t));
    const std::ptrdiff_t w = cursor.view().window.columns;
    const Sample* p = samples + cursor.view().index(c - 1, r - 1);
    const Four r0 = load(p), r1 = load(p + w), r2 = load(p + 2 * w), r3 = load(p + 3 * w);
    if (!plain(r0, r1, r2, r3, Sample{})) return careful(cursor, c, r, s, t);
    const Four y = weights(t);
    return sum(weights(s) * ((y[0] * r0 + y[1] * r1) + (y[2] * r2 + y[3] * r3)));
}

bool RasterSurface::is_inside(glm::dvec2 at) const {
    constexpr double rim = 0.5 + 1e-9;  // a position at the very edge counts as inside whatever its rounding
    const double beyond = around_ > 0 ? width_ : rim;
    return at.y >= -rim && at.y <= height_ - 1 + rim && at.x >= -beyond && at.x <= width_ - 1 + beyond;
}

// False: they do not all lie in the cursor's view and away from what takes care at the raster's borders.
template <class Sample>
bool RasterSurface::heights_inside(const SampleCursor& cursor, const Sample* samples, const glm::dvec2* at,
                                   float* out) const {
    const SampleView& view = cursor.view();
    const int first_column = std::max(view.core.column, 1),
              end_column = std::min(view.core.column + view.core.columns, width_ - 2);
    const int first_row = std::max(view.core.row, poles_.first == PoleRow::at_row ? 2 : 1),
              end_row = std::min(view.core.row + view.core.rows, height_ - (poles_.last == PoleRow::at_row ? 3 : 2));
    const Doubles x = each_lane<Doubles>([&](std::size_t w) { return at[w].x; }),
                  y = each_lane<Doubles>([&](std::size_t w) { return at[w].y; });
    if (!all_of((x >= double(first_column)) & (x < double(end_column)) & (y >= double(first_row)) &
                (y < double(end_row))))
        return false;
    const Ints c = __builtin_convertvector(x, Ints), r = __builtin_convertvector(y, Ints);
    const Floats s = __builtin_convertvector(x - __builtin_convertvector(c, Doubles), Floats),
                 t = __builtin_convertvector(y - __builtin_convertvector(r, Doubles), Floats);
    std::array<const Sample*, lanes> first;
    for (std::size_t w = 0; w < lanes; ++w) first[w] = samples + view.index(c[w] - 1, r[w] - 1);
    std::array<PlaceRow, 4> rows;
    for (std::size_t j = 0; j < 4; ++j) rows[j] = load_row(first, static_cast<std::ptrdiff_t>(j) * view.window.columns);
    const PlaceRow by_x = weights(s), by_y = weights(t);
    PlaceRow column;
    for (std::size_t i = 0; i < 4; ++i)
        column[i] =
            by_x[i] * ((by_y[0] * rows[0][i] + by_y[1] * rows[1][i]) + (by_y[2] * rows[2][i] + by_y[3] * rows[3][i]));
    const Floats h = (column[0] + column[1]) + (column[2] + column[3]);
    const Ints is_plain = plain(rows, Sample{});
    for (std::size_t w = 0; w < lanes; ++w) {
        const float v = is_plain[w] ? h[w] : careful(cursor, c[w], r[w], s[w], t[w]);
        out[w] = static_cast<float>(offset_ + scale_ * static_cast<double>(v));
    }
    return true;
}

float RasterSurface::height(SampleCursor& cursor, glm::dvec2 at) const {
    if (!is_inside(at)) return nan;
    const int c = static_cast<int>(std::floor(at.x)), r = static_cast<int>(std::floor(at.y));
    const SampleView& view = cursor.at(std::clamp(c, 0, width_ - 1), std::clamp(r, 0, height_ - 1));
    const float v =
        view.shorts ? fast_or_careful(cursor, view.shorts, c, r, at) : fast_or_careful(cursor, view.floats, c, r, at);
    return static_cast<float>(offset_ + scale_ * static_cast<double>(v));
}

void RasterSurface::heights(SampleCursor& cursor, std::span<const glm::dvec2> at, std::span<float> out) const {
    std::size_t i = 0;
    for (; i + lanes <= at.size(); i += lanes) {
        const SampleView& view = cursor.view();
        if (view.shorts ? heights_inside(cursor, view.shorts, &at[i], &out[i])
                        : heights_inside(cursor, view.floats, &at[i], &out[i]))
            continue;
        for (std::size_t w = i; w < i + lanes; ++w) out[w] = height(cursor, at[w]);
    }
    for (; i < at.size(); ++i) out[i] = height(cursor, at[i]);
}

}  // namespace planet
