#pragma once
// The viewer's camera: where the eye is, and what dragging, zooming, tilting and flying make of it. No window, no OpenGL.
//
// A pose has no roll. Its angles are those of the local frame below the eye, so they are what `octaglobe render --height`
// takes: any view is a command line.
//
// Every gesture is one question: which pose shows this point of the ground in that pixel? hold() answers it by moving the
// eye over the planet at its height, turn_to() by turning the head. So what is under the cursor stays there to a millionth
// of a pixel, on the ellipsoid, at poles, from afar and near mountains above the eye.

#include <glm/glm.hpp>
#include <optional>

#include "planet/frames.h"
#include "planet/geodesy/ellipsoid.h"
#include "render/picture/camera.h"

namespace render {

struct Pose {
    glm::dvec3 normal{1, 0, 0};            ///< geodetic normal through the eye, unit
    double h = 2e7;                        ///< m above the ellipsoid
    double heading = 0;                    ///< rad clockwise from north, 0..2 pi
    double pitch = -90 * planet::degrees;  ///< rad, -pi/2 (straight down)..pi/2

    glm::dvec3 eye() const { return planet::ecef_from_normal(planet::wgs84, normal, {h}); }
};

/// A picture's geometry, pixels.
struct Lens {
    double focal = 1000;
    int width = 1280, height = 720;

    Camera camera(const Pose& pose) const;
    /// Of the middle of the picture.
    glm::dvec2 middle() const { return {0.5 * width, 0.5 * height}; }
};

/// The direction that a pixel position (from the top left; its middle is at +0.5) shows, ecef, unit.
glm::dvec3 ray(const Pose& pose, const Lens& lens, const glm::dvec2& pixel);

/// Where a direction or a point shows; nothing if it is not ahead.
std::optional<glm::dvec2> pixel_of_direction(const Pose& pose, const Lens& lens, const glm::dvec3& direction);
std::optional<glm::dvec2> pixel_of_point(const Pose& pose, const Lens& lens, const glm::dvec3& point);

/// What happens to the heading where the eye moves over the planet.
enum class Compass {
    kept,     ///< the same angle from north: north stays up in the picture
    carried,  ///< the same direction, carried along: no pole to spin about
};

/// The eye moved over the ground by metres of arc (east and north at its start), at its height.
Pose moved(const Pose& pose, double east_m, double north_m, Compass compass);

/// The pose of an eye at `eye` looking in a direction; `up` gives the heading where that is straight down or up.
Pose pose_from(const glm::dvec3& eye, const glm::dvec3& ahead, const glm::dvec3& up);

/// The result of a search for a pose.
struct Held {
    Pose pose;   ///< the best that was found
    bool exact;  ///< the point is in the pixel to 0.001 pixels
};

/// Moves the eye at its height so that the point shows in the pixel. Not exact where no such place is in reach: beyond the
/// limb, or for a point level with the eye. If north cannot stay up (about a pole) the heading is carried instead.
Held hold(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, Compass compass);

/// Turns the head so that the direction shows in the pixel.
Held turn_to(const Pose& pose, const Lens& lens, const glm::dvec3& direction, const glm::dvec2& pixel);

/// How far the eye may look up, rad: anywhere near the ground; from afar the planet stays in the middle.
double highest_pitch(double h);

inline constexpr double least_clearance_m = 2;  ///< between the eye and the drawn ground
inline constexpr double highest_eye_m = 1e8;    ///< above the ellipsoid: beyond it, steps of the grid would show

/// Moves the eye towards the point or away, so that their distance is multiplied, and keeps the point in its pixel.
/// @param factor > 0, below 1 nearer
Pose zoomed(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, double factor,
            Compass compass);

/// Moves the eye about the point: turned clockwise seen from above, and tilted up. The point keeps its pixel.
Pose orbited(const Pose& pose, const Lens& lens, const glm::dvec3& point, const glm::dvec2& pixel, double turn,
             double tilt);

/// No lower than that. @param floor_h m above the ellipsoid
Pose lifted(Pose pose, double floor_h);

/// The eye's way after a drag: metres a second over the ground, slowing down.
class Glide {
  public:
    /// Takes down how the eye moved in a time. Times of single events are noisy: the last tenth of a second counts.
    void note(const Pose& from, const Pose& to, double seconds);
    /// Forgets it. To be called where a hand stops the globe.
    void stop() { velocity_ = glm::dvec2(0); }
    /// The pose some time on. @param lens stops where less than a pixel would move in a tenth of a second
    Pose advance(const Pose& pose, const Lens& lens, double clearance_m, double seconds, Compass compass);
    bool moving() const { return velocity_ != glm::dvec2(0); }

  private:
    glm::dvec2 velocity_{0};  ///< m/s east and north below the eye
};

}  // namespace render
