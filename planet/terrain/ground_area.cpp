#include "planet/terrain/ground_area.h"

#include <algorithm>
#include <cassert>

#include "planet/geodesy/geodesic_path.h"
#include "planet/terrain/ground_walk.h"

namespace planet {

namespace {

// Arcs of great circles on the sphere of normals no longer than this part from geodesics by less than 4 mm.
constexpr double arc_m = 5000;
// Cells are halved until no side is longer: the area of the sphere over a plane triangle, to second order, is then good to
// 1e-7.
constexpr double ground_side_m = 100000;

double triple(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(a, glm::cross(b, c));
}

// A short arc of a ring.
struct Arc {
    glm::dvec3 a, b;  // unit

    // Of an arc from p to q of less than half a turn.
    bool crosses(const glm::dvec3& p, const glm::dvec3& q) const {
        return (triple(p, q, a) >= 0) != (triple(p, q, b) >= 0) && (triple(a, b, p) >= 0) != (triple(a, b, q) >= 0) &&
               glm::dot(p + q, a + b) > 0;
    }
    double distance(const glm::dvec3& n) const {
        const glm::dvec3 side = b - a;
        const double t = glm::dot(n - a, side) / glm::dot(side, side);
        return glm::length(n - (a + std::clamp(t, 0.0, 1.0) * side));
    }
};

enum class Passage {
    none,     // the arc misses the cell
    through,  // it cuts the cell in two
    part,     // it ends inside
};

// How an arc passes a cell, and the share of the cell on the side of its centre.
struct Cut {
    Passage passage = Passage::none;
    double share = 1;
};

Cut cut(const Arc& arc, const Corners& corners, const glm::dvec3& centre) {
    const glm::dvec3 m = glm::cross(arc.a, arc.b);
    const glm::dvec3 corner[3] = {corners.left, corners.right, corners.apex};
    double s[3];
    const double touch =
        1e-13 * glm::length(m);  // 0.6 um: rings along sides of cells, such as meridians, do not cut them
    for (int k = 0; k < 3; ++k) {
        s[k] = glm::dot(m, corner[k]);
        if (std::abs(s[k]) < touch) s[k] = 0;
    }
    if (std::max({s[0], s[1], s[2]}) <= 0 || std::min({s[0], s[1], s[2]}) >= 0) return {};
    const bool above[3] = {s[0] >= 0, s[1] >= 0, s[2] >= 0};
    // The corner that is alone on its side, and where the great circle meets its two sides.
    const int alone = above[1] == above[2] ? 0 : above[0] == above[2] ? 1 : 2;
    const glm::dvec3 ahead_of_a = glm::cross(m, arc.a), before_b = glm::cross(arc.b, m);
    int behind = 0, beyond = 0;
    double share = 1;
    for (int k = 1; k < 3; ++k) {
        const int j = (alone + k) % 3;
        const double t = s[alone] / (s[alone] - s[j]);
        share *= t;
        const glm::dvec3 x = corner[alone] + t * (corner[j] - corner[alone]);
        behind += glm::dot(x, ahead_of_a) < 0;
        beyond += glm::dot(x, before_b) < 0;
    }
    if (behind == 2 || beyond == 2) return {};
    if (behind + beyond > 0) return {Passage::part, 1};
    return {Passage::through, (glm::dot(m, centre) >= 0) == above[alone] ? share : 1 - share};
}

std::vector<Arc> arcs_of(const Geodesics& geodesics, const std::vector<Geodetic>& ring) {
    std::vector<Geodetic> closed = ring;
    closed.push_back(ring.front());
    const GeodesicPath path(geodesics, closed);
    std::vector<Arc> arcs;
    for (std::size_t leg = 0; leg < path.legs(); ++leg) {
        // Corners by themselves, so that rings with a side in common have the same bits there.
        glm::dvec3 from = normal_from_geodetic(closed[leg].latitude, closed[leg].longitude);
        const double start = path.leg_start(leg), length = path.leg_start(leg + 1) - start;
        const auto steps = static_cast<std::size_t>(std::ceil(length / arc_m));
        for (std::size_t i = 1; i <= steps; ++i) {
            const double s = start + length * static_cast<double>(i) / static_cast<double>(steps);
            const glm::dvec3 to = i == steps ? normal_from_geodetic(closed[leg + 1].latitude, closed[leg + 1].longitude)
                                             : path.normal_at(s);
            if (from != to) arcs.push_back({from, to});
            from = to;
        }
    }
    return arcs;
}

bool odd_crossings(std::span<const Arc> arcs, const glm::dvec3& p, const glm::dvec3& q) {
    bool odd = false;
    for (const Arc& arc : arcs) odd ^= arc.crosses(p, q);
    return odd;
}

// The same for directions any distance apart.
bool odd_crossings_far(std::span<const Arc> arcs, const glm::dvec3& p, const glm::dvec3& q) {
    if (glm::dot(p, q) > 0.5) return odd_crossings(arcs, p, q);
    glm::dvec3 middle = p + q;
    if (glm::length(middle) < 1e-3)
        middle = glm::cross(p, std::abs(p.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
    middle = glm::normalize(middle);
    return odd_crossings_far(arcs, p, middle) != odd_crossings_far(arcs, middle, q);
}

// A direction and whether it is inside of all rings together.
struct Known {
    glm::dvec3 direction{0, 0, 1};
    bool inside = false;
};

// A hair to the left of the middle of a ring's longest arc is inside iff the ring turns left.
Known beside(std::span<const Arc> arcs, bool counter_clockwise) {
    const auto longest = std::max_element(arcs.begin(), arcs.end(), [](const Arc& p, const Arc& q) {
        return glm::length(p.b - p.a) < glm::length(q.b - q.a);
    });
    const glm::dvec3 left = glm::cross(longest->a, longest->b - longest->a);
    return {glm::normalize(longest->a + longest->b + 1e-6 * left), counter_clockwise};
}

class AreaVisitor {
  public:
    AreaVisitor(const Ellipsoid& e, std::vector<Arc> arcs, const Known& known, double finest_m,
                const std::function<void(double)>& progress)
        : e_(e), arcs_(std::move(arcs)), finest_chord_(finest_m / e.a), progress_(progress) {
        State all{{}, known};
        all.near.resize(arcs_.size());
        for (std::size_t i = 0; i < arcs_.size(); ++i) all.near[i] = static_cast<std::uint32_t>(i);
        stack_.push_back(std::move(all));
    }

    bool enter(const Corners& corners) {
        const State& above = stack_.back();
        const CellReach reach(corners);
        State state;
        for (const std::uint32_t i : above.near) {
            if (arcs_[i].distance(reach.centre) > reach.chord * (1 + 1e-9) + 1e-9) continue;
            if (above.near.size() > few || cut(arcs_[i], corners, reach.centre).passage != Passage::none)
                state.near.push_back(i);
        }
        state.known = {reach.centre, above.known.inside};
        if (stack_.size() == 1) {
            state.known.inside ^= odd_crossings_far(arcs_, above.known.direction, reach.centre);
        } else {
            for (const std::uint32_t i : above.near)
                state.known.inside ^= arcs_[i].crosses(above.known.direction, reach.centre);
        }
        if (state.near.empty() && !state.known.inside) return false;
        stack_.push_back(std::move(state));
        return true;
    }
    void leave() {
        stack_.pop_back();
        if (progress_ && stack_.size() <= 8) progress_(static_cast<double>(++left_) / (8 * 255));
    }
    bool halve(const GroundCell& cell) const {
        const Corners& c = cell.normal;
        const double longest =
            std::max({glm::length(c.left - c.right), glm::length(c.right - c.apex), glm::length(c.apex - c.left)});
        if (longest * e_.a > ground_side_m) return true;
        return longest > finest_chord_ && !is_clear(cell);
    }
    void visit(const GroundCell& cell) {
        const State& state = stack_.back();
        const double area = area_of(cell);
        ++result.cells;
        double share = state.known.inside ? 1 : 0;
        if (!state.near.empty() && is_clear(cell)) {
            const Cut passing = cut(arcs_[state.near.front()], cell.normal, state.known.direction);
            share = state.known.inside ? passing.share : 1 - passing.share;
        } else if (!state.near.empty()) {
            result.bound += area;
        }
        // Millions of small cells: summed in two words (Neumaier).
        const double x = share * area, sum = result.area + x;
        low_ += std::abs(result.area) >= x ? result.area - sum + x : x - sum + result.area;
        result.area = sum;
    }

    GroundArea take() const {
        GroundArea r = result;
        r.area += low_;
        return r;
    }

    GroundArea result;

  private:
    // From so many arcs on, they are only told apart from a cell by its circumcircle.
    static constexpr std::size_t few = 32;
    struct State {
        std::vector<std::uint32_t> near;  // arcs that may pass through the cell
        Known known;                      // its centre
    };

    // Of the plane triangle, and by as much more as the sphere's is over the triangle of the normals.
    double area_of(const GroundCell& cell) const {
        const auto plane = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
            return 0.5 * glm::length(glm::cross(b - a, c - a));
        };
        const auto& [l, r, a] = cell.normal;
        const double flat = plane(ecef_from_normal(e_, l, {cell.h[0]}), ecef_from_normal(e_, r, {cell.h[1]}),
                                  ecef_from_normal(e_, a, {cell.h[2]}));
        if (glm::length(r - l) < 3e-4) return flat;
        const double dots = glm::dot(l, r) + glm::dot(r, a) + glm::dot(a, l);
        return flat * 2 * std::atan2(std::abs(triple(l, r, a)), 1 + dots) / plane(l, r, a);
    }

    // Whether the share that is inside is known: no arc, or one from side to side.
    bool is_clear(const GroundCell& cell) const {
        const State& state = stack_.back();
        if (state.near.empty()) return true;
        return state.near.size() == 1 &&
               cut(arcs_[state.near.front()], cell.normal, state.known.direction).passage == Passage::through;
    }

    Ellipsoid e_;
    std::vector<Arc> arcs_;
    double finest_chord_;
    const std::function<void(double)>& progress_;
    std::vector<State> stack_;
    std::size_t left_ = 0;
    double low_ = 0;
};

}  // namespace

GroundArea ground_area(const StoreField& field, const Rings& rings, const std::function<void(double)>& progress) {
    const Ellipsoid& e = field.store().metadata().ellipsoid;
    const Geodesics geodesics(e);
    std::vector<Arc> all;
    std::vector<std::vector<Arc>> by_ring;
    std::vector<Known> known;
    double perimeter = 0;
    for (const auto& ring : rings) {
        assert(ring.size() >= 3);
        const PolygonSize size = geodesics.polygon(ring);
        std::vector<Arc> arcs = arcs_of(geodesics, ring);
        if (size.area == 0 || arcs.size() < 3) continue;
        perimeter += size.perimeter;
        known.push_back(beside(arcs, size.area > 0));
        all.insert(all.end(), arcs.begin(), arcs.end());
        by_ring.push_back(std::move(arcs));
    }
    if (known.empty()) return {};
    Known start{known.front().direction, false};
    for (std::size_t i = 0; i < known.size(); ++i)
        start.inside ^= known[i].inside != odd_crossings_far(by_ring[i], known[i].direction, start.direction);
    AreaVisitor visitor(e, std::move(all), start, std::max(1e-6 * perimeter, 0.01), progress);
    GroundWalk(field.cache(), visitor).planet();
    return visitor.take();
}

}  // namespace planet
