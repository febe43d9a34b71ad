// octaglobe query area: of polygons whose sides are geodesics, and of the ground in them.

#include <iostream>

#include "planet/elevation/features.h"
#include "planet/error.h"
#include "planet/terrain/ground_area.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/query/query.h"
#include "render/app/source_report.h"

namespace render {
namespace {

using planet::degrees;
using planet::Error;
using planet::Fault;
using planet::Geodetic;

struct Options {
    std::vector<std::string> input;
    bool on_terrain = false;
    std::string json;
    GroundOptions ground;
};

struct Polygons {
    planet::Rings rings;
    std::size_t polygons = 0, holes = 0, corners = 0;
    double area = 0, perimeter = 0;  ///< geodesic
};

/// A closed ring of longitudes and latitudes in degrees. Neighbours that are the same place count once.
std::vector<Geodetic> ring_from(const std::vector<glm::dvec3>& closed) {
    std::vector<Geodetic> ring;
    for (std::size_t i = 0; i + 1 < closed.size(); ++i)
        if (i == 0 || closed[i].x != closed[i - 1].x || closed[i].y != closed[i - 1].y)
            ring.push_back({closed[i].y * degrees, std::remainder(closed[i].x, 360) * degrees, {}});
    return ring;
}

void add_ring(Polygons& all, std::vector<Geodetic> ring, bool hole, const std::string& where) {
    if (ring.size() < 3)
        throw Error(Fault::bad_data, where, "has a ring of fewer than three different corners", "polygons");
    const planet::PolygonSize size = planet::Geodesics(planet::wgs84).polygon(ring);
    all.area += (hole ? -1 : 1) * std::abs(size.area);
    all.perimeter += size.perimeter;
    all.corners += ring.size();
    all.holes += hole;
    all.polygons += !hole;
    all.rings.push_back(std::move(ring));
}

Polygons polygons_from_file(const std::string& path) {
    const planet::Features features = planet::read_features(path);
    if (features.polygons.empty())
        throw Error(Fault::bad_data, path, "holds no polygon", "a vector file with polygons, e.g. GeoJSON or KML");
    Polygons all;
    for (const planet::Polygon& polygon : features.polygons) {
        add_ring(all, ring_from(polygon.outer), false, path);
        for (const auto& hole : polygon.holes) add_ring(all, ring_from(hole), true, path);
    }
    return all;
}

Polygons polygons_from(const std::vector<std::string>& input) {
    if (input.size() == 1) return polygons_from_file(input.front());
    if (input.size() < 3)
        throw Error(Fault::bad_usage, "polygon", std::to_string(input.size()) + " corners are no polygon",
                    "a vector file, or LAT,LON three times or more");
    Polygons all;
    std::vector<Geodetic> ring;
    for (const auto& text : input) ring.push_back(parse_place("polygon", text));
    if (ring.front().latitude == ring.back().latitude && ring.front().longitude == ring.back().longitude)
        ring.pop_back();
    add_ring(all, std::move(ring), false, "polygon");
    return all;
}

std::string square_text(double area) {
    const bool large = area >= 1e6;
    return fixed(area, 2) + " m2" + (large ? " (" + fixed(area / 1e6, area >= 1e9 ? 1 : 3) + " km2)" : "");
}

void area(const Options& options) {
    Report report("query area", options.json);
    Polygons polygons;
    {
        const auto step = report.step("read");
        polygons = polygons_from(options.input);
    }
    planet::GroundArea ground;
    if (options.on_terrain) {
        const planet::StoreField field = open_ground(options.ground, report);
        const auto step = report.step("measure");
        Progress progress;
        ground = planet::ground_area(field, polygons.rings, [&](double share) { progress.update("measuring", share); });
        progress.clear();
        report_damage(field, report);
        const double bound = ground.bound + 1e-6 * ground.area;
        std::cout << square_text(ground.area) << " of ground within " << four_digits(bound) << " m2, over ";
        report.set("terrain_area_m2", ground.area);
        report.set("terrain_area_bound_m2", bound);
        report.set("ground_cells", ground.cells);
        report.set("sources", sources_json(field.sources()));
    }
    std::cout << square_text(polygons.area) << " on the ellipsoid, perimeter " << fixed(polygons.perimeter, 2) << " m; "
              << grouped(polygons.corners) << " corners\n";
    report.set("area_m2", polygons.area);
    report.set("perimeter_m", polygons.perimeter);
    report.set("polygons", polygons.polygons);
    report.set("holes", polygons.holes);
    report.set("corners", polygons.corners);
    report.set("crs", "EPSG:4326");
    report.write();
}

}  // namespace

void add_query_area(CLI::App& query) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(query, "area", "The area of polygons with geodesic sides (WGS84)",
                                    "octaglobe query area 37,-109.05 41,-109.05 41,-102.05 37,-102.05\n"
                                    "  octaglobe query area park.geojson --on-terrain");
    command
        ->add_option_function<std::vector<std::string>>(
            "polygon", [options](const std::vector<std::string>& texts) { options->input = texts; },
            "A vector file, or corners in degrees")
        ->type_name("FILE or LAT,LON ...")
        ->required()
        ->expected(1, 1 << 20);
    command->add_flag("--on-terrain", options->on_terrain, "Also the area of the ground");
    add_ground_options(*command, options->ground);
    add_json_option(*command, options->json);
    command->final_callback([options] { area(*options); });
}

}  // namespace render
