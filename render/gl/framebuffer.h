#pragma once
// Drawing goes to a framebuffer object, always: mostly there is no window to draw to.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gl/texture.h"

namespace render {

/// Reversed depth, once after a context is made: near 1, far 0, cleared to 0, nearer is greater, depth in [0, 1] and
/// not in OpenGL's [-1, 1], so that the float's fine steps near 0 lie where the distance grows. Rows stay bottom-up
/// (GL_LOWER_LEFT).
void set_reversed_depth();

/// A colour picture with a 32-bit float depth, and more samples a pixel if wanted.
class Framebuffer {
  public:
    struct Options {
        /// sRGB formats are written linearly unless GL_FRAMEBUFFER_SRGB is enabled.
        GLenum color_format = GL_RGBA8;  ///< GL_RGBA8, GL_SRGB8_ALPHA8, GL_RGBA16F, GL_RGBA32F, ...
        int samples = 1;                 ///< 1..Limits::samples
        bool depth = true;
        bool stencil = false;  ///< eight bits, beside depth
    };

    Framebuffer() = default;
    /// Throws planet::Error: bad_usage for a side outside 1..Limits::target_size or more samples than Limits::samples,
    /// no_graphics if the driver has no memory for it or cannot draw to the format.
    Framebuffer(int width, int height, const Options& options);
    Framebuffer(int width, int height) : Framebuffer(width, height, Options{}) {}

    int width() const noexcept { return width_; }
    int height() const noexcept { return height_; }
    int samples() const noexcept { return samples_; }
    explicit operator bool() const noexcept { return static_cast<bool>(draw_); }

    /// Makes it what is drawn to, and its whole area the viewport.
    void bind() const;
    /// The same without depth, which depth() can then be read from while this is drawn to.
    void bind_color() const;
    /// Clears colour, and depth to 0 (the far end of reversed depth). Does not depend on any state but the scissor and
    /// the write masks.
    void clear(float red, float green, float blue, float alpha) const;
    /// Averages the samples into color() and takes one of them into depth(). Nothing to do for one sample. The
    /// scissor test, if enabled, limits it.
    void resolve() const;
    /// Depth alone.
    void resolve_depth() const;

    /// Draws the picture over a window's framebuffer (0), stretched to its size; resolves before.
    void show_in_window(int width, int height) const;

    /// The picture as a texture, after resolve().
    const Texture& color() const noexcept { return color_; }
    /// The depth as a texture (GL_DEPTH_COMPONENT32F, or with stencil GL_DEPTH32F_STENCIL8), after resolve(); empty
    /// without depth.
    const Texture& depth() const noexcept { return depth_; }

    /// Reads colour as 8-bit RGBA, the top row first, and resolves before. Values of a float picture are clamped to
    /// [0, 1] and rounded. Rows start every `stride_pixels` pixels; what lies between them is left alone.
    void read_rgba8(std::span<std::uint8_t> pixels, std::size_t stride_pixels) const;
    std::vector<std::uint8_t> read_rgba8() const;
    /// Reads colour as four floats a pixel, the top row first.
    std::vector<float> read_rgba_float() const;
    /// Reads depth, the top row first: 1 near, 0 far or nothing drawn.
    std::vector<float> read_depth() const;
    /// Depth of one pixel, at depth_sample() in it. @param x, y from the top left
    float read_depth(int x, int y) const;
    /// Where in a pixel, from its top left, lies the sample that resolving takes depth from: OpenGL leaves that to the
    /// driver, and drivers take the first.
    glm::dvec2 depth_sample() const;

  private:
    void blit_to(GLuint target, GLbitfield what) const;
    template <class Value>
    std::vector<Value> read(GLenum format, std::size_t components) const;

    int width_ = 0, height_ = 0, samples_ = 1;
    Texture color_, depth_;                       // one sample a pixel
    Texture sampled_color_, sampled_depth_;       // several, if samples_ > 1
    Handle<FramebufferKind> draw_, resolved_;     // resolved_ only if samples_ > 1
    mutable Handle<FramebufferKind> color_only_;  // made when it is first bound
};

}  // namespace render
