// The default Earth and its imagery. ctest runs this before the other tests of the program (tests/CMakeLists.txt), so
// that what takes half a minute is done once.

#include <gtest/gtest.h>

#include "render/app/picture/earth_store.h"
#include "render/app/picture/imagery.h"

namespace render {
namespace {

TEST(BakedEarth, IsThere) {
    const EarthSources sources;
    LazyEarth earth(sources);
    ChecksumIndex index = user_checksum_index();
    const auto quietly = [](std::string_view, double) {};
    const auto store = open_earth_store(sources, earth, index, quietly);
    EXPECT_TRUE(store->metadata().complete);
    EXPECT_GE(store->metadata().tiles, 8u);
    const Imagery imagery = open_imagery(
        {}, sources, index, [&] { return earth.get().heights; }, 2, quietly);
    EXPECT_GT(imagery.day.side, 0);
    index.save();
}

}  // namespace
}  // namespace render
