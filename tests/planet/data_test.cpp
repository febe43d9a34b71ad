// The data that ships: that it is what data/README.md says, by values known from elsewhere.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "planet/elevation/image_io.h"
#include "planet/elevation/raster_field.h"
#include "planet/elevation/raster_io.h"
#include "planet/elevation/sha256.h"
#include "planet/elevation/surface_field.h"
#include "planet/geodesy/geoid.h"

namespace planet {
namespace {

namespace fs = std::filesystem;

const fs::path data = fs::path(OCTAGLOBE_SOURCE_DIR) / "data";

const Raster& relief() {
    static const Raster raster = read_raster(data / "etopo5.tif");
    return raster;
}
const Raster& land_mask() {
    static const Raster raster = read_raster(data / "land_mask.tif");
    return raster;
}
const Raster& mountains() {
    static const Raster raster = read_raster(data / "sangre_de_cristo.tif");
    return raster;
}

/// The cell of the 5' grids that holds a position in degrees.
struct Cell {
    int column, row;
};
Cell cell_at(double latitude, double longitude) {
    return {static_cast<int>((longitude + 180) * 12), static_cast<int>((90 - latitude) * 12)};
}
double relief_at(double latitude, double longitude) {
    const Cell c = cell_at(latitude, longitude);
    return relief().at(c.column, c.row);
}
bool land_at(double latitude, double longitude) {
    const Cell c = cell_at(latitude, longitude);
    return land_mask().at(c.column, c.row) == 1;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double mean_a = 0, mean_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i], mean_b += b[i];
    mean_a /= static_cast<double>(a.size()), mean_b /= static_cast<double>(b.size());
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += (a[i] - mean_a) * (b[i] - mean_b);
        aa += (a[i] - mean_a) * (a[i] - mean_a);
        bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return ab / std::sqrt(aa * bb);
}

TEST(Data, EveryFileIsListedWithItsChecksum) {
    std::stringstream readme;
    readme << std::ifstream(data / "README.md").rdbuf();
    std::set<std::string> listed;
    std::ifstream sums(data / "SHA256SUMS");
    for (std::string digest, name; sums >> digest >> name; listed.insert(name)) {
        EXPECT_EQ(sha256_of_file(data / name), digest) << name;
        EXPECT_NE(readme.str().find("`" + digest.substr(0, 12) + "`"), std::string::npos) << name;
    }
    std::set<std::string> found;
    std::uintmax_t total = 0;
    for (const auto& entry : fs::directory_iterator(data)) {
        total += entry.is_regular_file() ? entry.file_size() : 0;
        const std::string extension = entry.path().extension();
        const bool made = !extension.empty() && extension != ".py" && extension != ".md";
        if (entry.is_regular_file() && made) found.insert(entry.path().filename());
    }
    EXPECT_EQ(found, listed);
    EXPECT_GE(listed.size(), 10u);
    EXPECT_LT(total, 25'000'000u);
}

TEST(Data, ReliefCoversThePlanetInCells) {
    ASSERT_EQ(relief().width, 4320);
    ASSERT_EQ(relief().height, 2160);
    EXPECT_EQ(columns_around(relief()), 4320);
    EXPECT_EQ(poles_of(relief()).first, PoleRow::at_edge);
    EXPECT_EQ(poles_of(relief()).last, PoleRow::at_edge);
    EXPECT_NEAR(relief().grid.origin.x, -180 + 1.0 / 24, 1e-9);
    EXPECT_NEAR(relief().grid.origin.y, 90 - 1.0 / 24, 1e-9);
    for (int row = 0; row < 2160; ++row)
        for (int column = 0; column < 4320; ++column) {
            const double H = relief().at(column, row);
            ASSERT_TRUE(H >= -11000 && H <= 8850) << column << ' ' << row << ' ' << H;
        }
}

TEST(Data, ReliefOfKnownPlaces) {
    EXPECT_NEAR(relief_at(27.988, 86.925), 6096, 60);    // Everest, as low as 5' cells make it
    EXPECT_NEAR(relief_at(45.833, 6.865), 2613, 60);     // Mont Blanc
    EXPECT_NEAR(relief_at(-3.0758, 37.3533), 3962, 60);  // Kilimanjaro
    EXPECT_NEAR(relief_at(46.853, -121.76), 2704, 60);   // Rainier
    EXPECT_NEAR(relief_at(39.74, -104.99), 1622, 30);    // Denver
    EXPECT_LT(relief_at(31.5, 35.5), -300);              // the Dead Sea
    EXPECT_NEAR(relief_at(42, 50.5), -29, 5);            // the Caspian
    EXPECT_NEAR(relief_at(-89.99, 0), 2800, 60);         // the South Pole
    EXPECT_LT(relief_at(89.99, 0), -3500);               // the North Pole
    EXPECT_NEAR(relief_at(11.35, 142.2), -10000, 700);   // the Mariana Trench
}

TEST(Data, ReliefAtAPointIsThatOfItsCell) {
    const RasterField field(std::make_shared<const Raster>(relief()), VerticalDatum::egm96);
    EXPECT_NEAR(field.height(normal_from_geodetic(27.988 * degrees, 86.925 * degrees)), 6096, 60);
    EXPECT_NEAR(field.height(normal_from_geodetic(39.74 * degrees, -104.99 * degrees)), 1622, 30);
    EXPECT_LT(field.height(normal_from_geodetic(31.5 * degrees, 35.5 * degrees)), -300);
}

TEST(Data, ReliefIsWithoutTheStripesOfItsSource) {
    for (int longitude = 0; longitude < 40; ++longitude) EXPECT_GT(relief_at(-81.25, longitude + 0.5), 2400);
    for (int longitude = -45; longitude < -30; ++longitude)  // 300 to 1000 m, where the stripe stood 2100 m high
        EXPECT_LT(relief_at(-81.2, longitude + 0.5), 1100) << longitude;
    EXPECT_GT(relief_at(-13.05, 133.85), 200);  // Arnhem Land, drowned in the source
}

TEST(Data, ReliefHasLakesAtTheirLevels) {
    EXPECT_EQ(relief_at(47.7, -87.5), 183);    // Superior
    EXPECT_EQ(relief_at(43.5, -87.0), 176);    // Michigan
    EXPECT_EQ(relief_at(43.6, -77.8), 75);     // Ontario
    EXPECT_EQ(relief_at(66.29, -118.0), 156);  // Great Bear Lake, 440 m below the sea in the source
    EXPECT_EQ(relief_at(61.0, 31.5), 5);       // Ladoga
    EXPECT_EQ(relief_at(31.5, 35.5), -430);    // the Dead Sea, the lowest land of all
    EXPECT_EQ(relief_at(36.96, 50.96), -30);   // the south coast of the Caspian
    for (int row = 0; row < relief().height; ++row)
        for (int column = 0; column < relief().width; ++column) {
            if (land_mask().at(column, row) == 0) continue;
            ASSERT_GE(relief().at(column, row), row < 1800 ? -430 : 0) << column << ' ' << row;  // 1800: 60 S
        }
}

TEST(Data, ReliefIsWithoutTheSingleFaultsOfItsSource) {
    EXPECT_NEAR(relief_at(69.46, -120.71), 300, 200);   // the Melville Hills, 3205 m in the source
    EXPECT_NEAR(relief_at(60.71, -132.62), 1200, 300);  // the Yukon, 2715 m
    EXPECT_NEAR(relief_at(18.58, 101.9), 450, 200);     // Laos, -1006 m
    EXPECT_NEAR(relief_at(13.25, 109.25), 100, 100);    // the coast of Vietnam, 1981 m
}

/// Heights of 5' cells against means of a 3" model, with the cells taken from `columns` and `rows` beside their place.
double agreement_with_mountains(int columns, int rows) {
    const Raster& fine = mountains();
    std::vector<double> coarse, means;
    for (int row = 1; row < 11; ++row)
        for (int column = 1; column < 23; ++column) {
            double sum = 0;
            for (int y = 0; y < 100; ++y)
                for (int x = 0; x < 100; ++x) sum += fine.at(column * 100 + x, row * 100 + y);
            means.push_back(sum / 10000);
            const Cell c = cell_at(38 - (row + 0.5) / 12, -106 + (column + 0.5) / 12);
            coarse.push_back(relief().at(c.column + columns, c.row + rows));
        }
    return correlation(coarse, means);
}

TEST(Data, ReliefLiesWhereAFinerModelSays) {
    const double here = agreement_with_mountains(0, 0);
    EXPECT_GT(here, 0.995);
    for (int rows = -1; rows <= 1; ++rows)
        for (int columns = -1; columns <= 1; ++columns)
            if (rows != 0 || columns != 0) {
                EXPECT_LT(agreement_with_mountains(columns, rows), here - 0.02);
            }
}

TEST(Data, SeaIsBelowZeroAndOnlySea) {
    ASSERT_EQ(land_mask().width, relief().width);
    ASSERT_EQ(land_mask().height, relief().height);
    double land = 0, all = 0;
    for (int row = 0; row < land_mask().height; ++row)
        for (int column = 0; column < land_mask().width; ++column) {
            const double mask = land_mask().at(column, row);
            ASSERT_TRUE(mask == 0 || mask == 1);
            if (mask == 0) {
                ASSERT_LT(relief().at(column, row), 0) << column << ' ' << row;
            }
            const double area = std::cos((90 - (row + 0.5) / 12) * degrees);
            land += mask * area, all += area;
        }
    // 148.94 million km2 of 510.07 are land; of that, ice shelves (1.5) are sea here and the Caspian (0.37) is land.
    EXPECT_NEAR(land / all, (148.94 - 1.5 + 0.37) / 510.07, 0.004);
    for (const auto& [latitude, longitude] : {std::pair{42.0, 50.5},
                                              {31.5, 35.5},
                                              {-89.99, 0.0},
                                              {-86.0, 10.0},
                                              {67.0, 179.9},
                                              {67.0, -179.9},
                                              {0.0, 20.0},
                                              {47.7, -87.5}})
        EXPECT_TRUE(land_at(latitude, longitude)) << latitude << ' ' << longitude;
    for (const auto& [latitude, longitude] : {std::pair{89.99, 0.0},
                                              {-60.0, 0.0},
                                              {0.0, 179.99},
                                              {0.0, -179.99},
                                              {43.0, 34.0},
                                              {57.0, 19.5},
                                              {60.0, -85.0},
                                              {-82.0, -170.0}})
        EXPECT_FALSE(land_at(latitude, longitude)) << latitude << ' ' << longitude;
}

TEST(Data, SurfaceIsFlatAtSeaAndDeepAtTheDeadSea) {
    const auto surface = make_surface_field(relief(), land_mask(), VerticalDatum::egm96);
    EXPECT_EQ(surface->height(normal_from_geodetic(0, -140 * degrees)), 0);
    EXPECT_EQ(surface->height(normal_from_geodetic(std::acos(0.0), 0)), 0);
    EXPECT_LT(surface->height(normal_from_geodetic(31.5 * degrees, 35.5 * degrees)), -300);
    EXPECT_NEAR(surface->height(normal_from_geodetic(27.988 * degrees, 86.925 * degrees)), 6096, 60);
}

TEST(Data, MountainsAreInMetresAndInPlace) {
    const Raster& fine = mountains();
    ASSERT_EQ(fine.width, 2401);
    ASSERT_EQ(fine.height, 1201);
    EXPECT_NEAR(fine.grid.origin.x, -106, 1e-9);
    EXPECT_NEAR(fine.grid.origin.y, 38, 1e-9);
    EXPECT_NEAR(fine.grid.per_column.x, 1.0 / 1200, 1e-12);
    EXPECT_NEAR(fine.grid.per_row.y, -1.0 / 1200, 1e-12);
    double lowest = 9999, highest = 0;
    glm::dvec2 summit{0};
    for (int row = 0; row < fine.height; ++row)
        for (int column = 0; column < fine.width; ++column) {
            const double H = fine.at(column, row);
            ASSERT_FALSE(std::isnan(H));
            lowest = std::min(lowest, H);
            if (H > highest) highest = H, summit = fine.grid.crs_from_sample({column, row});
        }
    EXPECT_EQ(lowest, 1359);
    EXPECT_NEAR(highest, 4372, 60);  // Blanca Peak
    EXPECT_NEAR(summit.y, 37.5767, 1.0 / 1200);
    EXPECT_NEAR(summit.x, -105.4858, 1.0 / 1200);
}

TEST(Data, GeoidAtPublishedPoints) {
    const Geoid geoid(data / "egm96-15.pgm");
    const double points[][3] = {{38.6281550, 269.7791550, -31.628}, {-14.6212170, 305.0211140, -2.969},
                                {46.8743190, 102.4487290, -43.575}, {-23.6174460, 133.8747120, 15.871},
                                {38.6254730, 359.9995000, 50.066},  {-0.4667440, 0.0023000, 17.329}};
    for (const auto& [latitude, longitude, N] : points)
        EXPECT_NEAR(geoid.undulation(latitude * degrees, longitude * degrees).m, N, 0.02);
}

TEST(Data, PicturesCoverThePlanetFromTheAntimeridian) {
    const Image day = read_image(data / "blue_marble.jpg");
    const Image night = read_image(data / "night_lights.jpg");
    const Image water = read_image(data / "water_mask.png");
    for (const Image* image : {&day, &night}) EXPECT_EQ(image->width, 4096);
    for (const Image* image : {&day, &night, &water}) ASSERT_EQ(image->width, 2 * image->height);
    const auto at = [](const Image& image, double latitude, double longitude) {
        const std::uint8_t* p = image.pixel(static_cast<int>((longitude + 180) / 360 * image.width),
                                            static_cast<int>((90 - latitude) / 180 * image.height));
        return glm::ivec3(p[0], p[1], p[2]);
    };
    const glm::ivec3 sahara = at(day, 23, 10), pacific = at(day, 0, -140), antarctica = at(day, -80, 60);
    EXPECT_GT(sahara.r, sahara.b + 40);
    EXPECT_GT(pacific.b, pacific.r + 20);
    EXPECT_GT(antarctica.r, 200);
    EXPECT_GT(at(night, 48.86, 2.35).r, at(night, 47, -20).r + 60);  // Paris shines, the Atlantic does not
    std::vector<double> mask, picture;
    for (double latitude = -84.5; latitude < 85; ++latitude)
        for (double longitude = -179.5; longitude < 180; ++longitude) {
            mask.push_back(land_at(latitude, longitude));
            picture.push_back(255 - at(water, latitude, longitude).g);
        }
    EXPECT_GT(correlation(mask, picture), 0.9);
}

struct StarRow {
    double right_ascension, declination, magnitude, colour;  // degrees
};

std::vector<StarRow> read_star_rows() {
    std::ifstream file(data / "stars.csv");
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line, "right_ascension_deg,declination_deg,v_mag,b_v");
    std::vector<StarRow> stars;
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        StarRow s{};
        if (fields >> s.right_ascension >> s.declination >> s.magnitude >> s.colour)
            stars.push_back(s);
        else
            ADD_FAILURE() << line;
    }
    return stars;
}

TEST(Data, StarsAreWhereTheyShouldBe) {
    const std::vector<StarRow> stars = read_star_rows();
    EXPECT_NEAR(static_cast<double>(stars.size()), 8900, 600);  // the naked eye's, to 6.5
    for (const StarRow& s : stars) {
        EXPECT_TRUE(s.right_ascension >= 0 && s.right_ascension < 360 && std::abs(s.declination) <= 90);
        EXPECT_TRUE(s.magnitude >= -1.5 && s.magnitude <= 6.5 && s.colour >= -0.5 && s.colour <= 4);
    }
    // Sirius, Vega, Polaris, Betelgeuse: J2000 positions, V and B-V of the Bright Star Catalogue.
    const StarRow known[] = {{101.2872, -16.7161, -1.46, 0.00},
                             {279.2347, 38.7837, 0.03, 0.00},
                             {37.9546, 89.2641, 2.02, 0.60},
                             {88.7929, 7.4071, 0.50, 1.85}};
    for (const StarRow& k : known) {
        const auto off = [&](const StarRow& s) {
            return std::hypot((s.right_ascension - k.right_ascension) * std::cos(k.declination * degrees),
                              s.declination - k.declination);
        };
        const auto s = std::min_element(stars.begin(), stars.end(), [&](auto& a, auto& b) { return off(a) < off(b); });
        ASSERT_NE(s, stars.end());
        EXPECT_LT(off(*s), 0.002) << k.magnitude;
        EXPECT_NEAR(s->magnitude, k.magnitude, 0.2);
        EXPECT_NEAR(s->colour, k.colour, 0.4);
    }
}

/// Lines of a GeoJSON file with one MultiLineString.
std::vector<std::vector<glm::dvec2>> read_lines(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    const std::string json = text.str();
    std::vector<std::vector<glm::dvec2>> lines;
    for (std::size_t at = json.find("[[[") + 1; at < json.size(); ++at) {
        if (json[at] != '[') continue;
        if (json[at + 1] == '[') {
            lines.emplace_back();
            continue;
        }
        glm::dvec2 point{0};
        if (std::sscanf(json.c_str() + at, "[%lf,%lf]", &point.x, &point.y) == 2) lines.back().push_back(point);
    }
    return lines;
}

TEST(Data, CoastlinesAndBordersStayOnTheMap) {
    for (const char* name : {"coastlines.geojson", "borders.geojson"}) {
        const auto lines = read_lines(data / name);
        std::size_t points = 0;
        for (const auto& line : lines) {
            ASSERT_GE(line.size(), 2u);
            points += line.size();
            for (std::size_t i = 0; i < line.size(); ++i) {
                ASSERT_TRUE(std::abs(line[i].x) <= 180 && std::abs(line[i].y) < 86) << name;
                if (i == 0) continue;
                EXPECT_LT(std::abs(line[i].x - line[i - 1].x), 15) << name;
                EXPECT_FALSE(std::abs(line[i].x) == 180 && std::abs(line[i - 1].x) == 180) << name;
            }
        }
        EXPECT_GT(points, 10'000u) << name;
    }
}

TEST(Data, CoastlinesRunBetweenLandAndSea) {
    std::size_t near = 0, all = 0;
    for (const auto& line : read_lines(data / "coastlines.geojson"))
        for (const glm::dvec2 p : line) {
            if (std::abs(p.x) > 179 || std::abs(p.y) > 80) continue;
            int land = 0;
            for (double y : {-0.25, -0.08, 0.08, 0.25})
                for (double x : {-0.25, -0.08, 0.08, 0.25}) land += land_at(p.y + y, p.x + x);
            near += land > 0 && land < 16;
            ++all;
        }
    EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(all));
}

}  // namespace
}  // namespace planet
