#pragma once
// Segments as pixels: one indirect draw of all strips. Arrays live on the GPU and follow those in memory.

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
    bool relief = false;       ///< heights as colours instead of the imagery; from_afar too, then
    double morph_reach = 0;    ///< K of the split test if vertices morph, which takes segments with morphs(); else 0
};

/// A copy on the GPU of an array that changes in places and may grow.
class FollowingBuffer {
  public:
    /// Sends the elements of `changed`; all of them if they no longer fit, and then the buffer is another one.
    /// @param changed ranges of elements of `stride` bytes @return bytes sent
    std::size_t follow(std::span<const std::byte> contents, std::span<const planet::Range> changed, std::size_t stride);
    /// The same for an array that seldom changes: sends all of it if any of it has changed.
    std::size_t follow(std::span<const std::byte> contents);

    const Buffer& buffer() const { return buffer_; }

  private:
    bool make_room(std::size_t bytes);

    Buffer buffer_;
    std::vector<std::byte> last_;  // of follow(contents)
};

class TerrainPass {
  public:
    /// Makes the mesh that of these segments. If it was of the same Segments before, which have been updated once since,
    /// only what that changed is sent; at rest that is nothing.
    /// @param patch_layers by segment: the layer of its normals in the patch texture, or -1
    void upload(const planet::Segments& segments, std::span<const std::int32_t> patch_layers);

    /// Draws into what is bound. Textures: units 0..3 of the sky, 4 day, 5 night, 6 relief cube, 7 patches.
    void draw(const Camera& camera, const PicturePart& part, const TerrainLook& look);

    const VertexArray& vertex_array() const { return array_; }
    /// On the GPU, room to grow included.
    std::size_t bytes() const;
    /// What the last upload() sent.
    std::size_t sent_bytes() const { return sent_; }

  private:
    Program& program(const TerrainLook& look);
    void make_array(bool morphs);

    std::array<Program, 16> programs_;  // linked when first needed: bit 0 from afar, 1 patched, 2 morphed, 3 relief
    bool patched_ = false;
    VertexArray array_;
    FollowingBuffer vertices_, morphs_, indices_, layers_, commands_;
    const planet::Segments* followed_ = nullptr;
    GLsizei command_count_ = 0;
    std::size_t sent_ = 0;
};

/// Sets the uniforms of grid.glsl and clip_from_ecef.
void set_grid_camera(Program& program, const Camera& camera, const PicturePart& part);

/// Sets every uniform of the terrain shaders.
void set_terrain_uniforms(Program& program, const Camera& camera, const PicturePart& part, const TerrainLook& look);

/// The attributes of terrain.vert.glsl: of a SegmentVertex, and of a patch layer (an int32).
std::array<Attribute, 4> segment_attributes();
Attribute layer_attribute();
/// Of a planet::MorphVertex, for MORPH in grid.glsl.
std::array<Attribute, 2> morph_attributes();

/// The attributes of grid.glsl in a vertex whose first 16 bytes are a GridPosition.
std::array<Attribute, 2> grid_attributes();

}  // namespace render
