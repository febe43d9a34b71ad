#pragma once
// Hands on the globe: what the mouse and the keys do to the pose. No window, no OpenGL.

#include <functional>
#include <optional>

#include "render/gl/window.h"
#include "render/viewer/camera.h"
#include "render/viewer/flight.h"

namespace render {

/// What is asked of the globe.
struct Ground {
    /// The point of the drawn ground that a ray meets first, ecef; nothing: the sky. @param direction unit
    std::function<std::optional<glm::dvec3>(const glm::dvec3& origin, const glm::dvec3& direction)> pick;
    /// Height of the drawn ground at a geodetic normal, m above the ellipsoid.
    std::function<double(const glm::dvec3& normal)> height;
};

/// Keys that are held down, each -1..1.
struct Steering {
    double right = 0, forward = 0;  ///< over the ground
    double nearer = 0;
    double turn = 0, tilt = 0;  ///< clockwise, up
    bool any() const { return right != 0 || forward != 0 || nearer != 0 || turn != 0 || tilt != 0; }
};

class Navigator {
  public:
    Navigator(Ground ground, const Pose& pose) : ground_(std::move(ground)), pose_(pose) {}

    const Pose& pose() const { return pose_; }
    /// At once, without a flight.
    void set_pose(const Pose& pose);

    /// A button, a motion or the wheel. Keys are left alone.
    void handle(const InputEvent& event, const Lens& lens);
    /// Lets time pass: glides, zooms, flies, steers. @param since_last call, seconds
    void advance(double since_last, const Lens& lens, const Steering& steering);
    /// Whether the next advance() changes anything without a hand.
    bool moves() const { return flight_ || zoom_left_ != 0 || glide_.moving(); }
    bool flies() const { return flight_.has_value(); }

    void fly_to(const Sight& sight, const Lens& lens);
    /// To a place, keeping the heading and, from near, the pitch. @param range m
    void fly_to(const glm::dvec3& normal, double range, const Lens& lens);
    void fly_home(const Lens& lens);
    void north_up(const Lens& lens);
    void look_down(const Lens& lens);
    /// By a factor of the distance to what is in the middle of the picture.
    void zoom(double factor, const Lens& lens);

    /// What the view is about: the ground in the middle of the picture, else that below the eye.
    Sight sight(const Lens& lens) const;
    /// The eye over the ground below it, m.
    double clearance() const { return pose_.h - ground_.height(pose_.normal); }

  private:
    enum class Drag { none, ground, sky, orbit };
    struct Anchor {
        glm::dvec3 point{0};
        glm::dvec2 pixel{0};
    };
    void note_throw(double seconds);
    void begin_drag(const InputEvent& event, const Lens& lens);
    void drag_to(const InputEvent& event, const Lens& lens);
    void begin_zoom(double notches, const glm::dvec2& pixel, const Lens& lens);
    void steer(double seconds, const Lens& lens, const Steering& steering);
    std::optional<Anchor> anchor_at(const glm::dvec2& pixel, const Lens& lens) const;
    Anchor middle(const Lens& lens) const;
    void stop();
    void keep_above_ground();

    Ground ground_;
    Pose pose_;
    Drag drag_ = Drag::none;
    Anchor anchor_;      ///< of a drag
    glm::dvec3 sky_{0};  ///< the direction that is dragged
    glm::dvec2 last_pixel_{0};
    double last_seconds_ = 0;
    double pressed_seconds_ = -1;
    glm::dvec2 pressed_pixel_{0};
    Glide glide_;
    Pose noted_;           ///< of the last advance() of a drag
    bool thrown_ = false;  ///< the button went up while the hand moved
    Anchor zoom_anchor_;
    double zoom_left_ = 0;  ///< natural logarithm of the factor that is still to come
    std::optional<Flight> flight_;
    double flown_ = 0;
};

}  // namespace render
