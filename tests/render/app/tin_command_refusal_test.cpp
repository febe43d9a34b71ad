// What `octaglobe tin` refuses: one line that says what, where and what would be accepted, the right exit status, and
// nothing left behind.

#include "tests/render/app/refusals.h"
#include "tests/render/app/terrain_files.h"

namespace render {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What the calls below name.
void write_inputs(const ScratchFolder& folder) {
    hilly_terrain().write(folder / "dem.vrt");
    const auto write = [&](const char* name, auto&& change) {
        Terrain other = hilly_terrain();
        change(other);
        other.write(folder / name);
    };
    write("one.vrt", [](Terrain& t) { t.width = t.height = 1; });
    write("row.vrt", [](Terrain& t) { t.height = 1; });
    write("column.vrt", [](Terrain& t) { t.width = 1; });
    write("void.vrt", [](Terrain& t) { t.height_m = [](int, int) { return nan; }; });
    write("specks.vrt", [](Terrain& t) { t.height_m = [](int x, int y) { return (x + y) % 2 == 0 ? nan : 1; }; });
    write("shifted.vrt", [](Terrain& t) { t.x += 0.004; });
    write("moon.vrt", [](Terrain& t) { t.crs = "+proj=longlat +R=1737400 +no_defs"; });
    write("half.vrt", [](Terrain& t) { t.x = -180, t.step_x = 9, t.y = 60, t.step_y = -3; });
    std::ofstream(folder / "huge.vrt")
        << R"(<VRTDataset rasterXSize="60000" rasterYSize="60000"><SRS>EPSG:4326</SRS>)"
        << R"(<GeoTransform>10,0.0001,0,50,0,-0.0001</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>)";
    std::ofstream(folder / "empty.tif").flush();
    std::ofstream(folder / "damaged.tif") << "II*";
    std::ofstream(folder / "picture.png", std::ios::binary)
        << planet::testing::png_bytes(9, 9, 8, [](int x, int y) { return static_cast<unsigned>(x * y); });
    std::ofstream(folder / "part.png", std::ios::binary)
        << planet::testing::png_bytes(9, 9, 8, [](int x, int y) { return static_cast<unsigned>(x * y); });
    std::ofstream(folder / "part.pgw") << "0.04\n0\n0\n-0.04\n10.02\n49.98\n";
    std::ofstream(folder / "placed.png", std::ios::binary)
        << planet::testing::png_bytes(9, 9, 8, [](int x, int y) { return static_cast<unsigned>(x + y); });
    std::ofstream(folder / "placed.png.aux.xml")
        << "<PAMDataset><SRS>EPSG:4326</SRS><GeoTransform>9,1,0,51,0,-1</GeoTransform></PAMDataset>";
    write_features(folder / "in.geojson", R"({"type":"LineString","coordinates":[[10,50],[10.3,49.7]]})");
    write_features(folder / "out.geojson", R"({"type":"Point","coordinates":[20,20]})");
    write_features(folder / "far.geojson", R"({"type":"Polygon","coordinates":[[[20,20],[21,20],[21,21],[20,20]]]})");
    std::ofstream(folder / "damaged.geojson") << R"({"type":"FeatureCollection","features":[{"ty)";
    std::filesystem::create_directory(folder / "folder.ply");
}

class TinRefusals : public testing::TestWithParam<Refusal> {};

TEST_P(TinRefusals, OneLineAndNoFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    expect_one_line_and_no_file(folder, "tin", GetParam());
}

constexpr Refusal rasters[] = {
    {"--max-deviation 9 -o t.ply", 2, "tin: nothing to triangulate", "a raster"},
    {"missing.tif --max-deviation 9 -o t.ply", 3, "missing.tif: no such file", "GeoTIFF"},
    {"none/*.tif --max-deviation 9 -o t.ply", 3, "none/*.tif: matches no file", "a pattern"},
    {"empty.tif --max-deviation 9 -o t.ply", 3, "empty.tif: is empty", "GeoTIFF"},
    {"damaged.tif --max-deviation 9 -o t.ply", 3, "damaged.tif: cannot be read", "GeoTIFF"},
    {"in.geojson --max-deviation 9 -o t.ply", 3, "in.geojson: cannot be read", "GeoTIFF"},
    {"one.vrt --max-deviation 9 -o t.ply", 3, "one.vrt: 1x1 samples have no area", "2x2 samples or more"},
    {"row.vrt --max-deviation 9 -o t.ply", 3, "row.vrt: 41x1 samples have no area", "2x2 samples or more"},
    {"column.vrt --max-triangles 9 -o t.ply", 3, "column.vrt: 1x33 samples have no area", "2x2 samples or more"},
    {"row.vrt --max-deviation 9 --tile 9 -o out", 3, "row.vrt: 41x1 samples have no area", "2x2 samples or more"},
    {"void.vrt --max-deviation 9 -o t.ply", 3, "void.vrt: holds no heights", "one band of heights"},
    {"void.vrt --max-deviation 9 --tile 9 -o out", 3, "void.vrt: holds no heights", "one band of heights"},
    {"void.vrt --max-deviation 9 --tile 9 -o out --format ply", 3, "void.vrt: holds no heights", "one band"},
    {"specks.vrt --max-deviation 9 -o t.ply", 3, "the TIN: no triangle", "three valid samples side by side"},
    {"huge.vrt --max-deviation 9 -o t.ply", 3, "huge.vrt: 60000x60000 samples are too many", "--tile"},
    {"dem.vrt shifted.vrt --max-deviation 9 -o t.ply", 3, "shifted.vrt: is not on the grid of dem.vrt", "one CRS"},
    {"moon.vrt --max-deviation 9 -o t.glb", 2, "moon.vrt: is on another planet", "--frame source"},
    {"half.vrt --max-deviation 9 --frame utm -o t.ply", 2, "--frame: does not reach all of half.vrt", "another frame"},
    {"picture.png --max-deviation 9 --frame ecef -o t.glb", 2, "picture.png: has no place", "source or enu"},
};
INSTANTIATE_TEST_SUITE_P(Rasters, TinRefusals, testing::ValuesIn(rasters));

constexpr Refusal bounds[] = {
    {"dem.vrt -o t.ply", 2, "tin: no bound given", "--max-deviation or --max-triangles"},
    {"dem.vrt --max-deviation -1 -o t.ply", 2, "--max-deviation: '-1' is out of range", "0 to"},
    {"dem.vrt --max-deviation nan -o t.ply", 2, "--max-deviation: 'nan' is not a distance", "500m"},
    {"dem.vrt --max-deviation 1e300 -o t.ply", 2, "--max-deviation: '1e300' is out of range", "0 to"},
    {"dem.vrt --max-deviation 0 -o t.glb", 2, "--max-deviation: 0 m cannot be kept in a .glb", ".ply"},
    {"dem.vrt --max-deviation 0 -o t.stl", 2, "--max-deviation: 0 m cannot be kept in a .stl", ".ply"},
    {"dem.vrt --max-deviation 0 --tile 9 -o out", 2, "--max-deviation: 0 m cannot be kept in a .glb", "ply"},
    {"dem.vrt --max-triangles 1 -o t.ply", 2, "--max-triangles: '1' is out of range", "a whole number 2 to"},
    {"dem.vrt --max-triangles 99999999999999999999 -o t.ply", 2, "--max-triangles: ", "a whole number"},
    {"dem.vrt --max-triangles 9 --features in.geojson far.geojson --mask in.geojson -o t.ply", 3,
     "in.geojson: has no polygon", "polygons"},
    {"dem.vrt --max-triangles 2 --features in.geojson -o t.ply", 2, "the budget of triangles: 2 are fewer", "or more"},
    {"specks.vrt --max-triangles 9 -o t.ply", 3, "the TIN: no triangle", "three valid samples side by side"},
    {"dem.vrt --max-deviation 9 --quality good -o t.ply", 2, "--quality: 'good' is unknown", "fast, standard, best"},
    {"dem.vrt --max-deviation 9 --metric max -o t.ply", 2, "--metric: 'max' is unknown", "local, regional, rms"},
    {"dem.vrt --max-deviation 9 --locate grid -o t.ply", 2, "--locate: 'grid' is unknown", "auto, cells, naive"},
    {"dem.vrt --max-deviation 9 --locate cells --metric rms -o t.ply", 2, "--locate: goes with the local", "local"},
    {"dem.vrt --max-deviation 9 --base 0 -o t.ply", 2, "--base: '0' is out of range", "0.001"},
    {"dem.vrt --max-deviation 9 --exaggeration 0 -o t.ply", 2, "--exaggeration: '0' is out of range", "0.01 to 100"},
};
INSTANTIATE_TEST_SUITE_P(Bounds, TinRefusals, testing::ValuesIn(bounds));

constexpr Refusal features[] = {
    {"dem.vrt --max-deviation 9 --features missing.geojson -o t.ply", 3, "missing.geojson: no such file", "GeoPackage"},
    {"dem.vrt --max-deviation 9 --features damaged.geojson -o t.ply", 3, "damaged.geojson: cannot be read", "GeoPack"},
    {"dem.vrt --max-deviation 9 --features in.geojson out.geojson -o t.ply", 3, "out.geojson: has nothing on", "dem"},
    {"dem.vrt --max-deviation 9 --mask far.geojson -o t.ply", 3, "dem.vrt: has no valid sample within", "meets it"},
    {"dem.vrt --max-deviation 9 --mask far.geojson --tile 9 -o out", 3, "dem.vrt: holds no heights", "one band"},
    {"dem.vrt --max-deviation 9 --mask out.geojson -o t.ply", 3, "out.geojson: has no polygon", "polygons"},
};
INSTANTIATE_TEST_SUITE_P(Features, TinRefusals, testing::ValuesIn(features));

constexpr Refusal outputs[] = {
    {"dem.vrt --max-deviation 9", 2, "tin: nothing to write", "-o FILE"},
    {"dem.vrt --max-deviation 9 -o ''", 2, "--output: empty file name", "a path"},
    {"dem.vrt --max-deviation 9 -o t.xyz", 2, "t.xyz: is not a mesh format", ".glb, .ply, .obj or .stl"},
    {"dem.vrt --max-deviation 9 -o no/folder/t.ply", 2, "--output: 'no/folder/t.ply' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o folder.ply", 2, "--output: 'folder.ply' cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o t.ply --json t.ply", 2, "tin: one file for two things", "a file each"},
    {"dem.vrt --max-deviation 9 -o t.ply --error-grid e.png", 2, "e.png: is not a raster format", ".tif"},
    {"dem.vrt --max-deviation 9 -o t.ply --error-grid no/e.tif", 2, "no/e.tif: cannot be written", "a folder"},
    {"dem.vrt --max-deviation 9 -o t.ply --drape picture.png", 2, "--drape: only a .glb holds", ".glb"},
    {"dem.vrt --max-deviation 9 -o t.glb --drape in.geojson", 3, "in.geojson: ", "a picture"},
    {"dem.vrt --max-deviation 9 -o t.glb --drape picture.png --base 9", 2, "--drape: goes with no solid", "--base"},
    {"dem.vrt --max-deviation 9 -o t.glb --drape part.png", 3, "part.png: does not cover all of dem.vrt", "--mask"},
    {"dem.vrt --max-deviation 9 --tile 9 -o out --drape part.png", 3, "part.png: does not cover all of dem", "--mask"},
    {"picture.png --max-deviation 9 -o t.glb --drape placed.png", 3, "placed.png: has a place on the planet", "edge"},
    {"dem.vrt --max-deviation 9 -o t.stl --frame source", 2, ".stl: frame source is not written", "frame enu"},
    {"dem.vrt --max-deviation 9 -o t.glb --frame source", 2, ".glb: its coordinates are lengths", "enu, utm or ecef"},
    {"dem.vrt --max-deviation 9 --tile 1 -o out", 2, "--tile: '1' is out of range", "2 to 16384"},
    {"huge.vrt --max-deviation 9 --tile 2 -o out", 2, "--tile: 900000000 tiles are too many", "larger ones"},
    {"dem.vrt --max-deviation 9 --tile 9 --json r.json", 2, "--tile: without a folder", "-o FOLDER"},
    {"dem.vrt --max-triangles 9 --tile 9 -o out", 2, "--max-triangles: 9 are fewer than the tiles need", "40 or more"},
    {"dem.vrt --max-deviation 9 --features out.geojson --tile 9 -o out", 3, "out.geojson: has nothing on",
     "within dem"},
    {"dem.vrt --max-deviation 9 --metric gpu --tile 9 -o out", 2, "--tile: goes not with gpu", "regional or rms"},
    {"dem.vrt --max-deviation 9 --locate cells --tile 9 -o out", 2, "--tile: goes with no other way", "auto"},
    {"dem.vrt --max-deviation 9 --picture p.png --tile 9 -o out", 2, "--tile: goes with no picture", "without"},
    {"dem.vrt --max-deviation 9 --drape picture.png --base 9 --tile 9 -o out", 2, "--drape: goes with no solid",
     "--base"},
    {"dem.vrt --max-deviation 9 --tile 9 -o no/out", 2, "--output: ", "a new folder"},
    {"dem.vrt --max-deviation 9 --tile 9 -o dem.vrt", 2, "--output: ", "a new folder"},
    {"dem.vrt --max-deviation 9 --format ply -o t.ply", 2, "tin: --format requires --tile", "--help"},
};
INSTANTIATE_TEST_SUITE_P(Outputs, TinRefusals, testing::ValuesIn(outputs));

// What stood there before stays when a TIN fails.
TEST(TinThatFails, KeepsTheOldFile) {
    const ScratchFolder folder;
    write_inputs(folder);
    std::ofstream(folder / "t.glb") << "kept";
    EXPECT_EQ(run(folder.path(), words("tin dem.vrt --max-deviation 0 -o t.glb")).status, 2);
    EXPECT_EQ(content(folder / "t.glb"), "kept");
}

}  // namespace
}  // namespace render
