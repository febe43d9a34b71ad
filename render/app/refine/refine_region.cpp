#include "render/app/refine/refine_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "planet/error.h"
#include "planet/frames.h"

namespace render {
namespace {

using planet::MeshFrame;
using Ring = std::vector<glm::dvec2>;
using Corners = std::array<glm::dvec2, 3>;

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether a triangle of longitudes and latitudes has a pole within: once around it, longitude makes a whole turn.
bool holds_pole(const Corners& t) {
    double turned = 0;
    for (std::size_t k = 0; k < 3; ++k) turned += std::remainder(t[(k + 1) % 3].x - t[k].x, 360);
    return std::abs(turned) > 180;
}

/// Even-odd, over all rings.
bool holds(const std::vector<Ring>& rings, glm::dvec2 p) {
    bool inside = false;
    for (const Ring& ring : rings)
        for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
            const glm::dvec2 a = ring[i], b = ring[i + 1];
            if ((a.y > p.y) == (b.y > p.y)) continue;
            if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
        }
    return inside;
}

bool holds(const Corners& t, glm::dvec2 p) {
    const double a = turn(t[0], t[1], p), b = turn(t[1], t[2], p), c = turn(t[2], t[0], p);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool cross(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
    return (turn(a, b, c) > 0) != (turn(a, b, d) > 0) && (turn(c, d, a) > 0) != (turn(c, d, b) > 0);
}

bool meet(const Corners& t, const std::vector<Ring>& rings) {
    if (std::ranges::any_of(t, [&](glm::dvec2 corner) { return holds(rings, corner); })) return true;
    for (const Ring& ring : rings)
        for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
            if (holds(t, ring[i])) return true;
            for (std::size_t k = 0; k < 3; ++k)
                if (cross(t[k], t[(k + 1) % 3], ring[i], ring[i + 1])) return true;
        }
    return false;
}

}  // namespace

RefineRegion::RefineRegion(const std::string& path, const RefineMeaning& meaning) : meaning_(meaning) {
    const planet::MeshReference& reference = meaning.reference;
    if (reference.frame == MeshFrame::enu || reference.frame == MeshFrame::ecef) places_.emplace(reference, "--region");
    turns_ = places_ || reference.geographic;
    planet::FeatureOptions how;
    if (!places_) {
        how.crs = reference.crs;
        how.plain = reference.crs.empty();
    }
    planet::Features found = planet::read_features(path, how);
    if (found.polygons.empty())
        throw planet::Error(planet::Fault::bad_data, path, "has no polygon to refine in", "polygons");
    const auto add_ring = [](Area& area, const std::vector<glm::dvec3>& from) {
        Ring& ring = area.rings.emplace_back();
        for (const glm::dvec3& v : from) {
            ring.emplace_back(v);
            area.low = glm::min(area.low, ring.back());
            area.high = glm::max(area.high, ring.back());
        }
    };
    for (const planet::Polygon& polygon : found.polygons) {
        constexpr double far = std::numeric_limits<double>::infinity();
        Area& area = areas_.emplace_back(Area{{}, glm::dvec2(far), glm::dvec2(-far)});
        add_ring(area, polygon.outer);
        for (const auto& hole : polygon.holes) add_ring(area, hole);
    }
}

glm::dvec2 RefineRegion::in_plan(const glm::dvec3& p) const {
    const glm::dvec3 q = meaning_.in_file(p);
    if (!places_) return glm::dvec2(q);
    const planet::Geodetic g = places_->geodetic(q);
    return {g.longitude / planet::degrees, g.latitude / planet::degrees};
}

// Its sides are no lines there: all polygons that reach its latitudes count.
bool RefineRegion::near_pole(const std::array<glm::dvec2, 3>& t) const {
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    return std::ranges::any_of(areas_, [&, south = low, north = high](const Area& area) {
        return south + north > 0 ? area.high.y >= south : area.low.y <= north;
    });
}

bool RefineRegion::meets(const planet::TrianglePlaces& triangle) const {
    Corners t{in_plan(triangle[0]), in_plan(triangle[1]), in_plan(triangle[2])};
    if (places_ && holds_pole(t)) return near_pole(t);
    if (turns_)
        for (glm::dvec2& corner : t) corner.x += 360 * std::round((t[0].x - corner.x) / 360);
    for (const Area& area : areas_) {
        Corners near = t;
        if (turns_) {
            const double turns = std::round(((area.low.x + area.high.x) / 2 - t[0].x) / 360);
            for (glm::dvec2& corner : near) corner.x += 360 * turns;
        }
        const glm::dvec2 low = glm::min(glm::min(near[0], near[1]), near[2]);
        const glm::dvec2 high = glm::max(glm::max(near[0], near[1]), near[2]);
        if (low.x > area.high.x || low.y > area.high.y || high.x < area.low.x || high.y < area.low.y) continue;
        if (meet(near, area.rings)) return true;
    }
    return false;
}

}  // namespace render
