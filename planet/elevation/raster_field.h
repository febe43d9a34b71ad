#pragma once
// An elevation field from one raster.

#include <memory>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/raster_io.h"
#include "planet/elevation/raster_surface.h"
#include "planet/elevation/sample_map.h"

namespace planet {

/// Bicubic heights between the samples of a raster (raster_surface.h says how, at voids, water, seams and poles too).
/// Heights are rounded to float from float arithmetic: within 1e-6 of the largest sample around.
class RasterField : public ElevationField {
  public:
    /// @param datum what the raster's heights are measured from
    RasterField(std::shared_ptr<const Raster> raster, VerticalDatum datum);

    const Raster& raster() const { return *raster_; }

    VerticalDatum datum() const override { return datum_; }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override;
    /// In blocks of at most 64 x 64 samples. Where samples are much closer one way than the other (a geographic grid
    /// near a pole) the shorter spacing counts as at least a quarter of the longer one.
    double spacing(const Cap& cap) const override;
    void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const override;
    std::vector<SourceInfo> sources() const override;
    /// At most about four million: a raster with more has every n-th.
    void border(std::vector<glm::dvec3>& normals) const override;

  private:
    struct Block {
        glm::dvec3 centre;
        double angle;    // every sample of the block is within
        double spacing;  // infinity: nothing but voids
    };
    static constexpr int max_block = 64;  // samples a side
    static constexpr int group_size = 8;  // blocks a side

    int columns_without_repeat() const;
    void build_blocks();
    Block make_block(int column, int row, int columns, int rows) const;
    double spacing_at(glm::dvec2 sample) const;
    Block make_group(int column, int row) const;
    const Block& block(int column, int row) const {
        return blocks_[static_cast<std::size_t>(row) * static_cast<std::size_t>(block_columns_) +
                       static_cast<std::size_t>(column)];
    }
    /// Calls visit(column, row, block) for every block that may meet the cap and holds samples closer than visit's last
    /// answer (at first infinity).
    template <class Visit>
    void visit_blocks(const Cap& cap, Visit visit) const;
    void samples_of_block(int column, int row, const Cap& cap, double least_cosine, std::vector<glm::dvec3>& normals,
                          std::vector<float>& heights) const;

    std::shared_ptr<const Raster> raster_;
    VerticalDatum datum_;
    SampleMap map_;
    RasterSurface surface_;
    int block_size_ = max_block;
    int block_columns_ = 0, block_rows_ = 0;
    std::vector<Block> blocks_, groups_;  // row-major; a group bounds group_size x group_size blocks
};

/// Reads a file and makes a field of it.
std::shared_ptr<const RasterField> open_raster_field(const std::string& path, VerticalDatum datum,
                                                     const RasterOptions& options = {});

}  // namespace planet
