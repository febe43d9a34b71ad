#pragma once
// A flight through any number of views, for film: it passes each of them, and neither place, distance nor direction ever
// jumps or changes its speed at once. No window, no OpenGL.
//
// From view to view it takes the way of zoom_pan.h: straight across where the next place is near, out and in again where
// it is many ranges away. At the views themselves these ways would meet in corners; in the 1.5 s (of a quiet pace) on
// either side they bend towards a common velocity, by no more than a sixth of the range. Angles go from view to view
// without overshoot (monotone_cubic.h). So the way is a function of a parameter, the seconds it takes at a quiet pace;
// another monotone curve says when the flight is where, which begins and ends at rest.

#include <chrono>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "planet/geodesy/utc_time.h"
#include "render/viewer/flight.h"
#include "render/viewer/monotone_cubic.h"

namespace render {

/// What a Sight's range and angles are of.
enum class About {
    place,  ///< it is looked at from the range
    eye,    ///< the eye is that far straight above it
};

/// The camera's place, ecef.
glm::dvec3 eye_of(const Sight& sight, About about);

/// A view on a flight.
struct FlightView {
    Sight sight;
    double exaggeration = 1;
    planet::UtcTime time{};  ///< of sun and stars
};

struct FlightKey {
    FlightView view;
    std::optional<double> seconds{};  ///< when it is reached, above those before; without: as the pace asks
    double pace = 1;                  ///< of the way to it, without `seconds`; 2: twice as fast as a quiet one
};

class FlightPath {
  public:
    /// @param keys at least two; longitudes, headings and the order of times are taken as they are
    FlightPath(std::vector<FlightKey> keys, About about);

    About about() const { return about_; }
    /// Seconds from the first key to the last.
    double duration() const { return times_.back(); }
    /// When each key is reached.
    const std::vector<double>& times() const { return times_; }
    /// @param seconds 0 to duration(). At a key's time: just its view.
    FlightView at(double seconds) const;

  private:
    /// Per second of a quiet pace.
    struct Velocity {
        glm::dvec3 place{0};   ///< ecef, in ranges
        double log_range = 0;  ///< of its natural logarithm
    };
    struct Leg {
        GreatCircle ground;
        ZoomPan way;
        double begin = 0, length = 0;         ///< in seconds of a quiet pace
        bool polar = false;                   ///< its heading is carried along, lest the view spin about a pole
        double carried = 0;                   ///< by how much it turns from its beginning to its end
        double carried_before = 0;            ///< by those before
        Velocity at_begin, at_end;            ///< of its own way
        Velocity wanted_begin, wanted_end{};  ///< agreed with its neighbours
    };

    Leg make_leg(std::size_t i) const;
    Velocity velocity(const Leg& leg, std::size_t i, double s) const;
    void set_times();
    void agree_velocities();
    void set_curves();
    Sight sight_on(std::size_t i, double s) const;

    std::vector<FlightKey> keys_;
    About about_;
    std::vector<Leg> legs_;
    std::vector<double> times_;
    MonotoneCubic way_of_time_;
    MonotoneCubic heading_, pitch_, exaggeration_, sun_;  ///< by the way; the sun in seconds since the first key
};

}  // namespace render
