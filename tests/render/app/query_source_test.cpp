// Which source octaglobe query says a height came from.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/planet/version3_store.h"
#include "tests/render/app/baked_store.h"

namespace render {
namespace {

using nlohmann::json;

// 41 x 33 samples of 0.01 degrees each: low.vrt with its first sample at 50 N, 10 E; two tiles beside each other that share
// a column, from 10.2 E on, with a void amid the second; one across the antimeridian.
class QuerySource : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new ScratchFolder;
        Terrain low;
        low.height_m = [](int, int) { return 200; };
        low.width = 81;
        low.write(*folder_ / "low.vrt");
        std::filesystem::create_directory(*folder_ / "tiles");
        Terrain tile;
        tile.band = "<NoDataValue>-1</NoDataValue>";
        tile.y = 49.9;
        tile.x = 10.2;
        tile.width = tile.height = 21;
        tile.height_m = [](int, int) { return 500; };
        tile.write(*folder_ / "tiles/west, low.vrt");
        tile.x = 10.4;
        tile.height_m = [](int c, int r) { return std::abs(c - 10) < 3 && std::abs(r - 10) < 3 ? -1 : 700; };
        tile.write(*folder_ / "tiles/x.vrt");
        Terrain pacific = low;
        pacific.x = 179.7;
        pacific.y = -20;
        pacific.write(*folder_ / "pacific.vrt");
        baked_ = bake(*folder_, "low.vrt pacific.vrt tiles/*.vrt");
    }
    static void TearDownTestSuite() { delete folder_; }

    static Outcome query(const std::string& arguments, const std::string& store = "store.octa") {
        return run(folder_->path(), words("query " + arguments + " --json answer.json --store " + store));
    }
    /// The line, from "from" on; empty where it says no source.
    static std::string line_at(const std::string& place, const std::string& store = "store.octa") {
        const Outcome outcome = query("height " + place, store);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1);
        const auto from = outcome.out.find("; from ");
        return from == std::string::npos ? "" : outcome.out.substr(from + 2, outcome.out.size() - from - 3);
    }
    static json answer() { return json::parse(content(*folder_ / "answer.json")); }

    static inline ScratchFolder* folder_ = nullptr;
    static inline json baked_;
};

TEST_F(QuerySource, IsTheFileAtThePlace) {
    EXPECT_EQ(line_at("49.95,10.05"), "from low.vrt");
    EXPECT_EQ(line_at("49.8,10.3"), "from west, low.vrt");
    EXPECT_EQ(line_at("49.87,10.5"), "from x.vrt");
    EXPECT_EQ(answer().at("source"), "x.vrt");
    EXPECT_EQ(answer().at("source_index"), 2);
    EXPECT_EQ(answer().at("blended_with"), json::array());
    const json sources = answer().at("sources");
    EXPECT_EQ(sources[2].at("files"), (json{"west, low.vrt", "x.vrt"}));
    EXPECT_FALSE(sources[0].contains("files"));
    for (const char* place : {"-20.1,179.9", "-20.1,180", "-20.1,-180", "-20.1,-179.8"})
        EXPECT_EQ(line_at(place), "from pacific.vrt") << place;
}

TEST_F(QuerySource, IsBelowAVoidAndBlendedThere) {
    EXPECT_EQ(line_at("49.8,10.5"), "from low.vrt, blended with x.vrt");
    EXPECT_EQ(answer().at("blended_with"), json{"x.vrt"});
    const std::string beside = line_at("49.8,10.612");
    EXPECT_TRUE(beside == "from x.vrt, blended with low.vrt" || beside == "from low.vrt, blended with x.vrt") << beside;
}

TEST_F(QuerySource, IsNoneWhereNothingWasGiven) {
    for (const char* place : {"90,0", "-90,13", "0,180", "12,-70"}) {
        const Outcome outcome = query("height " + std::string(place));
        EXPECT_NE(outcome.out.find("; no source there, "), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.out.find("from"), std::string::npos) << outcome.out;
        EXPECT_TRUE(answer().at("source").is_null());
        EXPECT_TRUE(answer().at("source_index").is_null());
        EXPECT_EQ(answer().at("blended_with"), json::array());
    }
}

TEST_F(QuerySource, IsAColumnOfTables) {
    std::ofstream(*folder_ / "places.csv") << "49.95,10.05\n49.8,10.3\n12,-70\n49.8,10.5\n";
    ASSERT_EQ(query("height --points places.csv -o heights.csv").status, 0);
    std::istringstream lines(content(*folder_ / "heights.csv"));
    const char* const ends[] = {",source,blended_with", ",low.vrt,", ",\"west, low.vrt\",", ",no source,",
                                ",low.vrt,x.vrt"};
    std::string line;
    for (const char* end : ends) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_TRUE(line.ends_with(end)) << line;
    }
    ASSERT_EQ(query("profile 49.87,10.05 49.87,10.55 --samples 400 -o profile.csv").status, 0);
    const std::string profile = content(*folder_ / "profile.csv");
    EXPECT_NE(profile.find("height_bound_m,source,blended_with\n"), std::string::npos);
    EXPECT_TRUE(profile.ends_with(",x.vrt,\n"));
}

TEST_F(QuerySource, StretchesOfAProfileFollowEachOther) {
    ASSERT_EQ(query("profile 49.87,10.05 49.87,10.55").status, 0);
    const json stretches = answer().at("stretches");
    std::vector<std::string> names;
    double end = 0;
    for (const json& each : stretches) {
        EXPECT_EQ(each.at("from_m").get<double>(), end);
        end = each.at("to_m").get<double>();
        if (names.empty() || names.back() != each.at("source")) names.push_back(each.at("source"));
    }
    EXPECT_EQ(end, answer().at("distance_m").get<double>());
    EXPECT_EQ(names, (std::vector<std::string>{"low.vrt", "west, low.vrt", "x.vrt"}));
    // The tile begins half a sample west of 10.2, and a vertex may lie half a spacing off.
    const double degree = 111320 * std::cos(49.87 * planet::degrees);
    for (const json& each : stretches)
        if (each.at("source") == "west, low.vrt") {
            EXPECT_NEAR(each.at("from_m").get<double>(), (10.195 - 10.05) * degree, 0.02 * degree);
            break;
        }
}

TEST_F(QuerySource, OfFilesOfOneNameSaysWhichSource) {
    std::filesystem::create_directory(*folder_ / "a");
    std::filesystem::create_directory(*folder_ / "b");
    Terrain terrain = hilly_terrain();
    terrain.write(*folder_ / "a/dem.vrt");
    terrain.x = 20;
    terrain.write(*folder_ / "b/dem.vrt");
    bake(*folder_, "a/dem.vrt b/dem.vrt -o same.octa");
    EXPECT_EQ(line_at("49.9,10.1", "same.octa"), "from dem.vrt (source 1)");
    EXPECT_EQ(line_at("49.9,20.1", "same.octa"), "from dem.vrt (source 2)");
}

TEST_F(QuerySource, OfAnOlderStoreIsOneOfAll) {
    std::filesystem::copy_file(*folder_ / "store.octa", *folder_ / "old.octa");
    planet::testing::make_version_3(*folder_ / "old.octa");
    EXPECT_EQ(line_at("49.8,10.3", "old.octa"), "from one of low.vrt, pacific.vrt, *.vrt (2 files)");
    EXPECT_TRUE(answer().at("source").is_null());
    EXPECT_EQ(answer().at("source_one_of").size(), 3u);
    EXPECT_EQ(line_at("12,-70", "old.octa"), "");
    EXPECT_EQ(run(folder_->path(), words("verify old.octa")).status, 0);

    bake(*folder_, "low.vrt -o one.octa");
    planet::testing::make_version_3(*folder_ / "one.octa");
    EXPECT_EQ(line_at("49.9,10.1", "one.octa"), "from low.vrt");
    EXPECT_EQ(line_at("12,-70", "one.octa"), "");
}

TEST_F(QuerySource, OfAnOlderUnfinishedStoreIsNotGoneOnWith) {
    std::filesystem::copy_file(*folder_ / "store.octa", *folder_ / "half.octa");
    planet::testing::make_version_3(*folder_ / "half.octa");
    planet::SqliteFile(*folder_ / "half.octa", planet::SqliteFile::Access::recover)
        .run("UPDATE metadata SET value = '0' WHERE key = 'complete'");
    const Outcome outcome =
        run(folder_->path(), words("bake low.vrt pacific.vrt tiles/*.vrt --least-level 12 -o half.octa --resume"));
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("in format version 3"), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

// In a leaf tile that cannot be read the tile above answers, with its own sources.
TEST_F(QuerySource, OfADamagedTileIsThatOfTheOneAbove) {
    std::filesystem::copy_file(*folder_ / "store.octa", *folder_ / "bad.octa");
    {
        planet::SqliteFile file(*folder_ / "bad.octa", planet::SqliteFile::Access::recover);
        file.run("UPDATE tiles SET data = CAST(substr(data, 1, length(data) - 1) || x'5a' AS BLOB) WHERE code >= 8192");
    }
    const Outcome outcome = query("height 49.8,10.3", "bad.octa");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.err.find("is damaged"), std::string::npos);
    EXPECT_NE(outcome.out.find("; no bound, a tile there is damaged, "), std::string::npos) << outcome.out;
    EXPECT_NE(run(folder_->path(), words("verify bad.octa")).status, 0);
}

}  // namespace
}  // namespace render
