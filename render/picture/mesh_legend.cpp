#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "render/picture/mesh_figure.h"
#include "render/picture/stroke_text.h"

namespace render {
namespace {

// Lengths in figure units.
constexpr double text_size = 13, swatch_height = 26, widest_swatch = 30, number_below = 24, gap = 14, group_gap = 46;
constexpr double least_spacing = 5, legend_mark = 7;
constexpr double legend_middle = 52;  ///< below the plot

/// Builds the legend from left to right. Run once to measure and once to draw.
class Row {
  public:
    Row(double unit, double line_unit, double left, double middle)
        : unit_(unit), line_unit_(line_unit), x_(left), middle_(middle) {}

    void text(std::string_view words) {
        add_text(legend_.strokes, words, x_, middle_ + 0.5 * 10.0 / 14 * text_size * unit_, text_size * unit_,
                 figure_color::ink);
        x_ += text_width(words, text_size * unit_);
    }
    void skip(double units) { x_ += units * unit_; }

    /// A strip of triangles, one for each value, numbered below.
    void strip(const MeshColors& colors, double spacing) {
        const double s = spacing * unit_, h = 0.5 * std::min(swatch_height * unit_, s);
        const int every = static_cast<int>(std::ceil(widest_number(colors.last()) / std::max(s, unit_)));
        for (int value = colors.first(); value <= colors.last(); ++value) {
            const bool up = (value - colors.first()) % 2 == 0;
            const double base = up ? middle_ + h : middle_ - h, tip = up ? middle_ - h : middle_ + h;
            swatch({glm::vec3(x_, base, 0), glm::vec3(x_ + s, tip, 0), glm::vec3(x_ + 2 * s, base, 0)},
                   colors.of(value));
            if ((value - colors.first()) % every == 0) number(value, x_ + s, h);
            x_ += s;
        }
        x_ += s;
    }
    void curve(Color color) {
        const double width = 34 * unit_;
        for (int i = 0; i < 24; ++i) {
            const auto at = [&](int k) {
                return glm::vec3(x_ + width * k / 24, middle_ + 5 * unit_ * std::cos(k * std::numbers::pi / 6), 0);
            };
            line(at(i), at(i + 1), curve_width * line_unit_, color);
        }
        x_ += width;
    }
    void dot(double radius, Color fill) {
        const double r = radius * line_unit_;
        const glm::vec3 p(x_ + r, middle_, 0);
        line(p, p, 2 * r, fill == figure_color::paper ? figure_color::ink : fill);
        if (fill == figure_color::paper) line(p, p, 2 * (r - ring_width * line_unit_), fill);
        x_ += 2 * r;
    }

    double x() const { return x_; }
    Legend take() { return std::move(legend_); }

  private:
    double widest_number(int value) const { return text_width(std::to_string(value), text_size * unit_) + 7 * unit_; }
    void line(const glm::vec3& a, const glm::vec3& b, double width, Color color) {
        legend_.strokes.push_back({a, b, static_cast<float>(width), color});
    }
    void swatch(const std::array<glm::vec3, 3>& corners, Color color) {
        for (const glm::vec3& c : corners) legend_.swatches.push_back({c, with_alpha(color, 0)});
        for (std::size_t k = 0; k < 3; ++k) line(corners[k], corners[(k + 1) % 3], 1.1 * line_unit_, figure_color::ink);
    }
    void number(int value, double x, double half) {
        const std::string digits = std::to_string(value);
        add_text(legend_.strokes, digits, x - 0.5 * text_width(digits, text_size * unit_),
                 middle_ + half + number_below * unit_, text_size * unit_, figure_color::ink);
    }

    double unit_, line_unit_, x_, middle_;
    Legend legend_;
};

void fill(Row& row, const MeshPicture& picture, const MeshColors& colors, bool has_curve, double spacing) {
    bool first = true;
    const auto next = [&] {
        if (!first) row.skip(group_gap);
        first = false;
    };
    if (colors.last() >= colors.first()) {
        next();
        row.text(colors.steps() ? "merging step" : "bisection level");
        row.skip(gap);
        row.strip(colors, spacing);
    }
    if (!picture.marks.empty()) {
        next();
        row.dot(legend_mark, figure_color::ink);
        row.skip(0.7 * gap);
        row.text("removed");
    }
    if (picture.marks.size() > 1) {
        next();
        row.dot(other_mark, figure_color::paper);
        row.skip(0.7 * gap);
        row.text("removed with it");
    }
    if (has_curve) {
        next();
        row.curve(colors.steps() ? figure_color::curve_over_steps : figure_color::curve);
        row.skip(0.7 * gap);
        row.text("strip");
    }
}

/// Around a plot that the mesh goes beyond.
void add_frame(std::vector<Stroke>& strokes, const MeshView& view) {
    const PixelBox& p = view.plot;
    const glm::vec3 corners[] = {
        {p.left, p.top, 0}, {p.right, p.top, 0}, {p.right, p.bottom, 0}, {p.left, p.bottom, 0}};
    for (std::size_t k = 0; k < 4; ++k)
        strokes.push_back(
            {corners[k], corners[(k + 1) % 4], static_cast<float>(1.2 * view.line_unit), figure_color::ink});
}

}  // namespace

Legend make_legend(const MeshPicture& picture, const MeshView& view, const MeshColors& colors, bool has_curve) {
    Legend framed;
    if (picture.window) add_frame(framed.strokes, view);
    if (!has_legend(picture)) return framed;
    const double room = view.plot.right - view.plot.left;
    const auto width = [&](double spacing) {
        Row row(view.legend_unit, view.line_unit, 0, 0);
        fill(row, picture, colors, has_curve, spacing);
        return row.x();
    };
    // What does not depend on the spacing of the swatches is measured with none.
    const double count = std::max(colors.last() - colors.first() + 2, 1);
    const double spacing = std::clamp((room - width(0)) / view.legend_unit / count, least_spacing, widest_swatch);
    const double fit = std::min(1.0, room / width(spacing));
    Row row(fit * view.legend_unit, fit * view.line_unit, 0.5 * (picture.width - fit * width(spacing)),
            view.plot.bottom + legend_middle * view.legend_unit);
    fill(row, picture, colors, has_curve, spacing);
    Legend legend = row.take();
    legend.strokes.insert(legend.strokes.end(), framed.strokes.begin(), framed.strokes.end());
    return legend;
}

}  // namespace render
