// Places along parallels, against GeographicLib.

#include "planet/geodesy/utm_parallels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "planet/elevation/raster.h"
#include "planet/patches/raster_frame.h"

namespace planet {
namespace {

std::vector<double> latitudes(double first, double last, std::size_t rows) {
    std::vector<double> found;
    for (std::size_t i = 0; i < rows; ++i)
        found.push_back((first + (last - first) * static_cast<double>(i) / static_cast<double>(rows - 1)) * degrees);
    return found;
}

UtmParallels::Columns columns(double west, double east, int count) {
    return {west * degrees, (east - west) / (count - 1) * degrees, count};
}

double farthest(const UtmParallels& parallels, int zone, bool north, const UtmParallels::Columns& columns,
                const std::vector<double>& latitudes) {
    double most = 0;
    for (std::size_t row = 0; row < latitudes.size(); row += 7)
        for (int column = 0; column < columns.count; column += 11) {
            const auto found = parallels.at(column, static_cast<int>(row));
            const auto exact = utm_place(latitudes[row], columns.first + column * columns.step, zone, north);
            most = std::max(most, std::hypot(found.easting - exact.easting, found.northing - exact.northing));
        }
    return most;
}

TEST(UtmParallels, AreThoseOfTheProjection) {
    struct Case {
        double west, east, south, north;
        int zone;
    };
    for (const Case& c : {Case{-106, -105.9, 37, 37.1, 13}, Case{-106, -102.6, 34.6, 38, 13},
                          Case{-109.5, -100.5, 20, 50, 13}, Case{3, 9, 60, 84, 31}, Case{177, 183, -60, -50, 1},
                          Case{2, 4, -3, 3, 31}, Case{29.5, 30.5, 83, 84, 36}, Case{-180, 180, 85, 90, 0}}) {
        const auto across = columns(c.west, c.east, 601);
        const auto up = latitudes(c.north, c.south, 301);
        for (const bool north : {true, false}) {
            if (c.zone == 0 && !north) continue;  // another projection
            const auto parallels = UtmParallels::make(c.zone, north, across, up);
            ASSERT_TRUE(parallels.has_value()) << c.west << " to " << c.east;
            EXPECT_LT(farthest(*parallels, c.zone, north, across, up), UtmParallels::accuracy);
        }
    }
}

TEST(UtmParallels, AreNotMadeWhereTheyWouldBeWrong) {
    EXPECT_FALSE(UtmParallels::make(31, true, columns(-60, 66, 601), latitudes(1, -1, 9))) << "far from the zone";
    EXPECT_FALSE(UtmParallels::make(31, true, columns(177, 183, 601), latitudes(1, -1, 9))) << "on the other side";
    EXPECT_FALSE(UtmParallels::make(13, true, columns(-106, -105, 12), latitudes(38, 37, 9))) << "too few to gain";
}

// Samples of a raster by parallels, what lies between or beyond them by the projection; in windows the same bits.
TEST(UtmParallels, ServeFramesOfRasters) {
    auto raster = std::make_shared<Raster>();
    raster->name = "dem.tif";
    raster->width = 900;
    raster->height = 700;
    raster->crs = "EPSG:4326";
    raster->grid = {{-106, 0.3}, {1.0 / 1200, 0}, {0, -1.0 / 1200}};  // across the equator
    const RasterFrame frame(raster, MeshFrame::utm, VerticalDatum::egm96, nullptr, 2);
    std::vector<glm::dvec2> at{{0, 0},      {899, 699},   {400, 360}, {400, 361},
                               {450.5, 20}, {450, 20.25}, {-3, 8},    {910, 5}};
    const std::vector<double> heights(at.size(), 100);
    std::vector<glm::dvec3> placed(at.size()), again(at.size());
    std::vector<glm::vec3> up(at.size());
    frame.place(at, heights, placed, up);
    for (std::size_t i = 0; i < at.size(); ++i) {
        const glm::dvec2 p = raster->grid.crs_from_sample(at[i]);
        const auto exact = utm_place(p.y * degrees, p.x * degrees, 13, true);
        EXPECT_NEAR(placed[i].x, exact.easting, UtmParallels::accuracy);
        EXPECT_NEAR(placed[i].y, exact.northing, UtmParallels::accuracy);
        EXPECT_EQ(placed[i].z, 200);
        EXPECT_EQ(up[i], glm::vec3(0, 0, 1));
    }
    for (glm::dvec2& p : at) p -= glm::dvec2(300, 200);
    frame.window({300, 200}).place(at, heights, again, {});
    EXPECT_EQ(placed, again);
}

}  // namespace
}  // namespace planet
