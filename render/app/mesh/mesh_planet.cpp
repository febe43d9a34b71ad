// octaglobe mesh --planet: the whole planet, closed, within a bound or a budget, or of one level.

#include <iostream>

#include "planet/elevation/features.h"
#include "planet/error.h"
#include "planet/geodesy/geodesic.h"
#include "planet/store/planet_mesh.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/picture/earth_store.h"
#include "render/app/progress.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

std::shared_ptr<const planet::ElevationStore> open_store(const MeshOptions& options, Report& report) {
    const auto step = report.step("store");
    if (options.store)
        return std::make_shared<const planet::ElevationStore>(
            planet::ElevationStore::open(*options.store, planet::wgs84));
    const EarthSources sources;
    LazyEarth earth(sources);
    ChecksumIndex index = user_checksum_index();
    Progress progress;
    auto store = open_earth_store(sources, earth, index,
                                  [&](std::string_view what, double fraction) { progress.update(what, fraction); });
    index.save();
    return store;
}

/// Directions of points, and along lines so close that no lattice of that spacing has a vertex between them.
/// @param spacing radians
std::vector<glm::dvec3> directions(const planet::Features& features, double spacing) {
    std::vector<glm::dvec3> list;
    const auto normal = [](const glm::dvec3& p) {
        return planet::normal_from_geodetic(p.y * planet::degrees, p.x * planet::degrees);
    };
    const auto along = [&](const std::vector<glm::dvec3>& line) {
        for (std::size_t i = 1; i < line.size(); ++i) {
            const glm::dvec3 a = normal(line[i - 1]), b = normal(line[i]);
            const auto steps = static_cast<std::size_t>(std::ceil(glm::length(b - a) / spacing)) + 1;
            for (std::size_t k = 0; k <= steps; ++k)
                list.push_back(a + (b - a) * (static_cast<double>(k) / static_cast<double>(steps)));
        }
    };
    for (const glm::dvec3& p : features.points) list.push_back(normal(p));
    for (const auto& line : features.lines) along(line);
    for (const auto& polygon : features.polygons) {
        along(polygon.outer);
        for (const auto& hole : polygon.holes) along(hole);
    }
    return list;
}

planet::PlanetMesh make(planet::PlanetLattice& lattice, const MeshOptions& options, double rounding, Report& report) {
    planet::PlanetMeshOptions how;
    if (!options.keep.empty()) {
        const auto step = report.step("keep");
        const double finest = std::exp2(-0.5 * lattice.store().metadata().finest_level);
        how.keep = directions(planet::read_features(options.keep), finest);
        report.set("kept_directions", how.keep.size());
    }
    const auto step = report.step("refine");
    if (options.level) {
        if (*options.level > planet::finest_uniform_level)
            throw Error(Fault::bad_usage, "--level", std::to_string(*options.level) + " is too fine for a whole planet",
                        "0 to " + std::to_string(planet::finest_uniform_level));
        return planet::uniform_planet_mesh(lattice, *options.level);
    }
    how.max_deviation = options.max_deviation.value_or(0);
    how.max_triangles = options.max_triangles.value_or(0);
    how.rounding = rounding;
    return planet::planet_mesh(lattice, how);
}

void fill_report(const planet::DeviationReport& deviation, const planet::ElevationStore& store,
                 const MeshOptions& options, Report& report) {
    report.set("deviation_max_m", deviation.maximum);
    report.set("deviation_rms_m", deviation.rms);
    report.set("resampling_max_m", deviation.resampling);
    report.set("deviation_of_sources_max_m", deviation.total());
    if (options.max_deviation) report.set("tolerance_m", *options.max_deviation);
    report.set("samples", deviation.samples);
    report.set("store_vertical_datum", planet::name_of(store.metadata().datum));
    auto sources = nlohmann::ordered_json::array();
    for (const auto& source : store.metadata().sources) sources.push_back(source.name);
    report.set("sources", sources);
}

}  // namespace

void mesh_planet(const MeshOptions& options, Report& report) {
    if (options.priority != MeshPriority::least)
        throw Error(Fault::bad_usage, "--priority", "is for rasters", "--planet without it");
    MeshOutput output(options);
    planet::MeshReference reference;
    reference.frame = planet::MeshFrame::ecef;
    reference.crs = "EPSG:4978";
    reference.vertical_datum = planet::name_of(planet::VerticalDatum::ellipsoid);
    planet::check_frame(reference, output.format());
    const auto store = open_store(options, report);
    planet::PlanetLattice lattice(*store);
    const glm::dvec3 corner(store->metadata().ellipsoid.a + 10000);
    const planet::MeshRounding worst = planet::rounding_bound(-corner, corner, reference, output.format());
    const double rounding = std::sqrt(2 * worst.xy * worst.xy + worst.z * worst.z);
    if (options.max_deviation && *options.max_deviation < rounding)
        throw Error(
            Fault::bad_usage, "--max-deviation",
            four_digits(*options.max_deviation) + " m cannot be kept in a " + options.output->extension().string(),
            four_digits(rounding) + " m or more, by which it rounds, or a .ply");

    planet::PlanetMesh made = make(lattice, options, rounding, report);
    planet::MeshRounding rounded;
    {
        const auto step = report.step("round");
        rounded = planet::round_to_format(made.mesh, reference, output.format());
    }
    planet::DeviationReport deviation;
    {
        const auto step = report.step("measure");
        deviation = planet::measure(lattice, made, made.mesh.vertices);
    }
    output.write(made.mesh, reference, rounded, report);
    report_mesh(made.mesh, reference, report);
    fill_report(deviation, *store, options, report);
    output.draw({.vertices = made.mesh.vertices,
                 .triangles = made.mesh.triangles,
                 .level = made.mesh.level,
                 .planet = true,
                 .look_from = planet::normal_from_geodetic(20 * planet::degrees, 15 * planet::degrees)},
                report);
    output.commit();
    std::cout << grouped(made.mesh.triangles.size()) << " triangles, " << grouped(made.mesh.vertices.size())
              << " vertices; deviation at most " << four_digits(deviation.maximum) << " m, rms "
              << four_digits(deviation.rms) << " m over " << grouped(deviation.samples)
              << " vertices of the finest surface, which is within " << four_digits(deviation.resampling)
              << " m of its sources\n";
}

}  // namespace render
