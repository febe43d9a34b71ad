#pragma once
// Small meshes whose every triangle, side and gate is known, and what their pictures are asked.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "planet/error.h"
#include "planet/mesh/smooth_ellipsoid.h"
#include "render/gl/context.h"
#include "render/picture/mesh_figure.h"
#include "render/picture/mesh_picture.h"

namespace render::testing {

using glm::dvec2;
using glm::dvec3;

struct Mesh {
    std::vector<dvec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint8_t> level;

    MeshPicture picture(int size) const {
        MeshPicture p{.vertices = vertices, .triangles = triangles, .level = level};
        p.width = p.height = size;
        return p;
    }
    dvec3 middle(std::size_t t) const {
        const auto& [a, b, c] = triangles[t];
        return (vertices[a] + vertices[b] + vertices[c]) / 3.0;
    }
};

/// The square 0..64 by 0..64 bisected in the order of the Sierpinski curve. `split` is asked with the split vertex.
class Bisection {
  public:
    using Split = std::function<bool(const glm::ivec2&, int level)>;

    static Mesh of(const Split& split) {
        Bisection b(split);
        b.cell({64, 0}, {0, 0}, {64, 64}, 0);
        b.cell({0, 64}, {64, 64}, {0, 0}, 0);
        return b.mesh_;
    }
    static Mesh uniform(int finest) {
        return of([=](const glm::ivec2&, int level) { return level < finest; });
    }
    /// Level 2 to 6, the higher the nearer to (0, 0). The radii shrink by more than a child's vertex is away from its
    /// parent's, so the test is nested and the mesh conforming.
    static Mesh adaptive() {
        return of([](const glm::ivec2& m, int level) {
            const double split_side = 64 * std::sqrt(2.0) / std::pow(2, 0.5 * level);
            return level < 6 && std::hypot(m.x, m.y) <= 1.3 * split_side;
        });
    }

  private:
    explicit Bisection(const Split& split) : split_(split) {}

    void cell(const glm::ivec2& apex, const glm::ivec2& left, const glm::ivec2& right, int level) {
        const glm::ivec2 m = (left + right) / 2;
        if (split_(m, level)) {
            cell(m, left, apex, level + 1);
            cell(m, apex, right, level + 1);
            return;
        }
        mesh_.triangles.push_back({vertex(apex), vertex(left), vertex(right)});
        mesh_.level.push_back(static_cast<std::uint8_t>(level));
    }
    std::uint32_t vertex(const glm::ivec2& p) {
        const auto [place, is_new] =
            numbers_.try_emplace({p.x, p.y}, static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (is_new) mesh_.vertices.emplace_back(p, 0);
        return place->second;
    }

    const Split& split_;
    Mesh mesh_;
    std::map<std::pair<int, int>, std::uint32_t> numbers_;
};

inline Mesh planet_mesh(int level) {
    planet::SmoothEllipsoid source(planet::wgs84);
    source.refine_to_level(level);
    Mesh mesh;
    for (const planet::GridPosition& v : source.vertices()) mesh.vertices.push_back(planet::ecef_from_grid(v));
    const auto strip = source.strip();
    for (std::size_t i = 0; i + 2 < strip.size(); ++i) {
        const std::uint32_t a = strip[i], b = strip[i + 1], c = strip[i + 2];
        if (a != b && b != c && a != c) mesh.triangles.push_back({a, i & 1 ? c : b, i & 1 ? b : c});
    }
    mesh.level.assign(mesh.triangles.size(), static_cast<std::uint8_t>(level));
    return mesh;
}

inline Color pixel(const planet::Image& image, int x, int y) {
    const std::uint8_t* p = image.pixel(x, y);
    return {p[0], p[1], p[2]};
}
inline Color pixel(const planet::Image& image, const MeshPicture& picture, const dvec3& place) {
    const glm::vec3 p = make_mesh_view(picture).place(place);
    return pixel(image, static_cast<int>(p.x), static_cast<int>(p.y));
}
/// Relative luminance of sRGB, 0..1.
inline double luminance(Color c) {
    const auto linear = [](std::uint8_t v) { return std::pow(v / 255.0, 2.2); };
    return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}
inline bool reddish(Color c) {
    return c.red > c.green + 90 && c.red > c.blue + 60;
}
inline int count(const planet::Image& image, const std::function<bool(Color)>& test) {
    int n = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) n += test(pixel(image, x, y));
    return n;
}

class MeshPictures : public ::testing::Test {
  protected:
    void SetUp() override {
        try {
            context_.emplace(Context::create());
        } catch (const planet::Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
    void TearDown() override {
        if (!context_) return;
        EXPECT_EQ(take_gl_errors(), "");
    }
    std::optional<Context> context_;
};

}  // namespace render::testing
