#include "render/gl/framebuffer.h"

#include <algorithm>
#include <string>

#include "planet/error.h"
#include "render/gl/checks.h"

namespace render {
namespace {

Handle<FramebufferKind> make_framebuffer(const Texture& color, const Texture& depth) {
    GLuint name = 0;
    gl().CreateFramebuffers(1, &name);
    Handle<FramebufferKind> framebuffer(name);
    gl().NamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, color.name(), 0);
    const bool stencil = depth.internal_format() == GL_DEPTH32F_STENCIL8;
    if (depth)
        gl().NamedFramebufferTexture(name, stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, depth.name(),
                                     0);
    const GLenum status = gl().CheckNamedFramebufferStatus(name, GL_FRAMEBUFFER);
    require_gl("a framebuffer");
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw planet::Error(planet::Fault::no_graphics, "a framebuffer",
                            "the driver cannot draw to it (status " + std::to_string(status) + ")");
    return framebuffer;
}

/// Turns rows bottom-up into rows top-down, in place.
template <class Value>
void flip_rows(std::span<Value> values, std::size_t row, std::size_t stride, std::size_t rows) {
    for (std::size_t y = 0; y < rows / 2; ++y) {
        Value* const low = values.data() + y * stride;
        std::swap_ranges(low, low + row, values.data() + (rows - 1 - y) * stride);
    }
}

}  // namespace

void set_reversed_depth() {
    gl().ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_GREATER);
    gl().DepthMask(GL_TRUE);
    gl().ClearDepth(0);
    check_gl("set_reversed_depth");
}

Framebuffer::Framebuffer(int width, int height, const Options& options)
    : width_(width), height_(height), samples_(options.samples) {
    const int limit = gl().limits.target_size;
    if (width < 1 || height < 1 || width > limit || height > limit)
        throw planet::Error(planet::Fault::bad_usage, "framebuffer size",
                            std::to_string(width) + "x" + std::to_string(height),
                            "1x1 to " + std::to_string(limit) + "x" + std::to_string(limit));
    color_ = Texture::make_2d(options.color_format, width, height);
    const GLenum depth_format = options.stencil ? GL_DEPTH32F_STENCIL8 : GL_DEPTH_COMPONENT32F;
    if (options.depth) depth_ = Texture::make_2d(depth_format, width, height);
    if (samples_ == 1) {
        draw_ = make_framebuffer(color_, depth_);
        return;
    }
    sampled_color_ = Texture::make_multisample(options.color_format, width, height, samples_);
    if (options.depth) sampled_depth_ = Texture::make_multisample(depth_format, width, height, samples_);
    draw_ = make_framebuffer(sampled_color_, sampled_depth_);
    resolved_ = make_framebuffer(color_, depth_);
}

void Framebuffer::bind() const {
    gl().BindFramebuffer(GL_FRAMEBUFFER, draw_.name());
    gl().Viewport(0, 0, width_, height_);
}

void Framebuffer::bind_color() const {
    if (!color_only_) color_only_ = make_framebuffer(samples_ > 1 ? sampled_color_ : color_, {});
    gl().BindFramebuffer(GL_FRAMEBUFFER, color_only_.name());
    gl().Viewport(0, 0, width_, height_);
}

void Framebuffer::clear(float red, float green, float blue, float alpha) const {
    const GLfloat color[] = {red, green, blue, alpha};
    constexpr GLfloat far_depth = 0;
    gl().ClearNamedFramebufferfv(draw_.name(), GL_COLOR, 0, color);
    if (depth_) gl().ClearNamedFramebufferfv(draw_.name(), GL_DEPTH, 0, &far_depth);
    check_gl("Framebuffer::clear");
}

void Framebuffer::blit_to(GLuint target, GLbitfield what) const {
    gl().BlitNamedFramebuffer(draw_.name(), target, 0, 0, width_, height_, 0, 0, width_, height_, what, GL_NEAREST);
}

void Framebuffer::resolve() const {
    if (samples_ == 1) return;
    blit_to(resolved_.name(), GL_COLOR_BUFFER_BIT);
    resolve_depth();
    check_gl("Framebuffer::resolve");
}

void Framebuffer::resolve_depth() const {
    if (samples_ > 1 && depth_) blit_to(resolved_.name(), GL_DEPTH_BUFFER_BIT);
}

void Framebuffer::show_in_window(int width, int height) const {
    resolve();
    gl().BlitNamedFramebuffer(resolved_ ? resolved_.name() : draw_.name(), 0, 0, 0, width_, height_, 0, 0, width,
                              height, GL_COLOR_BUFFER_BIT,
                              width == width_ && height == height_ ? GL_NEAREST : GL_LINEAR);
    check_gl("Framebuffer::show_in_window");
}

void Framebuffer::read_rgba8(std::span<std::uint8_t> pixels, std::size_t stride_pixels) const {
    const auto columns = static_cast<std::size_t>(width_), rows = static_cast<std::size_t>(height_);
    assert(stride_pixels >= columns && pixels.size() >= 4 * ((rows - 1) * stride_pixels + columns));
    resolve();
    GLuint source = resolved_ ? resolved_.name() : draw_.name();
    // Converting while reading is slow for float pictures (15 ms at 1080p on llvmpipe); a blit first takes
    // 11. A pass that maps tones into an 8-bit picture of its own costs less than either, and is read in 0.4.
    Texture bytes;
    Handle<FramebufferKind> converted;
    if (color_.internal_format() != GL_RGBA8 && color_.internal_format() != GL_SRGB8_ALPHA8) {
        bytes = Texture::make_2d(GL_RGBA8, width_, height_);
        converted = make_framebuffer(bytes, {});
        gl().BlitNamedFramebuffer(source, converted.name(), 0, 0, width_, height_, 0, 0, width_, height_,
                                  GL_COLOR_BUFFER_BIT, GL_NEAREST);
        source = converted.name();
    }
    gl().BindFramebuffer(GL_READ_FRAMEBUFFER, source);
    gl().PixelStorei(GL_PACK_ROW_LENGTH, static_cast<GLint>(stride_pixels));
    gl().ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    gl().PixelStorei(GL_PACK_ROW_LENGTH, 0);
    require_gl("Framebuffer::read_rgba8");
    flip_rows(pixels, 4 * columns, 4 * stride_pixels, rows);
}

std::vector<std::uint8_t> Framebuffer::read_rgba8() const {
    std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    read_rgba8(pixels, static_cast<std::size_t>(width_));
    return pixels;
}

template <class Value>
std::vector<Value> Framebuffer::read(GLenum format, std::size_t components) const {
    const auto columns = components * static_cast<std::size_t>(width_), rows = static_cast<std::size_t>(height_);
    std::vector<Value> values(columns * rows);
    resolve();
    gl().BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_ ? resolved_.name() : draw_.name());
    gl().ReadPixels(0, 0, width_, height_, format, GL_FLOAT, values.data());
    require_gl("Framebuffer::read");
    flip_rows(std::span(values), columns, columns, rows);
    return values;
}

std::vector<float> Framebuffer::read_rgba_float() const {
    return read<float>(GL_RGBA, 4);
}

float Framebuffer::read_depth(int x, int y) const {
    assert(depth_ && x >= 0 && y >= 0 && x < width_ && y < height_);
    const int row = height_ - 1 - y;
    if (resolved_)
        gl().BlitNamedFramebuffer(draw_.name(), resolved_.name(), x, row, x + 1, row + 1, x, row, x + 1, row + 1,
                                  GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    gl().BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_ ? resolved_.name() : draw_.name());
    float depth = 0;
    gl().ReadPixels(x, row, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    require_gl("Framebuffer::read_depth");
    return depth;
}

glm::dvec2 Framebuffer::depth_sample() const {
    if (samples_ == 1) return glm::dvec2(0.5);
    GLfloat place[2] = {0.5f, 0.5f};
    gl().BindFramebuffer(GL_FRAMEBUFFER, draw_.name());
    gl().GetMultisamplefv(GL_SAMPLE_POSITION, 0, place);
    return {static_cast<double>(place[0]), 1 - static_cast<double>(place[1])};
}

std::vector<float> Framebuffer::read_depth() const {
    assert(depth_);
    return read<float>(GL_DEPTH_COMPONENT, 1);
}

}  // namespace render
