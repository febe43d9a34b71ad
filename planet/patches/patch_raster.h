#pragma once
// A raster on a grid of patches: square patches of 2^k + 1 samples, 2^k at least the shorter side less one, repeated
// along the longer side. What lies beyond the raster is padding: it repeats the samples on the border, weighs nothing
// in any deviation, and is clipped away from every mesh.

#include <vector>

#include "planet/elevation/raster.h"
#include "planet/quadtree/patch_lattice.h"

namespace planet {

class PatchRaster {
  public:
    /// x of the lattice is the raster's column, y its row. Throws Error(bad_data) for a raster that is one sample wide
    /// or high, has no valid sample, or makes more than max_samples lattice samples with its padding.
    explicit PatchRaster(const Raster& raster, std::size_t max_samples = std::size_t{1} << 28);

    const PatchLattice& lattice() const { return lattice_; }
    const PatchGrid& grid() const { return lattice_.grid(); }
    int width() const { return width_; }    ///< samples
    int height() const { return height_; }  ///< samples
    std::size_t valid_samples() const { return valid_; }
    bool has_void() const { return valid_ < heights_.size() - readable_beyond; }
    /// Largest |height of the source - height here|, metres: floats hold whole metres and most else exactly.
    double sample_rounding() const { return sample_rounding_; }

    /// A row of heights, metres, NaN where void. Eight floats beyond the end may be read.
    const float* row(int y) const {
        return heights_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    }
    /// Any lattice sample, padding included.
    float at(glm::ivec2 p) const { return row(std::min(p.y, height_ - 1))[std::min(p.x, width_ - 1)]; }
    bool inside(glm::ivec2 p) const { return p.x < width_ && p.y < height_; }
    /// Whether a triangle is padding only: its area has none in common with the raster.
    bool outside(const LatticeCorners& c) const {
        return std::min({c.left.x, c.right.x, c.apex.x}) >= width_ - 1 ||
               std::min({c.left.y, c.right.y, c.apex.y}) >= height_ - 1;
    }
    /// Whether a triangle lies within the raster.
    bool inside(const LatticeCorners& c) const { return inside(c.left) && inside(c.right) && inside(c.apex); }

  private:
    static constexpr std::size_t readable_beyond = 8;

    PatchLattice lattice_;
    int width_, height_;
    std::size_t valid_ = 0;
    double sample_rounding_ = 0;
    std::vector<float> heights_;
};

}  // namespace planet
