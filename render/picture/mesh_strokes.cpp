#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "render/picture/mesh_figure.h"

namespace render {
namespace {

constexpr float border_width = 1.7f, first_mark = 9;  ///< line units; marks: radius

constexpr float curve_from = 6, curve_whole = 13;  ///< pixels, legs of triangles: the curve appears between
constexpr float curve_gone = 1.5f;                 ///< pixels, legs of single triangles
constexpr float casing = 2.1f;                     ///< width of the white below the curve, of the curve's own
constexpr float thinning = 0.12f;                  ///< most width of the curve, of a triangle's leg
constexpr std::size_t smoothed = 8;                ///< triangles before and after over which the curve appears

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
    bool shown = footprint(view, picture.triangles[0]).shown;
    for (std::size_t i = 0; i < picture.triangles.size(); ++i) {
        const Triangle& t = picture.triangles[i];
        const bool next_shown = i + 1 < picture.triangles.size() && footprint(view, picture.triangles[i + 1]).shown;
        if (!std::exchange(shown, next_shown)) {
            entry = {};
            continue;
        }
        // A side that the next triangle shares needs no list.
        const Gate exit = next_shown ? gate_between(t, picture.triangles[i + 1]) : Gate{};
        const auto is = [](const Gate& g, std::uint32_t a, std::uint32_t b) {
            return g && ((g.a == a && g.b == b) || (g.a == b && g.b == a));
        };
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            if (!is(entry, a, b) && !is(exit, a, b)) open.add(a, b);
        }
        entry = exit;
    }
    const float width = border_width * static_cast<float>(view.line_unit);
    for (const Gate& side : open.take())
        strokes.push_back({view.places[side.a], view.places[side.b], width, figure_color::ink});
}

/// The curve through the middles of shared sides, bent so that it has no corners. Where triangles are small it becomes
/// thin, then faint.
class Curve {
  public:
    Curve(const MeshPicture& picture, const MeshView& view)
        : picture_(picture),
          view_(view),
          line_unit_(static_cast<float>(view.line_unit)),
          color_(picture.step.empty() ? figure_color::curve : figure_color::curve_over_steps) {}

    /// Adds the part within a triangle, and a broader white one.
    void add(std::size_t i, std::vector<Stroke>& casings, std::vector<Stroke>& cores) const {
        if (!footprint(view_, picture_.triangles[i]).shown || size(i) < curve_gone) return;
        const float seen = strength(i);
        const glm::vec3 from = entry(i), to = exit(i), chord = to - from;
        const float length = glm::length(chord);
        if (seen == 0 || length == 0) return;
        const std::size_t before = has_gate(i - 1) ? i - 1 : i, after = has_gate(i) ? i + 1 : i;
        const glm::vec3 leave = length * tangent(i, before), arrive = length * tangent(i, after);
        const bool straight = glm::length(leave - chord) + glm::length(arrive - chord) < 0.01f * length;
        const int pieces = straight ? 2 : static_cast<int>(std::clamp(length / 3, 2.0f, 24.0f));
        const glm::vec2 at_from(0.5f * (seen + strength(before)), 0.5f * (width(i) + width(before)));
        const glm::vec2 at_to(0.5f * (seen + strength(after)), 0.5f * (width(i) + width(after)));
        glm::vec3 last = from;
        for (int k = 1; k <= pieces; ++k) {
            const float s = static_cast<float>(k) / static_cast<float>(pieces);
            const glm::vec3 next = hermite(from, leave, to, arrive, s);
            const glm::vec2 pen = glm::mix(at_from, at_to, s);
            casings.push_back({last, next, pen.y * casing, with_alpha(figure_color::paper, pen.x)});
            cores.push_back({last, next, pen.y, with_alpha(color_, pen.x)});
            last = next;
        }
    }

  private:
    /// Of a triangle, pixels: its leg if it is not foreshortened.
    float size(std::size_t i) const {
        const Footprint f = footprint(view_, picture_.triangles[i]);
        return std::min(std::sqrt(2 * f.area), 2.2f * f.height);
    }
    float width(std::size_t i) const { return std::min(curve_width * line_unit_, thinning * size(i)); }
    /// 0..1, of the mean size around a triangle, lest the curve falls to pieces where sizes vary.
    float strength(std::size_t i) const {
        const std::size_t first = i - std::min<std::size_t>(i, smoothed), count = picture_.triangles.size();
        const std::size_t end = std::min(i + smoothed + 1, count);
        float sum = 0;
        for (std::size_t k = first; k < end; ++k) sum += std::min(size(k), curve_whole);
        return std::clamp((sum / static_cast<float>(end - first) - curve_from) / (curve_whole - curve_from), 0.0f,
                          1.0f);
    }
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
    /// Where two triangles meet: between their directions, nearer to that of the shorter way, as a circle would go.
    glm::vec3 tangent(std::size_t i, std::size_t neighbour) const {
        const glm::vec3 d = exit(i) - entry(i), e = exit(neighbour) - entry(neighbour);
        const glm::vec3 sum = d * glm::dot(e, e) + e * glm::dot(d, d);
        const float length = glm::length(sum);
        return length > 0 ? sum / length : d / glm::length(d);
    }

    const MeshPicture& picture_;
    const MeshView& view_;
    float line_unit_;
    Color color_;
};

void add_marks(std::vector<Stroke>& strokes, const MeshPicture& picture, const MeshView& view) {
    if (picture.marks.empty()) return;
    const float unit = static_cast<float>(view.line_unit);
    // Dots keep apart where the triangles that merge are small; those near a planet's limb only look so.
    float room = 4 * first_mark * unit;
    for (std::size_t i = 0; i < picture.step.size(); ++i) {
        if (picture.step[i] == 0 || !footprint(view, picture.triangles[i]).shown) continue;
        const auto& [p, q, r] = picture.triangles[i];
        const glm::vec3 a = view.places[p], b = view.places[q], c = view.places[r];
        const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        if (longest > 0) room = std::min(room, glm::length(glm::cross(b - a, c - a)) / longest);
    }
    const auto dot = [&](std::size_t i, float radius, Color color) {
        const glm::vec3 p = view.place(picture.marks[i]);
        strokes.push_back({p, p, 2 * radius, color});
    };
    const float first = std::clamp(0.4f * room, 2 * unit, first_mark * unit);
    const float other = std::clamp(0.3f * room, 1.5f * unit, other_mark * unit);
    for (std::size_t i = 1; i < picture.marks.size(); ++i) dot(i, other, figure_color::ink);
    for (std::size_t i = 1; i < picture.marks.size(); ++i)
        dot(i, std::max(other - ring_width * unit, 0.4f), figure_color::paper);
    dot(0, first + 1.3f * ring_width * unit, figure_color::paper);
    dot(0, first, figure_color::ink);
}

}  // namespace

MeshStrokes mesh_strokes(const MeshPicture& picture, const MeshView& view) {
    MeshStrokes strokes;
    add_border(strokes.list, picture, view);
    if (picture.curve) {
        std::vector<Stroke> cores;
        const Curve curve(picture, view);
        for (std::size_t i = 0; i < picture.triangles.size(); ++i) curve.add(i, strokes.list, cores);
        strokes.list.insert(strokes.list.end(), cores.begin(), cores.end());
        strokes.has_curve = !cores.empty();
    }
    add_marks(strokes.list, picture, view);
    return strokes;
}

}  // namespace render
