#include "planet/elevation/raster_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include "planet/elevation/image_io.h"
#include "planet/elevation/sha256.h"
#include "planet/error.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::RasterFile;
using testing::TemporaryFolder;
using testing::write_bytes;
using testing::write_raster;

const RasterFile alps{4, 3, "EPSG:4326", {10, 0.5, 0, 47, 0, -0.25}, ""};

std::string error_of(const std::string& path, const RasterOptions& options = {}) {
    try {
        read_raster(path, options);
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), Fault::bad_data);
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        EXPECT_EQ(std::string(e.what()).rfind(path, 0), 0u) << e.what();
        return e.what();
    }
    return "";
}

#define EXPECT_ERROR(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST(Sha256, PublishedValues) {
    Sha256 empty;
    EXPECT_EQ(empty.hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    Sha256 abc;
    abc.add("a", 1);
    abc.add("bc", 2);
    EXPECT_EQ(abc.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    Sha256 million;  // a million times "a", in uneven pieces
    const std::string piece(997, 'a');
    for (int i = 0; i < 1003; ++i) million.add(piece.data(), piece.size());
    million.add(piece.data(), 1000000 - 1003 * 997);
    EXPECT_EQ(million.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(RasterIo, SixteenBitStaysCompactWithVoidsMarked) {
    const TemporaryFolder folder;
    RasterFile file = alps;
    file.band = "<NoDataValue>-9999</NoDataValue>";
    write_raster<std::int16_t>(folder / "a.vrt", file, [](int c, int r) {
        return static_cast<std::int16_t>(c == 1 && r == 1 ? -9999 : 100 * r + c);
    });
    const Raster raster = read_raster(folder / "a.vrt");
    ASSERT_TRUE(std::holds_alternative<std::vector<std::int16_t>>(raster.samples));
    EXPECT_EQ(raster.width, 4);
    EXPECT_EQ(raster.height, 3);
    EXPECT_EQ(raster.crs, "EPSG:4326");
    EXPECT_TRUE(raster.geographic());
    EXPECT_EQ(raster.at(3, 2), 203);
    EXPECT_TRUE(std::isnan(raster.at(1, 1)));
    EXPECT_EQ(raster.grid.origin, glm::dvec2(10.25, 46.875));  // the centre of the corner pixel
    EXPECT_EQ(raster.name, "a.vrt");
    EXPECT_EQ(raster.checksum.size(), 64u);
}

TEST(RasterIo, ValuesThatDoNotFitSixteenBitBecomeFloats) {
    const TemporaryFolder folder;
    write_raster<std::uint16_t>(folder / "a.vrt", alps,
                                [](int c, int r) { return static_cast<std::uint16_t>(c == 3 && r == 2 ? 65535 : 7); });
    const Raster raster = read_raster(folder / "a.vrt");
    EXPECT_TRUE(std::holds_alternative<std::vector<float>>(raster.samples));
    EXPECT_EQ(raster.at(3, 2), 65535);
    EXPECT_EQ(raster.at(0, 0), 7);
    // The marks of void and water are ordinary values to a file that does not call them nodata.
    for (const int odd : {-32768, -32767}) {
        write_raster<std::int16_t>(folder / "b.vrt", alps,
                                   [&](int c, int) { return static_cast<std::int16_t>(c == 2 ? odd : 7); });
        EXPECT_EQ(read_raster(folder / "b.vrt").at(2, 0), odd);
    }
}

TEST(RasterIo, EveryBandType) {
    const TemporaryFolder folder;
    const auto check = [&](const std::string& name) {
        const Raster raster = read_raster(folder / name);
        EXPECT_EQ(raster.at(2, 1), 12) << name;
        EXPECT_EQ(raster.at(0, 0), 0) << name;
    };
    write_raster<std::uint8_t>(folder / "1", alps, [](int c, int r) { return static_cast<std::uint8_t>(10 * r + c); });
    write_raster<std::uint16_t>(folder / "2", alps,
                                [](int c, int r) { return static_cast<std::uint16_t>(10 * r + c); });
    write_raster<std::int32_t>(folder / "3", alps, [](int c, int r) { return 10 * r + c; });
    write_raster<float>(folder / "4", alps, [](int c, int r) { return static_cast<float>(10 * r + c); });
    write_raster<double>(folder / "5", alps, [](int c, int r) { return 10.0 * r + c; });
    for (const char* name : {"1", "2", "3", "4", "5"}) check(name);
}

TEST(RasterIo, ScaleOffsetAndFeet) {
    const TemporaryFolder folder;
    RasterFile file = alps;
    file.band = "<Scale>0.1</Scale><Offset>-100</Offset>";
    const auto value = [](int c, int r) { return static_cast<std::int16_t>(1000 * r + c); };
    write_raster<std::int16_t>(folder / "scaled", file, value);
    EXPECT_NEAR(read_raster(folder / "scaled").at(3, 1), 0.3, 1e-9);
    file.band = "<UnitType>ft</UnitType>";
    write_raster<std::int16_t>(folder / "feet", file, value);
    EXPECT_NEAR(read_raster(folder / "feet").at(0, 1), 304.8, 1e-9);
    file.band = "";
    file.crs = "EPSG:4326+6360";  // NAVD88 height in US survey feet
    write_raster<std::int16_t>(folder / "crs_feet", file, value);
    const Raster raster = read_raster(folder / "crs_feet");
    EXPECT_NEAR(raster.at(0, 1), 1000 * 1200.0 / 3937, 1e-9);
    EXPECT_TRUE(raster.geographic());
}

TEST(RasterIo, FloatsThatAreNoHeightsAreVoid) {
    const TemporaryFolder folder;
    const float odd[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), -3.4028235e38f};
    RasterFile file = alps;
    file.band = "<NoDataValue>-1.1</NoDataValue>";  // not a float: the file holds the nearest one
    write_raster<float>(folder / "a", file, [&](int c, int r) { return r == 0 ? odd[c] : r == 1 ? -1.1f : 5.0f; });
    const Raster raster = read_raster(folder / "a");
    for (int c = 0; c < 4; ++c) {
        EXPECT_TRUE(std::isnan(raster.at(c, 0))) << c;
        EXPECT_TRUE(std::isnan(raster.at(c, 1))) << c;
        EXPECT_EQ(raster.at(c, 2), 5);
    }
}

TEST(RasterIo, GeoTiffIsReadAndACutOneIsRefused) {
    const TemporaryFolder folder;
    const auto value = [](int c, int r) { return static_cast<std::int16_t>(50 * r + c); };
    const std::string whole = testing::tiff_bytes(40, 30, true, value);
    write_bytes(folder / "whole.tif", whole);
    const Raster raster = read_raster(folder / "whole.tif");
    EXPECT_EQ(raster.at(39, 29), 50 * 29 + 39);
    EXPECT_NEAR(raster.grid.origin.x, 10.005, 1e-12);
    EXPECT_NEAR(raster.grid.origin.y, 49.995, 1e-12);
    EXPECT_EQ(raster.checksum, sha256_of_file(folder / "whole.tif"));
    int refused = 0;
    for (std::size_t length = 0; length < whole.size(); length += 61) {  // never a crash, never half a DEM
        write_bytes(folder / "cut.tif", whole.substr(0, length));
        refused += error_of(folder / "cut.tif").empty() ? 0 : 1;
    }
    EXPECT_EQ(refused, static_cast<int>((whole.size() + 60) / 61));
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        EXPECT_NE(entry.path().extension(), ".xml") << "a file was left beside the source";
}

TEST(RasterIo, EachBadFileGetsItsOwnLine) {
    const TemporaryFolder folder;
    EXPECT_ERROR(error_of(folder / "missing.tif"), "no such file");
    write_bytes(folder / "empty.tif", "");
    EXPECT_ERROR(error_of(folder / "empty.tif"), "is empty");
    write_bytes(folder / "text.tif", "Dear all,\nthis is not a picture.\n");
    EXPECT_ERROR(error_of(folder / "text.tif"), "cannot be read");
    EXPECT_ERROR(error_of(folder.path().string()), "cannot be read");
    write_bytes(folder / "bare.tif",
                testing::tiff_bytes(4, 4, false, [](int c, int) { return static_cast<std::int16_t>(c); }));
    EXPECT_ERROR(error_of(folder / "bare.tif"), "no georeference");
    const auto value = [](int c, int) { return static_cast<std::uint8_t>(c); };
    write_raster<std::uint8_t>(folder / "rgb", alps, value, 3);
    EXPECT_ERROR(error_of(folder / "rgb"), "colour picture");
    EXPECT_ERROR(error_of(folder / "rgb"), "accepted: one band of heights");
    write_raster<std::uint8_t>(folder / "two", alps, value, 2);
    EXPECT_ERROR(error_of(folder / "two"), "2 bands");
    RasterFile file = alps;
    file.band = "<NoDataValue>9</NoDataValue>";
    write_raster<std::int16_t>(folder / "void", file, [](int, int) { return static_cast<std::int16_t>(9); });
    EXPECT_ERROR(error_of(folder / "void"), "every sample is nodata");
    const RasterFile nowhere{4, 3, "", {500000, 30, 0, 5000000, 0, -30}, ""};
    write_raster<std::uint8_t>(folder / "nowhere", nowhere, value);
    EXPECT_ERROR(error_of(folder / "nowhere"), "does not name its CRS");
    RasterOptions named;
    named.crs_if_missing = "EPSG:32633";
    EXPECT_EQ(read_raster(folder / "nowhere", named).crs, "EPSG:32633");
    const RasterFile flat{4, 3, "EPSG:4326", {10, 0, 0, 47, 0, 0}, ""};
    write_raster<std::uint8_t>(folder / "flat", flat, value);
    EXPECT_ERROR(error_of(folder / "flat"), "no georeference");
}

TEST(RasterIo, ALatitudeLongitudeGridNeedNotNameItsCrs) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.asc",
                "ncols 3\nnrows 2\nxllcorner 5\nyllcorner 45\ncellsize 0.5\nNODATA_value -1\n1 2 3\n4 -1 6\n");
    const Raster raster = read_raster(folder / "a.asc");
    EXPECT_EQ(raster.crs, "EPSG:4326");
    EXPECT_EQ(raster.at(0, 1), 4);
    EXPECT_TRUE(std::isnan(raster.at(1, 1)));
    EXPECT_EQ(raster.grid.origin, glm::dvec2(5.25, 45.75));
}

TEST(RasterIo, TooManySamplesAreRefusedOrReduced) {
    const TemporaryFolder folder;
    // 60,000 x 60,000 without a byte of data behind it: the size alone must be refused before anything is allocated.
    write_bytes(
        folder / "huge.vrt",
        "<VRTDataset rasterXSize=\"60000\" rasterYSize=\"60000\"><SRS>EPSG:4326</SRS><GeoTransform>0,0.001,0,60,0,"
        "-0.001</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>");
    EXPECT_ERROR(error_of(folder / "huge.vrt"), "60000x60000 samples are too many; accepted: at most 536870912");
    const RasterFile file{90, 60, "EPSG:4326", {0, 0.5, 0, 45, 0, -0.5}, ""};
    write_raster<std::int16_t>(folder / "a", file, [](int c, int r) { return static_cast<std::int16_t>(100 * r + c); });
    RasterOptions small;
    small.max_samples = 300;
    EXPECT_ERROR(error_of(folder / "a", small), "too many");
    small.reduce = true;
    const Raster raster = read_raster(folder / "a", small);
    EXPECT_EQ(raster.reduction, 5);
    EXPECT_EQ(raster.width, 18);
    EXPECT_EQ(raster.at(1, 1), 707);  // every fifth sample itself, from the middle of its block of 5 x 5
    EXPECT_EQ(raster.grid.origin, glm::dvec2(1.25, 43.75));
    EXPECT_EQ(raster.grid.per_column.x, 2.5);
}

TEST(RasterIo, ASizeAloneIsRefusedBeforeMemoryIsTaken) {
    const auto peak_kib = [] {
        std::ifstream status("/proc/self/status");
        std::string word;
        while (status >> word)
            if (word == "VmPeak:") break;
        long kib = 0;
        status >> kib;
        return kib;
    };
    const TemporaryFolder folder;
    const std::string band = "<VRTRasterBand dataType=\"Float64\" band=\"1\"/></VRTDataset>";
    RasterOptions plain;
    plain.plain = true;
    const auto refused = [&](const std::string& width, const std::string& height) {
        write_bytes(folder / "a.vrt",
                    "<VRTDataset rasterXSize=\"" + width + "\" rasterYSize=\"" + height + "\">" + band);
        EXPECT_ERROR(error_of(folder / "a.vrt", plain), width + "x" + height + " samples are too many");
    };
    refused("60000", "60000");  // also loads GDAL, which takes memory of its own
    const long before = peak_kib();
    refused("60000", "60000");
    refused("2147483647", "1");
    refused("1", "2147483647");
    refused("2147483647", "2147483647");  // 2^62 samples still fit 64 bits
    EXPECT_GT(before, 0);
    EXPECT_LT(peak_kib() - before, 64 << 10);  // 60,000 x 60,000 takes 14 million KiB
}

TEST(RasterIo, TheLeastSizes) {
    const TemporaryFolder folder;
    const auto value = [](int c, int r) { return static_cast<std::int16_t>(10 * r + c + 1); };
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {5, 1}, {2, 2}, {1, 2}})
        for (const char* crs : {"EPSG:4326", "EPSG:32632", ""}) {
            const RasterFile file{width, height, crs, {10, 0.5, 0, 47, 0, -0.25}, ""};
            write_raster<std::int16_t>(folder / "a", file, value);
            const Raster raster = read_raster(folder / "a");
            EXPECT_EQ(raster.width, width);
            EXPECT_EQ(raster.height, height);
            EXPECT_EQ(raster.count(), static_cast<std::size_t>(width * height));
            EXPECT_EQ(raster.at(width - 1, height - 1), 10 * (height - 1) + width);
            EXPECT_EQ(raster.grid.origin, glm::dvec2(10.25, 46.875));
        }
}

TEST(RasterIo, DoublesThatAreNoHeightsAreVoid) {
    const TemporaryFolder folder;
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const double odd[] = {std::numeric_limits<double>::quiet_NaN(), infinite, -infinite, 1e300};
    write_raster<double>(folder / "a", alps, [&](int c, int r) { return r == 0 ? odd[c] : -12.5; });
    const Raster raster = read_raster(folder / "a");
    for (int c = 0; c < 4; ++c) {
        EXPECT_TRUE(std::isnan(raster.at(c, 0))) << c;
        EXPECT_EQ(raster.at(c, 2), -12.5);
    }
    write_raster<double>(folder / "b", alps, [&](int c, int) { return odd[c]; });
    EXPECT_ERROR(error_of(folder / "b"), "every sample is nodata");
    write_raster<float>(folder / "c", alps, [&](int c, int) { return c == 3 ? 4.0f : static_cast<float>(odd[c]); });
    EXPECT_EQ(read_raster(folder / "c").at(3, 0), 4);
    RasterFile scaled = alps;
    scaled.band = "<Scale>nan</Scale>";
    write_raster<float>(folder / "d", scaled, [](int, int) { return 1.0f; });
    EXPECT_ERROR(error_of(folder / "d"), "no usable scale");
}

void expect_pixel_grid(const Raster& raster) {
    EXPECT_TRUE(raster.plain);
    EXPECT_FALSE(raster.geographic());
    EXPECT_EQ(raster.crs, "");
    EXPECT_EQ(raster.transform, nullptr);
    EXPECT_EQ(raster.grid.crs_from_sample({3, 2}), glm::dvec2(3, -2));
}

TEST(RasterIo, GreyHeightmapsAreReadWhenAsked) {
    const TemporaryFolder folder;
    RasterOptions plain;
    plain.plain = true;
    for (const int bits : {8, 16})
        write_bytes(folder / (std::to_string(bits) + ".png"), testing::png_bytes(4, 2, bits, [&](int c, int r) {
                        return static_cast<unsigned>(r == 0 ? c : (1 << bits) - 4 + c);
                    }));
    for (const char* name : {"8.png", "16.png"}) {
        EXPECT_ERROR(error_of(folder / name), "no georeference");
        const Raster raster = read_raster(folder / name, plain);
        expect_pixel_grid(raster);
        EXPECT_EQ(raster.at(2, 0), 2);
        EXPECT_EQ(raster.at(3, 1), name[0] == '8' ? 255 : 65535);
        EXPECT_EQ(columns_around(raster), 0);
    }
    write_bytes(folder / "8.pgw", "10\n0\n0\n-10\n500000\n5000000\n");  // a world file: a place without a CRS
    const Raster placed = read_raster(folder / "8.png", plain);
    EXPECT_TRUE(placed.plain);
    EXPECT_EQ(placed.grid.crs_from_sample({3, 1}), glm::dvec2(500030, 4999990));
    const std::uint8_t colours[12] = {};
    ImageWriter picture(folder / "rgb.png", 4, 1, 3, SampleType::uint8);
    picture.write_rows(colours, 1);
    picture.finish();
    EXPECT_ERROR(error_of(folder / "rgb.png", plain), "colour picture");
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        names.insert(entry.path().filename().string());
    EXPECT_EQ(names, (std::set<std::string>{"16.png", "8.pgw", "8.png", "rgb.png"}));
}

TEST(RasterIo, PlainIsOnlyWhatHasNoPlaceOtherwise) {
    const TemporaryFolder folder;
    RasterOptions plain;
    plain.plain = true;
    const auto value = [](int c, int r) { return static_cast<std::int16_t>(10 * r + c); };
    const auto read = [&](const std::string& crs, const RasterOptions& options) {
        const RasterFile file{4, 3, crs, {10, 0.5, 0, 47, 0, -0.25}, ""};
        write_raster<std::int16_t>(folder / "a", file, value);
        return read_raster(folder / "a", options);
    };
    EXPECT_FALSE(read("EPSG:32632", plain).plain);
    EXPECT_EQ(read("EPSG:32632", plain).crs, "EPSG:32632");
    // These could be degrees, and without the option they are.
    EXPECT_EQ(read("", {}).crs, "EPSG:4326");
    const std::string local = "LOCAL_CS[\"a mine\",UNIT[\"metre\",1]]";
    const std::string odd =
        "PROJCS[\"a\",GEOGCS[\"b\",DATUM[\"c\",SPHEROID[\"d\",6378137,298]],PRIMEM[\"Greenwich\",0],"
        "UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Nobodys\"],UNIT[\"metre\",1]]";
    EXPECT_THROW(read(odd, {}), Error);
    for (const std::string& crs : {std::string(), local, odd}) {
        const Raster raster = read(crs, plain);
        EXPECT_TRUE(raster.plain) << crs;
        EXPECT_EQ(raster.crs, "");
        EXPECT_EQ(raster.transform, nullptr);
        EXPECT_EQ(raster.radius_m, Raster().radius_m);
        EXPECT_EQ(raster.grid.origin, glm::dvec2(10.25, 46.875));
        RasterOptions both = plain;
        both.crs_if_missing = "EPSG:32633";
        EXPECT_EQ(read(crs, both).crs, crs == odd ? "" : "EPSG:32633");
    }
    RasterOptions reduced = plain;
    reduced.max_samples = 6;
    reduced.reduce = true;
    write_bytes(folder / "bare.tif", testing::tiff_bytes(9, 6, false, value));
    const Raster raster = read_raster(folder / "bare.tif", reduced);
    EXPECT_EQ(raster.grid.origin, glm::dvec2(1, -1));
    EXPECT_EQ(raster.grid.crs_from_sample({2, 1}), glm::dvec2(7, -4));
    EXPECT_EQ(raster.at(2, 1), 47);
    const RasterFile flat{4, 3, "EPSG:4326", {10, 0, 0, 47, 0, 0}, ""};  // a georeference without an area is none
    write_raster<std::int16_t>(folder / "flat", flat, value);
    expect_pixel_grid(read_raster(folder / "flat", plain));
}

}  // namespace
}  // namespace planet
