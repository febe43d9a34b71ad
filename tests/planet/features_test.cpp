#include "planet/elevation/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/geodesy/utm.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::RasterFile;
using testing::TemporaryFolder;
using testing::write_bytes;
using testing::write_raster;

std::string feature(const std::string& type, const std::string& coordinates) {
    return R"({"type":"Feature","properties":{},"geometry":{"type":")" + type + R"(","coordinates":)" + coordinates +
           "}}";
}

/// @param crs e.g. "EPSG::32613"; empty: none, which GDAL takes for WGS84
std::string collection(const std::string& features, const std::string& crs = "") {
    std::string text = R"({"type":"FeatureCollection",)";
    if (!crs.empty()) text += R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:)" + crs + R"("}},)";
    return text + R"("features":[)" + features + "]}";
}

template <class... Options>
std::string error_of(const std::string& path, const Options&... options) {
    try {
        read_features(path, options...);
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        EXPECT_EQ(std::string(e.what()).rfind(path, 0), 0u) << e.what();
        return e.what();
    }
    return "";
}

#define EXPECT_ERROR(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

FeatureOptions in_crs(const std::string& crs) {
    FeatureOptions options;
    options.crs = crs;
    return options;
}

bool same(const glm::dvec3& a, const glm::dvec3& b) {
    return a.x == b.x && a.y == b.y && (a.z == b.z || (std::isnan(a.z) && std::isnan(b.z)));
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Features, EveryKindIsTakenApart) {
    const TemporaryFolder folder;
    write_bytes(
        folder / "a.geojson",
        collection(feature("Point", "[8,46]") + "," + feature("MultiPoint", "[[1,2,3],[4,5,6]]") + "," +
                   feature("LineString", "[[0,0],[1,1],[2,0]]") + "," +
                   feature("MultiLineString", "[[[0,0,7],[1,1,8]],[[2,2,9],[3,3,10]]]") + "," +
                   feature("Polygon", "[[[0,0],[9,0],[9,9],[0,0]],[[5,1],[6,1],[6,2],[5,1]]]") + "," +
                   feature("MultiPolygon", "[[[[0,0],[1,0],[1,1],[0,0]]],[[[2,0],[3,0],[3,1],[2,0]]]]") + "," +
                   R"({"type":"Feature","properties":{},"geometry":null},)" +
                   R"({"type":"Feature","properties":{},"geometry":{"type":"GeometryCollection","geometries":[)" +
                   R"({"type":"Point","coordinates":[-3,-4]},{"type":"GeometryCollection","geometries":[)" +
                   R"({"type":"LineString","coordinates":[[0,0],[5,5]]}]}]}})"));
    const Features f = read_features(folder / "a.geojson");
    ASSERT_EQ(f.points.size(), 4u);
    EXPECT_TRUE(same(f.points[0], {8, 46, nan}));  // longitude first; no height is no 0
    EXPECT_TRUE(same(f.points[2], {4, 5, 6}));
    EXPECT_TRUE(same(f.points[3], {-3, -4, nan}));
    ASSERT_EQ(f.lines.size(), 4u);
    EXPECT_EQ(f.lines[0].size(), 3u);
    EXPECT_TRUE(std::isnan(f.lines[0][1].z));
    EXPECT_TRUE(same(f.lines[2][1], {3, 3, 10}));
    ASSERT_EQ(f.polygons.size(), 3u);
    EXPECT_EQ(f.polygons[0].outer.size(), 4u);
    ASSERT_EQ(f.polygons[0].holes.size(), 1u);
    EXPECT_TRUE(same(f.polygons[0].holes[0][1], {6, 1, nan}));
    EXPECT_TRUE(f.polygons[2].holes.empty());
    EXPECT_EQ(f.vertex_count(), 4u + 3 + 2 + 2 + 2 + 8 + 4 + 4);
}

TEST(Features, EveryLayerCounts) {
    const TemporaryFolder folder;  // a folder of files is several layers
    write_bytes(folder / "a.csv", "id,WKT\n1,POINT (1 2)\n");
    write_bytes(folder / "b.csv", "id,WKT\n1,\"LINESTRING (1 2, 3 4)\"\n");
    write_bytes(folder / "c.csv", "id,name\n1,no place\n");
    const Features f = read_features(folder.path().string());
    EXPECT_EQ(f.points.size(), 1u);
    EXPECT_EQ(f.lines.size(), 1u);
}

TEST(Features, PartsWithoutALengthOrAnAreaBecomeTheLesserKind) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.csv",
                "id,WKT\n1,\"LINESTRING (1 2)\"\n2,\"POLYGON ((1 1, 2 2, 1 1))\"\n3,LINESTRING EMPTY\n4,POINT EMPTY\n"
                "5,POLYGON EMPTY\n6,\"POLYGON ((0 0, 9 0, 9 9, 0 0), (3 1, 4 1, 3 1))\"\n");
    const Features f = read_features(folder / "a.csv");
    EXPECT_EQ(f.points.size(), 1u);
    ASSERT_EQ(f.lines.size(), 2u);
    EXPECT_EQ(f.lines[0].size(), 3u);
    EXPECT_TRUE(same(f.lines[1].front(), {3, 1, nan}));
    ASSERT_EQ(f.polygons.size(), 1u);
    EXPECT_TRUE(f.polygons[0].holes.empty());
}

TEST(Features, OpenRingsAreClosed) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.csv",
                "id,WKT\n1,\"POLYGON Z ((0 0 1, 4 0 2, 4 4 3))\"\n2,\"TRIANGLE ((0 0, 1 0, 1 1, 0 0))\"\n");
    const Features f = read_features(folder / "a.csv");
    ASSERT_EQ(f.polygons.size(), 2u);
    ASSERT_EQ(f.polygons[0].outer.size(), 4u);
    EXPECT_EQ(f.polygons[0].outer[3], glm::dvec3(0, 0, 1));
}

TEST(Features, CurvesBecomeChords) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.csv",
                "id,WKT\n1,\"CIRCULARSTRING (0 0, 1 1, 2 0)\"\n2,\"COMPOUNDCURVE (CIRCULARSTRING (0 0, 1 1, 2 0), (2 "
                "0, 5 0))\"\n"
                "3,\"CURVEPOLYGON (CIRCULARSTRING (0 0, 2 0, 0 0))\"\n4,\"CURVEPOLYGON ((0 0, 1 0, 1 1, 0 0))\"\n"
                "5,\"MULTICURVE ((0 0, 5 5), CIRCULARSTRING (0 0, 1 1, 2 0))\"\n");
    const Features f = read_features(folder / "a.csv");
    ASSERT_EQ(f.lines.size(), 4u);
    ASSERT_EQ(f.polygons.size(), 2u);
    EXPECT_EQ(f.polygons[1].outer.size(), 4u);
    EXPECT_EQ(f.lines[2].size(), 2u);
    const auto check_arc = [](const std::vector<glm::dvec3>& line, std::size_t n, double turn) {
        ASSERT_GE(line.size(), n);
        for (std::size_t i = 1; i < n; ++i) {
            const glm::dvec2 a(line[i - 1].x - 1, line[i - 1].y), b(line[i].x - 1, line[i].y);
            EXPECT_NEAR(glm::length(a), 1, 1e-12);
            EXPECT_GT(glm::length(0.5 * (a + b)), 1 - 0.0007);
            turn -= std::acos(glm::dot(a, b));
        }
        EXPECT_NEAR(turn, 0, 1e-6);
    };
    check_arc(f.lines[0], f.lines[0].size(), std::numbers::pi);
    check_arc(f.lines[1], f.lines[1].size() - 1, std::numbers::pi);
    check_arc(f.polygons[0].outer, f.polygons[0].outer.size(), 2 * std::numbers::pi);
    EXPECT_EQ(f.lines[1].back().x, 5);
}

TEST(Features, ToAndFromACrs) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.geojson", collection(feature("LineString", "[[-105.5,37.5,1],[-104.25,38,2]]")));
    const Features utm = read_features(folder / "a.geojson", in_crs("EPSG:32613"));
    // The reference is not PROJ but GeographicLib.
    const Utm expected = utm_from_geodetic({38 * degrees, -104.25 * degrees, EllipsoidalHeight{}}, 13);
    ASSERT_EQ(utm.lines.size(), 1u);
    EXPECT_NEAR(utm.lines[0][1].x, expected.easting, 1e-6);
    EXPECT_NEAR(utm.lines[0][1].y, expected.northing, 1e-6);
    EXPECT_EQ(utm.lines[0][1].z, 2);

    write_bytes(folder / "utm.geojson", collection(feature("Point", "[455000.1,4150000.7]"), "EPSG::32613"));
    const Features back = read_features(folder / "utm.geojson");
    const Geodetic there = geodetic_from_utm({13, true, 455000.1, 4150000.7});
    EXPECT_NEAR(back.points.at(0).x, there.longitude / degrees, 1e-11);
    EXPECT_NEAR(back.points.at(0).y, there.latitude / degrees, 1e-11);
    // From a CRS to the same one no bit changes: what lies on a sample stays on it.
    const Features same_crs = read_features(folder / "utm.geojson", in_crs("EPSG:32613"));
    EXPECT_TRUE(same(same_crs.points.at(0), {455000.1, 4150000.7, nan}));

    EXPECT_THROW(read_features(folder / "a.geojson", in_crs("EPSG:1")), Error);
    EXPECT_THROW(read_features(folder / "a.geojson", in_crs((folder / "a.geojson").c_str())), Error);
}

TEST(Features, AFileWithoutACrsIsInTheOneAskedFor) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.csv", "x,y,z\n455000.1,4150000.7,12.5\n455001,4150002,\n");
    const Features f = read_features(folder / "a.csv", in_crs("EPSG:32613"));
    ASSERT_EQ(f.points.size(), 2u);
    EXPECT_TRUE(same(f.points[0], {455000.1, 4150000.7, 12.5}));
    EXPECT_TRUE(same(f.points[1], {455001, 4150002, nan}));
    EXPECT_ERROR(error_of(folder / "a.csv"),
                 "holds the longitude and latitude (455000.1, 4150000.7, 12.5); accepted: ");
    FeatureOptions plain;
    plain.plain = true;
    EXPECT_TRUE(same(read_features(folder / "a.csv", plain).points.at(0), {455000.1, 4150000.7, 12.5}));
}

TEST(Features, HeightsInFeetBecomeMetres) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.csv", "lon,lat,ele\n8,46,1000\n");
    write_bytes(folder / "a.vrt",
                "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource relativeToVRT=\"1\">a.csv</SrcDataSource>"
                "<LayerSRS>EPSG:4326+6360</LayerSRS>"
                "<GeometryField encoding=\"PointFromColumns\" x=\"lon\" y=\"lat\" z=\"ele\"/>"
                "</OGRVRTLayer></OGRVRTDataSource>");
    const Features f = read_features(folder / "a.vrt");
    EXPECT_EQ(f.points.at(0).x, 8);
    EXPECT_NEAR(f.points.at(0).z, 1000 * 1200.0 / 3937, 1e-9);
}

TEST(Features, GpxGivesHeightsAndEachVertexOnce) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.gpx",
                "<?xml version=\"1.0\"?><gpx version=\"1.1\" creator=\"a\" xmlns=\"http://www.topografix.com/GPX/1/1\">"
                "<wpt lat=\"46\" lon=\"8\"><ele>500</ele></wpt><wpt lat=\"46\" lon=\"9\"/>"
                "<trk><trkseg><trkpt lat=\"46\" lon=\"8\"><ele>100</ele></trkpt>"
                "<trkpt lat=\"47\" lon=\"8\"><ele>200</ele></trkpt>"
                "<trkpt lat=\"47\" lon=\"9\"/></trkseg></trk>"
                "<trk><trkseg><trkpt lat=\"46\" lon=\"8\"/><trkpt lat=\"47\" lon=\"8\"/></trkseg></trk></gpx>");
    const Features f = read_features(folder / "a.gpx");
    ASSERT_EQ(f.points.size(), 2u);
    EXPECT_TRUE(same(f.points[0], {8, 46, 500}));
    EXPECT_TRUE(same(f.points[1], {9, 46, nan}));
    ASSERT_EQ(f.lines.size(), 2u);
    EXPECT_TRUE(same(f.lines[0][1], {8, 47, 200}));
    EXPECT_TRUE(same(f.lines[0][2], {9, 47, nan})) << "OGR says 0";
    EXPECT_TRUE(same(f.lines[1][1], {8, 47, nan}));
}

TEST(Features, KmlMeansItsHeightsOnlyWhenItSaysSo) {
    const TemporaryFolder folder;
    const auto placemark = [](const std::string& mode, const std::string& z) {
        return "<Placemark><Point>" + (mode.empty() ? "" : "<altitudeMode>" + mode + "</altitudeMode>") +
               "<coordinates>8,46" + z + "</coordinates></Point></Placemark>";
    };
    write_bytes(folder / "a.kml",
                "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>" + placemark("", "") +
                    placemark("", ",0") + placemark("", ",700") + placemark("absolute", ",0") +
                    placemark("clampToGround", ",700") + placemark("relativeToGround", ",2") +
                    "<Placemark><LineString><coordinates>8,46 9,47</coordinates></LineString></Placemark>"
                    "</Document></kml>");
    const Features f = read_features(folder / "a.kml");
    const double z[] = {nan, nan, 700, 0, nan, nan};
    ASSERT_EQ(f.points.size(), std::size(z));
    for (std::size_t i = 0; i < std::size(z); ++i) EXPECT_TRUE(same(f.points[i], {8, 46, z[i]})) << i;
    ASSERT_EQ(f.lines.size(), 1u);
    EXPECT_TRUE(same(f.lines[0][1], {9, 47, nan}));
}

TEST(Features, NothingIsWrittenBesideTheSource) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.gml",
                "<?xml version=\"1.0\"?><ogr:FeatureCollection xmlns:ogr=\"http://ogr.maptools.org/\" "
                "xmlns:gml=\"http://www.opengis.net/gml\"><gml:featureMember><ogr:a fid=\"1\"><ogr:g><gml:Point>"
                "<gml:coordinates>1,2</gml:coordinates></gml:Point></ogr:g></ogr:a></gml:featureMember>"
                "</ogr:FeatureCollection>");
    write_bytes(folder / "b.geojson", collection(feature("Point", "[1,2]")));
    EXPECT_EQ(read_features(folder / "a.gml").points.size(), 1u);
    EXPECT_EQ(read_features(folder / "b.geojson").points.size(), 1u);
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        names.insert(entry.path().filename().string());
    EXPECT_EQ(names, (std::set<std::string>{"a.gml", "b.geojson"}));
}

TEST(Features, EachBadFileGetsItsOwnLine) {
    const TemporaryFolder folder;
    const auto written = [&](const std::string& name, const std::string& text) {
        write_bytes(folder / name, text);
        return error_of(folder / name);
    };
    EXPECT_ERROR(error_of(folder / "missing.geojson"), "no such file; accepted: a vector file, e.g. GeoJSON");
    EXPECT_ERROR(written("empty.geojson", ""), "is empty");
    EXPECT_ERROR(written("text.txt", "Dear all,\nthis is no map.\n"), "cannot be read");
    EXPECT_ERROR(written("picture.tif", testing::tiff_bytes(4, 4, true, [](int, int) { return std::int16_t{1}; })),
                 "is a raster (GTiff), not features; accepted: a vector file");
    EXPECT_ERROR(written("none.geojson", collection("")), "holds no points, lines or polygons");
    EXPECT_ERROR(written("null.geojson", collection(R"({"type":"Feature","properties":{},"geometry":null})")),
                 "holds no points, lines or polygons");
    EXPECT_ERROR(written("table.csv", "name,age\nAda,36\n"), "holds no points, lines or polygons");
    EXPECT_ERROR(written("inf.geojson", collection(feature("LineString", "[[1,2],[1e999,3]]"))),
                 "holds the coordinates (inf, 3); accepted: finite numbers");
    EXPECT_ERROR(written("nan.geojson", collection(feature("LineString", "[[1,2],[NaN,3]]"))),
                 "holds the coordinates (nan");
    EXPECT_ERROR(written("point.geojson", collection(feature("Point", "[3,NaN]"))), "holds the coordinates (3, nan");
    EXPECT_ERROR(written("deep.geojson", collection(feature("Point", "[3,4,-1e999]"))),
                 "holds the coordinates (3, 4, -inf)");
    EXPECT_ERROR(written("metres.geojson", collection(feature("Point", "[455000,4150000]"))),
                 "holds the longitude and latitude (455000, 4150000); accepted: latitudes from -90 to 90");
    write_bytes(folder / "pole.geojson", collection(feature("Point", "[0,90]")));
    EXPECT_EQ(error_of(folder / "pole.geojson"), "");
    EXPECT_EQ(written("far.geojson", collection(feature("Point", "[-15,0]"))), "");
    EXPECT_ERROR(error_of(folder / "far.geojson", in_crs("EPSG:32613")), "(-15, 0) has no place in the CRS wanted");
    EXPECT_ERROR(written("ecef.geojson", collection(feature("Point", "[6378137,0,0]"), "EPSG::4978")), "geocentric");
}

TEST(Features, ACutFileIsRefusedOrWhole) {
    const TemporaryFolder folder;
    const std::string whole = collection(feature("Point", "[1,2]") + "," + feature("LineString", "[[0,0],[1,1]]"));
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write_bytes(folder / "cut.geojson", whole.substr(0, length));
        EXPECT_NE(error_of(folder / "cut.geojson"), "") << length;
    }
    // The first record is sound, so this shows only while reading.
    write_bytes(folder / "b.geojsonl", feature("Point", "[1,2]") + "\n" + feature("Point", "[3,") + "\n");
    EXPECT_ERROR(error_of(folder / "b.geojsonl"), "is damaged or cut short");
}

TEST(Features, TooManyVerticesAreRefused) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.geojson",
                collection(feature("Point", "[1,2]") + "," + feature("Polygon", "[[[0,0],[9,0],[9,9],[0,0]]]")));
    FeatureOptions options;
    options.max_vertices = 5;
    EXPECT_EQ(read_features(folder / "a.geojson", options).vertex_count(), 5u);
    options.max_vertices = 4;
    EXPECT_ERROR(error_of(folder / "a.geojson", options), "holds too many vertices; accepted: at most 4 vertices");
    std::string arc = "id,WKT\n1,\"CIRCULARSTRING (0 0";
    for (int i = 1; i <= 2000; ++i) arc += ", " + std::to_string(i) + (i % 2 ? " 1" : " 0");
    write_bytes(folder / "arc.csv", arc + ")\"\n");
    options.max_vertices = 10'000;
    EXPECT_ERROR(error_of(folder / "arc.csv", options), "curves of too many vertices; accepted: at most 10000");
}

Raster raster_of(const std::string& path, const RasterFile& file, const RasterOptions& options = {}) {
    write_raster<std::int16_t>(path, file, [](int c, int) { return static_cast<std::int16_t>(c); });
    return read_raster(path, options);
}

TEST(Features, InTheCoordinatesOfARaster) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.geojson", collection(feature("Point", "[-105.5,37.5]")));
    const Raster utm = raster_of(folder / "utm", {3, 2, "EPSG:32613", {4e5, 30, 0, 4.2e6, 0, -30}, ""});
    glm::dvec2 expected(-105.5, 37.5);
    utm.transform->crs_from_geodetic({&expected, 1});
    const glm::dvec3 found = read_features(folder / "a.geojson", utm).points.at(0);
    EXPECT_NEAR(found.x, expected.x, 1e-8);
    EXPECT_NEAR(found.y, expected.y, 1e-8);
    // A CRS without a code travels as WKT.
    const Raster lambert = raster_of(
        folder / "lambert", {3, 2, "+proj=laea +lat_0=37 +lon_0=-105 +datum=WGS84", {0, 30, 0, 0, 0, -30}, ""});
    expected = {-105.5, 37.5};
    lambert.transform->crs_from_geodetic({&expected, 1});
    EXPECT_NEAR(read_features(folder / "a.geojson", lambert).points.at(0).x, expected.x, 1e-8);
    EXPECT_ERROR(error_of(folder / "a.geojson", utm, std::int64_t{0}), "too many vertices");
}

TEST(Features, OfAPlainRasterStayAsTheyAre) {
    const TemporaryFolder folder;
    RasterOptions options;
    options.plain = true;
    const Raster plain = raster_of(folder / "plain", {3, 2, "", {0, 0, 0, 0, 0, 0}, ""}, options);
    write_bytes(folder / "a.geojson", collection(feature("Point", "[1000,-700]")));  // GDAL calls that WGS84
    EXPECT_TRUE(same(read_features(folder / "a.geojson", plain).points.at(0), {1000, -700, nan}));
}

TEST(Features, LongitudesTurnToWhereTheRasterIs) {
    const TemporaryFolder folder;
    const Raster fiji = raster_of(folder / "fiji", {20, 10, "EPSG:4326", {170, 1, 0, -10, 0, -1}, ""});
    write_bytes(folder / "a.geojson",
                collection(feature("Point", "[-179,-15]") + "," + feature("LineString", "[[179,-15],[181,-15]]") + "," +
                           feature("Polygon",
                                   "[[[-178,-16],[-176,-16],[-176,-15],[-178,-16]],"
                                   "[[-177,-16],[-176.5,-16],[-176.5,-15.5],[-177,-16]]]")));
    const Features f = read_features(folder / "a.geojson", fiji);
    EXPECT_EQ(f.points.at(0).x, 181);
    EXPECT_EQ(f.lines.at(0)[0].x, 179);
    EXPECT_EQ(f.lines.at(0)[1].x, 181);
    EXPECT_EQ(f.polygons.at(0).outer[0].x, 182);
    EXPECT_EQ(f.polygons.at(0).holes.at(0)[0].x, 183);
}

TEST(Features, OfAnotherPlanetMayPassForWgs84) {
    const TemporaryFolder folder;
    const Raster moon = raster_of(folder / "moon", {4, 3, "+proj=eqc +R=1737400", {0, 1000, 0, 0, 0, -1000}, ""});
    write_bytes(folder / "a.geojson", collection(feature("Point", "[1,-2]")));
    const glm::dvec3 found = read_features(folder / "a.geojson", moon).points.at(0);
    EXPECT_NEAR(found.x, 1737400 * std::numbers::pi / 180, 1e-6);
    EXPECT_NEAR(found.y, -2 * 1737400 * std::numbers::pi / 180, 1e-6);
}

// Every "[12.5,-3]" of a GeoJSON file.
std::size_t positions_in(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::size_t n = 0;
    for (std::size_t i = 0; i + 1 < text.size(); ++i)
        n += text[i] == '[' && (text[i + 1] == '-' || (text[i + 1] >= '0' && text[i + 1] <= '9')) ? 1 : 0;
    return n;
}

TEST(Features, TheCoastlinesAndBordersThatShip) {
    for (const char* name : {"coastlines", "borders"}) {
        const std::string path = std::string(OCTAGLOBE_SOURCE_DIR "/data/") + name + ".geojson";
        const Features f = read_features(path);
        EXPECT_GT(f.lines.size(), 100u);
        EXPECT_TRUE(f.points.empty());
        EXPECT_TRUE(f.polygons.empty());
        EXPECT_EQ(f.vertex_count(), positions_in(path)) << name;
        for (const auto& line : f.lines)
            for (const glm::dvec3& v : line) {
                ASSERT_LE(std::abs(v.x), 180);
                ASSERT_LE(std::abs(v.y), 90);
                ASSERT_TRUE(std::isnan(v.z));
            }
    }
}

}  // namespace
}  // namespace planet
