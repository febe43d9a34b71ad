#pragma once
// A settled view, drawn part by part: while one is drawn, the mesh of the next is made.

#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <vector>

#include "render/app/picture/globe_looks.h"
#include "render/app/picture/part_mesh.h"
#include "render/app/picture/picture_parts.h"

namespace render {

/// Of all parts together. Counts are of what was made for them.
struct PaintedParts {
    std::uint64_t triangles = 0, vertices = 0, strip_indices = 0;
    std::uint64_t sent_bytes = 0;    ///< of meshes, to the GPU
    double deviation_max_m = 0;      ///< certified
    double pixel_deviation_max = 0;  ///< see PartMesh
};

class PartPainter {
  public:
    /// All must outlive it. Begins to make the first part's mesh.
    PartPainter(const RenderOptions& options, const DrawnSurface& surface, const Camera& camera, Steps& steps);

    struct Output {
        std::function<void(std::vector<std::uint8_t> band, int rows)> write;  ///< RGB, top down, as wide as is wanted
        std::function<void(double part)> progress = [](double) {};            ///< 0..1
    };
    /// Draws all of it, once. @param looks with the sky and the layers of the view @param most_samples of the context
    void paint(GlobeLooks& looks, int most_samples, const Output& output);

    const PaintedParts& painted() const { return painted_; }
    /// The one that was drawn last, and what it and all others were made from.
    PartMesh& last_mesh() { return meshes_[last_]; }
    const planet::TileSource& tiles() const { return mesher_.tiles(); }
    planet::ResidentCounts counts() const { return mesher_.counts(); }

  private:
    void begin_mesh();
    std::optional<PicturePart> next_mesh(GlobeLooks& looks);
    std::vector<std::uint8_t> draw(GlobeLooks& looks, int samples, const PicturePart& part, const PicturePart& kept);

    const RenderOptions& options_;
    const DrawnSurface& surface_;
    const Camera& camera_;
    Steps& steps_;
    unsigned threads_;
    int line_reach_;  ///< pixels, of what layers look at beside a pixel; 0: there are none
    PartMesher mesher_;
    PictureParts parts_;
    PaintedParts painted_;
    Texture patch_texture_;
    Framebuffer target_;
    PartMesh meshes_[2];
    int made_ = 0, last_ = 0;                         ///< of these: the one being made, and the last that was drawn
    std::future<std::optional<PicturePart>> mesh_{};  ///< last: its end waits for work that uses all of the above
};

}  // namespace render
