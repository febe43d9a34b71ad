#include "render/gl/texture.h"

#include <algorithm>
#include <bit>
#include <string>

#include "planet/error.h"
#include "render/gl/checks.h"

namespace render {
namespace {

constexpr PixelFormat pixel_formats[] = {
    {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1},
    {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2},
    {GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, 3},
    {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    {GL_SRGB8, GL_RGB, GL_UNSIGNED_BYTE, 3},
    {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    {GL_R8_SNORM, GL_RED, GL_BYTE, 1},
    {GL_RG8_SNORM, GL_RG, GL_BYTE, 2},
    {GL_RGBA8_SNORM, GL_RGBA, GL_BYTE, 4},
    {GL_R16, GL_RED, GL_UNSIGNED_SHORT, 2},
    {GL_RG16, GL_RG, GL_UNSIGNED_SHORT, 4},
    {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 8},
    {GL_R16_SNORM, GL_RED, GL_SHORT, 2},
    {GL_RG16_SNORM, GL_RG, GL_SHORT, 4},
    {GL_RGBA16_SNORM, GL_RGBA, GL_SHORT, 8},
    {GL_R16F, GL_RED, GL_HALF_FLOAT, 2},
    {GL_RG16F, GL_RG, GL_HALF_FLOAT, 4},
    {GL_RGB16F, GL_RGB, GL_HALF_FLOAT, 6},
    {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
    {GL_R32F, GL_RED, GL_FLOAT, 4},
    {GL_RG32F, GL_RG, GL_FLOAT, 8},
    {GL_RGB32F, GL_RGB, GL_FLOAT, 12},
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1},
    {GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2},
    {GL_R16I, GL_RED_INTEGER, GL_SHORT, 2},
    {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
    {GL_DEPTH32F_STENCIL8, GL_DEPTH_STENCIL, GL_FLOAT_32_UNSIGNED_INT_24_8_REV, 8},
};

/// Calls set(parameter, value) for each property: the same for a texture and a sampler.
template <class SetInteger, class SetFloat>
void apply_sampling(const Sampling& s, SetInteger set_integer, SetFloat set_float) {
    set_integer(GL_TEXTURE_MIN_FILTER, s.min_filter);
    set_integer(GL_TEXTURE_MAG_FILTER, s.mag_filter);
    set_integer(GL_TEXTURE_WRAP_S, s.wrap_s);
    set_integer(GL_TEXTURE_WRAP_T, s.wrap_t);
    set_integer(GL_TEXTURE_WRAP_R, s.wrap_r);
    if (s.max_anisotropy > 1) set_float(GL_TEXTURE_MAX_ANISOTROPY, s.max_anisotropy);
}

void require_side(std::string_view what, int side, int limit) {
    if (side >= 1 && side <= limit) return;
    throw planet::Error(planet::Fault::bad_usage, what, std::to_string(side), "1 to " + std::to_string(limit));
}

}  // namespace

PixelFormat pixel_format(GLenum internal_format) {
    const auto* found = std::ranges::find(pixel_formats, internal_format, &PixelFormat::internal_format);
    assert(found != std::end(pixel_formats));
    return found != std::end(pixel_formats) ? *found : PixelFormat{};
}

int mip_levels(int width, int height, int depth) {
    const int longest = std::max({width, height, depth, 1});
    return static_cast<int>(std::bit_width(static_cast<unsigned>(longest)));
}

Texture::Texture(GLenum target, GLenum internal_format, int width, int height, int depth, int levels)
    : target_(target),
      internal_format_(internal_format),
      width_(width),
      height_(height),
      depth_(depth),
      levels_(levels) {
    assert(levels >= 1 && levels <= mip_levels(width, height, target == GL_TEXTURE_3D ? depth : 1));
    GLuint name = 0;
    gl().CreateTextures(target, 1, &name);
    handle_ = Handle<TextureKind>(name);
}

void Texture::require_created() const {
    require_gl("a texture of " + std::to_string(width_) + "x" + std::to_string(height_) + "x" + std::to_string(depth_));
}

Texture Texture::make_2d(GLenum internal_format, int width, int height, int levels) {
    require_side("texture width", width, gl().limits.texture_size);
    require_side("texture height", height, gl().limits.texture_size);
    Texture texture(GL_TEXTURE_2D, internal_format, width, height, 1, levels);
    gl().TextureStorage2D(texture.name(), levels, internal_format, width, height);
    texture.require_created();
    texture.set_sampling({});
    return texture;
}

Texture Texture::make_2d_array(GLenum internal_format, int width, int height, int layers, int levels) {
    require_side("texture width", width, gl().limits.texture_size);
    require_side("texture height", height, gl().limits.texture_size);
    require_side("texture layers", layers, gl().limits.array_layers);
    Texture texture(GL_TEXTURE_2D_ARRAY, internal_format, width, height, layers, levels);
    gl().TextureStorage3D(texture.name(), levels, internal_format, width, height, layers);
    texture.require_created();
    texture.set_sampling({});
    return texture;
}

Texture Texture::make_3d(GLenum internal_format, int width, int height, int depth, int levels) {
    require_side("texture width", width, gl().limits.volume_size);
    require_side("texture height", height, gl().limits.volume_size);
    require_side("texture depth", depth, gl().limits.volume_size);
    Texture texture(GL_TEXTURE_3D, internal_format, width, height, depth, levels);
    gl().TextureStorage3D(texture.name(), levels, internal_format, width, height, depth);
    texture.require_created();
    texture.set_sampling({});
    return texture;
}

Texture Texture::make_cube(GLenum internal_format, int size, int levels) {
    require_side("cube map size", size, gl().limits.cube_size);
    Texture texture(GL_TEXTURE_CUBE_MAP, internal_format, size, size, 6, levels);
    gl().TextureStorage2D(texture.name(), levels, internal_format, size, size);
    texture.require_created();
    texture.set_sampling({});
    return texture;
}

Texture Texture::make_multisample(GLenum internal_format, int width, int height, int samples) {
    require_side("texture width", width, gl().limits.texture_size);
    require_side("texture height", height, gl().limits.texture_size);
    require_side("samples", samples, gl().limits.samples);
    Texture texture(GL_TEXTURE_2D_MULTISAMPLE, internal_format, width, height, 1, 1);
    gl().TextureStorage2DMultisample(texture.name(), samples, internal_format, width, height, GL_TRUE);
    texture.require_created();
    return texture;
}

std::size_t Texture::level_bytes(int level) const noexcept {
    return static_cast<std::size_t>(width(level)) * static_cast<std::size_t>(height(level)) *
           static_cast<std::size_t>(depth(level)) * static_cast<std::size_t>(pixel_format(internal_format_).bytes);
}

void Texture::upload(int level, std::span<const std::byte> texels) {
    upload_box(level, 0, 0, 0, width(level), height(level), depth(level), texels);
}

void Texture::upload_layer(int level, int layer, std::span<const std::byte> texels) {
    upload_box(level, 0, 0, layer, width(level), height(level), 1, texels);
}

void Texture::upload_box(int level, int x, int y, int z, int width, int height, int depth,
                         std::span<const std::byte> texels) {
    const PixelFormat pixels = pixel_format(internal_format_);
    assert(level >= 0 && level < levels_);
    assert(x >= 0 && y >= 0 && z >= 0 && width >= 0 && height >= 0 && depth >= 0);
    assert(x + width <= this->width(level) && y + height <= this->height(level) && z + depth <= this->depth(level));
    assert(texels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                static_cast<std::size_t>(depth) * static_cast<std::size_t>(pixels.bytes));
    if (texels.empty()) return;
    if (target_ == GL_TEXTURE_2D)
        gl().TextureSubImage2D(name(), level, x, y, width, height, pixels.format, pixels.type, texels.data());
    else
        gl().TextureSubImage3D(name(), level, x, y, z, width, height, depth, pixels.format, pixels.type, texels.data());
    check_gl("Texture::upload");
}

void Texture::generate_mipmaps() {
    gl().GenerateTextureMipmap(name());
    check_gl("Texture::generate_mipmaps");
}

void Texture::set_sampling(const Sampling& sampling) {
    Sampling s = sampling;
    // One level only: the same picture as with a mip filter, and the shortcuts of software renderers apply.
    if (levels_ == 1 && s.min_filter != GL_NEAREST && s.min_filter != GL_LINEAR)
        s.min_filter = s.min_filter == GL_NEAREST_MIPMAP_NEAREST || s.min_filter == GL_NEAREST_MIPMAP_LINEAR
                           ? GL_NEAREST
                           : GL_LINEAR;
    apply_sampling(
        s, [&](GLenum key, GLenum value) { gl().TextureParameteri(name(), key, static_cast<GLint>(value)); },
        [&](GLenum key, GLfloat value) { gl().TextureParameterf(name(), key, value); });
    check_gl("Texture::set_sampling");
}

std::vector<std::byte> Texture::download(int level) const {
    const PixelFormat pixels = pixel_format(internal_format_);
    std::vector<std::byte> texels(level_bytes(level));
    gl().GetTextureImage(name(), level, pixels.format, pixels.type, static_cast<GLsizei>(texels.size()), texels.data());
    check_gl("Texture::download");
    return texels;
}

Sampler::Sampler(const Sampling& sampling) {
    GLuint name = 0;
    gl().CreateSamplers(1, &name);
    handle_ = Handle<SamplerKind>(name);
    apply_sampling(
        sampling, [&](GLenum key, GLenum value) { gl().SamplerParameteri(name, key, static_cast<GLint>(value)); },
        [&](GLenum key, GLfloat value) { gl().SamplerParameterf(name, key, value); });
    check_gl("Sampler");
}

}  // namespace render
