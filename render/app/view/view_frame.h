#pragma once
// The pictures in the viewer's window: quick ones while it moves, and the settled one, which has the pixels of
// `octaglobe render`.

#include <cstdint>
#include <optional>
#include <vector>

#include "render/app/picture/globe_looks.h"
#include "render/gl/framebuffer.h"

namespace render {

class ViewFrame {
  public:
    /// Draws a frame at once, at a part of the camera's size and with one sample a pixel. @return seconds it took
    double draw_moving(GlobeLooks& looks, const GlobeLooks::Frame& frame, double scale);

    /// Begins the settled picture anew.
    void begin_settled(int samples);
    /// Draws more of it, for about so long: a processor may take seconds for all of it, and a hand may want to go on.
    /// @return whether it is whole
    bool draw_settled(GlobeLooks& looks, const GlobeLooks::Frame& frame, double seconds);
    bool settled() const { return settled_; }

    /// The last whole picture over the window's framebuffer.
    void show(int width, int height) const;
    /// The same as RGB, top row first.
    std::vector<std::uint8_t> rgb() const;
    /// What the picture that is shown has in a pixel, by its depth: within a pixel of it, to depth_resolution(). Nothing:
    /// the sky, or outside. @param pixel from the top left, of the size that draw_...() were given
    std::optional<glm::dvec3> point_at(const glm::dvec2& pixel) const;
    /// Of the picture that is shown, in pixels of the view: 1 or more.
    double pixel_size() const { return still_shown_ ? 1 : 1 / moving_scale_; }
    int width() const { return shown().width(); }
    int height() const { return shown().height(); }

  private:
    const Framebuffer& shown() const { return still_shown_ ? still_ : moving_; }

    Framebuffer moving_, still_, next_;  ///< next_: the settled picture while it is not whole
    Camera moving_camera_, still_camera_;
    double moving_scale_ = 1;  ///< of moving_camera_'s pixels to those of the view
    int samples_ = 1;
    int rows_done_ = 0;
    int rows_at_once_ = 0;  ///< as measured; 0: not yet
    bool settled_ = false, still_shown_ = false;
};

}  // namespace render
