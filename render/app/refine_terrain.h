#pragma once
// A raster of heights below a mesh that is refined: where its vertices belong, and how far the mesh is from the samples.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planet/bisection/bisection.h"
#include "planet/elevation/elevation_field.h"
#include "render/app/refine_base.h"

namespace render {

/// Places are as in a RefineBase. "Up" is the mesh's z: in an enu frame, that at its origin.
class RefineTerrain {
  public:
    /// Throws planet::Error: bad_data for what is no DEM or larger than memory allows; bad_usage for a mesh in another
    /// CRS, or an Earth-centred one.
    RefineTerrain(const std::string& path, std::optional<planet::VerticalDatum> datum, const RefineMeaning& meaning);

    const std::string& name() const { return name_; }
    /// On the ground, between samples bilinear; as it is where no sample is near.
    glm::dvec3 on_ground(const glm::dvec3& p) const;
    /// The largest distance of any sample in a triangle, its sides included, along z. 0 without samples.
    double deviation(const planet::TrianglePlaces& triangle) const;

    struct Measured {
        double max = 0, rms = 0;                 ///< m
        double max_in_region = 0;                ///< m, over triangles for which `region` holds
        std::size_t samples = 0, uncovered = 0;  ///< valid ones in triangles, each counted once; in none
    };
    /// @param region empty: all triangles
    Measured measure(const planet::PlainMesh& mesh,
                     const std::function<bool(const planet::TrianglePlaces&)>& region = {}) const;

  private:
    struct Box {
        int left, right, low, high;  ///< columns and rows, both ends included
    };

    const glm::dvec3& sample(int column, int row) const {
        return samples_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(column)];
    }
    glm::dvec2 column_row(glm::dvec2 p) const;
    Box box_around(const planet::TrianglePlaces& triangle) const;
    template <class Visit>
    void for_each_sample(const planet::TrianglePlaces& triangle, Visit&& visit) const;

    std::string name_;
    int width_ = 0, height_ = 0;
    std::vector<glm::dvec3> samples_;  ///< z NaN: void
};

}  // namespace render
