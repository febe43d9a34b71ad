// Layers through the whole program: what is drawn where, what is reported, what is refused.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "planet/elevation/image_io.h"
#include "render/gl/context.h"
#include "tests/render/app/picture_difference.h"
#include "tests/render/app/program_process.h"
#include "tests/render/app/terrain_files.h"

namespace render {
namespace {

namespace fs = std::filesystem;

constexpr const char* square =
    R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"Square","kind":"area"},"geometry":)"
    R"({"type":"Polygon","coordinates":[[[178,-2],[-178,-2],[-178,2],[178,2],[178,-2]]]}}]})";

class LayerCommand : public testing::Test {
  protected:
    void SetUp() override {
        for (const auto& way : probe_backends())
            if (way.available) return;
        GTEST_SKIP() << "no usable OpenGL";
    }
    void write(const std::string& name, const std::string& text) {
        std::ofstream(folder_.path() / name, std::ios::binary) << text;
    }
    Outcome render(const std::string& arguments) {
        return run(folder_.path(), words("render --size 200x200 " + arguments));
    }
    planet::Image picture(const std::string& arguments) {
        const Outcome outcome = render(arguments + " -o p.png --json p.json");
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        report_ = nlohmann::json::parse(content(folder_ / "p.json"), nullptr, false);
        return planet::read_image(folder_ / "p.png");
    }
    /// One line, the status of bad data, and no picture.
    void refuses(const std::string& layer, const std::string& says) {
        const Outcome outcome = run(folder_.path(), {"render", "--size", "64x64", "--layer", layer, "-o", "none.png"});
        EXPECT_EQ(outcome.status, 3) << layer << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
        EXPECT_FALSE(fs::exists(folder_ / "none.png"));
    }
    static std::array<int, 3> pixel(const planet::Image& image, int x, int y) {
        const std::uint8_t* p = &image.pixels[static_cast<std::size_t>(3 * (y * image.width + x))];
        return {p[0], p[1], p[2]};
    }

    ScratchFolder folder_;
    nlohmann::json report_;
};

// 4 degrees of longitude across the antimeridian, seen from where 10 pixels are a degree.
TEST_F(LayerCommand, APolygonAcrossTheAntimeridianIsFilledWhereItIs) {
    write("square.geojson", square);
    const std::string view = "--at 0,180 --range 3000km --time 2026-06-21T00:00:00Z ";
    const planet::Image plain = picture(view);
    const planet::Image drawn = picture(view + "--layer square.geojson,color=#ff0000,fill=1,opacity=1");
    EXPECT_EQ(pixel(drawn, 100, 100), (std::array{255, 0, 0}));
    for (const auto& [x, y] : {std::pair(20, 100), {180, 100}, {100, 20}, {100, 180}})
        EXPECT_EQ(pixel(drawn, x, y), pixel(plain, x, y)) << x << ' ' << y;
    ASSERT_EQ(report_["layers"].size(), 1u);
    EXPECT_EQ(report_["layers"][0]["name"], "square");
    EXPECT_EQ(report_["layers"][0]["features"], 1);
    EXPECT_EQ(report_["layers"][0]["vertices"], 5);
}

TEST_F(LayerCommand, LaterLayersLieOnTop) {
    write("a.geojson", square);
    write("b.geojson", square);
    const std::string view = "--at 0,180 --range 3000km ";
    const std::string a = "--layer a.geojson,color=#ff0000,fill=1 ", b = "--layer b.geojson,color=#0000ff,fill=1 ";
    EXPECT_EQ(pixel(picture(view + a + b), 100, 100), (std::array{0, 0, 255}));
    EXPECT_EQ(pixel(picture(view + b + a), 100, 100), (std::array{255, 0, 0}));
    EXPECT_EQ(pixel(picture(view + b + "--layer a.geojson,opacity=0"), 100, 100), (std::array{0, 0, 255}));
}

TEST_F(LayerCommand, ALineIsAsWideAsItShouldBeAtAnyDistance) {
    write("line.geojson", R"({"type":"LineString","coordinates":[[-40,0.3],[-20,0.3]]})");
    for (const char* range : {"2km", "90km", "4000km"}) {
        const planet::Image image =
            picture(std::string("--at 0.3,-30 --range ") + range + " --layer line.geojson,color=#ff0000,width=6");
        int red = 0;
        for (int y = 0; y < image.height; ++y) {
            const auto [r, g, b] = pixel(image, 100, y);
            red += r > 200 && g < 60 && b < 60;
        }
        EXPECT_NEAR(red, 6, 1) << range;
    }
}

TEST_F(LayerCommand, CoastlinesAndReliefAreShown) {
    const std::string view = "--at 5,10 --range 9000km ";
    const planet::Image plain = picture(view), coasts = picture(view + "--show coastlines,borders"),
                        relief = picture(view + "--show relief");
    EXPECT_GT(compare(plain, coasts, 8).share(), 0.005);
    EXPECT_LT(compare(plain, coasts, 8).share(), 0.2);
    EXPECT_GT(compare(plain, relief, 8).share(), 0.2);
}

TEST_F(LayerCommand, AMeshStandsInItsPlace) {
    const std::string dem = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";
    const std::string view = "--at 37.5,-105 --range 60km --time 2026-06-21T18:00:00Z ";
    const planet::Image plain = picture(view);
    for (const char* name : {"t.glb", "t.ply"}) {
        ASSERT_EQ(run(folder_.path(), {"tin", dem, "--max-deviation", "80", "-o", name}).status, 0);
        const planet::Image drawn = picture(view + "--layer " + name + ",color=#ff00ff");
        EXPECT_GT(compare(plain, drawn, 20).share(), 0.5) << name;
        const auto [r, g, b] = pixel(drawn, 100, 100);
        EXPECT_GT(r, g + 40);
        EXPECT_GT(b, g + 30);
    }
}

// A mesh stands for the ground of a line unless it is far above that.
TEST_F(LayerCommand, LinesAndMeshesLieInTheirOrder) {
    const std::string dem = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";
    ASSERT_EQ(run(folder_.path(), {"tin", dem, "--max-deviation", "80", "-o", "t.glb"}).status, 0);
    Terrain plateau{.width = 9, .height = 9, .x = -105.2, .y = 37.7, .step_x = 0.05, .step_y = -0.05};
    plateau.height_m = [](int column, int) { return 9000 + column; };
    plateau.write(folder_.path() / "plateau.vrt");
    ASSERT_EQ(run(folder_.path(), {"tin", "plateau.vrt", "--max-deviation", "20", "-o", "high.glb"}).status, 0);
    write("line.geojson", R"({"type":"LineString","coordinates":[[-105.3,37.5],[-104.7,37.5]]})");
    const std::string view = "--at 37.5,-105 --range 60km --time 2026-06-21T18:00:00Z --layer ";
    const std::string line = "line.geojson,color=#ff0000,width=8", also = " --layer ";
    const auto red = [&](const std::string& layers) {
        const auto [r, g, b] = pixel(picture(view + layers), 100, 100);
        return r > g + 60 && r > b + 60;
    };
    EXPECT_TRUE(red("t.glb,color=#00ff00" + also + line));
    EXPECT_FALSE(red(line + also + "t.glb,color=#00ff00"));
    EXPECT_TRUE(red(line + also + "t.glb,color=#00ff00,opacity=0"));
    EXPECT_FALSE(red("high.glb" + also + line));
    EXPECT_TRUE(red("high.glb,opacity=0" + also + line));
    // With many samples a pixel depths are resolved.
    EXPECT_TRUE(red("t.glb,color=#00ff00" + also + line + " --samples 4"));
}

TEST_F(LayerCommand, CoastlinesLieOnAMeshThatIsBelowAllElse) {
    ASSERT_EQ(run(folder_.path(), {"mesh", "--planet", "--level", "12", "-o", "earth.glb"}).status, 0);
    write("line.geojson", R"({"type":"LineString","coordinates":[[-150,-60],[-149,-60]]})");
    const std::string view = "--at 5,10 --range 9000km --layer ", coasts = " --show coastlines",
                      above = "line.geojson --layer earth.glb";
    EXPECT_GT(compare(picture(view + "earth.glb"), picture(view + "earth.glb" + coasts), 8).share(), 0.005);
    EXPECT_EQ(compare(picture(view + above), picture(view + above + coasts), 8).share(), 0);
}

// Red in the north, blue in the south.
TEST_F(LayerCommand, AMeshHasItsPictureOnIt) {
    planet::Image photo{64, 64, 3, {}};
    for (int i = 0; i < 64 * 64; ++i)
        for (const int byte : i < 64 * 32 ? std::array{250, 10, 10} : std::array{10, 10, 250})
            photo.pixels.push_back(static_cast<std::uint8_t>(byte));
    planet::write_image(folder_ / "photo.png", photo);
    const std::string dem = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";
    ASSERT_EQ(run(folder_.path(), {"tin", dem, "--max-deviation", "80", "--drape", "photo.png", "-o", "t.glb"}).status,
              0);
    const std::string view = "--at 37.5,-105 --range 60km --time 2026-06-21T18:00:00Z --layer ";
    const planet::Image drawn = picture(view + "t.glb");
    const auto north = pixel(drawn, 100, 40), south = pixel(drawn, 100, 160);
    EXPECT_GT(north[0], north[2] + 80);
    EXPECT_GT(south[2], south[0] + 80);
    const auto green = pixel(picture(view + "t.glb,color=#00ff00"), 100, 40);
    EXPECT_GT(green[1], green[0] + 80);

    std::string bytes = content(folder_ / "t.glb");
    const std::size_t start = bytes.rfind("\x89PNG");
    ASSERT_NE(start, bytes.npos);
    bytes.replace(start, 4, "none");
    write("broken.glb", bytes);
    const Outcome outcome = render(view + "broken.glb -o broken.png");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err.rfind("octaglobe: warning: broken.glb: is no picture", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    const auto plain = pixel(planet::read_image(folder_ / "broken.png"), 100, 40);
    EXPECT_LT(std::abs(plain[0] - plain[2]), 30);
}

TEST_F(LayerCommand, AMeshHasTheColourOfItsMaterial) {
    const std::string dem = OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif";
    ASSERT_EQ(run(folder_.path(), {"tin", dem, "--max-deviation", "200", "-o", "t.glb"}).status, 0);
    const std::string grey = content(folder_ / "t.glb"), factor = R"("baseColorFactor":[0.6,0.6,0.6,)";
    const auto seen = [&](const std::string& other) {
        std::string bytes = grey;
        EXPECT_NE(bytes.find(factor), bytes.npos);
        write("m.glb", bytes.replace(bytes.find(factor), factor.size(), other));
        return pixel(picture("--at 37.5,-105 --range 60km --time 2026-06-21T18:00:00Z --layer m.glb"), 100, 100);
    };
    const auto clay = seen(factor), red = seen(R"("baseColorFactor":[0.9,0.1,0.1,)"),
               white = seen(R"("baseColorFactor":[1.0,1.0,1.0,)");
    EXPECT_GT(red[0], red[1] + 80);
    EXPECT_EQ(white, clay);
    EXPECT_LT(std::abs(clay[0] - clay[2]), 40);
}

TEST_F(LayerCommand, LabelsAreDrawn) {
    write(
        "peak.geojson",
        R"({"type":"Feature","properties":{"Name":"Point Nemo"},"geometry":{"type":"Point","coordinates":[-123.4,-48.9]}})");
    const std::string view = "--at -48.9,-123.4 --range 900km --layer peak.geojson";
    const planet::Image marked = picture(view), named = picture(view + ",label=name");
    const PictureDifference d = compare(marked, named, 8);
    EXPECT_GT(d.share(), 0.005);
    EXPECT_LT(d.share(), 0.1);
}

TEST_F(LayerCommand, RefusesFilesThatAreNoLayers) {
    write("broken.geojson", R"({"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"Poin)");
    write("empty.geojson", "");
    write("none.geojson", R"({"type":"FeatureCollection","features":[]})");
    write("far.geojson", R"({"type":"Point","coordinates":[10,95]})");
    write("broken.glb", "glTF");
    write("placeless.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const char* name : {"broken.geojson", "empty.geojson", "none.geojson", "far.geojson", "missing.gpx",
                             "broken.glb", "placeless.obj", "missing.ply"})
        refuses(name, name);
    write("square.geojson", square);
    const ScratchVariable font("OCTAGLOBE_FONT", "/dev/null");
    refuses("square.geojson,label=name", "font");
}

TEST_F(LayerCommand, ALabelThatIsNoAttributeSaysWhichThereAre) {
    write("square.geojson", square);
    const Outcome outcome = render("--layer square.geojson,label=title -o none.png");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("name, kind"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace render
