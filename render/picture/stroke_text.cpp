#include "render/picture/stroke_text.h"

#include <cmath>
#include <numbers>
#include <span>

namespace render {
namespace {

// Units: digits are 14 high, small letters 10; the baseline is at 0, y up.

/// An arc of an ellipse, degrees counter-clockwise from the right; or, if rx is 0, the line from (x, y) to (from, to).
struct Piece {
    double x, y, rx, ry, from, to;
};

constexpr Piece arc(double x, double y, double rx, double ry, double from = 0, double to = 360) {
    return {x, y, rx, ry, from, to};
}
constexpr Piece line(double x0, double y0, double x1, double y1) {
    return {x0, y0, 0, 0, x1, y1};
}

struct Glyph {
    char character;
    double width;
    Piece pieces[5];
    int count;
};

template <class... Pieces>
constexpr Glyph glyph(char character, double width, Pieces... pieces) {
    return {character, width, {pieces...}, sizeof...(pieces)};
}

constexpr Glyph glyphs[] = {
    glyph('0', 8.4, arc(4.2, 7, 4.2, 7)),
    glyph('1', 4, line(0, 11.2, 4, 14), line(4, 14, 4, 0)),
    glyph('2', 8, arc(4, 10, 4, 4, 165, -38), line(7.15, 7.54, 0, 0), line(0, 0, 8, 0)),
    glyph('3', 8, arc(4, 10.6, 3.4, 3.4, 150, -90), arc(4, 3.6, 4, 3.6, 90, -155)),
    glyph('4', 8.6, line(6.4, 0, 6.4, 14), line(6.4, 14, 0, 3.8), line(0, 3.8, 8.6, 3.8)),
    glyph('5', 8, line(7, 14, 1.7, 14), line(1.7, 14, 1.1, 7.9), arc(3.8, 4.5, 4.2, 4.5, 131, -155)),
    glyph('6', 8.4, arc(4.2, 4.4, 4.2, 4.4), line(0.7, 6.8, 5.4, 14)),
    glyph('7', 8, line(0, 14, 8, 14), line(8, 14, 2.4, 0)),
    glyph('8', 8, arc(4, 10.6, 3.4, 3.4), arc(4, 3.6, 4, 3.6)),
    glyph('9', 8.4, arc(4.2, 9.6, 4.2, 4.4), line(7.7, 7.2, 3, 0)),
    glyph('a', 9, arc(4.5, 5, 4.5, 5), line(9, 10, 9, 0)),
    glyph('b', 9, arc(4.5, 5, 4.5, 5), line(0, 15, 0, 0)),
    glyph('c', 8, arc(4.7, 5, 4.7, 5, 45, 315)),
    glyph('d', 9, arc(4.5, 5, 4.5, 5), line(9, 15, 9, 0)),
    glyph('e', 9, arc(4.5, 5, 4.5, 5, 0, 318), line(0, 5, 9, 5)),
    glyph('f', 5, arc(4.6, 12.4, 2.6, 2.6, 70, 180), line(2, 12.4, 2, 0), line(0, 10, 4.8, 10)),
    glyph('g', 9, arc(4.5, 5, 4.5, 5), line(9, 10, 9, -0.6), arc(4.5, -0.6, 4.5, 4.2, 0, -150)),
    glyph('h', 8, line(0, 15, 0, 0), arc(4, 6, 4, 4, 0, 180), line(8, 6, 8, 0)),
    glyph('i', 0, line(0, 10, 0, 0), line(0, 13.8, 0, 14.2)),
    glyph('j', 1, line(1, 10, 1, -3), line(1, 13.8, 1, 14.2), arc(-1, -3, 2, 2, 0, -80)),
    glyph('k', 7, line(0, 15, 0, 0), line(6.4, 10, 0, 4), line(2.4, 6.2, 7, 0)),
    glyph('l', 0, line(0, 15, 0, 0)),
    glyph('m', 13.2, line(0, 10, 0, 0), arc(3.3, 6.7, 3.3, 3.3, 0, 180), line(6.6, 6.7, 6.6, 0),
          arc(9.9, 6.7, 3.3, 3.3, 0, 180), line(13.2, 6.7, 13.2, 0)),
    glyph('n', 8, line(0, 10, 0, 0), arc(4, 6, 4, 4, 0, 180), line(8, 6, 8, 0)),
    glyph('o', 10, arc(5, 5, 5, 5)),
    glyph('p', 9, arc(4.5, 5, 4.5, 5), line(0, 10, 0, -5)),
    glyph('q', 9, arc(4.5, 5, 4.5, 5), line(9, 10, 9, -5)),
    glyph('r', 4.4, line(0, 10, 0, 0), arc(4, 5.6, 4, 4.4, 84, 180)),
    glyph('s', 6.6, arc(3.3, 7.5, 2.7, 2.5, 40, 270), arc(3.3, 2.5, 3.1, 2.5, 90, -145)),
    glyph('t', 5.2, line(2, 14, 2, 2.6), arc(4.6, 2.6, 2.6, 2.6, 180, 285), line(0, 10, 5, 10)),
    glyph('u', 8, line(0, 10, 0, 4), arc(4, 4, 4, 4, 180, 360), line(8, 10, 8, 0)),
    glyph('v', 8.4, line(0, 10, 4.2, 0), line(4.2, 0, 8.4, 10)),
    glyph('w', 12.4, line(0, 10, 3.2, 0), line(3.2, 0, 6.2, 10), line(6.2, 10, 9.2, 0), line(9.2, 0, 12.4, 10)),
    glyph('x', 8, line(0, 10, 8, 0), line(0, 0, 8, 10)),
    glyph('y', 8.6, line(0, 10, 4.4, 0), line(8.6, 10, 2.2, -5)),
    glyph('z', 8, line(0, 10, 8, 10), line(8, 10, 0, 0), line(0, 0, 8, 0)),
    glyph(',', 1.4, line(1.2, 0.6, 0.2, -2.6)),
    glyph('.', 0.4, line(0, 0, 0.4, 0)),
    glyph('-', 5, line(0, 5, 5, 5)),
};
constexpr double digit_height = 14, gap = 3.1, blank_width = 4, stroke_width = 1.55;

const Glyph* find(char c) {
    for (const Glyph& g : glyphs)
        if (g.character == c) return &g;
    return nullptr;
}

double advance(char c) {
    const Glyph* g = find(c);
    return (g ? g->width : blank_width) + gap;
}

}  // namespace

double text_width(std::string_view text, double size) {
    double width = text.empty() ? 0 : -gap;
    for (const char c : text) width += advance(c);
    return width * size / digit_height;
}

void add_text(std::vector<Stroke>& strokes, std::string_view text, double left, double baseline, double size,
              Color color) {
    const double scale = size / digit_height;
    double x = 0;
    const auto place = [&](double px, double py) {
        return glm::vec3(left + scale * (x + px), baseline - scale * py, 0);
    };
    const auto add = [&](const Piece& p) {
        const auto stroke = [&](const glm::vec3& a, const glm::vec3& b) {
            strokes.push_back({a, b, static_cast<float>(stroke_width * scale), color});
        };
        if (p.rx == 0) return stroke(place(p.x, p.y), place(p.from, p.to));
        constexpr double step_degrees = 12;
        const int steps = static_cast<int>(std::ceil(std::abs(p.to - p.from) / step_degrees));
        const auto at = [&](int i) {
            const double a = (p.from + (p.to - p.from) * i / steps) * std::numbers::pi / 180;
            return place(p.x + p.rx * std::cos(a), p.y + p.ry * std::sin(a));
        };
        for (int i = 0; i < steps; ++i) stroke(at(i), at(i + 1));
    };
    for (const char c : text) {
        if (const Glyph* g = find(c))
            for (const Piece& p : std::span(g->pieces, static_cast<std::size_t>(g->count))) add(p);
        x += advance(c);
    }
}

}  // namespace render
