#include "planet/geodesy/geoid.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geoid.hpp>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "planet/error.h"

namespace planet {
namespace {

namespace fs = std::filesystem;

/// A folder that goes away with the test.
class Folder {
  public:
    Folder() : path(fs::temp_directory_path() / ("octaglobe_geoid_" + std::to_string(std::random_device{}()))) {
        fs::create_directories(path);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path write(const std::string& name, const std::string& content) const {
        std::ofstream(path / name, std::ios::binary) << content;
        return path / name;
    }
    const fs::path path;
};

const std::string header_comments =
    "P5\n# Geoid file in PGM format\n# Description a test geoid\n# Offset -108\n# Scale 0.003\n";

std::string pgm(int width, int height, const std::function<int(int, int)>& grey) {
    std::string text = header_comments + std::to_string(width) + " " + std::to_string(height) + "\n65535\n";
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int g = y == 0 || y == height - 1 ? grey(0, y) : grey(x, y);
            text.push_back(static_cast<char>(g >> 8));
            text.push_back(static_cast<char>(g & 255));
        }
    return text;
}

int rough(int x, int y) {
    const unsigned mixed = (static_cast<unsigned>(x) * 2654435761u) ^ (static_cast<unsigned>(y) * 40503u * 65537u);
    return static_cast<int>((mixed >> 7) & 0xffff);
}

std::string what_of(const fs::path& path) {
    try {
        const Geoid geoid(path);
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.what();
    }
    return "accepted";
}

TEST(Geoid, AgreesWithGeographicLibEverywhere) {
    const Folder folder;
    const Geoid ours(folder.write("rough.pgm", pgm(24, 13, rough)));
    const GeographicLib::Geoid reference("rough", folder.path.string(), true, true);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> latitude(-90, 90), longitude(-180, 180);
    for (int i = 0; i < 200000; ++i) {
        const double lat = latitude(random), lon = longitude(random);
        // Neighbouring samples of this grid differ by up to 200 m: 1e-9 m is rounding.
        ASSERT_NEAR(ours.undulation(lat * degrees, lon * degrees).m, reference(lat, lon), 1e-9) << lat << " " << lon;
    }
}

TEST(Geoid, SeamsAgreeWithGeographicLib) {
    const Folder folder;
    const Geoid ours(folder.write("rough.pgm", pgm(24, 13, rough)));
    const GeographicLib::Geoid reference("rough", folder.path.string(), true, true);
    for (double lat : {-90.0, -89.999, -75.5, -0.0, 0.0, 1e-13, 14.0, 89.999, 90.0})
        for (double lon : {-180.0, -179.999, -1e-9, -0.0, 0.0, 7.0, 179.999, 180.0, 359.9995, 540.0})
            EXPECT_NEAR(ours.undulation(lat * degrees, lon * degrees).m, reference(lat, lon), 1e-8)
                << lat << " " << lon;
}

TEST(Geoid, OneValueAtAPole) {
    const Folder folder;
    const Geoid geoid(folder.write("rough.pgm", pgm(24, 13, rough)));
    for (double pole : {90.0, -90.0})
        for (int lon = -180; lon <= 180; lon += 5)
            EXPECT_NEAR(geoid.undulation(pole * degrees, lon * degrees).m, geoid.undulation(pole * degrees, 0).m, 1e-9);
    EXPECT_NEAR(geoid.undulation(glm::dvec3(0, 0, 2)).m, geoid.undulation(90 * degrees, 1).m, 1e-9);
}

TEST(Geoid, NormalsAndBatchesGiveTheSameAsAngles) {
    const Folder folder;
    const Geoid geoid(folder.write("rough.pgm", pgm(24, 13, rough)));
    std::vector<glm::dvec3> normals;
    for (int i = 0; i < 1000; ++i) normals.push_back(normal_from_geodetic((i - 500) * 0.003, i * 0.0063 - 3.14));
    std::vector<GeoidUndulation> batch(normals.size());
    geoid.undulations(normals, batch);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Geodetic g = geodetic_from_normal(normals[i]);
        EXPECT_NEAR(batch[i].m, geoid.undulation(g.latitude, g.longitude).m, 1e-9);
        EXPECT_EQ(batch[i].m, geoid.undulation(normals[i]).m);
    }
}

// The cubics of two cells differ along the side between them: a place there must not change cells with the way its angles
// are found.
// Neighbours in one cell are worked out together: poles, sides of cells, the antimeridian and no places too.
TEST(Geoid, BatchesOfAnglesGiveTheSameBits) {
    const Geoid geoid(fs::path(OCTAGLOBE_SOURCE_DIR) / "data/egm96-15.pgm");
    for (const double row : {-90.0, -89.99, -37.5, -0.1, 0.0, 12.25, 45.0, 89.8, 90.0, 91.0, std::nan("")})
        for (const double start : {-181.0, -180.05, -106.0, -0.1, 0.0, 105.9, 179.95, 359.9})
            for (const double step : {0.0, 1.0 / 1200, 0.3}) {
                std::vector<double> latitude, longitude;
                for (int i = 0; i < 150; ++i) {
                    latitude.push_back((row - step * (i / 70)) * degrees);
                    longitude.push_back((start + step * i) * degrees);
                }
                std::vector<GeoidUndulation> found(latitude.size());
                geoid.undulations(latitude, longitude, found);
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const double one = geoid.undulation(latitude[i], longitude[i]).m;
                    EXPECT_TRUE(found[i].m == one || (std::isnan(found[i].m) && std::isnan(one)))
                        << row << " " << start;
                }
            }
}

TEST(Geoid, OnSidesOfCellsNormalsTakeTheAnglesOfTheStandardLibrary) {
    const Folder folder;
    const Geoid geoid(folder.write("rough.pgm", pgm(24, 13, rough)));
    std::vector<glm::dvec3> normals;
    for (int lat = -75; lat <= 75; lat += 15)
        for (int lon = -180; lon < 180; lon += 5) normals.push_back(normal_from_geodetic(lat * degrees, lon * degrees));
    for (int i = 0; i < 24; ++i) normals.push_back(glm::normalize(glm::dvec3(1, i, i % 3)));
    std::vector<GeoidUndulation> batch(normals.size());
    geoid.undulations(normals, batch);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const glm::dvec3& n = normals[i];
        const double latitude = std::atan2(n.z, std::sqrt(n.x * n.x + n.y * n.y)), longitude = std::atan2(n.y, n.x);
        EXPECT_NEAR(batch[i].m, geoid.undulation(latitude, longitude).m, i < 11 * 72 ? 0 : 1e-9) << i;
    }
}

TEST(Geoid, ThreadsReadOneGridAndGetTheSameBits) {
    const Folder folder;
    const Geoid geoid(folder.write("rough.pgm", pgm(24, 13, rough)));
    const auto sweep = [&geoid](std::vector<double>& out) {
        for (int i = 0; i < 20000; ++i) out.push_back(geoid.undulation(std::sin(i * 0.7), std::fmod(i * 0.37, 3)).m);
    };
    std::vector<double> first, second;
    std::thread thread([&] { sweep(second); });
    sweep(first);
    thread.join();
    EXPECT_EQ(first, second);
}

TEST(Geoid, NoAnswerIsNaN) {
    const Folder folder;
    const Geoid geoid(folder.write("flat.pgm", pgm(24, 13, [](int, int) { return 36000; })));
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(geoid.undulation(0.3, 0.4).m, 0, 1e-10);
    EXPECT_TRUE(std::isnan(geoid.undulation(nan, 0).m));
    EXPECT_TRUE(std::isnan(geoid.undulation(0, nan).m));
    EXPECT_TRUE(std::isnan(geoid.undulation(0, infinity).m));
    EXPECT_TRUE(std::isnan(geoid.undulation(1.571, 0).m));
    EXPECT_TRUE(std::isnan(geoid.undulation(glm::dvec3(nan, 0, 1)).m));
}

TEST(Geoid, BadFilesGiveOneClearLine) {
    const Folder folder;
    const std::string good = pgm(24, 13, rough);
    EXPECT_NE(what_of(folder.path / "missing.pgm").find("no such file"), std::string::npos);
    EXPECT_NE(what_of(folder.path).find("is not a file"), std::string::npos);
    EXPECT_NE(what_of(folder.write("nodata.pgm", header_comments + "24 13\n65535")).find("header"), std::string::npos);
    EXPECT_NE(what_of(folder.write("empty.pgm", "")).find("ends within its header"), std::string::npos);
    EXPECT_NE(what_of(folder.write("text.pgm", "hello\n")).find("P5"), std::string::npos);
    EXPECT_NE(what_of(folder.write("zeros.pgm", std::string(100000, '\0'))).find("header"), std::string::npos);
    EXPECT_NE(what_of(folder.write("cut.pgm", good.substr(0, 300))).find("bytes"), std::string::npos);
    EXPECT_NE(what_of(folder.write("long.pgm", good + "x")).find("bytes"), std::string::npos);
    EXPECT_NE(what_of(folder.write("8bit.pgm", header_comments + "24 13\n255\n")).find("16-bit"), std::string::npos);
    EXPECT_NE(what_of(folder.write("noscale.pgm", "P5\n# Offset 1\n24 13\n65535\n")).find("Scale"), std::string::npos);
    EXPECT_NE(what_of(folder.write("badscale.pgm", "P5\n# Offset 1\n# Scale x\n24 13\n65535\n")).find("line 3"),
              std::string::npos);
    EXPECT_NE(what_of(folder.write("odd.pgm", header_comments + "23 13\n65535\n")).find("23x13"), std::string::npos);
    EXPECT_NE(what_of(folder.write("huge.pgm", header_comments + "2000000000 2000000001\n65535\n")).find("bytes"),
              std::string::npos);
    EXPECT_NE(what_of(folder.write("overflow.pgm", header_comments + "99999999999 13\n65535\n")).find("samples"),
              std::string::npos);
    EXPECT_EQ(what_of(folder.write("good.pgm", good)), "accepted");
}

}  // namespace
}  // namespace planet
