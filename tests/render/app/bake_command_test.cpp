// octaglobe bake, and what render, query, info and verify make of a store of the user's own.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geoid.h"
#include "planet/geodesy/utm.h"
#include "tests/render/app/baked_store.h"

namespace render {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using planet::degrees;

json info_of(const ScratchFolder& folder, const std::string& store = "store.octa") {
    const Outcome outcome = run(folder.path(), words("info " + store + " --json info.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(content(folder / "info.json"));
}

void expect_sound(const ScratchFolder& folder, const std::string& store = "store.octa") {
    const Outcome outcome = run(folder.path(), words("verify " + store));
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_NE(outcome.out.find(": sound"), std::string::npos) << outcome.out;
}

TEST(BakeCommand, ReportsWhatItMade) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    const json baked = bake(folder, "dem.vrt");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"bake.json", "dem.vrt", "dem.vrt.raw", "store.octa"}));
    EXPECT_EQ(baked.at("bytes"), fs::file_size(folder / "store.octa"));
    EXPECT_GT(baked.at("tiles"), 8);
    EXPECT_GT(baked.at("vertices"), 41 * 33);
    EXPECT_GT(baked.at("vertices_per_second"), 0);
    EXPECT_EQ(baked.at("vertical_datum"), "egm96");
    EXPECT_EQ(baked.at("quantum_m"), 0.25);
    EXPECT_GT(baked.at("peak_memory_bytes"), 1e6);
    // 0.01 degrees at latitude 49.84: 1112 m and 717 m, so 893 m apart; the lattice is no coarser, and at most sqrt 2 finer.
    const double spacing = baked.at("spacing_m");
    EXPECT_LE(spacing, 895);
    EXPECT_GE(spacing, 890 / std::sqrt(2.0));
    const json source = baked.at("sources").at(0);
    EXPECT_EQ(source.at("name"), "dem.vrt");
    EXPECT_EQ(source.at("crs"), "EPSG:4326");
    EXPECT_EQ(source.at("vertical_datum"), "egm96");
    EXPECT_NEAR(source.at("spacing_m"), 893, 2);
    EXPECT_EQ(source.at("sha256").get<std::string>().size(), 64u);
    double seconds = 0;
    for (const auto& [step, taken] : baked.at("seconds").items()) seconds += taken.get<double>();
    EXPECT_GT(seconds, 0);
    expect_sound(folder);

    const json info = info_of(folder);
    for (const char* key : {"tiles", "vertices", "bytes", "finest_level", "spacing_m", "quantum_m", "resampling_max_m",
                            "vertical_datum", "sources", "ellipsoid"})
        EXPECT_EQ(info.at(key), baked.at(key)) << key;
    EXPECT_EQ(info.at("complete"), true);
    EXPECT_EQ(info.at("done"), 1);
    std::uint64_t tiles = 0, vertices = 0;
    for (const json& level : info.at("levels")) {
        tiles += level.at("tiles").get<std::uint64_t>();
        vertices += level.at("vertices").get<std::uint64_t>();
    }
    EXPECT_EQ(tiles, baked.at("tiles"));
    EXPECT_EQ(vertices, baked.at("vertices"));
}

TEST(BakeCommand, SummaryFitsAScreen) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    for (const char* arguments : {"bake dem.vrt -o store.octa", "info store.octa"}) {
        const Outcome outcome = run(folder.path(), words(arguments));
        EXPECT_EQ(outcome.err, "");  // no progress in a pipe
        EXPECT_LE(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 24) << outcome.out;
        EXPECT_NE(outcome.out.find("dem.vrt"), std::string::npos) << outcome.out;
    }
}

// What the store says of its levels, against reading every tile.
TEST(BakeCommand, InfoCountsVertices) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt --density 3");
    const auto store = planet::ElevationStore::open(folder / "store.octa");
    std::map<int, std::uint64_t> vertices;
    for (const auto root : store.tiles()) vertices[root.bisection_level()] += store.read(root)->height.size();
    const json info = info_of(folder);
    for (const json& level : info.at("levels"))
        EXPECT_EQ(level.at("vertices"), vertices.at(level.at("bisection_level"))) << level;
}

TEST(BakeCommand, InfoSaysWhereItIsFine) {
    const ScratchFolder folder;
    Terrain fiji = hilly_terrain();  // across the antimeridian
    fiji.x = 179.8, fiji.y = -16;
    fiji.write(folder / "fiji.vrt");
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "fiji.vrt dem.vrt");
    std::vector<json> fine;
    const json info = info_of(folder);
    for (const json& area : info.at("areas"))
        if (area.at("bisection_level") == info.at("areas")[0].at("bisection_level")) fine.push_back(area);
    ASSERT_EQ(fine.size(), 2u);
    if (fine[0].at("south_deg") < 0) std::swap(fine[0], fine[1]);
    const auto expect_box = [](const json& area, double south, double west, double north, double east) {
        const double margin = 2;  // of whole tiles around the source
        const auto within = [&](const char* key, double least, double most) {
            EXPECT_GE(area.at(key), least) << key;
            EXPECT_LE(area.at(key), most) << key;
        };
        within("south_deg", south - margin, south);
        within("west_deg", west - margin, west);
        within("north_deg", north, north + margin);
        within("east_deg", east, east + margin);
    };
    expect_box(fine[0], 49.68, 10, 50, 10.4);
    expect_box(fine[1], -16.32, 179.8, -16, -179.8);
}

// The finest surface is within the bound that a query tells of every sample.
TEST(BakeCommand, QueryTellsHeightAndBound) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt");
    const auto field = open_field(folder / "store.octa");
    double most = 0;
    for (int row = 0; row < 33; ++row)
        for (int column = 0; column < 41; ++column) {
            const double latitude = 50 - 0.01 * row, longitude = 10 + 0.01 * column;
            const double off = std::abs(height_at(field, latitude, longitude) - hills(column, row));
            const auto normal = planet::normal_from_geodetic(latitude * degrees, longitude * degrees);
            EXPECT_LE(off, field.bound_at(normal).total() + 1e-3) << column << "," << row;
            most = std::max(most, off);
        }
    EXPECT_GT(most, 1);  // it is not for nothing

    const Outcome outcome = run(folder.path(), words("query height 49.9,10.1 --store store.octa --json q.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json answer = json::parse(content(folder / "q.json"));
    EXPECT_NEAR(answer.at("height_m"), height_at(field, 49.9, 10.1), 0.1);  // the field is flat in a cell: it sags
    EXPECT_NEAR(std::strtod(outcome.out.c_str(), nullptr), answer.at("height_m"), 0.005);
    const double bound = answer.at("height_bound_m");
    EXPECT_GT(bound, 0);
    EXPECT_LE(bound, info_of(folder).at("resampling_max_m"));
    EXPECT_NE(outcome.out.find(" within "), std::string::npos) << outcome.out;
}

// A hill in two datums, and in a projection: the same heights. Without --datum, above EGM96.
TEST(BakeCommand, MixesDatumsAndReferenceSystems) {
    const ScratchFolder folder;
    const planet::Geoid geoid(OCTAGLOBE_SOURCE_DIR "/data/egm96-15.pgm");
    const auto hill = [](double latitude, double longitude) {
        return 500 + 300 * std::exp(-300 * ((latitude - 49.84) * (latitude - 49.84) +
                                            (longitude - 10.2) * (longitude - 10.2)));
    };
    Terrain above_geoid, above_ellipsoid, projected;
    above_geoid.height_m = [&](int column, int row) { return hill(50 - 0.01 * row, 10 + 0.01 * column); };
    above_geoid.write(folder / "geoid.vrt");
    above_ellipsoid.height_m = [&](int column, int row) {
        const double latitude = 50 - 0.01 * row, longitude = 10 + 0.01 * column;
        return hill(latitude, longitude) + geoid.undulation(latitude * degrees, longitude * degrees).m;
    };
    above_ellipsoid.write(folder / "ellipsoid.vrt");
    const planet::Utm corner = planet::utm_from_geodetic({50 * degrees, 10 * degrees, {}}, 32);
    projected.crs = "EPSG:32632";
    projected.x = corner.easting, projected.y = corner.northing;
    projected.step_x = 700, projected.step_y = -1000;
    projected.height_m = [&](int column, int row) {
        planet::Utm at = corner;
        at.easting += 700 * column, at.northing -= 1000 * row;
        const planet::Geodetic g = planet::geodetic_from_utm(at);
        return hill(g.latitude / degrees, g.longitude / degrees) + geoid.undulation(g.latitude, g.longitude).m;
    };
    projected.write(folder / "utm.vrt");

    bake(folder, "geoid.vrt -o a.octa");
    const json b = bake(folder, "ellipsoid.vrt --datum ellipsoid -o b.octa");
    const json c = bake(folder, "geoid.vrt utm.vrt --datum egm96 --datum ellipsoid -o c.octa");
    EXPECT_EQ(b.at("sources").at(0).at("vertical_datum"), "ellipsoid");
    EXPECT_EQ(b.at("vertical_datum"), "egm96");
    EXPECT_EQ(c.at("sources").at(0).at("vertical_datum"), "egm96");
    EXPECT_EQ(c.at("sources").at(1).at("vertical_datum"), "ellipsoid");
    const auto one = open_field(folder / "a.octa"), two = open_field(folder / "b.octa"),
               three = open_field(folder / "c.octa");
    for (double latitude = 49.72; latitude < 49.96; latitude += 0.013)
        for (double longitude = 10.05; longitude < 10.35; longitude += 0.017) {
            const double height = height_at(one, latitude, longitude);
            EXPECT_NEAR(height_at(two, latitude, longitude), height, 0.5) << latitude << "," << longitude;
            EXPECT_NEAR(height_at(three, latitude, longitude), height, 8)
                << latitude << "," << longitude;  // 1 km samples
        }
    EXPECT_GT(height_at(two, 49.84, 10.2), 780);
    EXPECT_GT(height_at(three, 49.84, 10.2), 780);
}

// A void of the upper source shows the lower one, blended at its border, and nothing else. Where neither has an answer
// the height is 0.
TEST(BakeCommand, VoidsFallThrough) {
    const ScratchFolder folder;
    Terrain base = hilly_terrain();
    base.height_m = [](int, int) { return 1000.0; };
    base.x = 9.8, base.y = 50.2, base.width = 81, base.height = 73;
    base.write(folder / "base.vrt");
    Terrain top = hilly_terrain();
    top.band = "<NoDataValue>-9999</NoDataValue>";
    top.height_m = [](int column, int row) {
        const bool hole = column >= 10 && column < 25 && row >= 10 && row < 22;
        return hole || (column * 7 + row * 13) % 50 == 0 ? -9999.0 : 1200.0;
    };
    top.write(folder / "top.vrt");
    bake(folder, "base.vrt top.vrt");
    expect_sound(folder);
    const auto field = open_field(folder / "store.octa");
    for (double latitude = 49.6; latitude < 50.1; latitude += 0.0031)
        for (double longitude = 9.9; longitude < 10.5; longitude += 0.0037) {
            const double height = height_at(field, latitude, longitude);
            EXPECT_GE(height, 999.5) << latitude << "," << longitude;
            EXPECT_LE(height, 1200.5) << latitude << "," << longitude;
        }
    EXPECT_NEAR(height_at(field, 49.84, 10.17), 1000, 1);  // in the middle of the hole
    EXPECT_NEAR(height_at(field, 49.95, 10.35), 1200, 1);
    EXPECT_NEAR(height_at(field, 50.15, 10.5), 1000, 1);
}

// Where no source is the height is 0, on cells fine enough to be round: 22 km sag by some 20 m.
TEST(BakeCommand, TheSeaIsRoundWhereNoSourceIs) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    ASSERT_EQ(run(folder.path(), words("bake dem.vrt -o store.octa")).status, 0);
    const auto field = open_field(folder / "store.octa");
    for (double latitude = -85; latitude < 90; latitude += 7.3)
        for (double longitude = -180; longitude < 180; longitude += 11.9)
            if (std::abs(latitude - 50) + std::abs(longitude - 10) > 4) {
                EXPECT_LE(height_at(field, latitude, longitude), 0) << latitude << "," << longitude;
                EXPECT_GE(height_at(field, latitude, longitude), -50) << latitude << "," << longitude;
            }
    const Outcome outcome = run(folder.path(), words("query height 30,-40 --store store.octa --json q.json"));
    EXPECT_NE(outcome.out.find("no source there"), std::string::npos) << outcome.out;
    const json answer = json::parse(content(folder / "q.json"));
    EXPECT_TRUE(answer.at("height_bound_m").is_null());
}

TEST(BakeCommand, LaterSourcesAreOnTop) {
    const ScratchFolder folder;
    Terrain low = hilly_terrain(), high = hilly_terrain();
    low.height_m = [](int, int) { return 100.0; };
    high.height_m = [](int, int) { return 900.0; };
    low.write(folder / "low.vrt");
    high.write(folder / "high.vrt");
    bake(folder, "low.vrt high.vrt -o a.octa");
    bake(folder, "high.vrt low.vrt -o b.octa");
    EXPECT_NEAR(height_at(open_field(folder / "a.octa"), 49.84, 10.2), 900, 0.5);
    EXPECT_NEAR(height_at(open_field(folder / "b.octa"), 49.84, 10.2), 100, 0.5);
}

TEST(BakeCommand, TheShippedEarthCanLieBelow) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt --base earth --finest-level 12 -o with.octa");
    bake(folder, "dem.vrt --finest-level 12 -o without.octa");
    EXPECT_GT(height_at(open_field(folder / "with.octa"), 33, 88), 2000);  // Tibet
    EXPECT_LT(height_at(open_field(folder / "without.octa"), 33, 88), 0);  // far below a chord of the sea
    const json sources = info_of(folder, "with.octa").at("sources");
    EXPECT_EQ(sources.front().at("name"), "etopo5.tif");
    EXPECT_EQ(sources.back().at("name"), "dem.vrt");
}

TEST(BakeCommand, OptionsDecideHowFine) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    const json plain = bake(folder, "dem.vrt -o plain.octa");
    const json dense = bake(folder, "dem.vrt --density 2 -o dense.octa");
    const json capped = bake(folder, "dem.vrt --finest-level 20 --quantum 2 -o capped.octa");
    EXPECT_EQ(dense.at("finest_level"), plain.at("finest_level").get<int>() + 2);
    EXPECT_LT(dense.at("resampling_max_m"), plain.at("resampling_max_m"));
    EXPECT_EQ(capped.at("finest_level"), 20);
    EXPECT_EQ(capped.at("quantum_m"), 2);
    const auto field = open_field(folder / "capped.octa");
    for (const auto root : field.store().tiles()) {
        const auto tile = field.store().read(root);
        for (const float height : tile->height) EXPECT_EQ(std::fmod(height, 2.0f), 0);
    }
}

TEST(BakeCommand, PatternsAreExpanded) {
    const ScratchFolder folder;
    fs::create_directory(folder / "tiles");
    for (const int i : {0, 1}) {
        Terrain part = hilly_terrain();
        part.x += 0.41 * i;
        part.height_m = [](int, int) { return 700.0; };
        part.write(folder.path() / "tiles" / ("part" + std::to_string(i) + ".vrt"));
    }
    bake(folder, "tiles/*.vrt");
    const auto field = open_field(folder / "store.octa");
    for (const double longitude : {10.2, 10.405, 10.6}) EXPECT_NEAR(height_at(field, 49.84, longitude), 700, 0.5);
}

TEST(BakeCommand, BakingTwiceGivesTheSameRows) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt -o a.octa");
    bake(folder, "dem.vrt -o b.octa");
    EXPECT_EQ(rows_of(folder / "a.octa"), rows_of(folder / "b.octa"));
}

TEST(BakeCommand, AStoreIsNotOverwrittenUnasked) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt");
    const std::string before = content(folder / "store.octa");
    const auto names = folder.names();
    const Outcome refused = run(folder.path(), words("bake dem.vrt --density 1 -o store.octa"));
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(refused.err.starts_with("octaglobe: --output: 'store.octa' is a finished store; accepted: --replace"))
        << refused.err;
    EXPECT_EQ(content(folder / "store.octa"), before);

    // A bake that cannot begin leaves the old store.
    EXPECT_EQ(run(folder.path(), words("bake missing.tif --replace -o store.octa")).status, 3);
    EXPECT_EQ(content(folder / "store.octa"), before);

    bake(folder, "dem.vrt --density 1 --replace");
    EXPECT_EQ(folder.names(), names);
    EXPECT_NE(content(folder / "store.octa"), before);
    expect_sound(folder);
}

TEST(BakeCommand, ResumingAFinishedStoreDoesNothing) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt");
    const std::string before = content(folder / "store.octa");
    for (const char* arguments : {"bake dem.vrt --least-level 12 --resume -o store.octa",
                                  "bake --least-level 12 --resume -o store.octa", "bake --resume -o store.octa"}) {
        const Outcome outcome = run(folder.path(), words(arguments));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "store.octa is finished\n");
        EXPECT_EQ(content(folder / "store.octa"), before);
    }
}

TEST(BakeCommand, ResumingNothingBeginsIt) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt --resume -o resumed.octa");
    bake(folder, "dem.vrt");
    EXPECT_EQ(rows_of(folder / "resumed.octa"), rows_of(folder / "store.octa"));
}

TEST(BakeCommand, RenderDrawsTheStore) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    bake(folder, "dem.vrt");
    const std::string view = "render --store store.octa --at 49.84,10.2 --range 30km --pitch -30 --size 160x90 ";
    for (const char* name : {"a", "b"}) {
        const Outcome outcome =
            run(folder.path(), words(view + "-o " + name + ".png --json " + std::string(name) + ".json"));
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
    }
    EXPECT_EQ(content(folder / "a.png"), content(folder / "b.png"));
    const json report = json::parse(content(folder / "a.json"));
    ASSERT_EQ(report.at("sources").size(), 1u);
    EXPECT_EQ(report.at("sources").at(0).at("name"), "dem.vrt");
    EXPECT_LE(report.at("pixel_deviation_max"), 0.5);
    // The eye stands on the range's end, seen from the store's ground and no other.
    EXPECT_NEAR(report.at("eye_height_m"), 30000 * std::sin(30 * degrees) + 850, 450);
}

}  // namespace
}  // namespace render
