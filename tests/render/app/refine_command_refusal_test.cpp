// What `octaglobe refine` refuses: one line that says what, where and what would be accepted, the right exit status, and
// nothing left behind. Hostile meshes take no memory to speak of.

#include "planet/geodesy/ellipsoid.h"
#include "tests/render/app/refine_program.h"
#include "tests/render/app/refusals.h"

namespace render {
namespace {

using planet::SurfaceMesh;

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

/// What the calls below name.
void write_inputs(const ScratchFolder& folder) {
    const SurfaceMesh mesh = uneven_mesh();
    write_mesh_file(folder / "mesh.ply", mesh);
    write_mesh_file(folder / "degrees.ply", terrain_rectangle(), degrees_reference());
    SurfaceMesh away = mesh;
    for (glm::dvec3& v : away.vertices) v.x += 1e4;
    write_mesh_file(folder / "away.ply", away);
    planet::MeshReference ecef;
    ecef.frame = planet::MeshFrame::ecef;
    write_mesh_file(folder / "ecef.ply", mesh, ecef);
    planet::MeshReference lambert;
    lambert.crs = "EPSG:2154";
    write_mesh_file(folder / "lambert.ply", mesh, lambert);
    SurfaceMesh world = terrain_rectangle();
    for (glm::dvec3& v : world.vertices) v.x = v.x < 10.2 ? -170 : 170;
    write_mesh_file(folder / "world.ply", world, degrees_reference());
    SurfaceMesh planet;
    const double a = planet::wgs84.a;
    planet.vertices = {{a, 0, 0}, {0, a, 0}, {0, 0, a}, {-a, -a, -a}};
    planet.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    write_mesh_file(folder / "planet.ply", planet, ecef);
    const std::string whole = content(folder / "mesh.ply");
    write_text(folder / "short.ply", whole.substr(0, whole.size() / 2));
    write_text(folder / "text.oprog", "no stream");
    write_text(folder / "empty.obj", "");
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    write_text(folder / "points.obj", square);
    write_text(folder / "nan.obj", "v 0 0 nan\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    write_text(folder / "corners.obj", square + "f 1 2 3\nf 1 3 3\n");
    write_text(folder / "flat.obj", "v 0 0 0\nv 1 1 0\nv 2 2 0\nf 1 2 3\n");
    write_text(folder / "three.obj", square + "v 0 0 1\nf 1 2 3\nf 1 3 4\nf 3 1 5\n");
    write_text(folder / "turned.obj", square + "f 1 2 3\nf 4 3 1\n");
    write_text(folder / "twice.obj", square + "f 1 2 3\nf 1 3 2\n");
    write_text(folder / "junction.obj", square + "v 0.5 0 0\nv 0.5 -1 0\nf 1 2 3\nf 1 3 4\nf 1 6 5\nf 6 2 5\n");
    write_text(folder / "seam.obj", square + "v 0 0 0\nv 1 1 0\nf 1 2 3\nf 5 6 4\n");
    write_text(folder / "wall.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n");
    write_text(folder / "lies.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
               "property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n");
    Terrain terrain = hilly_terrain();
    terrain.write(folder / "dem.vrt");
    terrain.crs = "+proj=longlat +R=1737400 +no_defs";
    terrain.write(folder / "moon.vrt");
    write_text(folder / "heights.png",
               planet::testing::png_bytes(9, 9, 8, [](int x, int y) { return static_cast<unsigned>(x * y); }));
    write_features(folder / "line.geojson", R"({"type":"LineString","coordinates":[[10,50],[10.3,49.7]]})");
}

class RefineRefusals : public testing::TestWithParam<Refusal> {};

TEST_P(RefineRefusals, OneLineAndNoFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    ASSERT_EQ(run(folder.path(), words("refine mesh.ply --steps 1 --progressive out.oprog")).status, 0);
    expect_one_line_and_no_file(folder, "refine", GetParam(), [] {
        const rlimit memory{std::size_t{4} << 30, std::size_t{4} << 30};
        ::setrlimit(RLIMIT_AS, &memory);
    });
}

constexpr Refusal meshes[] = {
    {"missing.ply --steps 1 -o t.ply", 3, "missing.ply: no such file", ".glb"},
    {"dem.vrt --steps 1 -o t.ply", 2, "dem.vrt: is not a mesh format", ".glb"},
    {"short.ply --steps 1 -o t.ply", 3, "short.ply: ", ".glb"},
    {"empty.obj --steps 1 -o t.ply", 3, "empty.obj: has no triangles", ".glb"},
    {"points.obj --steps 1 -o t.ply", 3, "points.obj: has no triangles", ".glb"},
    {"lies.ply --steps 1 -o t.ply", 3, "lies.ply: it ends early", ".glb"},
    {"nan.obj --steps 1 -o t.ply", 3, "nan.obj: a coordinate is not finite", ".glb"},
    {"corners.obj --steps 1 -o t.ply", 3, "corners.obj: triangle 1 has two corners at vertex 2 (1, 1, 0)", "conform"},
    {"flat.obj --steps 1 -o t.ply", 3, "flat.obj: triangle 0 has no area", "a conforming triangle mesh"},
    {"three.obj --steps 1 -o t.ply", 3,
     "three.obj: the side from vertex 0 (0, 0, 0) to vertex 2 (1, 1, 0) has 3 triangles", "a conforming triangle mesh"},
    {"turned.obj --steps 1 -o t.ply", 3, "turned.obj: the side from vertex 0 (0, 0, 0) to vertex 2 (1, 1, 0) has two",
     "a conforming triangle mesh"},
    {"twice.obj --steps 1 -o t.ply", 3, "the mesh: triangle 0 has a second one", "one"},
    {"junction.obj --steps 1 -o t.ply", 3,
     "junction.obj: the side from vertex 0 (0, 0, 0) to vertex 1 (1, 0, 0) has vertex 4 (0.5, 0, 0) within it", "weld"},
    {"junction.obj --weld --steps 1 -o t.ply", 3, "junction.obj: the side from vertex 0", "a conforming"},
    {"seam.obj --steps 1 -o t.ply", 3, "seam.obj: the side from vertex ", "--weld joins"},
    {"wall.obj --steps 1 --sides plan -o t.ply", 3, "the mesh: ", ""},
    {"text.oprog -o t.ply", 3, "text.oprog: ", ""},
};
INSTANTIATE_TEST_SUITE_P(Meshes, RefineRefusals, testing::ValuesIn(meshes));

constexpr Refusal limits[] = {
    {"", 2, "refine: nothing to refine", "a mesh file"},
    {"mesh.ply -o t.ply", 2, "refine: no limit given", "--max-side"},
    {"mesh.ply --steps 1", 2, "refine: nothing to write", "-o FILE"},
    {"mesh.ply --max-side 0 -o t.ply", 2, "--max-side: '0' is out of range", ""},
    {"mesh.ply --max-side nan -o t.ply", 2, "--max-side: 'nan' is not a distance", "500m"},
    {"mesh.ply --max-triangles 31 -o t.ply", 2, "--max-triangles: 31 are fewer than the mesh has", "32 or more"},
    {"mesh.ply --steps 41 -o t.ply", 2, "--steps: '41' is out of range", "0 to 40"},
    {"mesh.ply --steps 40 -o t.ply", 2, "--steps: 40 make too many triangles", "at most 21"},
    {"mesh.ply --max-side 0.001 -o t.ply", 2, "--max-side: takes more than 100000000 triangles", "--max-triangles"},
    {"mesh.ply --steps 40 -o t.ply --max-side 1", 2, "--steps: goes with no limit", "--steps, --split, or limits"},
    {"mesh.ply --split 1,1 --steps 1 -o t.ply", 2, "--steps: goes with no limit", "--steps, --split, or limits"},
    {"mesh.ply --split 1 -o t.ply", 2, "--split: '1' is no point", "X,Y"},
    {"mesh.ply --split 1e6,0 -o t.ply", 2, "--split: no triangle holds that point", "within the mesh"},
    {"ecef.ply --split 1,1 -o t.ply", 2, "--split: is a point in plan", "--region"},
    {"mesh.ply --max-side 9 --order deviation -o t.ply", 2, "--order: deviation from what", "--elevation"},
    {"mesh.ply --steps 1 --order length -o t.ply", 2, "--order: is for limits", "--max-side"},
    {"mesh.ply --split 1,1 --region line.geojson -o t.ply", 2, "--region: is for limits and steps", "--max-side"},
    {"mesh.ply --max-side 9 --region line.geojson -o t.ply", 3, "line.geojson: has no polygon", "polygons"},
    {"mesh.ply --max-side 9 --rule both -o t.ply", 2, "--rule: 'both' is unknown", "modified, plain"},
    {"mesh.ply --max-deviation 9 -o t.ply", 2, "refine: --max-deviation requires --elevation", "--help"},
    {"away.ply --elevation dem.vrt --max-deviation 9 -o t.ply", 3, "dem.vrt: has no sample within the mesh", "meets"},
    {"ecef.ply --steps 1 --sides plan -o t.ply", 2, "--sides: an Earth-centred mesh has no plan", "space"},
    {"ecef.ply --elevation dem.vrt --max-deviation 9 -o t.ply", 3, "dem.vrt: has no sample within the mesh", "meets"},
    {"ecef.ply --elevation heights.png --max-deviation 9 -o t.ply", 2, "heights.png: has no place on the planet", ""},
    {"degrees.ply --elevation moon.vrt --max-deviation 9 -o t.ply", 2, "--elevation: moon.vrt is in ", "EPSG:4326"},
    {"degrees.ply --elevation missing.tif --max-deviation 9 -o t.ply", 3, "missing.tif: no such file", "GeoTIFF"},
};
INSTANTIATE_TEST_SUITE_P(Limits, RefineRefusals, testing::ValuesIn(limits));

constexpr Refusal streams[] = {
    {"mesh.ply --at 0.5 -o t.ply", 2, "--at: is for progressive meshes", ".oprog"},
    {"mesh.ply --view 1,2,3km -o t.ply", 2, "--view: is for progressive meshes", ".oprog"},
    {"mesh.ply --morph 9 -o t", 2, "--morph: is for progressive meshes", ".oprog"},
    {"out.oprog --steps 1 -o t.ply", 2, "refine: a progressive mesh is not refined further", "--at"},
    {"out.oprog --weld -o t.ply", 2, "refine: a progressive mesh is not refined further", "--at"},
    {"out.oprog --rule plain -o t.ply", 2, "--rule: a progressive mesh keeps that by which it was made", "modified"},
    {"out.oprog --frame ecef -o t.ply", 2, "--frame: the mesh is at no known place", "EPSG:4326"},
    {"out.oprog --at 1.1 -o t.ply", 2, "--at: '1.1' is out of range", "0 to 1"},
    {"out.oprog --at x -o t.ply", 2, "--at: 'x' is not a number", ""},
    {"out.oprog --view 1,2 -o t.ply", 2, "--view: '1,2' is no view", "LAT,LON,RANGE"},
    {"out.oprog --view 91,2,3km -o t.ply", 2, "--view: ", ""},
    {"out.oprog --view 1,2,3km -o t.ply", 2, "--view: the mesh is at no known place", "EPSG:4326"},
    {"out.oprog --morph 1 -o t", 2, "--morph: '1' is out of range", "2 to"},
    {"out.oprog --morph 9 --json r.json", 2, "--morph: without a folder", "-o FOLDER"},
    {"out.oprog --morph 9 -o mesh.ply", 2, "--output: ", "a new folder"},
    {"out.oprog --morph 9 --view 1,2,3km -o t", 2, "--morph: goes with no view", "--morph or --view"},
    {"out.oprog --format ply -o t.ply", 2, "refine: --format requires --morph", "--help"},
};
INSTANTIATE_TEST_SUITE_P(Streams, RefineRefusals, testing::ValuesIn(streams));

constexpr Refusal outputs[] = {
    {"mesh.ply --steps 1 -o t.xyz", 2, "t.xyz: is not a mesh format", ".glb, .ply, .obj or .stl"},
    {"mesh.ply --steps 1 -o no/folder/t.ply", 2, "--output: 'no/folder/t.ply' cannot be written", "a folder"},
    {"mesh.ply --steps 1 --progressive t.ply", 2, "--progressive: 't.ply' has another ending", ".oprog"},
    {"mesh.ply --steps 1 -o t.ply --json t.ply", 2, "refine: one file for two things", "a file each"},
    {"mesh.ply --steps 1 -o t.ply --picture p.xyz", 2, "", ""},
    {"degrees.ply --steps 1 --frame source -o t.glb", 2, ".glb: its coordinates are lengths", "enu, utm or ecef"},
    {"ecef.ply --steps 1 --frame source -o t.ply", 2, "--frame: the mesh's source is not known", "enu, ecef or utm"},
    {"mesh.ply --steps 1 --frame enu -o t.ply", 2, "--frame: the mesh is at no known place", "EPSG:4326"},
    {"lambert.ply --steps 1 --frame enu -o t.ply", 2, "--frame: places are not known in EPSG:2154", "EPSG:4326"},
    {"mesh.ply --steps 1 --frame local -o t.ply", 2, "--frame: 'local' is unknown", "source, utm, enu, ecef"},
    {"planet.ply --steps 1 --frame utm -o t.ply", 2, "--frame: does not reach all of the mesh", "another frame"},
    {"world.ply --steps 1 --frame utm -o t.ply", 2, "--frame: does not reach all of the mesh", "another frame"},
    {"mesh.ply --max-side 1e-4 --max-triangles 9 --steps 1 -o t.ply", 2, "--steps: goes with no limit", "--steps"},
};
INSTANTIATE_TEST_SUITE_P(Outputs, RefineRefusals, testing::ValuesIn(outputs));

// What stood there before stays.
TEST(RefineThatFails, KeepsTheOldFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    write_text(folder / "t.ply", "kept");
    EXPECT_EQ(run(folder.path(), words("refine three.obj --steps 1 -o t.ply")).status, 3);
    EXPECT_EQ(content(folder / "t.ply"), "kept");
}

}  // namespace
}  // namespace render
