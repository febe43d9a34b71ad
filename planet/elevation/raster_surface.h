#pragma once
// The surface through the samples of a raster: bicubic, with care at voids, water, the antimeridian and the poles.
//
// Between samples: cubic convolution with a = -1/2 (Keys, "Cubic convolution interpolation for digital image
// processing", IEEE Trans. ASSP 29(6), 1981), which is the bicubic Hermite patch whose slopes are central differences
// (Catmull-Rom). It goes through the samples, is C1, and is exact for quadratic surfaces; x^3 is off by t(1-t)(1-2t).
//
//     o   o   o   o      fast: all 4 x 4 samples are plain heights: 16 products.
//     o   A---B   o      else: the same Hermite patch of A B C D with slopes that look at no void: one-sided beside
//     one, o   | p |   o      0 between two. The slopes belong to the samples, so the surface stays C1 beside voids,
//     and a o   C---D   o      void's neighbourhood is at most quadratic, never the work of invented values. o   o   o
//     o
//
// A sample stands for its pixel: there is an answer wherever the nearest sample is not void, up to half a sample beyond
// the outer ones; where a corner of the patch is void it is continued linearly from the others.
//
// Water is flat at height 0. Slopes of land beside it are at most 1.5 times its height a sample and the twist is 0:
// then no patch between water and land above 0 goes below 0 (of the patch's terms s²t²[(3-2s)(3-2t) f - (1-s)(3-2t) fx
// - (3-2s)(1-t) fy] each is >= 0), and a patch between four water samples is exactly 0.
//
// A raster that goes around continues across a pole at longitude + 180. Where the pole is the edge of the last pixels
// the surface is led to one value there, the mean of the last row, over half a row; where it is a row, the mean
// replaces that row.

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "planet/elevation/raster_samples.h"
#include "planet/elevation/raster_survey.h"

namespace planet {

class RasterSurface {
  public:
    /// @param raster  of what the survey was made
    RasterSurface(const RasterHeader& raster, const RasterSurvey& survey);

    /// Heights in metres at columns and rows (whole at pixel centres); NaN where void, outside or NaN. Columns of a
    /// raster that goes around may lie up to a turn outside.
    void heights(SampleCursor& cursor, std::span<const glm::dvec2> samples, std::span<float> out) const;

    /// Whether a pixel holds a height (or water); columns wrap, rows beyond a pole or the raster do not.
    bool has_sample(const SampleCursor& cursor, int column, int row) const;
    int columns_around() const { return around_; }
    Poles poles() const { return poles_; }

  private:
    // 4 x 4 samples around a point, in samples' units; NaN where there is none.
    struct Neighbourhood {
        std::array<std::array<float, 4>, 4> height;  // [row][column]
        std::array<std::array<bool, 4>, 4> water;
    };
    struct Corner {
        float f, fx, fy, fxy;
    };

    bool is_inside(glm::dvec2 sample) const;
    float fetch(const SampleCursor& cursor, int column, int row, bool& water) const;
    Corner corner(const Neighbourhood& n, int column, int row) const;
    float careful(const SampleCursor& cursor, int column, int row, float s, float t) const;
    float lead_to_pole(double row, float value) const;

    float height(SampleCursor& cursor, glm::dvec2 sample) const;
    /// Of as many as fit a register, where they are easy.
    template <class Sample>
    bool heights_inside(const SampleCursor& cursor, const Sample* samples, const glm::dvec2* at, float* out) const;
    template <class Sample>
    float fast_or_careful(const SampleCursor& cursor, const Sample* samples, int column, int row, glm::dvec2 at) const;

    int width_, height_;
    double scale_, offset_;
    int around_;
    Poles poles_;
    float zero_;  // height 0 in samples' units: what water is worth
    float first_pole_ = 0, last_pole_ = 0;
};

}  // namespace planet
