#pragma once
// A raster of heights below a mesh that is refined: where its vertices belong, and how far the mesh is from the samples.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planet/bisection/bisection.h"
#include "planet/elevation/raster_field.h"
#include "planet/patches/raster_frame.h"
#include "render/app/refine/refine_base.h"
#include "render/app/refine/sample_tree.h"

namespace render {

/// Places are as in a RefineBase. Distances are along the vertical of the sample: the normal of the ellipsoid in the frames
/// enu and ecef, else z.
class RefineTerrain {
  public:
    /// Throws planet::Error: bad_data for what is no DEM or larger than memory allows; bad_usage for a mesh in another
    /// CRS.
    RefineTerrain(const std::string& path, std::optional<planet::VerticalDatum> datum, const RefineMeaning& meaning);

    const std::string& name() const { return raster_->name; }
    /// The ground at a place: between samples bilinear, at the place's x and y. Of a round mesh bicubic, on its vertical.
    /// Nothing where no sample is near.
    std::optional<glm::dvec3> ground(const glm::dvec3& p) const;
    /// The largest distance of any sample in a triangle, its sides included. 0 without samples.
    double deviation(const planet::TrianglePlaces& triangle) const;

    struct Measured {
        double max = 0, rms = 0;                 ///< m
        double max_in_region = 0;                ///< m, over triangles in the region
        std::size_t samples = 0, uncovered = 0;  ///< valid ones in triangles, each counted once; in none
    };
    /// @param region whether a triangle is in it; empty: all are
    Measured measure(const planet::PlainMesh& mesh, const std::function<bool(std::size_t triangle)>& region = {}) const;

  private:
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(raster_->width) +
               static_cast<std::size_t>(column);
    }
    const glm::dvec3& sample(int column, int row) const { return samples_[index(column, row)]; }
    glm::dvec3 vertical(std::size_t sample) const {
        return verticals_.empty() ? glm::dvec3(0, 0, 1) : glm::dvec3(verticals_[sample]);
    }
    glm::dvec3 ecef_normal(const glm::dvec3& p) const;
    void place_samples(const planet::RasterFrame& frame, const RefineMeaning& meaning);
    void plant_tree();
    SampleBox box_around(const planet::TrianglePlaces& triangle) const;
    glm::dvec2 column_row(glm::dvec2 p) const;
    template <class Visit>
    void for_each_sample(const planet::TrianglePlaces& triangle, Visit&& visit) const;

    std::shared_ptr<const planet::Raster> raster_;
    std::shared_ptr<const planet::Geoid> geoid_;        ///< null where heights are used as they are
    std::unique_ptr<const planet::RasterField> field_;  ///< of a round mesh
    std::vector<glm::dvec3> samples_;                   ///< NaN: void
    std::vector<glm::vec3> verticals_;                  ///< empty: z everywhere
    glm::dvec3 origin_{0};                              ///< ecef = origin + ecef_from_mesh p, where there are verticals
    glm::dmat3 ecef_from_mesh_{1};
    SampleTree tree_;  ///< by unit normals where there are verticals, else by x and y
};

}  // namespace render
