// octaglobe refine of Earth-centred meshes: new vertices leave the chords, elevation counts along the ellipsoid's normals,
// at the poles and the antimeridian too. And from one frame to another.

#include <algorithm>

#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/local_frame.h"
#include "planet/geodesy/utm.h"
#include "tests/render/app/refine_program.h"

namespace render {
namespace {

using planet::MeshFrame;
using planet::MeshReference;
using planet::SurfaceMesh;
using planet::wgs84;

MeshReference earth_centred() {
    MeshReference reference;
    reference.frame = MeshFrame::ecef;
    reference.crs = "EPSG:4978";
    reference.vertical_datum = "ellipsoid";
    return reference;
}

/// Eight triangles with their corners on the ellipsoid.
SurfaceMesh octahedron() {
    const double a = wgs84.a, b = wgs84.b;
    SurfaceMesh mesh;
    mesh.vertices = {{a, 0, 0}, {0, a, 0}, {-a, 0, 0}, {0, -a, 0}, {0, 0, b}, {0, 0, -b}};
    for (std::uint32_t i = 0; i < 4; ++i) {
        mesh.triangles.push_back({i, (i + 1) % 4, 4});
        mesh.triangles.push_back({(i + 1) % 4, i, 5});
    }
    return mesh;
}

glm::dvec3 ecef(double latitude_deg, double longitude_deg, double h) {
    return planet::ecef_from_geodetic(wgs84, {latitude_deg * planet::degrees, longitude_deg * planet::degrees, {h}});
}

/// How far from p a triangle is along a line, nothing if it does not meet that: from the planes through the line and two
/// corners each.
std::optional<double> distance_along(const glm::dvec3& p, const glm::dvec3& up, const SurfaceMesh& mesh,
                                     std::size_t t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const glm::dvec3 a = mesh.vertices[i] - p, b = mesh.vertices[j] - p, c = mesh.vertices[k] - p;
    const double ab = glm::dot(up, glm::cross(a, b)), bc = glm::dot(up, glm::cross(b, c)),
                 ca = glm::dot(up, glm::cross(c, a)), area = ab + bc + ca, rounding = -1e-9 * std::abs(area);
    if (area == 0 || std::min({ab / area, bc / area, ca / area}) * std::abs(area) < rounding) return std::nullopt;
    return (bc * glm::dot(up, a) + ca * glm::dot(up, b) + ab * glm::dot(up, c)) / area;
}

/// Of any sample from the mesh along its vertical; infinite if there is no triangle. @param margin samples left out around
double largest_deviation(const SurfaceMesh& mesh, const Terrain& terrain, int margin = 0) {
    double largest = 0;
    for (int row = margin; row < terrain.height - margin; ++row)
        for (int column = margin; column < terrain.width - margin; ++column) {
            const double latitude = terrain.y + row * terrain.step_y, longitude = terrain.x + column * terrain.step_x;
            const glm::dvec3 p = ecef(latitude, longitude, terrain.height_m(column, row));
            const glm::dvec3 up = planet::normal_from_geodetic(latitude * planet::degrees, longitude * planet::degrees);
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
                if (const auto d = distance_along(p, up, mesh, t)) least = std::min(least, std::abs(*d));
            largest = std::max(largest, least);
        }
    return largest;
}

TEST_F(RefineCommandTest, VerticesOfAPlanetAreAsHighAsTheirSides) {
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    const Json report = refine("planet.ply --steps 8 -o round.ply");
    EXPECT_EQ(report["placed"], "mean height");
    for (const glm::dvec3& p : read("round.ply").vertices) ASSERT_NEAR(planet::height_from_ecef(wgs84, p).m, 0, 1e-6);
    SurfaceMesh high = octahedron();
    high.vertices[4].z += 4000;
    write_mesh_file(folder_ / "high.ply", high, earth_centred());
    refine("high.ply --max-triangles 40 -o half.ply");
    const SurfaceMesh half = read("half.ply");
    EXPECT_TRUE(std::ranges::any_of(half.vertices, [](const glm::dvec3& p) {
        return std::abs(planet::height_from_ecef(wgs84, p).m - 2000) < 1e-6;
    }));
}

// In an .stl, which is local, too.
TEST_F(RefineCommandTest, APlanetInALocalFrameIsRound) {
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    EXPECT_EQ(refine("planet.ply --steps 4 -o round.stl")["frame"], "enu");
    refine("planet.ply --steps 4 --frame enu -o local.ply");
    MeshReference reference;
    const SurfaceMesh local = planet::read_mesh((folder_ / "local.ply"), &reference);
    const SurfaceMesh round = planet::read_mesh((folder_ / "round.stl"));
    EXPECT_EQ(round.triangles.size(), local.triangles.size());
    for (const glm::dvec3& p : local.vertices)
        ASSERT_NEAR(planet::height_from_ecef(wgs84, reference.origin + reference.ecef_from_enu * p).m, 0, 1e-6);
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "flat.ply", terrain_rectangle(), degrees_reference());
    refine("flat.ply --frame ecef --elevation dem.vrt --datum ellipsoid --max-deviation 50 -o part.ply");
    // The rectangle's upper side is a chord, not the parallel of the first row of samples.
    EXPECT_LE(largest_deviation(read("part.ply"), terrain, 1), 50 + 1e-6);
    refine("planet.ply --frame enu --elevation dem.vrt --datum ellipsoid --max-deviation 50 -o fine.ply");
    SurfaceMesh fine = planet::read_mesh((folder_ / "fine.ply"), &reference);
    for (glm::dvec3& p : fine.vertices) p = reference.origin + reference.ecef_from_enu * p;
    EXPECT_LE(largest_deviation(fine, terrain), 50 + 1e-6);
}

TEST_F(RefineCommandTest, PlacedSidesOfAPlanetAreShort) {
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    const Json report = refine("planet.ply --max-side 500km -o round.ply");
    EXPECT_LE(longest_side(read("round.ply")), 500e3);
    EXPECT_LE(number(report, "side_max_placed_m"), 500e3);
}

TEST_F(RefineCommandTest, TheBoundHoldsAlongTheVerticalsOfAPlanet) {
    const Terrain terrain = hilly_terrain();
    terrain.write(folder_ / "dem.vrt");
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    const Json report = refine("planet.ply --elevation dem.vrt --datum ellipsoid --max-deviation 20 -o fine.ply");
    EXPECT_EQ(report["samples"], terrain.width * terrain.height);
    EXPECT_EQ(report["samples_uncovered"], 0);
    EXPECT_EQ(report["sides"], "space");
    EXPECT_EQ(report["placed"], "elevation");
    EXPECT_LE(number(report, "deviation_max_m"), 20 + 1e-6);
    const SurfaceMesh mesh = read("fine.ply");
    const double found = largest_deviation(mesh, terrain);
    EXPECT_LE(found, 20 + 1e-6);
    EXPECT_NEAR(found, number(report, "deviation_max_m"), 1e-3);
}

// Poles, the antimeridian, and the seam between the last column and the first.
TEST_F(RefineCommandTest, TheBoundHoldsAllAroundAPlanet) {
    Terrain world;
    world.width = 72, world.height = 36;
    world.x = -177.5, world.y = 87.5, world.step_x = 5, world.step_y = -5;
    world.height_m = [](int x, int y) { return 20'000 * std::sin(0.7 * x) * std::sin(0.5 * y); };
    world.write(folder_ / "world.vrt");
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    const Json report = refine("planet.ply --elevation world.vrt --datum ellipsoid --max-deviation 8km -o fine.glb");
    EXPECT_EQ(report["samples"], 72 * 36);
    EXPECT_EQ(report["samples_uncovered"], 0);
    EXPECT_LE(largest_deviation(read("fine.glb"), world), 8000 + 0.01);
}

TEST_F(RefineCommandTest, HeightsAboveTheGeoidAreRaisedByIt) {
    Terrain level = hilly_terrain();
    level.height_m = [](int, int) { return 0; };
    level.write(folder_ / "level.vrt");
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    refine("planet.ply --elevation level.vrt --max-deviation 5 -o fine.ply");
    const SurfaceMesh fine = read("fine.ply");
    int above = 0;
    for (const glm::dvec3& p : fine.vertices) {
        const planet::Geodetic g = planet::geodetic_from_ecef(wgs84, p);
        const double latitude = g.latitude / planet::degrees, longitude = g.longitude / planet::degrees;
        if (longitude < 10.01 || longitude > 10.39 || latitude < 49.69 || latitude > 49.99) continue;
        EXPECT_NEAR(g.h.m, 48, 3) << "the geoid over Franconia";
        ++above;
    }
    EXPECT_GT(above, 3);
}

TEST_F(RefineCommandTest, ARegionMayHoldAPole) {
    write_mesh_file(folder_ / "planet.ply", octahedron(), earth_centred());
    write_features(folder_ / "cap.geojson",
                   R"({"type":"Polygon","coordinates":[[[-180,70],[180,70],[180,90],[-180,90],[-180,70]]]})");
    const Json report = refine("planet.ply --max-side 500km --region cap.geojson -o cap.ply");
    const SurfaceMesh mesh = read("cap.ply");
    for (const auto& t : mesh.triangles) {
        const glm::dvec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
        const double latitude = planet::geodetic_from_ecef(wgs84, middle).latitude / planet::degrees;
        const double side = glm::distance(mesh.vertices[t[0]], mesh.vertices[t[1]]);
        if (latitude > 72) {
            EXPECT_LE(side, 500e3);
        } else if (latitude < -20) {
            EXPECT_GE(side, 1000e3);
        }
    }
    EXPECT_GT(report["triangles"], 300);
}

// ---- from frame to frame ----

TEST_F(RefineCommandTest, AMeshInDegreesIsPutIntoAnyFrame) {
    MeshReference degrees = degrees_reference();
    degrees.vertical_datum = "ellipsoid";
    SurfaceMesh mesh = terrain_rectangle();
    for (std::size_t v = 0; v < 4; ++v) mesh.vertices[v].z = 100.0 * static_cast<double>(v);
    planet::MeshLooks looks;
    looks.normals.assign(4, {0, 0, 1});
    write_mesh_file(folder_ / "degrees.ply", mesh, degrees, looks);
    for (const char* arguments : {"--frame ecef -o out.ply", "--frame utm -o out.ply", "--frame enu -o out.ply",
                                  "-o out.glb", "--frame utm -o out.glb", "-o out.stl"}) {
        SCOPED_TRACE(arguments);
        const Json report = refine("degrees.ply --steps 0 " + std::string(arguments));
        const std::string name = words(arguments).back();
        MeshReference reference;
        const SurfaceMesh out = planet::read_mesh((folder_.path() / name).string(), &reference);
        ASSERT_EQ(out.vertices.size(), 4u);
        const planet::LocalFrame local(wgs84, {49.84 * planet::degrees, 10.2 * planet::degrees, {}});
        for (const glm::dvec3& p : mesh.vertices) {
            const planet::Geodetic g{p.y * planet::degrees, p.x * planet::degrees, {p.z}};
            const planet::Utm utm = planet::utm_from_geodetic(g, 32);
            const glm::dvec3 expected = report["frame"] == "utm"   ? glm::dvec3(utm.easting, utm.northing, p.z)
                                        : report["frame"] == "enu" ? local.enu_from_ecef(ecef(p.y, p.x, p.z))
                                                                   : ecef(p.y, p.x, p.z);
            const double tolerance = name == "out.ply" ? 1e-6 : report["frame"] == "utm" ? 0.5 : 0.01;
            EXPECT_TRUE(std::ranges::any_of(
                out.vertices, [&](const glm::dvec3& q) { return glm::distance(q, expected) < tolerance; }))
                << expected.x << " " << expected.y << " " << expected.z;
        }
    }
    planet::MeshLooks found;
    refine("degrees.ply --steps 0 --frame ecef -o out.ply");
    const SurfaceMesh out = read("out.ply", &found);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_LT(glm::distance(glm::dvec3(found.normals[v]), planet::normal_from_ecef(wgs84, out.vertices[v])), 1e-6);
}

TEST_F(RefineCommandTest, HeightsAboveTheGeoidBecomeEllipsoidal) {
    write_mesh_file(folder_ / "degrees.ply", terrain_rectangle(), degrees_reference());
    refine("degrees.ply --steps 0 --frame ecef -o out.ply");
    for (const glm::dvec3& p : read("out.ply").vertices) EXPECT_NEAR(planet::height_from_ecef(wgs84, p).m, 48, 3);
    const Json report = refine("degrees.ply --steps 0 --frame utm -o out.ply");
    for (const glm::dvec3& p : read("out.ply").vertices) EXPECT_EQ(p.z, 0);
    EXPECT_EQ(report["crs"], "EPSG:32632");
}

}  // namespace
}  // namespace render
