// A bake keeps within its memory, whatever the size of its sources.

#include <gtest/gtest.h>

#include "tests/render/app/baked_store.h"

namespace render {
namespace {

// 8192 x 8192 samples: 134 MB as 16-bit numbers, and 2 GB in a bake that would keep all its tiles.
TEST(BakeMemory, ALargeRasterIn128MiB) {
    const ScratchFolder folder;
    std::ofstream(folder / "large.vrt") << R"(<VRTDataset rasterXSize="8192" rasterYSize="8192"><SRS>EPSG:4326</SRS>
        <GeoTransform>-106.0004166, 0.000244140625, 0, 38.0004166, 0, -0.0001220703125</GeoTransform>
        <VRTRasterBand dataType="Int16" band="1"><SimpleSource>
        <SourceFilename>)" OCTAGLOBE_SOURCE_DIR R"(/data/sangre_de_cristo.tif</SourceFilename><SourceBand>1</SourceBand>
        <SrcRect xOff="0" yOff="0" xSize="2401" ySize="1201"/><DstRect xOff="0" yOff="0" xSize="8192" ySize="8192"/>
        </SimpleSource></VRTRasterBand></VRTDataset>)";
    rusage usage{};
    Process process(folder.path(),
                    words("bake large.vrt --least-level 12 --memory 128MiB -o store.octa --json r.json"));
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
