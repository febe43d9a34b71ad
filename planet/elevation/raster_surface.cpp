#include "planet/elevation/raster_surface.h"

#include <algorithm>
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

void RasterSurface::heights(SampleCursor& cursor, std::span<const glm::dvec2> at, std::span<float> out) const {
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (!is_inside(at[i])) {
            out[i] = nan;
            continue;
        }
        const int c = static_cast<int>(std::floor(at[i].x)), r = static_cast<int>(std::floor(at[i].y));
        const SampleView& view = cursor.at(std::clamp(c, 0, width_ - 1), std::clamp(r, 0, height_ - 1));
        const float v = view.shorts ? fast_or_careful(cursor, view.shorts, c, r, at[i])
                                    : fast_or_careful(cursor, view.floats, c, r, at[i]);
        out[i] = static_cast<float>(offset_ + scale_ * static_cast<double>(v));
    }
}

}  // namespace planet
