#pragma once
// Textures of immutable storage with given mip chains, and samplers.

#include <cstddef>
#include <span>
#include <vector>

#include "render/gl/handle.h"

namespace render {

/// How texels of an internal format lie in memory.
struct PixelFormat {
    GLenum internal_format = 0;  ///< GL_RGBA8, ...
    GLenum format = 0;           ///< GL_RGBA, ...
    GLenum type = 0;             ///< GL_UNSIGNED_BYTE, ...
    int bytes = 0;               ///< of a texel
};

/// The layout of an internal format: 8 and 16-bit UNORM and SNORM, sRGB8 with or without alpha, 16 and 32-bit float and
/// 8, 16 and 32-bit integers, GL_DEPTH_COMPONENT32F and GL_DEPTH32F_STENCIL8. Asking for another one is misuse.
PixelFormat pixel_format(GLenum internal_format);

/// Levels of a full mip chain down to 1 x 1 (x 1).
int mip_levels(int width, int height, int depth = 1);

/// Filters and wrap modes, of a Sampler or of a texture's own.
struct Sampling {
    GLenum min_filter = GL_LINEAR_MIPMAP_LINEAR;
    GLenum mag_filter = GL_LINEAR;
    GLenum wrap_s = GL_CLAMP_TO_EDGE, wrap_t = GL_CLAMP_TO_EDGE, wrap_r = GL_CLAMP_TO_EDGE;
    float max_anisotropy = 1;  ///< above 1 only where GL_EXT_texture_filter_anisotropic or OpenGL 4.6 has it
};

/// A texture. Texels come as tightly packed rows of pixel_format(internal_format). Rows are as OpenGL has them: row 0
/// is at t = 0. The layers of a level lie one behind the other: z of a 3-D texture, the layers of an array, and a cube
/// map's faces in the order +x -x +y -y +z -z, each with OpenGL's cube map orientation.
///
/// Creation throws planet::Error: bad_usage for a side of 0 or above the context's limits, no_graphics if the driver
/// has no memory. A new texture's contents are undefined. Its sampling is Sampling{} (without mip filter for one
/// level).
class Texture {
  public:
    Texture() = default;
    static Texture make_2d(GLenum internal_format, int width, int height, int levels = 1);
    static Texture make_2d_array(GLenum internal_format, int width, int height, int layers, int levels = 1);
    static Texture make_3d(GLenum internal_format, int width, int height, int depth, int levels = 1);
    static Texture make_cube(GLenum internal_format, int size, int levels = 1);
    /// For drawing to only. `samples` is 1..Limits::samples.
    static Texture make_multisample(GLenum internal_format, int width, int height, int samples);

    GLuint name() const noexcept { return handle_.name(); }
    explicit operator bool() const noexcept { return static_cast<bool>(handle_); }
    GLenum target() const noexcept { return target_; }
    GLenum internal_format() const noexcept { return internal_format_; }
    int width(int level = 0) const noexcept { return side(width_, level); }
    int height(int level = 0) const noexcept { return side(height_, level); }
    /// Of a 3-D texture the depth of that level, of an array the layers, of a cube map 6, else 1.
    int depth(int level = 0) const noexcept { return target_ == GL_TEXTURE_3D ? side(depth_, level) : depth_; }
    int levels() const noexcept { return levels_; }
    /// Bytes of a whole level, all its layers.
    std::size_t level_bytes(int level) const noexcept;

    /// Replaces a whole level; `texels` holds exactly level_bytes(level).
    void upload(int level, std::span<const std::byte> texels);
    /// Replaces one layer of a level (a face, a layer, a slice), or `layer` 0 of a 2-D texture.
    void upload_layer(int level, int layer, std::span<const std::byte> texels);
    /// Replaces the box at (x, y, z) of a level.
    void upload_box(int level, int x, int y, int z, int width, int height, int depth,
                    std::span<const std::byte> texels);
    /// Fills levels 1.. from level 0 by the driver's own filter, which differs between drivers: where pictures are to
    /// be the same everywhere, upload a chain.
    void generate_mipmaps();
    void set_sampling(const Sampling& sampling);
    /// Copies a level back. Waits for the GPU.
    std::vector<std::byte> download(int level) const;
    void bind(GLuint unit) const { gl().BindTextureUnit(unit, name()); }

  private:
    Texture(GLenum target, GLenum internal_format, int width, int height, int depth, int levels);
    static int side(int base, int level) noexcept { return base >> level > 0 ? base >> level : (base > 0 ? 1 : 0); }
    void require_created() const;

    Handle<TextureKind> handle_;
    GLenum target_ = 0, internal_format_ = 0;
    int width_ = 0, height_ = 0, depth_ = 0, levels_ = 0;
};

/// Sampling apart from a texture: bound to a unit, it overrides the texture's own.
class Sampler {
  public:
    Sampler() = default;
    explicit Sampler(const Sampling& sampling);

    GLuint name() const noexcept { return handle_.name(); }
    explicit operator bool() const noexcept { return static_cast<bool>(handle_); }
    void bind(GLuint unit) const { gl().BindSampler(unit, name()); }

  private:
    Handle<SamplerKind> handle_;
};

}  // namespace render
