#pragma once
// The meshes that a picture's parts are drawn from.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "planet/mesh/segments.h"
#include "planet/streaming/resident_tiles.h"
#include "render/app/picture/drawn_surface.h"
#include "render/app/picture/steps.h"
#include "render/picture/camera.h"
#include "render/picture/relief_patches.h"

namespace render {

struct PartMesh {
    planet::Segments segments;
    ReliefPatches patches;
    planet::SegmentView view;        ///< that it was built for
    double deviation_max_m = 0;      ///< certified, of what is drawn
    double pixel_deviation_max = 0;  ///< pixels, certified; infinite if a damaged tile hides what is beside the eye
};

/// What a part of a picture asks of its mesh, as fine as the options say. @param segment_angle see planet::SegmentView
planet::SegmentView part_view(const RenderOptions& options, const DrawnSurface& surface, const Camera& camera,
                              const PicturePart& part, double segment_angle);

/// Where the angle begins, and what it is multiplied with while there are more patches than that.
double first_segment_angle(const Camera& camera);
inline constexpr double segment_angle_step = 1.5, largest_segment_angle = 10;
inline constexpr std::size_t patch_limit = 1800;

/// Makes one mesh at a time, settled: every tile that the part needs is waited for. Tiles stay for the next part, within
/// the memory limit.
class PartMesher {
  public:
    /// All must outlive it.
    PartMesher(const RenderOptions& options, const DrawnSurface& surface, const Camera& camera, Steps& steps)
        : options_(options), surface_(surface), camera_(camera), steps_(steps) {
        take_tiles();
    }

    /// What to do where a part takes more than patch_limit patches.
    enum class Crowd {
        coarser,  ///< make them coarser
        refused,  ///< make nothing: in another part of the picture they would be as fine as they were, and a seam be seen
    };
    /// @return false where it was refused
    /// Throws planet::Error(bad_usage) if the coarsest mesh has more triangles than RenderOptions::max_triangles.
    bool build(const PicturePart& part, Crowd crowd, PartMesh& mesh);

    /// What build() takes its tiles from.
    const planet::TileSource& tiles() const;
    planet::ResidentCounts counts() const;

  private:
    /// The split test's K, and by how much it is coarser than the picture asked for.
    struct Fineness {
        double K, coarsening;
    };
    void take_tiles();
    Fineness fineness(double segment_angle);
    void build_segments(PartMesh& mesh);
    void certify(PartMesh& mesh, double coarsening) const;

    const RenderOptions& options_;
    const DrawnSurface& surface_;
    const Camera& camera_;
    Steps& steps_;
    std::optional<planet::StoreTiles> tiles_;
    std::size_t loaded_before_ = 0;        ///< tiles that went when memory was full
    std::map<double, Fineness> fineness_;  // by segment angle: the same in all parts
    // Only once a tile is known to be damaged: the cells of its parent stand in for it without a crack.
    std::unique_ptr<planet::ResidentTiles> around_damage_;
};

}  // namespace render
