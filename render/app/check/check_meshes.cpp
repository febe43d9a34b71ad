#include <cmath>
#include <random>

#include "planet/geodesy/ellipsoid.h"
#include "planet/mesh/refine.h"
#include "planet/mesh/surface_check.h"
#include "planet/store/store_field.h"
#include "planet/streaming/store_tiles.h"
#include "render/app/check/check_parts.h"
#include "render/app/picture/earth_store.h"
#include "render/picture/camera.h"

namespace render {
namespace {

struct Eye {
    double latitude, longitude;  // degrees
    double height;               // m above the ellipsoid
};

std::vector<Eye> eyes() {
    // Poles, the four E_i (one on the antimeridian), the antimeridian in the middle of a face, the finest data.
    std::vector<Eye> list{{90, 0, 5e3},      {-90, 0, 50e3},     {0, 0, 5e3},     {0, 90, 500e3},       {0, 180, 20e3},
                          {0, -90, 20000e3}, {-16.5, 180, 10e3}, {62, -180, 2e3}, {37.58, -105.49, 6e3}};
    std::mt19937_64 engine(1);
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    constexpr std::size_t count = 16;
    while (list.size() < count) {
        const double latitude = std::asin(2 * uniform() - 1) / planet::degrees, longitude = 360 * uniform() - 180;
        list.push_back({latitude, longitude, std::exp2(uniform() * 11) * 10e3});  // 10 km to 20,000 km
    }
    return list;
}

planet::SplitTest test_of(const Eye& eye) {
    constexpr int width = 1920, height = 1080;
    constexpr double deviation = 2;  // pixels: meshes of some 100,000 triangles
    const double focal_px = focal_length_px(40 * planet::degrees, width, height);
    const glm::dvec3 normal =
        planet::normal_from_geodetic(eye.latitude * planet::degrees, eye.longitude * planet::degrees);
    return {planet::ecef_from_normal(planet::wgs84, normal, {eye.height}),
            planet::split_reach(focal_px, std::hypot(0.5 * width, 0.5 * height) / focal_px, deviation)};
}

}  // namespace

CheckPart check_meshes(const std::function<void(std::string_view, double)>& progress) {
    const EarthSources sources;
    LazyEarth earth(sources);
    ChecksumIndex index = user_checksum_index();
    const planet::StoreField field(open_earth_store(sources, earth, index, progress));
    index.save();
    const planet::StoreTiles tiles(field.cache(), {field.store().metadata().ellipsoid, 1});

    planet::SurfaceCheck sum;
    std::size_t open_sides = 0, wrong_strips = 0, wrong_euler = 0;
    const std::vector<Eye> list = eyes();
    for (const Eye& eye : list) {
        const planet::SurfaceCheck mesh = planet::check(planet::refine_planet(tiles, test_of(eye)));
        sum.triangles += mesh.triangles;
        open_sides += mesh.border_sides + mesh.wrong_sides;
        sum.doubled_vertices += mesh.doubled_vertices;
        sum.degenerate += mesh.degenerate;
        sum.unused_vertices += mesh.unused_vertices;
        sum.turned += mesh.turned;
        wrong_strips += !mesh.strips_match;
        wrong_euler += mesh.euler() != 2;
    }
    const auto row = [](std::string name, std::size_t count) {
        return planet::check_row(std::move(name), static_cast<double>(count), 0, "1");
    };
    const auto triangles = static_cast<double>(sum.triangles);
    return {{planet::check_row("mesh triangles checked (whole planet, " + std::to_string(list.size()) + " views)",
                               triangles, triangles, "1"),
             row("mesh sides without exactly two triangles", open_sides),
             row("mesh vertices twice at one place", sum.doubled_vertices),
             row("mesh vertices without a triangle", sum.unused_vertices),
             row("mesh triangles with a corner twice", sum.degenerate),
             row("mesh triangles that face inwards", sum.turned), row("meshes where V - E + F is not 2", wrong_euler),
             row("meshes whose strip is not their triangles", wrong_strips),
             row("damaged elevation tiles met", field.cache().damage().size())},
            {}};
}

}  // namespace render
