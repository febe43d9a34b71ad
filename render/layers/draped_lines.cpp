#include "render/layers/draped_lines.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace render {

namespace {

using planet::wgs84;

constexpr double longest_piece_px = 3, least_side_px = 1;
constexpr double crowded_px = 4;
constexpr double lowest_ground_m = 600;
constexpr double shortest_side_m = 0.02;  // near the eye sides are not cut any finer

struct Vertex {
    glm::dvec3 normal{0}, point{0};
};

class Draper {
  public:
    Draper(const Camera& camera, DrapeGround& ground, std::vector<ScreenPiece>& pieces)
        : camera_(camera), ground_(ground), culling_(ground.culling), pieces_(pieces) {}

    void drape(std::span<const glm::dvec3> normals) {
        if (normals.size() == 1) return point(normals.front());
        std::optional<Vertex> from;
        glm::dvec3 from_normal = normals.front(), from_foot = foot(from_normal);
        for (std::size_t i = 1; i < normals.size(); ++i) {
            const glm::dvec3 to_foot = foot(normals[i]);
            const double length = glm::distance(from_foot, to_foot);
            if (i + 1 < normals.size() && pixels(length, from_foot) < least_side_px) continue;
            if (hidden(0.5 * (from_foot + to_foot), length, ground_.relief_m)) {
                from.reset();
            } else {
                if (!from) from = vertex(from_normal);
                const Vertex to = vertex(normals[i]);
                side(*from, to, 0);
                from = to;
            }
            from_normal = normals[i];
            from_foot = to_foot;
        }
    }

  private:
    static glm::dvec3 foot(const glm::dvec3& normal) { return planet::ecef_from_normal(wgs84, normal); }
    Vertex vertex(const glm::dvec3& normal) { return {normal, ground_.point(normal)}; }

    /// At most so many, if it ends there.
    double pixels(double length, const glm::dvec3& at) const {
        const double distance = std::max(glm::distance(camera_.eye, at) - length - ground_.relief_m, 1.0);
        return length * camera_.focal_px / distance;
    }

    /// Of a side about its middle. @param relief how far its ground may be from the straight line between its ends
    bool hidden(const glm::dvec3& middle, double length, double relief) const {
        unsigned open = culling_.everything();
        const double bulge = std::min(length * length / (4 * wgs84.b), 2 * wgs84.a);
        return culling_.hidden(middle, 0.5 * length + bulge + relief, open);
    }

    void point(const glm::dvec3& normal) {
        const glm::dvec3 below = foot(normal);
        if (hidden(below, 0, ground_.relief_m) || is_behind_planet(camera_.eye, below)) return;
        const auto near = screen_from_ecef(camera_, below);
        if (!near || !first_in_square(glm::dvec2(*near))) return;
        if (const auto at = screen_from_ecef(camera_, ground_.point(normal)))
            pieces_.push_back({glm::vec3(*at), glm::vec3(*at)});
    }

    /// Of a crowd, those that would show.
    bool first_in_square(const glm::dvec2& at) {
        const glm::ivec2 square(glm::floor(at / crowded_px));
        return taken_
            .insert(static_cast<std::uint64_t>(static_cast<std::uint32_t>(square.x)) << 32 |
                    static_cast<std::uint32_t>(square.y))
            .second;
    }

    void side(const Vertex& from, const Vertex& to, int depth) {
        const double length = glm::distance(from.point, to.point);
        const glm::dvec3 middle = 0.5 * (from.point + to.point);
        if (hidden(middle, length, std::min(2 * length, 2 * ground_.relief_m))) return;
        const auto a = screen_from_ecef(camera_, from.point), b = screen_from_ecef(camera_, to.point);
        const bool short_enough = a && b ? glm::distance(glm::dvec2(*a), glm::dvec2(*b)) <= longest_piece_px &&
                                               length < 0.5 * glm::distance(middle, camera_.eye)
                                         : length < shortest_side_m;
        constexpr int deepest = 40;
        if (short_enough || length < shortest_side_m || depth == deepest) {
            if (a && b && !is_behind_planet(camera_.eye, middle)) pieces_.push_back({glm::vec3(*a), glm::vec3(*b)});
            return;
        }
        const Vertex between = vertex(middle_of_side(from.normal, to.normal));
        side(from, between, depth + 1);
        side(between, to, depth + 1);
    }

    const Camera& camera_;
    DrapeGround& ground_;
    planet::CullingTest culling_;
    std::vector<ScreenPiece>& pieces_;
    std::unordered_set<std::uint64_t> taken_;  // squares with a point
};

}  // namespace

glm::dvec3 DrapeGround::point(const glm::dvec3& normal) {
    if (const auto at = drawn.point_at(normal)) return *at;
    return planet::ecef_from_normal(wgs84, normal, {height(normal)});
}

bool is_behind_planet(const glm::dvec3& eye, const glm::dvec3& point) {
    const glm::dvec3 axes = glm::dvec3(wgs84.a, wgs84.a, wgs84.b) - lowest_ground_m;
    const glm::dvec3 from = eye / axes, way = point / axes - from;
    const double nearest = -glm::dot(from, way) / glm::dot(way, way);
    if (!(nearest > 0 && nearest < 1)) return false;
    const glm::dvec3 there = from + nearest * way;
    return glm::dot(there, there) < 1;
}

void drape(const GeodesicLines& lines, const Camera& camera, DrapeGround& ground, std::vector<ScreenPiece>& pieces) {
    const planet::CullingTest culling(ground.culling);
    Draper draper(camera, ground, pieces);
    for (const GeodesicLines::Run& run : lines.runs()) {
        unsigned open = culling.everything();
        if (!culling.hidden(run.centre, run.radius + ground.relief_m, open)) draper.drape(lines.vertices(run));
    }
}

}  // namespace render
