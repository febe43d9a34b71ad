#pragma once
// Imported meshes, shaded as the terrain is, over the terrain that they stand for.

#include <algorithm>
#include <functional>
#include <map>
#include <span>

#include "render/gl/texture.h"
#include "render/layers/layer.h"
#include "render/passes/terrain.h"

namespace render {

/// What a mesh and the terrain may be off along the view, a coarse one while the eye moves, too, m: nearer than that it is
/// the mesh that is seen. Not more than a part of the distance (shaders/mesh_lift.glsl).
inline double mesh_lift_m(double exaggeration) {
    return 500 * std::max(exaggeration, 1.0);
}

class LayerMeshPass {
  public:
    /// With the context that is current.
    LayerMeshPass();

    /// Draws the meshes of layers, with depth, after the terrain, into what is bound and has a
    /// stencil. Leaves its alpha. Textures and the uniform block of the sky are bound.
    void draw(std::span<const Layer* const> layers, const Camera& camera, const PicturePart& part,
              const TerrainLook& look);

  private:
    struct OnGpu {
        double exaggeration = 0;
        VertexArray array;
        Buffer vertices, indices;
        GLsizei count = 0;
        Texture picture;
    };
    const OnGpu& on_gpu(const PlacedMesh& mesh, double exaggeration);

    void write_own_depth(const std::function<void()>& triangles);

    Program program_, nothing_;
    VertexArray no_vertices_;
    std::map<const PlacedMesh*, OnGpu> meshes_;
};

}  // namespace render
