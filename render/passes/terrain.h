#pragma once
// Segments as pixels: one indirect draw of all strips.

#include <array>
#include <span>

#include "planet/mesh/segments.h"
#include "render/gl/buffer.h"
#include "render/gl/shader.h"
#include "render/picture/camera.h"

namespace render {

/// What the shading needs beside the uniform block of the sky.
struct TerrainLook {
    double exaggeration = 1;
    double polar_stretch = 1;  ///< (a/b)^2 of the ellipsoid
    float patch_range = 1;     ///< what 1 in a patch texel stands for
    bool from_afar = false;    ///< see needs_close_up()
};

class TerrainPass {
  public:
    /// Replaces the mesh. @param patch_layers by segment: the layer of its normals in the patch texture, or -1
    void upload(const planet::Segments& segments, std::span<const std::int32_t> patch_layers);

    /// Draws into what is bound. Textures: units 0..3 of the sky, 4 day, 5 night, 6 relief cube, 7 patches.
    void draw(const Camera& camera, const PicturePart& part, const TerrainLook& look);

    const VertexArray& vertex_array() const { return array_; }
    std::size_t bytes() const { return vertices_.size() + indices_.size() + layers_.size() + commands_.size(); }

  private:
    Program& program(bool from_afar);

    std::array<Program, 4> programs_;  // linked when first needed: bit 0 from afar, bit 1 patched
    bool patched_ = false;
    VertexArray array_;
    Buffer vertices_, indices_, layers_, commands_;
    GLsizei command_count_ = 0;
};

/// Sets the uniforms of grid.glsl and clip_from_ecef.
void set_grid_camera(Program& program, const Camera& camera, const PicturePart& part);

/// Sets every uniform of the terrain shaders.
void set_terrain_uniforms(Program& program, const Camera& camera, const PicturePart& part, const TerrainLook& look);

/// The attributes of terrain.vert.glsl: of a SegmentVertex, and of a patch layer (an int32).
std::array<Attribute, 4> segment_attributes();
Attribute layer_attribute();

/// The attributes of grid.glsl in a vertex whose first 16 bytes are a GridPosition.
std::array<Attribute, 2> grid_attributes();

}  // namespace render
