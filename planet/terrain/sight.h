#pragma once
// Lines of sight over the ground, with the planet's curvature and the refraction of the air.
//
// Refraction. Light bends down with a curvature of k / R, k the refraction coefficient (0.13 in surveying by day, 0 in a
// vacuum) and R the Gaussian mean radius at the eye. In the eye's local frame every point is lifted by k d^2 / 2 R, d its
// horizontal distance: there the bent lines through the eye are straight, to third order in d / R. This is the usual
// effective radius R / (1 - k), but with the ellipsoid's exact curvature beside it: positions are earth-centred.
//
// Ground. In a vertical plane through the eye the ground of a cell is a *piece* between two crossings of its sides:
//
//     z(d) = line between the crossings + c (d - d0) (d1 - d),    c = (1 - k) / 2 R
//
// because it is linear in the heights, not in the chords: c puts back what the planet bulges. A piece hides what is
// beyond it below the steepest line that touches it: an end, or where z / d has its maximum inside (a sea horizon).

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "planet/geodesy/local_frame.h"
#include "planet/terrain/ground.h"
#include "planet/terrain/ground_walk.h"

namespace planet {

/// Cells of the ground are halved until no side is longer: c, which takes the planet for a sphere there, is then good to
/// 2 mm.
inline constexpr double sight_side_m = 5000;
/// From the eye to the target along the ellipsoid: whatever is seen in air, from at most 20 km above ground of 9 km to the
/// same, is nearer.
inline constexpr double sight_distance_max_m = 2e6;
inline constexpr double sight_height_max_m = 20000;  ///< of eye and target above the ground
/// Touching counts as seen: the ground under a target is at the end of its own line. Metres at the target.
inline constexpr double sight_tolerance_m = 1e-4;

struct SightOptions {
    double eye_height = 2;     ///< metres above the ground, 0.01..sight_height_max_m
    double target_height = 0;  ///< metres above the ground, 0..sight_height_max_m
    double refraction = 0.13;  ///< -1..0.5
};

/// The frame of an eye, in which lines of sight are straight.
class SightFrame {
  public:
    /// @param normal unit, of the eye's foot @param h of the eye
    SightFrame(const Ellipsoid& e, const glm::dvec3& normal, EllipsoidalHeight h, double refraction);

    /// x east, y north, z up and lifted; metres. @param ecef metres
    glm::dvec3 lifted(const glm::dvec3& ecef) const;
    glm::dvec3 ecef_from_lifted(glm::dvec3 p) const;
    /// c, 1/m.
    double bulge() const { return bulge_; }
    const LocalFrame& local() const { return local_; }

  private:
    LocalFrame local_;
    double lift_, bulge_;
};

/// A cell of the ground in a SightFrame.
struct SightTriangle {
    std::array<glm::dvec3, 3> p;
    double bound = 0;  ///< metres: of the source samples from it
};
SightTriangle sight_triangle(const SightFrame& frame, const Ellipsoid& e, const GroundCell& cell);

/// What a vertical plane cuts out of a cell. Distances are horizontal, in the frame.
struct SightPiece {
    double d0 = 0, d1 = 0;  ///< 0 < d0 <= d1
    double z0 = 0, z1 = 0;
    double bound = 0;

    double z_at(double d, double bulge) const {
        const double t = d1 > d0 ? (d - d0) / (d1 - d0) : 0;
        return z0 + t * (z1 - z0) + bulge * (d - d0) * (d1 - d);
    }
};
/// @param direction unit, horizontal: the plane is the half of it that the direction points into
std::optional<SightPiece> cut(const SightTriangle& triangle, glm::dvec2 direction, double bulge);

/// The steepest line from the eye to a point.
struct Steepest {
    double slope = -std::numeric_limits<double>::infinity();
    double d = 0;  ///< where it touches
};
/// Of a piece raised by `raised` metres, up to a distance beyond d0.
Steepest steepest(const SightPiece& piece, double end, double bulge, double raised = 0);

enum class Visibility {
    visible,    ///< whatever the ground is within its bound
    hidden,     ///< the same
    undecided,  ///< the ground within its bound could be either
};

struct Sight {
    bool visible = false;  ///< over the ground as it is answered
    Visibility certain = Visibility::undecided;
    double distance = 0;  ///< metres, straight, from the eye to the target
    /// What comes nearest to hiding the target, or hides it most: the ground's height below the line, negative where it
    /// is above; metres. 0 at the target itself if nothing before comes near.
    double clearance = 0;
    /// Where that is, on the ground, and how far from the eye along the ground (horizontally in its frame), metres.
    Geodetic obstruction;
    double obstruction_distance = 0;
    double rise_needed = 0;  ///< metres that a hidden target would have to rise to be seen; else 0
    double bound = 0;        ///< the largest of the ground along the line, metres
    std::size_t cells = 0;   ///< of the ground that the line passes over
};

/// From a place to another. Latitudes and longitudes are read, heights are not.
/// Throws Error(bad_usage) for an option out of range or places more than sight_distance_max_m apart.
Sight line_of_sight(const StoreField& field, const Geodetic& from, const Geodetic& to, const SightOptions& options);

/// Throws Error(bad_usage) for an option out of range.
void check(const SightOptions& options);

}  // namespace planet
