#pragma once
// Normals per pixel. A patch is the square of a segment's root and its neighbour across the split side, with 65 x 65
// normals sampled from the finest surface, so lighting does not change with the level of the triangles.

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "planet/mesh/segments.h"
#include "render/gl/texture.h"

namespace render {

inline constexpr int patch_side = 65;
inline constexpr float patch_range = 4;  ///< slopes to 76 degrees

/// The finest surface. Both must be safe from several threads.
struct PatchSurface {
    /// Heights, metres, at unit normals; finite.
    std::function<void(std::span<const glm::dvec3>, std::span<float>)> heights;
    /// Distance between its vertices at a unit normal, metres.
    std::function<double(const glm::dvec3&)> spacing;
};

/// The texels of one patch, RGBA16 SNORM, by mip level from the finest.
std::vector<std::vector<std::int16_t>> make_relief_patch(planet::LocationCode patch, const PatchSurface& surface,
                                                         double radius_m);

class ReliefPatches {
  public:
    /// Makes the patches of all detailed segments. @param radius_m of the planet
    void build(const planet::Segments& segments, const PatchSurface& surface, double radius_m, int threads);

    /// By segment: the layer, or -1.
    std::span<const std::int32_t> layers() const { return layers_; }
    std::size_t count() const { return count_; }

    /// RGBA16 SNORM array with mips: the offset of the terrain normal from the geodetic one over patch_range; a = 1.
    Texture upload() const;

  private:
    std::vector<std::int32_t> layers_;
    std::size_t count_ = 0;
    std::vector<std::vector<std::int16_t>> levels_;  // by mip level, all layers one behind the other
};

}  // namespace render
