// The certificate of a picture, by brute force: at every vertex of the finest lattice below a drawn triangle
//   metres   the triangle's plane passes it, along the geodetic normal, within the report's deviation_max_m
//   pixels   where the picture shows it, the drawn surface is within max_pixel_deviation of it, and within what the
//            report says was achieved
// Nothing of the library's deviations, radii and tests is used, but that a vertex exists where its deviation is not 0.

#include <gtest/gtest.h>

#include <unordered_map>

#include "planet/bake/bake.h"
#include "planet/elevation/layered_field.h"
#include "planet/elevation/raster_field.h"
#include "planet/geodesy/geoid.h"
#include "render/app/data_path.h"
#include "tests/render/app/earth_views.h"
#include "tests/render/app/segment_triangles.h"

namespace render {
namespace {

using namespace testing;

// The corners of a drawn triangle are rounded to the grid, half a step a coordinate; steep planes pass that on.
constexpr double rounding_m = 1e-4;

/// The shipped data thinned out, so that every vertex can be looked at: relief every 83 km, the Sangre de Cristo every
/// 280 m.
std::shared_ptr<const planet::ElevationStore> bake_thinned() {
    const auto layer = [](const char* file, std::int64_t samples) {
        planet::RasterOptions options;
        options.max_samples = samples;
        options.reduce = true;
        return planet::open_raster_field(data_file(file), planet::VerticalDatum::egm96, options);
    };
    const std::vector<std::shared_ptr<const planet::ElevationField>> layers{layer("etopo5.tif", 480 * 240),
                                                                            layer("sangre_de_cristo.tif", 801 * 401)};
    const planet::LayeredField field(layers, planet::VerticalDatum::egm96);
    const auto geoid = std::make_shared<planet::Geoid>(data_file("egm96-15.pgm"));
    planet::BakeOptions options;
    options.undulation = [geoid](auto normals, auto out) { geoid->undulations(normals, out); };
    return std::make_shared<planet::ElevationStore>(planet::bake_in_memory(field, options));
}

/// All finest vertices at their true heights.
class FinestLattice {
  public:
    FinestLattice(const planet::ElevationStore& store, double exaggeration) : layers_(store.metadata().layers) {
        const planet::Placement placement{store.metadata().ellipsoid, exaggeration};
        for (const planet::LocationCode root : store.tiles()) {
            Tile& t = tiles_[root.bits()];
            t.tile = *store.read(root);
            t.normal = planet::tile_normals(root, t.tile.depth);
            for (std::size_t v = 0; v < t.normal.size(); ++v)
                t.position.push_back(
                    placement.ecef(t.normal[v], static_cast<double>(t.tile.height[v]),
                                   t.tile.undulation.empty() ? planet::GeoidUndulation{} : t.tile.undulation[v]));
        }
    }

    /// Calls visit(position, normal) for every vertex in a cell but its corners, those on its sides included.
    template <class Visit>
    void visit_below(planet::LocationCode cell, Visit&& visit) const {
        // Of two tiles that hold the cell as a corner, the upper one.
        const int level = cell.bisection_level();
        const int in_tile = level == 0 ? 0 : level - layers_.root_level(level - 1);
        const Tile& t = tiles_.at(cell.bits() >> in_tile);
        this->visit(t, static_cast<unsigned>(cell.bits() & ((1u << in_tile) - 1)) | 1u << in_tile, visit);
    }

  private:
    struct Tile {
        planet::Tile tile;
        std::vector<glm::dvec3> normal, position;  // by vertex index
    };

    template <class Visit>
    void visit(const Tile& t, unsigned i, Visit&& visit_vertex) const {
        if (i >> t.tile.depth) {
            if (const unsigned k = i - (1u << t.tile.depth); t.tile.child_exists[k])
                visit(tiles_.at(layers_.below(t.tile.root, k).bits()), 1, visit_vertex);
            return;
        }
        if (!(t.tile.deviation[i] > 0)) return;
        const std::size_t v = planet::tile_layout().split_vertex[i];
        visit_vertex(t.position[v], t.normal[v]);
        visit(t, 2 * i, visit_vertex);
        visit(t, 2 * i + 1, visit_vertex);
    }

    planet::TileLayers layers_;
    std::unordered_map<std::uint64_t, Tile> tiles_;
};

/// The largest deviations found in a view.
struct Found {
    std::size_t vertices = 0, in_picture = 0;
    double metres = 0, pixels = 0;
};

/// Pixels from the middle of the picture; the definition of a pinhole camera, without its matrices.
glm::dvec2 pixel_of(const Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 v = camera.view_from_ecef * (point - camera.eye);
    return glm::dvec2(v) * (camera.focal_px / -v.z);
}

bool is_in_picture(const Camera& camera, const glm::dvec3& point) {
    const glm::dvec3 v = camera.view_from_ecef * (point - camera.eye);
    return v.z < 0 && std::fabs(v.x) * camera.focal_px <= -v.z * 0.5 * camera.width &&
           std::fabs(v.y) * camera.focal_px <= -v.z * 0.5 * camera.height;
}

Found measure(const planet::Segments& segments, const FinestLattice& lattice, const Camera& camera) {
    Found found;
    for (const SegmentTriangle& t : triangles_of(segments)) {
        glm::dvec3 a[3];
        for (std::size_t k = 0; k < 3; ++k) a[k] = planet::ecef_from_grid(segments.vertices()[t.vertex[k]].position);
        const glm::dvec3 normal = glm::cross(a[1] - a[0], a[2] - a[0]);
        lattice.visit_below(t.leaf, [&](const glm::dvec3& p, const glm::dvec3& n) {
            const double above = glm::dot(a[0] - p, normal) / glm::dot(n, normal);
            ++found.vertices;
            found.metres = std::max(found.metres, std::fabs(above));
            if (!is_in_picture(camera, p)) return;
            ++found.in_picture;
            found.pixels = std::max(found.pixels, glm::distance(pixel_of(camera, p), pixel_of(camera, p + above * n)));
        });
    }
    return found;
}

TEST(DeviationBound, HoldsAtEveryVertexOfTheFinestLattice) {
    constexpr struct {
        double factor;
        std::size_t views;
    } exaggerations[] = {{1, 52}, {5, 52}, {0.3, 10}, {30, 10}};
    constexpr double limits[] = {0.5, 1, 4};
    const auto store = bake_thinned();
    std::size_t vertices = 0, in_picture = 0;
    double nearest_metres = 0, nearest_pixels = 0;
    planet::Segments segments;
    for (const auto [exaggeration, count] : exaggerations) {
        const ExaggeratedEarth earth(store, exaggeration);
        const FinestLattice lattice(*store, exaggeration);
        EarthViews views(640, 480, 11, 140);
        for (std::size_t i = 0; i < count; ++i) {
            const EarthView view = views.next(earth);
            const double limit = limits[i % std::size(limits)];
            segments.build(earth.tiles(), segment_view(view.camera, earth.ball(), limit), 2);
            const Found found = measure(segments, lattice, view.camera);
            EXPECT_LE(found.metres, segments.deviation_max_m() + rounding_m)
                << "view " << i << ", exaggeration " << exaggeration;
            EXPECT_LE(found.pixels, std::min(1.0, segments.ratio_max() * (1 + 1e-3)) * limit)
                << "view " << i << ", exaggeration " << exaggeration;
            vertices += found.vertices;
            in_picture += found.in_picture;
            nearest_metres = std::max(nearest_metres, found.metres / std::max(segments.deviation_max_m(), 1e-3));
            nearest_pixels = std::max(nearest_pixels, found.pixels / limit);
        }
    }
    // The views are worth their name: many vertices, and some that use up what is certified.
    EXPECT_GT(vertices, 20000000u);
    EXPECT_GT(in_picture, 10000000u);
    EXPECT_GT(nearest_metres, 0.99);
    EXPECT_GT(nearest_pixels, 0.75);
}

}  // namespace
}  // namespace render
