// Rasters as files: what is written is read back, whole or not at all.

#include "planet/elevation/raster_writer.h"

#include <gtest/gtest.h>

#include "planet/error.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::TemporaryFolder;

RasterHeader header(int width, int height) {
    RasterHeader raster;
    raster.width = width;
    raster.height = height;
    raster.crs = "EPSG:32613";
    raster.grid = {{400000, 4200000}, {30, 0}, {0, -30}};
    return raster;
}

TEST(RasterWriter, WindowsInAnyOrderAreReadBack) {
    const TemporaryFolder folder;
    const RasterHeader like = header(300, 200);
    const auto value = [](int x, int y) { return static_cast<float>(x) + 0.25f * static_cast<float>(y); };
    {
        RasterWriter writer(folder / "w.tif", like);
        for (const SampleWindow w : {SampleWindow{100, 100, 200, 100}, {0, 100, 100, 100}, {0, 0, 300, 60}}) {
            std::vector<float> samples;
            for (int y = w.row; y < w.row + w.rows; ++y)
                for (int x = w.column; x < w.column + w.columns; ++x) samples.push_back(value(x, y));
            writer.write(w, samples);
        }
        EXPECT_FALSE(std::filesystem::exists(folder / "w.tif"));
        writer.finish();
    }
    const Raster read = read_raster(folder / "w.tif");
    EXPECT_EQ(read.crs, "EPSG:32613");
    EXPECT_EQ(read.grid.origin, like.grid.origin);
    EXPECT_EQ(read.grid.per_column, like.grid.per_column);
    EXPECT_EQ(read.grid.per_row, like.grid.per_row);
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 300; ++x)
            ASSERT_TRUE(y >= 60 && y < 100 ? std::isnan(read.at(x, y))
                                           : read.at(x, y) == static_cast<double>(value(x, y)))
                << x << ',' << y;
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(RasterWriter, LeavesNothingUnfinished) {
    const TemporaryFolder folder;
    { RasterWriter writer(folder / "w.tif", header(30, 20)); }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RasterWriter, RefusesWhatCannotBeWritten) {
    const TemporaryFolder folder;
    for (const std::string name : {"w.png", "w", "no/w.tif"}) try {
            RasterWriter writer(folder / name, header(30, 20));
            ADD_FAILURE() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), Fault::bad_usage);
        }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace planet
