#include "planet/terrain/sight.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "planet/error.h"
#include "planet/geodesy/geodesic.h"
#include "planet/geodesy/geodetic.h"

namespace planet {

namespace {

// Every height there is lies within this of the ellipsoid.
constexpr double relief_m = 12000;

// Cells that the vertical plane of a line passes through, cut.
class LineVisitor {
  public:
    LineVisitor(const SightFrame& frame, const Ellipsoid& e, glm::dvec2 direction, double end)
        : frame_(frame), e_(e), direction_(direction), end_(end) {}

    bool enter(const Corners& corners) const {
        const CellReach reach(corners);
        const glm::dvec3 p = frame_.local().enu_from_ecef(ecef_from_normal(e_, reach.centre));
        // Feet of the cell are within a * chord of that of its centre, and what stands on them leans by as much.
        const double r = 1.01 * (e_.a + relief_m) * reach.chord + 50;
        const double along = p.x * direction_.x + p.y * direction_.y, across = p.x * direction_.y - p.y * direction_.x;
        return std::abs(across) <= r && along >= -r && along <= end_ + r &&
               p.z > -e_.a;  // not on the far side of the planet
    }
    void leave() const {}
    bool halve(const GroundCell& cell) const { return longest_chord(cell.normal) * e_.a > sight_side_m; }
    void visit(const GroundCell& cell) {
        const auto piece = cut(sight_triangle(frame_, e_, cell), direction_, frame_.bulge());
        if (piece && piece->d0 < end_) pieces.push_back(*piece);
    }

    std::vector<SightPiece> pieces;

  private:
    static double longest_chord(const Corners& c) {
        return std::max({glm::length(c.left - c.right), glm::length(c.right - c.apex), glm::length(c.apex - c.left)});
    }

    const SightFrame& frame_;
    const Ellipsoid& e_;
    glm::dvec2 direction_;
    double end_;
};

struct Target {
    double d, z;  ///< in the frame, at its height
    double bound;
};

// The largest slope of the ground on the way to a target, ends of pieces behind it left out.
// @param sign of the pieces' bounds, and of the ground's under the eye
Steepest steepest_before(std::span<const SightPiece> pieces, double d, double bulge, double sign, double eye_bound) {
    Steepest worst;
    for (const SightPiece& piece : pieces) {
        if (piece.d0 >= d) continue;
        const double raised = sign == 0 ? 0 : sign * (piece.bound + eye_bound);
        const Steepest s = steepest(piece, d, bulge, raised);
        if (s.slope > worst.slope) worst = s;
    }
    return worst;
}

Visibility certainty(std::span<const SightPiece> pieces, const Target& target, double bulge, double eye_bound) {
    const auto slope = [&](double sign) {
        return (target.z + sign * (eye_bound - target.bound) + sight_tolerance_m) / target.d;
    };
    if (steepest_before(pieces, target.d, bulge, 1, eye_bound).slope <= slope(1)) return Visibility::visible;
    if (steepest_before(pieces, target.d, bulge, -1, eye_bound).slope > slope(-1)) return Visibility::hidden;
    return Visibility::undecided;
}

}  // namespace

SightFrame::SightFrame(const Ellipsoid& e, const glm::dvec3& normal, EllipsoidalHeight h, double refraction)
    : local_(e, normal, h) {
    const double R = curvature_radii(e, normal).mean();
    lift_ = refraction / (2 * R);
    bulge_ = (1 - refraction) / (2 * R);
}

glm::dvec3 SightFrame::lifted(const glm::dvec3& ecef) const {
    glm::dvec3 p = local_.enu_from_ecef(ecef);
    p.z += lift_ * (p.x * p.x + p.y * p.y);
    return p;
}

glm::dvec3 SightFrame::ecef_from_lifted(glm::dvec3 p) const {
    p.z -= lift_ * (p.x * p.x + p.y * p.y);
    return local_.ecef_from_enu(p);
}

SightTriangle sight_triangle(const SightFrame& frame, const Ellipsoid& e, const GroundCell& cell) {
    SightTriangle t;
    const glm::dvec3* normal[3] = {&cell.normal.left, &cell.normal.right, &cell.normal.apex};
    for (std::size_t k = 0; k < 3; ++k)
        t.p[k] = frame.lifted(ecef_from_normal(e, *normal[k], {cell.h[static_cast<int>(k)]}));
    if (cell.resampling > 0) {
        // The bound is that of the plane; the sag in a triangle is at most 4/3 of that in the middle of a side.
        double side2 = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 s = t.p[k] - t.p[(k + 1) % 3];
            side2 = std::max(side2, glm::dot(s, s));
        }
        t.bound = cell.resampling + side2 / (6 * e.b);
    }
    return t;
}

std::optional<SightPiece> cut(const SightTriangle& t, glm::dvec2 u, double bulge) {
    double across[3], along[3];
    for (std::size_t k = 0; k < 3; ++k) {
        across[k] = t.p[k].x * u.y - t.p[k].y * u.x;
        along[k] = t.p[k].x * u.x + t.p[k].y * u.y;
    }
    const bool left[3] = {across[0] >= 0, across[1] >= 0, across[2] >= 0};
    if (left[0] == left[1] && left[1] == left[2]) return {};
    double d[2], z[2];
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t j = (k + 1) % 3;
        if (left[k] == left[j]) continue;
        const double s = across[k] / (across[k] - across[j]);
        const double x = t.p[j].x - t.p[k].x, y = t.p[j].y - t.p[k].y;
        d[n] = along[k] + s * (along[j] - along[k]);
        z[n++] = t.p[k].z + s * (t.p[j].z - t.p[k].z) + bulge * s * (1 - s) * (x * x + y * y);
    }
    SightPiece piece{d[0], d[1], z[0], z[1], t.bound};
    if (d[0] > d[1]) piece = {d[1], d[0], z[1], z[0], t.bound};
    if (piece.d1 <= 0) return {};
    constexpr double nearest = 1e-3;
    if (piece.d0 < nearest) {  // the eye stands on it
        const double at = std::min(nearest, piece.d1);
        piece = {at, piece.d1, piece.z_at(at, bulge), piece.z1, t.bound};
    }
    return piece;
}

Steepest steepest(const SightPiece& piece, double end, double bulge, double raised) {
    const double d1 = std::min(piece.d1, end);
    Steepest s{(piece.z0 + raised) / piece.d0, piece.d0};
    const auto take = [&](double d) {
        const double slope = (piece.z_at(d, bulge) + raised) / d;
        if (slope > s.slope) s = {slope, d};
    };
    if (d1 > piece.d0) take(d1);
    // z = A + B d - c d^2 has its steepest line at d^2 = -A / c.
    const double length = piece.d1 - piece.d0;
    const double rise = length > 0 ? (piece.z1 - piece.z0) / length : 0;
    const double A = piece.z0 + raised - rise * piece.d0 - bulge * piece.d0 * piece.d1;
    const double d2 = -A / bulge;
    if (d2 > piece.d0 * piece.d0 && d2 < d1 * d1) take(std::sqrt(d2));
    return s;
}

void check(const SightOptions& o) {
    const auto need = [](bool good, const char* where, double value, const char* accepted) {
        if (!good) throw Error(Fault::bad_usage, where, std::to_string(value) + " is out of range", accepted);
    };
    need(o.eye_height >= 0.01 && o.eye_height <= sight_height_max_m, "eye height", o.eye_height, "0.01 to 20000 m");
    need(o.target_height >= 0 && o.target_height <= sight_height_max_m, "target height", o.target_height,
         "0 to 20000 m");
    need(o.refraction >= -1 && o.refraction <= 0.5, "refraction", o.refraction, "-1 to 0.5");
}

Sight line_of_sight(const StoreField& field, const Geodetic& from, const Geodetic& to, const SightOptions& o) {
    check(o);
    const Ellipsoid& e = field.store().metadata().ellipsoid;
    if (const double apart = Geodesics(e).distance(from, to); !(apart <= sight_distance_max_m))
        throw Error(Fault::bad_usage, "line of sight", std::to_string(std::llround(apart / 1000)) + " km is too long",
                    "at most 2000 km: nothing is seen from farther away through air");
    const glm::dvec3 n_eye = normal_from_geodetic(from.latitude, from.longitude);
    const glm::dvec3 n_target = normal_from_geodetic(to.latitude, to.longitude);
    SurfaceCursor cursor = field.cursor();
    const Ground under_eye = ground_at(cursor, n_eye), under_target = ground_at(cursor, n_target);

    const SightFrame frame(e, n_eye, {under_eye.h().m + o.eye_height}, o.refraction);
    const glm::dvec3 foot = frame.lifted(ecef_of(e, n_target, under_target));
    const glm::dvec3 top = frame.lifted(ecef_from_normal(e, n_target, {under_target.h().m + o.target_height}));
    const double d_foot = std::hypot(foot.x, foot.y);
    Sight sight;
    sight.distance = glm::length(frame.ecef_from_lifted(top) - frame.local().origin());
    if (d_foot < 0.01) {  // straight up or down
        sight.visible = true;
        sight.certain = Visibility::visible;
        sight.obstruction = {to.latitude, to.longitude, under_target.h()};
        sight.bound = std::max(under_eye.bound, under_target.bound);
        return sight;
    }
    const glm::dvec2 u = glm::dvec2(foot) / d_foot;
    Target target{std::max(d_foot, std::hypot(top.x, top.y)), top.z, under_target.bound};

    LineVisitor line(frame, e, u, target.d);
    GroundWalk(field.cache(), line).planet();
    std::vector<SightPiece>& pieces = line.pieces;
    std::sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.d0 < b.d0; });
    // The ground under the target is an end of its own line: to the bit the height that the pieces have there.
    for (const SightPiece& piece : pieces)
        if (piece.d0 <= d_foot && d_foot <= piece.d1) {
            target.z += piece.z_at(d_foot, frame.bulge()) - foot.z;
            break;
        }
    sight.cells = pieces.size();
    for (const SightPiece& piece : pieces) sight.bound = std::max(sight.bound, piece.bound);

    const Steepest worst = steepest_before(pieces, target.d, frame.bulge(), 0, 0);
    const double slope = target.z / target.d;
    sight.visible = worst.slope * target.d <= target.z + sight_tolerance_m;
    sight.certain = certainty(pieces, target, frame.bulge(), under_eye.bound);
    sight.obstruction_distance = worst.d;
    sight.clearance = (slope - worst.slope) * worst.d;
    if (!sight.visible) sight.rise_needed = (worst.slope - slope) * target.d;
    sight.obstruction = geodetic_from_ecef(e, frame.ecef_from_lifted({u * worst.d, worst.slope * worst.d}));
    return sight;
}

}  // namespace planet
