// A bake keeps within its memory, whatever the size of its sources.

#include <gtest/gtest.h>

#include "tests/render/app/baked_store.h"

namespace render {
namespace {

/// The shipped DEM again and again, side by side, cut to size x size samples.
std::string repeated_dem(int size) {
    constexpr int width = 2401, height = 1201;
    std::ostringstream vrt;
    vrt << "<VRTDataset rasterXSize='" << size << "' rasterYSize='" << size << "'><SRS>EPSG:4326</SRS>"
        << "<GeoTransform>-106, 0.000833333333333, 0, 38, 0, -0.000833333333333</GeoTransform>"
        << "<VRTRasterBand dataType='Int16' band='1'>";
    for (int y = 0; y < size; y += height)
        for (int x = 0; x < size; x += width)
            vrt << "<SimpleSource><SourceFilename>" OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif</SourceFilename>"
                << "<SourceBand>1</SourceBand><SrcRect xOff='0' yOff='0' xSize='" << width << "' ySize='" << height
                << "'/><DstRect xOff='" << x << "' yOff='" << y << "' xSize='" << width << "' ySize='" << height
                << "'/></SimpleSource>";
    vrt << "</VRTRasterBand></VRTDataset>";
    return vrt.str();
}

// 134 MB of samples as 16-bit numbers, and 6 GB in a bake that would keep all its tiles.
TEST(BakeMemory, ALargeRasterIn128MiB) {
    const ScratchFolder folder;
    std::ofstream(folder / "large.vrt") << repeated_dem(8192);
    rusage usage{};
    Process process(folder.path(), words("bake large.vrt --memory 128MiB -o store.octa --json r.json"));
    const Outcome outcome = process.wait(&usage);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_LE(usage.ru_maxrss * 1024L, 128L << 20);
    const auto report = nlohmann::json::parse(content(folder / "r.json"));
    EXPECT_GE(report.at("vertices"), 8192 * 8192);
    EXPECT_EQ(report.at("sources").at(0).at("name"), "large.vrt");
    EXPECT_TRUE(planet::ElevationStore::open(folder / "store.octa").metadata().complete);
}

}  // namespace
}  // namespace render
