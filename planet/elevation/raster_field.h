#pragma once
// An elevation field from one raster.

#include <memory>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/raster_blocks.h"
#include "planet/elevation/raster_io.h"
#include "planet/elevation/raster_mosaic.h"
#include "planet/elevation/raster_samples.h"
#include "planet/elevation/raster_surface.h"
#include "planet/elevation/raster_survey.h"
#include "planet/elevation/sample_map.h"

namespace planet {

/// Bicubic heights between the samples of a raster (raster_surface.h says how, at voids, water, seams and poles too).
/// Heights are rounded to float from float arithmetic: within 1e-6 of the largest sample around.
class RasterField : public ElevationField {
  public:
    /// @param datum what the raster's heights are measured from
    RasterField(std::shared_ptr<const Raster> raster, VerticalDatum datum);
    /// Of any samples and what a survey of them found. No view of the samples may be used after the field is gone.
    /// @param mosaic  that the samples are read from, if it has more than one file
    RasterField(std::shared_ptr<const RasterSamples> samples, RasterSurvey survey, VerticalDatum datum,
                bool datum_assumed = false, std::shared_ptr<const RasterMosaic> mosaic = {});

    const RasterHeader& raster() const { return samples_->header(); }

    VerticalDatum datum() const override { return datum_; }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override;
    /// The file of the nearest sample.
    void heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                              std::span<WeighedOrigin> origins) const override;
    /// In the blocks of a survey: at most 64 x 64 samples, more of rasters beyond 32,768 a side. Where samples are much closer one way than the other (a geographic grid
    /// near a pole) the shorter spacing counts as at least a quarter of the longer one.
    double spacing(const Cap& cap) const override;
    void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const override;
    void sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const override;
    std::vector<SourceInfo> sources() const override;
    void border(const Cap& cap, std::size_t every, std::vector<glm::dvec3>& normals) const override;
    std::size_t border_size() const override { return 2 * survey_.border_sides; }

  private:
    glm::ivec2 nearest_sample(glm::dvec2 sample) const;
    void find_origins(std::span<const glm::ivec2> nearest, std::span<WeighedOrigin> origins) const;
    double spacing_at(glm::dvec2 sample) const;
    RasterBlocks::Block make_block(int column, int row) const;
    void heights_of_row(SampleCursor& cursor, int column, int row, std::span<float> out) const;
    void add_border_of_row(SampleCursor& cursor, int row, int first_column, int columns,
                           std::vector<glm::dvec2>& at) const;
    bool may_have_border(int block_column, int block_row) const;

    std::shared_ptr<const RasterSamples> samples_;
    RasterSurvey survey_;
    VerticalDatum datum_;
    bool datum_assumed_;
    std::shared_ptr<const RasterMosaic> mosaic_;  // nothing: one file
    SampleMap map_;
    RasterSurface surface_;
    RasterBlocks blocks_;
};

/// Reads a file and makes a field of it.
std::shared_ptr<const RasterField> open_raster_field(const std::string& path, VerticalDatum datum,
                                                     const RasterOptions& options = {});

}  // namespace planet
