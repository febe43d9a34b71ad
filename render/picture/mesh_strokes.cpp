#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "render/picture/mesh_figure.h"

namespace render {
namespace {

constexpr double border_width = 1.7, curve_width = 2.3, casing = 1.5;  ///< line units; casing on both sides
constexpr double curve_from = 9, curve_whole = 17;  ///< height of a triangle, line units: the curve fades between
constexpr double ring = 1.6, first_mark = 6.5, other_mark = 4.2;  ///< line units; marks: radius

using Triangle = std::array<std::uint32_t, 3>;

/// The shared side of two triangles that follow each other, two corners; both the same if there is none.
struct Gate {
    std::uint32_t a = 0, b = 0;
    explicit operator bool() const { return a != b; }
};

Gate gate_between(const Triangle& t, const Triangle& next) {
    std::uint32_t found[3];
    int count = 0;
    for (const std::uint32_t v : t)
        if (std::ranges::find(next, v) != next.end()) found[count++] = v;
    return count == 2 ? Gate{found[0], found[1]} : Gate{};
}

/// Sides of one shown triangle only: the border of a plan, the horizon of a planet. Sides are taken off the list where
/// they come up again, which in curve order is soon: it stays short, whatever the size of the mesh.
class OpenSides {
  public:
    void add(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
        const auto [place, is_new] = list_.try_emplace(key, order_++);
        if (!is_new) list_.erase(place);
    }
    /// In the order in which they came.
    std::vector<Gate> take() {
        std::vector<std::pair<std::uint64_t, std::uint64_t>> sorted;
        for (const auto& [key, order] : list_) sorted.emplace_back(order, key);
        std::ranges::sort(sorted);
        std::vector<Gate> sides;
        for (const auto& [order, key] : sorted)
            sides.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)});
        return sides;
    }

  private:
    std::unordered_map<std::uint64_t, std::uint64_t> list_;
    std::uint64_t order_ = 0;
};

void add_border(std::vector<Stroke>& strokes, const MeshPicture& picture, const MeshView& view) {
    OpenSides open;
    Gate entry;
    for (std::size_t i = 0; i < picture.triangles.size(); ++i) {
        const Triangle& t = picture.triangles[i];
        if (!footprint(view, t).shown) {
            entry = {};
            continue;
        }
        // A side that the next triangle shares needs no list.
        Gate exit;
        if (i + 1 < picture.triangles.size() && footprint(view, picture.triangles[i + 1]).shown)
            exit = gate_between(t, picture.triangles[i + 1]);
        const auto is = [](const Gate& g, std::uint32_t a, std::uint32_t b) {
            return g && ((g.a == a && g.b == b) || (g.a == b && g.b == a));
        };
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            if (!is(entry, a, b) && !is(exit, a, b)) open.add(a, b);
        }
        entry = exit;
    }
    const auto width = static_cast<float>(border_width * view.line_unit);
    for (const Gate& side : open.take())
        strokes.push_back({view.places[side.a], view.places[side.b], width, figure_color::ink});
}

/// The curve through the middles of shared sides, bent so that it has no corners.
class Curve {
  public:
    Curve(const MeshPicture& picture, const MeshView& view) : picture_(picture), view_(view) {}

    /// Adds the part within a triangle, and a broader white one.
    void add(std::size_t i, std::vector<Stroke>& casings, std::vector<Stroke>& cores) const {
        const Footprint f = footprint(view_, picture_.triangles[i]);
        const double unit = view_.line_unit;
        const double strength = std::clamp((f.height / unit - curve_from) / (curve_whole - curve_from), 0.0, 1.0);
        if (!f.shown || strength <= 0) return;
        const glm::vec3 from = entry(i), to = exit(i), chord = to - from;
        const float length = glm::length(chord);
        if (length == 0) return;
        const glm::vec3 leave = length * tangent(i, has_gate(i - 1) ? i - 1 : i);
        const glm::vec3 arrive = length * tangent(i, has_gate(i) ? i + 1 : i);
        const bool straight = glm::length(leave - chord) + glm::length(arrive - chord) < 0.01f * length;
        const int pieces = straight ? 1 : std::clamp(static_cast<int>(length / 3), 2, 24);
        const auto width = static_cast<float>(curve_width * unit),
                   broad = width + static_cast<float>(2 * casing * unit);
        const Color color = picture_.step.empty() ? figure_color::curve : figure_color::curve_over_steps;
        glm::vec3 last = from;
        for (int k = 1; k <= pieces; ++k) {
            const float s = static_cast<float>(k) / static_cast<float>(pieces);
            const glm::vec3 next = hermite(from, leave, to, arrive, s);
            casings.push_back({last, next, broad, with_alpha(figure_color::paper, strength)});
            cores.push_back({last, next, width, with_alpha(color, strength)});
            last = next;
        }
    }

  private:
    static glm::vec3 hermite(const glm::vec3& p, const glm::vec3& u, const glm::vec3& q, const glm::vec3& v, float s) {
        const float s2 = s * s, s3 = s2 * s;
        return (2 * s3 - 3 * s2 + 1) * p + (s3 - 2 * s2 + s) * u + (3 * s2 - 2 * s3) * q + (s3 - s2) * v;
    }
    /// i may be one below 0.
    Gate gate(std::size_t i) const {
        if (i + 1 == 0 || i + 1 >= picture_.triangles.size()) return {};
        return gate_between(picture_.triangles[i], picture_.triangles[i + 1]);
    }
    bool has_gate(std::size_t i) const { return static_cast<bool>(gate(i)); }
    glm::vec3 middle(const Gate& g) const { return 0.5f * (view_.places[g.a] + view_.places[g.b]); }
    glm::vec3 centroid(std::size_t i) const {
        const Triangle& t = picture_.triangles[i];
        return (view_.places[t[0]] + view_.places[t[1]] + view_.places[t[2]]) / 3.0f;
    }
    glm::vec3 entry(std::size_t i) const {
        const Gate g = gate(i - 1);
        return g ? middle(g) : centroid(i);
    }
    glm::vec3 exit(std::size_t i) const {
        const Gate g = gate(i);
        return g ? middle(g) : centroid(i);
    }
    glm::vec3 direction(std::size_t i) const {
        const glm::vec3 d = exit(i) - entry(i);
        const float length = glm::length(d);
        return length > 0 ? d / length : glm::vec3(0);
    }
    /// Where two triangles meet: between their directions.
    glm::vec3 tangent(std::size_t i, std::size_t neighbour) const {
        const glm::vec3 sum = direction(i) + direction(neighbour);
        const float length = glm::length(sum);
        return length > 1e-3f ? sum / length : direction(i);
    }

    const MeshPicture& picture_;
    const MeshView& view_;
};

void add_marks(std::vector<Stroke>& strokes, const MeshPicture& picture, const MeshView& view) {
    if (picture.marks.empty()) return;
    // Dots keep apart where the triangles that merge are small.
    float room = static_cast<float>(4 * first_mark * view.line_unit);
    for (std::size_t i = 0; i < picture.step.size(); ++i) {
        if (picture.step[i] == 0) continue;
        const Footprint f = footprint(view, picture.triangles[i]);
        if (f.shown) room = std::min(room, f.height);
    }
    const float unit = static_cast<float>(view.line_unit);
    const auto radius = [&](double wanted) {
        return std::clamp(0.3f * room, 1.5f * unit, static_cast<float>(wanted) * unit);
    };
    const auto dot = [&](std::size_t i, float r, Color color) {
        const glm::vec3 p = view.place(picture.marks[i]);
        strokes.push_back({p, p, 2 * r, color});
    };
    const float edge = static_cast<float>(ring) * unit;
    for (std::size_t i = 1; i < picture.marks.size(); ++i) dot(i, radius(other_mark), figure_color::ink);
    for (std::size_t i = 1; i < picture.marks.size(); ++i)
        dot(i, std::max(radius(other_mark) - edge, 0.4f), figure_color::paper);
    dot(0, 1.3f * radius(first_mark) + 1.3f * edge, figure_color::paper);
    dot(0, 1.3f * radius(first_mark), figure_color::mark);
}

}  // namespace

std::vector<Stroke> mesh_strokes(const MeshPicture& picture, const MeshView& view) {
    std::vector<Stroke> strokes;
    add_border(strokes, picture, view);
    if (picture.curve) {
        std::vector<Stroke> cores;
        const Curve curve(picture, view);
        for (std::size_t i = 0; i < picture.triangles.size(); ++i) curve.add(i, strokes, cores);
        strokes.insert(strokes.end(), cores.begin(), cores.end());
    }
    add_marks(strokes, picture, view);
    return strokes;
}

}  // namespace render
