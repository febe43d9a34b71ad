// octaglobe query, as a user runs it: answers, files, and what is refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "planet/elevation/raster_io.h"
#include "render/app/query/place_list.h"
#include "render/app/query/profile_chart.h"
#include "tests/render/app/baked_store.h"

namespace render {
namespace {

/// A tent of 1,000 m along longitude 10.2 over a store of its own, at sea level around it.
class Query : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new ScratchFolder;
        Terrain terrain;
        terrain.height_m = [](int column, int) { return 1000 - 50.0 * std::abs(column - 20); };
        terrain.write(*folder_ / "dem.tif");
        bake(*folder_, "dem.tif");
    }
    static void TearDownTestSuite() { delete folder_; }

    static Outcome query(const std::string& arguments) {
        return run(folder_->path(), words("query " + arguments + " --store store.octa"));
    }
    static nlohmann::json answer(const std::string& arguments) {
        const Outcome outcome = query(arguments + " --json answer.json");
        EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
        EXPECT_EQ(outcome.err, "");
        return outcome.status == 0 ? nlohmann::json::parse(content(*folder_ / "answer.json")) : nlohmann::json();
    }
    static void write(const char* name, const std::string& text) {
        std::ofstream(*folder_ / name, std::ios::binary) << text;
    }
    static inline ScratchFolder* folder_ = nullptr;
};

TEST_F(Query, HeightOfSeveralPlaces) {
    const Outcome outcome = query("height 49.84,10.2 -30,-40 49.84,10.1");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::istringstream lines(outcome.out);
    std::string line;
    const double expected[] = {1000, 0, 500};
    for (const double height : expected) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_NEAR(std::strtod(line.c_str(), nullptr), height, 60) << line;
    }
    EXPECT_FALSE(std::getline(lines, line));
    const auto json = answer("height 49.84,10.2 -30,-40 --datum ellipsoid");
    ASSERT_EQ(json.at("heights").size(), 2u);
    EXPECT_EQ(json.at("vertical_datum"), "ellipsoid");
    for (const auto& each : json.at("heights"))
        EXPECT_EQ(each.at("height_m").get<double>(),
                  each.at("orthometric_height_m").get<double>() + each.at("geoid_undulation_m").get<double>());
    EXPECT_TRUE(json.at("heights")[1].at("height_bound_m").is_null());
}

// Cells of the sea are 176 km wide here, and their planes 600 m deep.
TEST_F(Query, TheSeaIsAtZero) {
    for (const char* place : {"-30,-40", "12,-177.3", "-89,5"})
        EXPECT_TRUE(query("height " + std::string(place)).out.starts_with("0.00 m above EGM96")) << place;
}

TEST_F(Query, HeightsOfATable) {
    write("points.csv", "name;lon;lat\na;10.2;49.84\n\nb;190;-30\r\n");
    const Outcome outcome = query("height --points points.csv -o heights.csv");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::istringstream lines(content(*folder_ / "heights.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "latitude_deg,longitude_deg,height_m,ellipsoidal_height_m,height_bound_m,source,blended_with");
    std::getline(lines, line);
    EXPECT_TRUE(line.starts_with("49.840000000,10.200000000,")) << line;
    std::getline(lines, line);
    EXPECT_TRUE(line.starts_with("-30.000000000,-170.000000000,0.000,")) << line;
    EXPECT_FALSE(std::getline(lines, line));

    write("points.geojson", R"({"type":"MultiPoint","coordinates":[[10.2,49.84],[10.1,49.84]]})");
    const Outcome features = query("height --points points.geojson");
    EXPECT_EQ(features.status, 0) << features.err;
    EXPECT_EQ(std::count(features.out.begin(), features.out.end(), '\n'), 3);
}

TEST_F(Query, ProfileAsTableAndFigure) {
    const auto json = answer("profile 49.84,10.02 49.84,10.38 --samples 361 -o profile.csv");
    EXPECT_NEAR(json.at("highest_m").get<double>(), 1000, 60);
    EXPECT_GT(json.at("terrain_length_m").get<double>(), json.at("distance_m").get<double>());
    EXPECT_NEAR(json.at("ascent_m").get<double>(), json.at("highest_m").get<double>() - 100, 60);
    std::istringstream lines(content(*folder_ / "profile.csv"));
    std::string line;
    int rows = -1;
    double last = -1, steepest = 0;
    for (; std::getline(lines, line); ++rows) {
        if (rows < 0) continue;
        const double distance = std::strtod(line.c_str(), nullptr);
        EXPECT_GT(distance, last);
        last = distance;
        std::istringstream fields(line);
        std::string field;
        for (int i = 0; i < 6; ++i) std::getline(fields, field, ',');
        steepest = std::max(steepest, std::strtod(field.c_str(), nullptr));
    }
    EXPECT_EQ(rows, 361);
    EXPECT_NEAR(last, json.at("distance_m").get<double>(), 0.001);
    EXPECT_NEAR(steepest, 100 * 5000.0 / (111320 * 0.6448), 3);  // 5000 m a degree of longitude at 49.84

    ASSERT_EQ(query("profile 49.84,10.02 49.9,10.2 49.84,10.38 --curvature -o profile.svg").status, 0);
    const std::string svg = content(*folder_ / "profile.svg");
    EXPECT_TRUE(svg.starts_with("<svg ")) << svg;
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    for (const char* word : {"Vertical exaggeration", "Distance along the ellipsoid (km)", "Height above the chord (m)",
                             "curvature", "stroke-dasharray"})
        EXPECT_NE(svg.find(word), std::string::npos) << word;
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(ProfileChart, TicksAreRound) {
    EXPECT_EQ(ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
    EXPECT_EQ(ticks(-3, 22, 6), (std::vector<double>{0, 5, 10, 15, 20}));
    EXPECT_EQ(ticks(0.1, 0.35, 3), (std::vector<double>{0.1, 0.2, 0.30000000000000004}));
    for (const double span : {1e-3, 1.0, 7.3, 99.0, 8848.0, 2e7})
        for (const double low : {-0.3 * span, 0.0, 1234.5}) {
            const auto list = ticks(low, low + span, 6);
            EXPECT_GE(list.size(), 3u);
            EXPECT_LE(list.size(), 7u);
            EXPECT_GE(list.front(), low - 1e-9 * span);
            EXPECT_LE(list.back(), low + span + 1e-9 * span);
        }
}

TEST(ProfileChart, DrawsFlatShortAndLongProfiles) {
    ProfileChart flat{{0, 0}, {5, 5}, {}, "a<b", "c&d", "EGM96", "", 0};
    const std::string text = svg_of(flat);
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf"), std::string::npos);
    EXPECT_NE(text.find("a&lt;b"), std::string::npos);
    EXPECT_NE(text.find("c&amp;d"), std::string::npos);
    ProfileChart large;
    for (int i = 0; i < 200000; ++i) {
        large.distance.push_back(i);
        large.height.push_back(i == 77777 ? 9000 : std::sin(i));
    }
    const std::string reduced = svg_of(large);
    EXPECT_LT(reduced.size(), 400000u);
    EXPECT_NE(reduced.find(" 71."), std::string::npos);  // the one peak is still there, at the top
}

TEST_F(Query, DistanceOnTerrain) {
    const auto json = answer("distance 49.84,10.02 49.84,10.38 --on-terrain");
    const double run = json.at("distance_m").get<double>(), slope = 5000.0 / (111320 * 0.6448);
    EXPECT_NEAR(json.at("terrain_length_m").get<double>() / run, std::sqrt(1 + slope * slope), 4e-4);
    EXPECT_TRUE(json.at("unique").get<bool>());
    EXPECT_FALSE(answer("distance 0,0 0,180").at("unique").get<bool>());
}

TEST_F(Query, AreasOfFilesAndCorners) {
    // Colorado; the same by GeographicLib's Planimeter.
    const auto state = answer("area 37,-109.05 41,-109.05 41,-102.05 37,-102.05");
    EXPECT_NEAR(state.at("area_m2").get<double>(), 269154549884.0, 1);
    write("ring.geojson", R"({"type":"Polygon","coordinates":[
        [[10.05,49.75],[10.35,49.75],[10.35,49.95],[10.05,49.95],[10.05,49.75]],
        [[10.1,49.8],[10.1,49.9],[10.3,49.9],[10.3,49.8],[10.1,49.8]]]})");
    const auto ring = answer("area ring.geojson --on-terrain");
    const double outer = answer("area 49.75,10.05 49.75,10.35 49.95,10.35 49.95,10.05").at("area_m2").get<double>();
    const double hole = answer("area 49.8,10.1 49.8,10.3 49.9,10.3 49.9,10.1").at("area_m2").get<double>();
    EXPECT_NEAR(ring.at("area_m2").get<double>(), outer - hole, 0.01);
    EXPECT_EQ(ring.at("holes"), 1);
    const double slope = 5000.0 / (111320 * 0.6448);
    EXPECT_NEAR(ring.at("terrain_area_m2").get<double>() / (outer - hole), std::sqrt(1 + slope * slope), 1e-3);
    EXPECT_LT(ring.at("terrain_area_bound_m2").get<double>(), 1e-4 * outer);
    // Across the antimeridian and around a pole, in a file and on the command line.
    write("pole.geojson", R"({"type":"Polygon","coordinates":[[[0,80],[120,80],[-120,80],[0,80]]]})");
    EXPECT_NEAR(answer("area pole.geojson").at("area_m2").get<double>(),
                answer("area 80,0 80,120 80,-120").at("area_m2").get<double>(), 0.01);
}

TEST_F(Query, LineOfSightOverTheTent) {
    const auto hidden = answer("line-of-sight 49.84,10.05 49.84,10.35 --eye-height 300 --target-height 5");
    EXPECT_EQ(hidden.at("visible"), false);
    EXPECT_EQ(hidden.at("visibility"), "hidden");
    EXPECT_NEAR(hidden.at("obstruction_longitude_deg").get<double>(), 10.2, 0.01);
    EXPECT_NEAR(hidden.at("clearance_m").get<double>(), -600, 80);
    const auto seen = answer("line-of-sight 49.84,10.05 49.84,10.35 --eye-height 2km --target-height 2km");
    EXPECT_EQ(seen.at("visibility"), "visible");
    EXPECT_GT(seen.at("clearance_m").get<double>(), 1000);
    EXPECT_EQ(answer("line-of-sight 49.84,10.16 49.84,10.19").at("visibility"), "undecided");
    EXPECT_TRUE(query("line-of-sight 49.84,10.05 49.84,10.35").out.find(" m, hidden: ") != std::string::npos);
}

TEST_F(Query, ViewshedAsRasterOutlineAndPicture) {
    const auto json = answer("viewshed 49.84,10.1 --radius 12km --cell 150 --eye-height 10 -o view.tif");
    const double share = json.at("visible_share").get<double>();
    EXPECT_GT(share, 0.2);
    EXPECT_LT(share, 0.95);
    // Its cells lie where its CRS says: those behind the ridge, which is in the east, are hidden.
    const planet::Raster raster = planet::read_raster(*folder_ / "view.tif");
    EXPECT_EQ(raster.width, 161);
    EXPECT_EQ(raster.height, 161);
    std::vector<glm::dvec2> place{{10.1, 49.84}, {10.23, 49.84}, {10.19, 49.86}};
    ASSERT_TRUE(raster.transform);
    raster.transform->crs_from_geodetic(place);
    EXPECT_NEAR(place[0].x, 0, 1e-3);
    EXPECT_NEAR(place[0].y, 0, 1e-3);
    const auto at = [&](glm::dvec2 xy) {
        const glm::dvec2 from = xy - raster.grid.origin;
        return raster.at(static_cast<int>(std::lround(from.x / raster.grid.per_column.x)),
                         static_cast<int>(std::lround(from.y / raster.grid.per_row.y)));
    };
    EXPECT_EQ(at(place[0]), 1);
    EXPECT_EQ(at(place[1]), 0);
    EXPECT_EQ(at(place[2]), 1);
    EXPECT_TRUE(std::isnan(raster.at(0, 0)));

    ASSERT_EQ(query("viewshed 49.84,10.1 --radius 12km --cell 150 --eye-height 10 -o view.geojson").status, 0);
    const auto area = answer("area view.geojson");
    EXPECT_NEAR(area.at("area_m2").get<double>() / json.at("visible_area_m2").get<double>(), 1, 1e-3);

    ASSERT_EQ(query("viewshed 49.84,10.1 --radius 3km --cell 100 -o view.png").status, 0);
    EXPECT_TRUE(content(*folder_ / "view.png").starts_with("\x89PNG"));
}

struct BadQuery {
    const char* arguments;
    int status;
    const char* line;
};

TEST_F(Query, RefusesInOneLine) {
    write("broken.geojson", R"({"type":"Polygon","coordinates":[[[0,0],[1,0],[1,)");
    write("line.geojson", R"({"type":"LineString","coordinates":[[0,0],[1,0]]})");
    write("beyond.geojson", R"({"type":"Polygon","coordinates":[[[0,89],[1,91],[1,80],[0,89]]]})");
    write("nan.csv", "lat,lon\n1,2\nnan,3\n");
    write("far.csv", "1,2\n91,3\n");
    write("words.csv", "here,there\n1,2\n");
    write("none.csv", "lat,lon\n");
    const BadQuery bad[] = {
        {"height", 2, "octaglobe: query height: place"},
        {"height 1,2 --points far.csv", 2, "octaglobe: query height: --points"},
        {"height 1,2 91,0", 2, "octaglobe: place: latitude 91 is out of range"},
        {"height --points missing.csv", 3, "octaglobe: missing.csv: "},
        {"height --points nan.csv", 3, "octaglobe: nan.csv line 3: "},
        {"height --points far.csv", 3, "octaglobe: far.csv line 2: latitude is out of range"},
        {"height --points words.csv", 3, "octaglobe: words.csv: its first line names no columns"},
        {"height --points none.csv", 3, "octaglobe: none.csv: holds no place"},
        {"height --points line.geojson", 3, "octaglobe: line.geojson: holds no point"},
        {"height 1,2 --datum navd88", 2, "octaglobe: --datum: 'navd88' is unknown"},
        {"profile 1,2", 2, "octaglobe: query profile: place"},
        {"profile 1,2 nan,3", 2, "octaglobe: place: 'nan,3' is not a place"},
        {"profile 1,2 3,4 -o x.pdf", 2, "octaglobe: --output: 'x.pdf' has no ending of a profile"},
        {"profile 1,2 3,4 --samples 1", 2, "octaglobe: --samples: '1' is out of range"},
        {"profile 1,2 3,4 -o no/such/x.svg", 2, "octaglobe: --output: "},
        {"distance 1,2 --on-terrain", 2, "octaglobe: query distance: to"},
        {"area 1,2 3,4", 2, "octaglobe: polygon: 2 corners are no polygon"},
        {"area 1,2 3,4 5,x", 2, "octaglobe: polygon: '5,x' is not a place"},
        {"area 1,2 1,2 1,2", 3, "octaglobe: polygon: has a ring of fewer than three"},
        {"area missing.geojson", 3, "octaglobe: missing.geojson: "},
        {"area broken.geojson", 3, "octaglobe: broken.geojson: "},
        {"area line.geojson", 3, "octaglobe: line.geojson: holds no polygon"},
        {"area beyond.geojson", 3, "octaglobe: beyond.geojson: "},
        {"line-of-sight 1,2", 2, "octaglobe: query line-of-sight: to"},
        {"line-of-sight 40,-100 -40,80", 2, "octaglobe: line of sight: 20004 km is too long"},
        {"line-of-sight 1,2 3,4 --eye-height 0", 2, "octaglobe: --eye-height: '0' is out of range"},
        {"line-of-sight 1,2 3,4 --eye-height -2", 2, "octaglobe: --eye-height: "},
        {"line-of-sight 1,2 3,4 --refraction 1", 2, "octaglobe: --refraction: '1' is out of range"},
        {"viewshed 1,2 --radius 501km", 2, "octaglobe: --radius: '501km' is out of range"},
        {"viewshed 1,2 --radius 100km --cell 1m", 2, "octaglobe: cell: "},
        {"viewshed 1,2 -o x.jpg", 2, "octaglobe: --output: 'x.jpg' has no ending of a viewshed"},
        {"viewshed 1,2 --radius 1km -o no/such/x.tif", 2, "octaglobe: --output: "},
        {"viewshed 1,2 --radius 1km -o no/such/x.png", 2, "octaglobe: --output: "},
    };
    const auto before = folder_->names();
    for (const BadQuery& each : bad) {
        const Outcome outcome = query(each.arguments);
        EXPECT_EQ(outcome.status, each.status) << each.arguments << ": " << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with(each.line)) << each.arguments << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "") << each.arguments;
    }
    EXPECT_EQ(folder_->names(), before);
}

// A million points on a line are no polygon; a million corners are one.
TEST_F(Query, AMillionPoints) {
    std::string line = "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Placemark><LineString><coordinates>";
    for (int i = 0; i < 1000000; ++i) line += std::to_string(i % 1000 * 0.001) + "," + std::to_string(i * 1e-6) + " ";
    write("line.kml", line + "</coordinates></LineString></Placemark></kml>");
    const Outcome outcome = query("area line.kml");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err,
              "octaglobe: line.kml: holds no polygon; accepted: a vector file with polygons, e.g. GeoJSON "
              "or KML\n");
    std::string table;
    for (int i = 0; i < 1000000; ++i) table += std::to_string(i % 181 - 90) + "," + std::to_string(i % 360) + "\n";
    EXPECT_EQ(places_from_table("table", table).size(), 1000000u);
}

// Stopped in the middle: no part of a file is left.
TEST_F(Query, AnInterruptedViewshedLeavesNothing) {
    const auto before = folder_->names();
    Process process(folder_->path(), words("query viewshed 49.84,10.1 --radius 100km --cell 30 --store store.octa -o "
                                           "interrupted.tif --json interrupted.json"));
    ::usleep(300000);
    ::kill(process.id(), SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_NE(outcome.status, 0);
    EXPECT_EQ(folder_->names(), before);
}

}  // namespace
}  // namespace render
