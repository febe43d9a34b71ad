#include "render/app/query/profile_chart.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "render/app/figures.h"

namespace render {
namespace {

// The figure and the area of the plot in it, in pixels.
constexpr double width = 1000, height = 440, left = 84, right = 968, top = 56, bottom = 348;

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (static_cast<unsigned char>(c) >= ' ')
            out += c;
    }
    return out;
}

/// A tick's number, grouped in thousands where the axis has one of five digits; as many decimals as its step needs.
std::string tick_text(double value, const std::vector<double>& axis) {
    const double step = axis.size() > 1 ? axis[1] - axis[0] : 1;
    const int decimals = step >= 1 ? 0 : static_cast<int>(std::ceil(-std::log10(step) - 1e-9));
    if (decimals == 0 && std::max(std::abs(axis.front()), std::abs(axis.back())) >= 1e4)
        return (value < 0 ? "\u2212" : "") + grouped(static_cast<std::size_t>(std::llround(std::abs(value))));
    const std::string text = fixed(value, decimals);
    return text.front() == '-' ? "\u2212" + text.substr(1) : text;
}

struct Scale {
    double low, high, from, to;  // [low, high] onto [from, to]
    double operator()(double v) const { return from + (v - low) / (high - low) * (to - from); }
    double pixels_per_unit() const { return std::abs(to - from) / (high - low); }
};

class Figure {
  public:
    explicit Figure(const ProfileChart& chart) : chart_(chart) {
        const double length = chart.distance.back();
        // A path of no length still has an axis.
        x_ = {0, length > 0 ? length : 1, left, right};
        double low = 0, high = 0;
        for (std::size_t i = 0; i < chart.height.size(); ++i) {
            const double v = drawn(i);
            low = i == 0 ? v : std::min({low, v, bulge(chart.distance[i])});
            high = i == 0 ? v : std::max(high, v);
        }
        if (chart.radius <= 0) {
            low = *std::min_element(chart.height.begin(), chart.height.end());
            if (low > 0 && low < 0.35 * high) low = 0;  // near enough to sea level to start there
        }
        const double room = std::max(0.06 * (high - low), 1.0);
        y_ = {low == 0 ? 0 : low - room, high + room, bottom, top};
    }

    std::string text() {
        out_ =
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 440\" width=\"1000\" height=\"440\" "
            "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#222\">\n"
            "<rect width=\"1000\" height=\"440\" fill=\"#fff\"/>\n";
        ground();
        axes();
        words();
        return out_ + "</svg>\n";
    }

  private:
    static std::string n(double v) { return fixed(v, 2); }
    double bulge(double s) const {
        return chart_.radius > 0 ? s * (chart_.distance.back() - s) / (2 * chart_.radius) : 0;
    }
    double drawn(std::size_t i) const { return chart_.height[i] + bulge(chart_.distance[i]); }

    void line(double x0, double y0, double x1, double y1, const char* style) {
        out_ += "<line x1=\"" + n(x0) + "\" y1=\"" + n(y0) + "\" x2=\"" + n(x1) + "\" y2=\"" + n(y1) + "\" " + style +
                "/>\n";
    }
    void label(double x, double y, const std::string& text, const char* style) {
        out_ += "<text x=\"" + n(x) + "\" y=\"" + n(y) + "\" " + style + ">" + escaped(text) + "</text>\n";
    }

    /// The points of the profile: all, or the extremes of each quarter pixel.
    std::string outline() const {
        std::string path;
        const auto add = [&](std::size_t i) {
            path += (path.empty() ? "M" : "L") + n(x_(chart_.distance[i])) + " " + n(y_(drawn(i)));
        };
        const std::size_t count = chart_.height.size();
        if (count <= 4 * static_cast<std::size_t>(right - left)) {
            for (std::size_t i = 0; i < count; ++i) add(i);
            return path;
        }
        for (std::size_t i = 0; i < count;) {
            const double column = std::floor(4 * x_(chart_.distance[i]));
            std::size_t least = i, most = i;
            for (; i < count && std::floor(4 * x_(chart_.distance[i])) == column; ++i) {
                if (chart_.height[i] < chart_.height[least]) least = i;
                if (chart_.height[i] > chart_.height[most]) most = i;
            }
            add(std::min(least, most));
            if (least != most) add(std::max(least, most));
        }
        return path;
    }

    void ground() {
        const std::string path = outline();
        out_ += "<path d=\"" + path + "L" + n(right) + " " + n(bottom) + "L" + n(left) + " " + n(bottom) +
                "Z\" fill=\"#e7dfd2\"/>\n";
        grid();
        if (chart_.radius > 0) level_line();
        out_ += "<path d=\"" + path +
                "\" fill=\"none\" stroke=\"#5b4426\" stroke-width=\"1.4\" "
                "stroke-linejoin=\"round\"/>\n";
    }

    /// Height 0, curved.
    void level_line() {
        std::string path;
        for (int i = 0; i <= 200; ++i) {
            const double s = chart_.distance.back() * i / 200;
            path += (i == 0 ? "M" : "L") + n(x_(s)) + " " + n(y_(bulge(s)));
        }
        out_ += "<path d=\"" + path + "\" fill=\"none\" stroke=\"#2f6f9f\" stroke-width=\"1\"/>\n";
    }

    void grid() {
        for (const double v : ticks(y_.low, y_.high, 6))
            line(left, y_(v), right, y_(v), "stroke=\"#000\" stroke-opacity=\"0.10\"");
        for (const double s : chart_.corners)
            line(x_(s), top, x_(s), bottom, "stroke=\"#000\" stroke-opacity=\"0.45\" stroke-dasharray=\"3 3\"");
    }

    void axes() {
        line(left, bottom, right, bottom, "stroke=\"#222\"");
        line(left, top, left, bottom, "stroke=\"#222\"");
        const std::vector<double> rows = ticks(y_.low, y_.high, 6);
        for (const double v : rows) {
            line(left - 5, y_(v), left, y_(v), "stroke=\"#222\"");
            label(left - 9, y_(v) + 4.5, tick_text(v, rows), "text-anchor=\"end\"");
        }
        const double unit = x_.high >= 2000 ? 1000 : 1;
        const std::vector<double> columns = ticks(0, x_.high / unit, 10);
        for (const double v : columns) {
            line(x_(v * unit), bottom, x_(v * unit), bottom + 5, "stroke=\"#222\"");
            label(x_(v * unit), bottom + 20, tick_text(v, columns), "text-anchor=\"middle\"");
        }
        label((left + right) / 2, bottom + 42,
              unit > 1 ? "Distance along the ellipsoid (km)" : "Distance along the ellipsoid (m)",
              "text-anchor=\"middle\"");
        out_ += "<text transform=\"translate(22 " + n((top + bottom) / 2) +
                ") rotate(-90)\" text-anchor=\"middle\">Height above " +
                (chart_.radius > 0 ? "the chord" : escaped(chart_.datum)) + " (m)</text>\n";
    }

    void words() {
        label(left, top - 22, chart_.from, "font-weight=\"bold\"");
        label(right, top - 22, chart_.to, "font-weight=\"bold\" text-anchor=\"end\"");
        std::string scale = "Vertical exaggeration " + exaggeration_text();
        if (chart_.radius > 0) scale += "; with the planet's curvature, " + chart_.datum + " in blue";
        label(left, height - 24, scale, "font-size=\"12\" fill=\"#555\"");
        label(right, height - 24, chart_.note, "font-size=\"12\" fill=\"#555\" text-anchor=\"end\"");
    }

    std::string exaggeration_text() const {
        const double e = y_.pixels_per_unit() / x_.pixels_per_unit();
        return fixed(e, e < 10 ? 1 : 0) + "\u00d7";
    }

    const ProfileChart& chart_;
    Scale x_{}, y_{};
    std::string out_;
};

}  // namespace

std::vector<double> ticks(double low, double high, int most) {
    assert(high > low && most >= 1);
    const double raw = (high - low) / most, power = std::pow(10, std::floor(std::log10(raw)));
    double step = 10 * power;
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= raw * (1 - 1e-9)) {
            step = factor * power;
            break;
        }
    std::vector<double> list;
    for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push_back(k * step + 0.0);
    return list;
}

std::string svg_of(const ProfileChart& chart) {
    assert(chart.distance.size() >= 2 && chart.distance.size() == chart.height.size());
    return Figure(chart).text();
}

}  // namespace render
