#include "render/app/tin/tin_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/tin/triangle_scan.h"
#include "render/app/temporary_names.h"
#include "render/picture/stroke_coverage.h"
#include "render/picture/stroke_text.h"

namespace render {
namespace {

// Pixels.
constexpr double panel_area = 760 * 480;
constexpr int margin = 56, gutter = 40, caption_height = 92, footer_height = 22;
constexpr double text_size = 21, small_text_size = 17;
constexpr float side_width = 1.25f;

constexpr Color side_color{214, 236, 255}, ring_color{255, 255, 255}, ring_casing{8, 10, 24}, no_data{226, 229, 235};

/// From lightness 0..1 (0.5: half as light to the eye), chroma and hue in degrees. (Ottosson, "A perceptual color space
/// for image processing", 2020.)
Color from_oklab(double lightness, double chroma, double hue) {
    const double a = chroma * std::cos(hue * std::numbers::pi / 180),
                 b = chroma * std::sin(hue * std::numbers::pi / 180);
    const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    const auto encoded = [](double linear) {
        const double x = std::clamp(linear, 0.0, 1.0);
        const double v = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
        return static_cast<std::uint8_t>(255 * v + 0.5);
    };
    return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
            encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
            encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 255};
}

/// From night blue over red to pale yellow, the lightness even. @param t 0..1
Color deviation_color(double t) {
    return from_oklab(0.17 + 0.79 * t, 0.055 + 0.125 * std::sin(std::numbers::pi * std::pow(t, 0.85)), 275 + 185 * t);
}

Color height_color(double t) {
    return from_oklab(0.2 + 0.77 * std::pow(t, 0.7), 0, 0);
}

/// A tenth of a metre below 100 m, rounded up: nothing that is said to be within is beyond.
std::string metres(double value) {
    char text[32];
    if (value < 100)
        std::snprintf(text, sizeof text, "%.1f m", std::ceil(10 * value - 1e-6) / 10);
    else
        std::snprintf(text, sizeof text, "%.0f m", std::ceil(value - 1e-6));
    return text;
}

double achieved_deviation(const planet::TinMesh& mesh, const planet::HeightGrid& grid) {
    double largest = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const planet::SortedTriangle t({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                       {mesh.height[a], mesh.height[b], mesh.height[c]});
        largest = std::max(largest, planet::worst_sample<double>(grid, t).deviation);
    }
    return largest;
}

struct PanelSize {
    int width, height;
};

PanelSize panel_size(const planet::HeightGrid& grid, glm::dvec2 shape) {
    const double aspect = std::clamp(grid.width() * shape.x / (grid.height() * shape.y), 0.2, 5.0);
    return {static_cast<int>(std::lround(std::sqrt(panel_area * aspect))),
            static_cast<int>(std::lround(std::sqrt(panel_area / aspect)))};
}

/// By pixel of a panel, in rows: the mean of value(sample) in it, those that are NaN apart; NaN if all are.
template <class Value>
std::vector<float> panel_means(const planet::HeightGrid& grid, PanelSize size, const Value& value) {
    const auto range = [](int pixel, int pixels, int samples) {
        const int first = static_cast<int>(std::int64_t{pixel} * samples / pixels);
        return std::pair(first, std::max(first + 1, static_cast<int>(std::int64_t{pixel + 1} * samples / pixels)));
    };
    std::vector<float> means;
    means.reserve(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const auto [left, right] = range(x, size.width, grid.width());
            const auto [top, bottom] = range(y, size.height, grid.height());
            double sum = 0;
            int count = 0;
            for (int j = top; j < bottom; ++j)
                for (int i = left; i < right; ++i) {
                    const double v = value(glm::ivec2(i, j));
                    if (std::isnan(v)) continue;
                    sum += v;
                    ++count;
                }
            means.push_back(static_cast<float>(sum / count));
        }
    return means;
}

/// What a panel needs of a stage, whose grid is as large as the raster.
struct Step {
    planet::TinMesh mesh;
    std::vector<float> deviation;  ///< panel_means(), metres
    glm::ivec2 inserted;
    double deviation_before;  ///< largest, metres
};

struct Layout {
    PanelSize panel_size;
    int columns = 1, rows = 1;

    int width() const { return 2 * margin + columns * panel_size.width + (columns - 1) * gutter; }
    int height() const { return 2 * margin + rows * (panel_size.height + caption_height) + footer_height; }
    PixelBox panel(int i) const {
        const auto left = static_cast<float>(margin + i % columns * (panel_size.width + gutter));
        const auto top = static_cast<float>(margin + i / columns * (panel_size.height + caption_height));
        return {left, top, left + static_cast<float>(panel_size.width), top + static_cast<float>(panel_size.height)};
    }
};

/// Wide sheets with few panels missing.
Layout make_layout(int panels, PanelSize size) {
    Layout best{size};
    double least = std::numeric_limits<double>::max();
    for (int columns = 1; columns <= panels; ++columns) {
        const Layout layout{size, columns, (panels - 1) / columns + 1};
        const int missing = layout.rows * columns - panels;
        const double badness = std::abs(std::log(layout.width() / (1.7 * layout.height()))) + 2.5 * missing / panels;
        if (badness >= least) continue;
        least = badness;
        best = layout;
    }
    return best;
}

class Sheet {
  public:
    Sheet(const planet::HeightGrid& grid, glm::dvec2 shape, int panels)
        : grid_(grid),
          shape_(shape),
          layout_(make_layout(panels, panel_size(grid, shape))),
          image_{layout_.width(), layout_.height(), 3, {}},
          strokes_(layout_.width(), layout_.height()) {
        image_.pixels.assign(image_.row_size() * static_cast<std::size_t>(image_.height), 255);
    }

    void add_heights() {
        float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
        for (int y = 0; y < grid_.height(); ++y)
            for (int x = 0; x < grid_.width(); ++x)
                if (grid_.valid({x, y})) {
                    low = std::min(low, grid_.at({x, y}));
                    high = std::max(high, grid_.at({x, y}));
                }
        const double range = std::max(1e-9, static_cast<double>(high) - static_cast<double>(low));
        fill(panel_means(grid_, layout_.panel_size,
                         [&](glm::ivec2 p) { return relief(p, static_cast<double>(low), range); }),
             1, height_color);
        caption(std::to_string(grid_.width()) + " by " + std::to_string(grid_.height()) + " samples");
        bar(height_color, metres(static_cast<double>(low)), metres(static_cast<double>(high)));
        next();
    }

    void add_step(const Step& step) {
        fill(step.deviation, std::max(1e-9, step.deviation_before), deviation_color);
        draw_sides(step.mesh);
        draw_ring(step.inserted);
        caption(std::to_string(step.mesh.triangles.size()) + " triangles, within " +
                metres(achieved_deviation(step.mesh, grid_)));
        bar(deviation_color, "0", metres(step.deviation_before));
        next();
    }

    planet::Image take() {
        text("colours show the deviation before the last vertex went in, the one in the ring", margin,
             image_.height - margin + 6, small_text_size);
        strokes_.paint(image_, figure_color::ink);
        return std::move(image_);
    }

  private:
    PixelBox box() const { return layout_.panel(panel_); }
    void next() { ++panel_; }

    /// A sample's place in the current panel: samples are the middles of what they stand for.
    glm::vec3 place(glm::ivec2 sample) const {
        const PixelBox b = box();
        const glm::vec2 at = (glm::vec2(sample) + 0.5f) / glm::vec2(grid_.width(), grid_.height());
        return {b.left + at.x * (b.right - b.left), b.top + at.y * (b.bottom - b.top), 0};
    }

    /// Paints the current panel. @param largest value, of the end of the scale
    void fill(const std::vector<float>& values, double largest, Color (*color)(double)) {
        std::array<Color, 1024> colors;
        for (std::size_t i = 0; i < colors.size(); ++i) colors[i] = color(static_cast<double>(i) / 1023);
        const int left = static_cast<int>(box().left), top = static_cast<int>(box().top);
        auto value = values.begin();
        for (int y = 0; y < layout_.panel_size.height; ++y)
            for (int x = 0; x < layout_.panel_size.width; ++x, ++value) {
                const double t = std::clamp(static_cast<double>(*value) / largest, 0.0, 1.0);
                set_pixel(left + x, top + y,
                          std::isnan(*value) ? no_data : colors[static_cast<std::size_t>(1023 * t + 0.5)]);
            }
    }

    void set_pixel(int x, int y, Color c) {
        std::uint8_t* p =
            image_.pixels.data() + static_cast<std::size_t>(y) * image_.row_size() + static_cast<std::size_t>(3 * x);
        p[0] = c.red;
        p[1] = c.green;
        p[2] = c.blue;
    }

    /// 0..1: height, and the slope in light from the north-west.
    double relief(glm::ivec2 p, double low, double range) const {
        const glm::ivec2 end(grid_.width() - 1, grid_.height() - 1);
        const auto height = [&](glm::ivec2 q) {
            return static_cast<double>(grid_.at(glm::clamp(q, glm::ivec2(0), end)));
        };
        const double slope = (height(p + 1) - height(p - 1)) / (2 * std::hypot(shape_.x, shape_.y));
        const double light = std::isnan(slope) ? 0 : -slope / std::sqrt(1 + slope * slope);
        return 0.06 + 0.84 * (height(p) - low) / range + 0.5 * light;
    }

    void draw_sides(const planet::TinMesh& mesh) {
        strokes_.clip(box());
        for (const auto& t : mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k)
                strokes_.add({place(mesh.vertices[t[k]]), place(mesh.vertices[t[(k + 1) % 3]]), side_width, {}});
        // Fainter where there are so many that they would hide the colours.
        const double many = static_cast<double>(mesh.triangles.size()) / 600;
        strokes_.paint(image_, with_alpha(side_color, std::clamp(0.6 / std::sqrt(many), 0.25, 0.6)));
        strokes_.clip(whole());
    }

    void draw_ring(glm::ivec2 sample) {
        constexpr int pieces = 48;
        constexpr float radius = 11;
        const glm::vec3 middle = place(sample);
        const auto at = [&](int i) {
            const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / pieces;
            return middle + radius * glm::vec3(std::cos(angle), std::sin(angle), 0);
        };
        for (const auto& [width, color] : {std::pair{6.0f, ring_casing}, std::pair{2.8f, ring_color}}) {
            for (int i = 0; i < pieces; ++i) strokes_.add({at(i), at(i + 1), width, {}});
            strokes_.paint(image_, color);
        }
    }

    PixelBox whole() const { return {0, 0, static_cast<float>(image_.width), static_cast<float>(image_.height)}; }

    void text(std::string_view words, double left, double baseline, double size) {
        std::vector<Stroke> strokes;
        add_text(strokes, words, left, baseline, size, {});
        strokes_.add(strokes);
    }

    void caption(std::string_view words) {
        text(words, static_cast<double>(box().left), static_cast<double>(box().bottom) + 34, text_size);
        strokes_.paint(image_, figure_color::ink);
    }

    /// A scale, with what its ends stand for.
    void bar(Color (*color)(double), std::string_view low, std::string_view high) {
        constexpr int length = 240, thickness = 12;
        const double baseline = static_cast<double>(box().bottom) + 66;
        double x = static_cast<double>(box().left);
        text(low, x, baseline, small_text_size);
        x += text_width(low, small_text_size) + 12;
        const int left = static_cast<int>(std::lround(x)), top = static_cast<int>(baseline) - thickness - 1;
        for (int i = 0; i < length; ++i)
            for (int j = 0; j < thickness; ++j) set_pixel(left + i, top + j, color(i / (length - 1.0)));
        text(high, left + length + 12, baseline, small_text_size);
        strokes_.paint(image_, figure_color::ink);
    }

    const planet::HeightGrid& grid_;
    const glm::dvec2 shape_;
    const Layout layout_;
    planet::Image image_;
    StrokeCoverage strokes_;
    int panel_ = 0;
};

void check(const std::vector<std::size_t>& stages) {
    using planet::Error;
    using planet::Fault;
    if (stages.empty() || stages.size() > most_stages)
        throw Error(Fault::bad_usage, "--stages", std::to_string(stages.size()) + " numbers of triangles",
                    "1 to " + std::to_string(most_stages));
    if (stages.front() < 3)
        throw Error(Fault::bad_usage, "--stages", std::to_string(stages.front()) + " triangles", "3 or more");
}

}  // namespace

glm::dvec2 metres_per_sample(const planet::RasterFrame& source) {
    const glm::dvec2 unit = source.metres_per_unit();
    return {glm::length(source.grid().per_column * unit), glm::length(source.grid().per_row * unit)};
}

planet::Image draw_tin_steps(const planet::HeightGrid& grid, glm::dvec2 shape, planet::TinOptions options,
                             std::vector<std::size_t> stages) {
    std::ranges::sort(stages);
    stages.erase(std::unique(stages.begin(), stages.end()), stages.end());
    check(stages);
    const PanelSize size = panel_size(grid, shape);
    const auto width = static_cast<std::size_t>(grid.width());
    std::vector<Step> steps;
    options.quality = planet::TinQuality::fast;
    options.stages = stages;
    options.max_triangles = stages.back();
    options.at_stage = [&](planet::TinStage&& stage) {
        const auto deviation = [&](glm::ivec2 p) {
            return static_cast<double>(
                stage.deviation[static_cast<std::size_t>(p.y) * width + static_cast<std::size_t>(p.x)]);
        };
        steps.push_back(
            {std::move(stage.mesh), panel_means(grid, size, deviation), stage.inserted, stage.deviation_max});
    };
    make_tin(grid, options);
    if (steps.empty())
        throw planet::Error(planet::Fault::bad_usage, "--stages", "no such number of triangles is on the way",
                            "numbers between those of the start and of the end");
    Sheet sheet(grid, shape, static_cast<int>(steps.size()) + 1);
    sheet.add_heights();
    for (const Step& step : steps) sheet.add_step(step);
    return sheet.take();
}

void write_tin_steps(const planet::HeightGrid& grid, glm::dvec2 shape, const planet::TinOptions& options,
                     const std::vector<std::size_t>& stages, const std::string& path) {
    planet::write_image(path, draw_tin_steps(grid, shape, options, stages), {.make_file = make_listed});
}

}  // namespace render
