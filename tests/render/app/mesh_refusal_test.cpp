// What `octaglobe mesh` refuses: one line that says what, where and what would be accepted, the right exit status, and
// nothing left behind.

#include "tests/render/app/refusals.h"
#include "tests/render/app/terrain_files.h"

namespace render {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The rasters and features that the calls below name.
void write_inputs(const ScratchFolder& folder) {
    Terrain terrain = hilly_terrain();
    terrain.write(folder / "dem.vrt");
    const auto write = [&](const char* name, auto&& change) {
        Terrain other = hilly_terrain();
        change(other);
        other.write(folder / name);
    };
    write("one.vrt", [](Terrain& t) { t.width = t.height = 1; });
    write("row.vrt", [](Terrain& t) { t.height = 1; });
    write("column.vrt", [](Terrain& t) { t.width = 1; });
    write("void.vrt", [](Terrain& t) {
        t.height_m = [](int, int) { return -9999.0; };
        t.band = "<NoDataValue>-9999</NoDataValue>";
    });
    write("nan.vrt", [](Terrain& t) { t.height_m = [](int, int) { return nan; }; });
    write("specks.vrt", [](Terrain& t) { t.height_m = [](int x, int y) { return (x + y) % 2 == 0 ? nan : 1; }; });
    write("moon.vrt", [](Terrain& t) { t.crs = "+proj=longlat +R=1737400 +no_defs"; });
    write("mars.vrt", [](Terrain& t) {
        t.crs = "+proj=eqc +a=3396190 +b=3376200 +no_defs";
        t.step_x = 1000, t.step_y = -1000;
    });
    write("half.vrt", [](Terrain& t) { t.x = -180, t.step_x = 9, t.y = 60, t.step_y = -3; });
    std::ofstream(folder / "huge.vrt")
        << R"(<VRTDataset rasterXSize="60000" rasterYSize="60000"><SRS>EPSG:4326</SRS>)"
        << R"(<GeoTransform>10,0.0001,0,50,0,-0.0001</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>)";
    planet::testing::write_raster<std::uint8_t>((folder / "colour.vrt").string(),
                                                {9, 9, "EPSG:4326", {10, 0.1, 0, 50, 0, -0.1}, ""},
                                                [](int x, int y) { return static_cast<std::uint8_t>(x * y); }, 3);
    std::ofstream(folder / "map.png", std::ios::binary)
        << planet::testing::png_bytes(9, 9, 8, [](int x, int y) { return static_cast<unsigned>(x * y); });
    std::ofstream(folder / "empty.tif").flush();
    write_features(folder / "in.geojson", R"({"type":"LineString","coordinates":[[10,50],[10.3,49.7]]})");
    write_features(folder / "out.geojson", R"({"type":"Point","coordinates":[20,20]})");
    std::ofstream(folder / "empty.geojson").flush();
    std::ofstream(folder / "damaged.geojson") << R"({"type":"FeatureCollection","features":[{"ty)";
    std::filesystem::create_directory(folder / "folder.ply");
}

class MeshRefusals : public testing::TestWithParam<Refusal> {};

TEST_P(MeshRefusals, OneLineAndNoFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    expect_one_line_and_no_file(folder, "mesh", GetParam());
}

constexpr Refusal rasters[] = {
    {"missing.tif --max-deviation 9 -o t.ply", 3, "missing.tif: no such file", "GeoTIFF"},
    {"empty.tif --max-deviation 9 -o t.ply", 3, "empty.tif: is empty", "GeoTIFF"},
    {"in.geojson --max-deviation 9 -o t.ply", 3, "in.geojson: cannot be read", "GeoTIFF"},
    {"colour.vrt --max-deviation 9 -o t.ply", 3, "colour.vrt: has 3 bands: a colour picture", "one band"},
    {"one.vrt --max-deviation 9 -o t.ply", 3, "one.vrt: 1x1 samples have no area", "2x2 samples or more"},
    {"row.vrt --max-deviation 9 -o t.ply", 3, "row.vrt: 41x1 samples have no area", "2x2 samples or more"},
    {"column.vrt --level 0 -o t.ply", 3, "column.vrt: 1x33 samples have no area", "2x2 samples or more"},
    {"void.vrt --max-deviation 9 -o t.ply", 3, "void.vrt: holds no heights", "one band of heights"},
    {"nan.vrt --max-deviation 9 -o t.ply", 3, "nan.vrt: holds no heights", "one band of heights"},
    {"specks.vrt --max-deviation 9 -o t.ply", 3, "specks.vrt: no triangle", "three valid samples side by side"},
    {"huge.vrt --max-deviation 9 -o t.ply", 3, "huge.vrt: 60000x60000 samples are too many", "at most 268435456"},
    {"moon.vrt --max-deviation 9 -o t.glb", 2, "moon.vrt: is on another planet", "--frame source"},
    {"moon.vrt --max-deviation 9 --frame utm -o t.ply", 2, "moon.vrt: is on another planet", "--frame source"},
    {"mars.vrt --max-deviation 9 --frame ecef -o t.ply", 2, "mars.vrt: is on another planet", "--frame source"},
    {"mars.vrt --max-deviation 9 -o t.stl", 2, "mars.vrt: is on another planet", "--frame source"},
    {"half.vrt --max-deviation 9 --frame utm -o t.ply", 2, "--frame: does not reach all of half.vrt", "another frame"},
    {"map.png --max-deviation 9 --frame utm -o t.ply", 2, "map.png: has no place on the planet",
     "--frame source or enu"},
    {"map.png --max-deviation 9 --frame ecef -o t.glb", 2, "map.png: has no place on the planet", "source or enu"},
};
INSTANTIATE_TEST_SUITE_P(Rasters, MeshRefusals, testing::ValuesIn(rasters));

constexpr Refusal bounds[] = {
    {"dem.vrt -o t.ply", 2, "mesh: no bound given", "--max-deviation, --max-triangles or --level"},
    {"dem.vrt --max-deviation -1 -o t.ply", 2, "--max-deviation: '-1' is out of range", "0 to"},
    {"dem.vrt --max-deviation nan -o t.ply", 2, "--max-deviation: 'nan' is not a distance", "500m"},
    {"dem.vrt --max-deviation inf -o t.ply", 2, "--max-deviation: 'inf' is not a distance", "500m"},
    {"dem.vrt --max-deviation 20x -o t.ply", 2, "--max-deviation: '20x' is not a distance", "500m"},
    {"dem.vrt --max-deviation 9 -o t.ply --drape photo.png", 2, "--drape: only a .glb holds", "-o FILE.glb"},
    {"dem.vrt --max-deviation 9 --drape photo.png --json r.json", 2, "--drape: only a .glb holds", "-o FILE.glb"},
    {"dem.vrt --max-deviation 9 -o t.glb --drape t.glb", 2, "--drape: would be overwritten", "another --output"},
    {"dem.vrt --max-deviation 9 -o t.glb --drape nothing.png", 3, "nothing.png", ""},
    {"--planet --level 4 -o t.glb --drape photo.png", 2, "--drape: goes over a raster", "a raster"},
    {"dem.vrt --max-deviation 0 -o t.glb", 2, "--max-deviation: 0 m cannot be kept in a .glb", ".ply"},
    {"dem.vrt --max-deviation 0 -o t.stl", 2, "--max-deviation: 0 m cannot be kept in a .stl", ".ply"},
    {"dem.vrt --max-triangles -5 -o t.ply", 2, "--max-triangles: '-5' is out of range", "a whole number 2 to"},
    {"dem.vrt --max-triangles 0 -o t.ply", 2, "--max-triangles: '0' is out of range", "a whole number 2 to"},
    {"dem.vrt --max-triangles 1 -o t.ply", 2, "--max-triangles: '1' is out of range", "a whole number 2 to"},
    {"dem.vrt --max-triangles 9.5 -o t.ply", 2, "--max-triangles: '9.5' is not a whole number", "a whole number"},
    {"dem.vrt --max-triangles 4 -o t.ply", 2, "--max-triangles: 4 is too few", "5 or more for this raster"},
    {"dem.vrt --max-triangles 20 --keep in.geojson -o t.ply", 2, "--max-triangles: 20 is too few",
     "and these features"},
    {"dem.vrt --level 11 -o t.ply", 2, "--level: 11 is finer than the raster", "0 to 10"},
    {"dem.vrt --level -1 -o t.ply", 2, "--level: '-1' is out of range", "0 to 56"},
    {"dem.vrt --level 3 --max-deviation 9 -o t.ply", 2, "--level: goes with no bound", "--level alone"},
    {"dem.vrt --level 3 --max-triangles 9 -o t.ply", 2, "--level: goes with no bound", "--level alone"},
    {"specks.vrt --max-triangles 9 -o t.ply", 3, "specks.vrt: no triangle", "a larger --max-triangles"},
};
INSTANTIATE_TEST_SUITE_P(Bounds, MeshRefusals, testing::ValuesIn(bounds));

constexpr Refusal features[] = {
    {"dem.vrt --max-deviation 9 --keep missing.geojson -o t.ply", 3, "missing.geojson: no such file", "GeoPackage"},
    {"dem.vrt --max-deviation 9 --keep empty.geojson -o t.ply", 3, "empty.geojson: is empty", "GeoPackage"},
    {"dem.vrt --max-deviation 9 --keep damaged.geojson -o t.ply", 3, "damaged.geojson: cannot be read", "GeoPackage"},
    {"dem.vrt --max-deviation 9 --keep dem.vrt -o t.ply", 3, "dem.vrt: is a raster (VRT), not features", "GeoPackage"},
    {"dem.vrt --max-deviation 9 --keep out.geojson -o t.ply", 3, "out.geojson: has nothing on the raster", "dem.vrt"},
};
INSTANTIATE_TEST_SUITE_P(Features, MeshRefusals, testing::ValuesIn(features));

constexpr Refusal outputs[] = {
    {"dem.vrt --max-deviation 9", 2, "mesh: nothing to write", "-o FILE"},
    {"dem.vrt --max-deviation 9 -o ''", 2, "--output: empty file name", "a path"},
    {"dem.vrt --max-deviation 9 -o t.xyz", 2, "t.xyz: is not a mesh format", ".glb, .ply, .obj or .stl"},
    {"dem.vrt --max-deviation 9 -o no/folder/t.ply", 2, "--output: 'no/folder/t.ply' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o folder.ply", 2, "--output: 'folder.ply' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o t.ply --json no/t.json", 2, "--json: 'no/t.json' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o t.ply --picture t.bmp", 2, "--picture: 't.bmp' has no ending of a picture", ".png"},
    {"dem.vrt --max-deviation 9 -o t.ply --picture no/t.png", 2, "--picture: 'no/t.png' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o t.ply --json t.ply", 2, "mesh: one file for two things", "a file each"},
    {"dem.vrt --max-deviation 9 -o t.stl --frame source", 2, ".stl: frame source is not written", "frame enu"},
    {"dem.vrt --max-deviation 9 -o t.glb --frame source", 2, ".glb: its coordinates are lengths", "enu, utm or ecef"},
    {"dem.vrt --max-deviation 9 -o t.ply --frame local", 2, "--frame: 'local' is unknown", "source, utm, enu, ecef"},
    {"dem.vrt --max-deviation 9 -o t.ply --datum msl", 2, "--datum: 'msl' is unknown", "egm96, ellipsoid"},
    {"dem.vrt --max-deviation 9 -o t.ply --size 300x300", 2, "mesh: --size requires --picture", "--help"},
    {"dem.vrt --max-deviation 9 --picture t.png --size 10x300", 2, "--size: '10x300' is out of range", "64 to 16384"},
};
INSTANTIATE_TEST_SUITE_P(Outputs, MeshRefusals, testing::ValuesIn(outputs));

constexpr Refusal kinds[] = {
    {"--max-deviation 9 -o t.ply", 2, "mesh: nothing to mesh", "a raster, or --planet, or --patches"},
    {"dem.vrt --planet --level 3 -o t.ply", 2, "mesh: more than one thing to mesh", "a raster, or --planet"},
    {"dem.vrt --store x --level 3 -o t.ply", 2, "mesh: --store requires --planet", "--help"},
    {"--planet --level 27 -o t.ply", 2, "--level: 27 is too fine for a whole planet", "0 to 22"},
    {"--planet --level 3 -o t.stl", 2, "--output: an .stl holds no planet", ".glb, .ply or .obj"},
    {"--planet --level 3 --frame enu -o t.glb", 2, "--frame: the planet has one frame", "ecef"},
    {"--planet --level 3 --datum egm96 -o t.glb", 2, "--datum: is for rasters", "--planet without it"},
    {"--planet --level 3 --keep in.geojson -o t.glb", 2, "--keep: goes with no level", "--max-deviation"},
    {"--planet --max-deviation 0 -o t.glb", 2, "--max-deviation: 0 m cannot be kept in a .glb", "or a .ply"},
    {"--planet --max-triangles 7 -o t.ply", 2, "--max-triangles: 7 is too few for the planet", "8 or more"},
    {"--planet --store dem.vrt --level 3 -o t.ply", 3, "dem.vrt: ", "store"},
    {"--patches 3x3 --json t.json", 2, "--patches: without a vertex to remove", "--remove X,Y"},
    {"--patches 3 --remove 5,5 --json t.json", 2, "--patches: '3' is no grid", "1x1 to 64x64"},
    {"--patches 0x3 --remove 5,5 --json t.json", 2, "--patches: '0' is out of range", "1 to 64"},
    {"--patches 3x65 --remove 5,5 --json t.json", 2, "--patches: '65' is out of range", "1 to 64"},
    {"--patches 3x3 --patch-level 0 --remove 5,5 --json t.json", 2, "--patch-level: '0' is out of range", "1 to 10"},
    {"--patches 3x3 --remove 0,16 --json t.json", 2, "--remove: '0,16' is the corner of a patch", "no corner"},
    {"--patches 3x3 --remove 49,0 --json t.json", 2, "--remove: '49' is out of range", "0 to 48"},
    {"--patches 3x3 --remove 5 --json t.json", 2, "--remove: '5' is no sample", "X,Y with X 0 to 48"},
    {"--patches 3x3 --level 4 --remove 5,5 --json t.json", 2, "--level: is for --planet and rasters", "--patch-level"},
    {"--patches 3x3 --max-deviation 4 --remove 5,5 --json t.json", 2, "--remove: goes with no bound", "--patch-level"},
    {"--planet --remove 45,45 --json t.json", 2, "--remove: needs a level", "--planet --level 1 to 22"},
    {"--planet --level 0 --remove 45,45 --json t.json", 2, "--remove: needs a level", "--planet --level 1 to 22"},
    {"--planet --level 23 --remove 45,45 --json t.json", 2, "--remove: needs a level", "--planet --level 1 to 22"},
    {"--planet --level 9 --remove 91,45 --json t.json", 2, "--remove: latitude 91 is out of range", "LAT,LON"},
    {"--planet --level 9 --remove 90,0 --json t.json", 2, "--remove: '90,0' is nearest to a corner", "another place"},
    {"dem.vrt --remove 4,4 -o t.ply", 2, "--remove: goes with no raster", "--patches, or --planet --level"},
};
INSTANTIATE_TEST_SUITE_P(Kinds, MeshRefusals, testing::ValuesIn(kinds));

// A mesh whose picture cannot be drawn does not appear either.
TEST(MeshWithoutGraphics, LeavesNothing) {
    const ScratchVariable egl("OCTAGLOBE_EGL_LIBRARY", "/nonexistent/libEGL.so"),
        osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nonexistent/libOSMesa.so");
    const ScratchFolder folder;
    write_inputs(folder);
    const auto before = folder.names();
    for (const char* what : {"dem.vrt --level 4", "--patches 2x2 --remove 8,8", "--planet --level 4"}) {
        const Outcome outcome =
            run(folder.path(), words("mesh " + std::string(what) + " -o t.ply --picture t.png --json t.json"));
        EXPECT_EQ(outcome.status, 4) << what;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(folder.names(), before) << what;
    }
}

// What stood there before stays when a mesh fails.
TEST(MeshThatFails, KeepsTheOldFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    std::ofstream(folder / "t.glb") << "kept";
    EXPECT_EQ(run(folder.path(), words("mesh dem.vrt --max-deviation 0 -o t.glb")).status, 2);
    EXPECT_EQ(content(folder / "t.glb"), "kept");
}

}  // namespace
}  // namespace render
