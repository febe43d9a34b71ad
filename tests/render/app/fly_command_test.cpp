// Flights as a user draws them: frames that depend on nothing but the flight, and one line for whatever is wrong.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "planet/elevation/image_io.h"
#include "render/app/fly/film.h"
#include "render/app/output_folder.h"
#include "render/app/picture/picture.h"
#include "tests/render/app/can_draw.h"
#include "tests/render/app/picture_difference.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

/// From afar to a mountain, whose heading then turns; 2.6 s.
constexpr const char* flight = R"({"keys": [
    {"at": [20, -100], "range": "9000km", "time": "2026-06-21T17:00:00Z"},
    {"at": "37.58,-105.49", "range": "30km", "heading": 30, "pitch": -20, "seconds": 2},
    {"heading": 40, "exaggeration": 1, "seconds": 2.6}]})";

void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

/// A program that is called ffmpeg and stands alone in PATH.
class StandIn {
  public:
    explicit StandIn(const std::string& script) {
        write(folder_ / "ffmpeg", "#!/bin/bash\n" + script);
        std::filesystem::permissions(folder_ / "ffmpeg", std::filesystem::perms::owner_all);
    }
    std::function<void()> in_path() const {
        return [path = folder_.path().native()] { ::setenv("PATH", path.c_str(), 1); };
    }

  private:
    ScratchFolder folder_;
};

/// Keeps what it gets as the video, whose name comes last.
constexpr const char* keeps_frames = "exec /bin/cat > \"${@: -1}\"\n";

class Fly : public testing::Test {
  protected:
    void SetUp() override {
        if (!can_draw()) GTEST_SKIP() << "no usable OpenGL";
        write(folder_ / "path.json", flight);
    }
    Outcome fly(const std::string& arguments, const std::function<void()>& prepare = {}) const {
        const std::string size = arguments.find("--size") == std::string::npos ? "--size 96x54 " : "";
        return run(folder_.path(), words("fly path.json --fps 5 " + size + arguments), prepare);
    }
    std::string frame(const std::string& folder, int number) const {
        char name[64];
        std::snprintf(name, sizeof name, "/frame_%06d.png", number);
        return content(folder_.path() / (folder + name));
    }

    /// Whether so many frames of a flight to "frames" are written.
    bool begun(int frames) const {
        for (const std::string& name : folder_.names())
            if (name.ends_with(".part") && !frame(name, frames - 1).empty()) return true;
        return false;
    }

    ScratchFolder folder_;
};

TEST_F(Fly, FramesAreThoseOfRenderAndDependOnNothingElse) {
    const Outcome whole = fly("-o all --threads 2 --json all.json");
    ASSERT_EQ(whole.status, 0) << whole.err;
    for (int i = 0; i < 14; ++i) EXPECT_GT(frame("all", i).size(), 500u) << i;
    EXPECT_TRUE(frame("all", 14).empty());
    const std::string report = content(folder_ / "all.json");
    EXPECT_NE(report.find("\"frames\": 14"), std::string::npos) << report;
    EXPECT_EQ(report.find("\"pixel_deviation_max\": null"), std::string::npos) << report;

    ASSERT_EQ(fly("-o part --threads 1 --frames 8:11").status, 0);
    for (int i = 8; i <= 11; ++i) EXPECT_TRUE(frame("part", i) == frame("all", i)) << i;
    EXPECT_TRUE(frame("part", 7).empty());

    const auto expect_picture = [&](const std::string& view, int number) {
        const Outcome drawn =
            run(folder_.path(), words("render --size 96x54 --time 2026-06-21T17:00:00Z -o one.png " + view));
        ASSERT_EQ(drawn.status, 0) << drawn.err;
        EXPECT_TRUE(content(folder_ / "one.png") == frame("all", number)) << number;
    };
    expect_picture("--at 20,-100 --range 9000km", 0);
    expect_picture("--at 37.58,-105.49 --range 30km --heading 30 --pitch -20", 10);
    expect_picture("--at 37.58,-105.49 --range 30km --heading 40 --pitch -20", 13);
}

// Frames larger than what is drawn at once, which here is little: four parts, with what crosses their borders.
TEST_F(Fly, ALargeFrameHasThePartsOfThePicture) {
    write(folder_ / "line.geojson", R"({"type": "LineString", "coordinates": [[-105.6, 37.5], [-105.4, 37.65]]})");
    FilmOptions film{.render = {.size = {160, 130}, .show = static_cast<std::uint32_t>(Overlay::graticule)}, .fps = 5};
    film.render.part_side = 112;
    film.render.layers = {parse_layer("layer", (folder_ / "line.geojson").string() + ",width=9")};
    film.frames = {9, 10};
    RenderOptions picture = film.render;
    const FlightPlan plan = read_flight_plan(folder_ / "path.json", {}, {});
    const auto frames = make_frame_output(folder_ / "large", film.render.size, film.fps, {false, ""});
    const FilmReport report = draw_film(film, plan, *frames);
    frames->finish();

    picture.at = plan.keys[1].at;
    picture.range = plan.keys[1].range;
    picture.heading = plan.keys[1].heading;
    picture.pitch = plan.keys[1].pitch;
    picture.time = *plan.keys[0].time;
    picture.output = folder_ / "one.png";
    const PictureReport drawn = draw_picture(picture);
    EXPECT_EQ(content(folder_ / "one.png"), frame("large", 10));
    EXPECT_GE(report.triangles_max, drawn.triangles);
    EXPECT_GT(report.tiles.tiles, 0u);
    // The parts are what is drawn at once, but for where layers meet their borders.
    picture.part_side = 2048;
    picture.output = folder_ / "whole.png";
    EXPECT_GT(drawn.triangles, draw_picture(picture).triangles);
    const PictureDifference d =
        compare(planet::read_image(folder_ / "one.png"), planet::read_image(folder_ / "whole.png"), 3);
    EXPECT_LT(d.share(), 0.002) << d.worst;
}

TEST_F(Fly, FollowsALine) {
    write(folder_ / "line.geojson", R"({"type": "LineString", "coordinates": [[179.99, -16.5], [180.01, -16.5]]})");
    const Outcome flown =
        run(folder_.path(),
            words("fly line.geojson --size 64x36 --fps 1 --height 800m --speed 500m --pitch -30 -o frames"));
    ASSERT_EQ(flown.status, 0) << flown.err;
    EXPECT_GT(frame("frames", 3).size(), 200u);
    EXPECT_TRUE(frame("frames", 5).empty());
    EXPECT_NE(frame("frames", 1), frame("frames", 3));
}

TEST_F(Fly, GivesEveryFrameToFfmpeg) {
    const StandIn ffmpeg(keeps_frames);
    const Outcome flown = fly("-o a.mp4 --frames 3:5", ffmpeg.in_path());
    ASSERT_EQ(flown.status, 0) << flown.err;
    EXPECT_EQ(content(folder_ / "a.mp4").size(), 3u * 96 * 54 * 3);
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.mp4", "path.json"}));
}

void expect_one_line(const Outcome& outcome, int status, const std::string& part) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST_F(Fly, SaysWhatFfmpegSaysOrThatThereIsNone) {
    const StandIn fails("echo first >&2; echo no such codec >&2; exit 3\n");
    expect_one_line(fly("-o a.mp4", fails.in_path()), 2, "no such codec");
    const ScratchFolder empty;
    expect_one_line(fly("-o a.webm", [&] { ::setenv("PATH", empty.path().c_str(), 1); }), 2, "apt-get install ffmpeg");
    expect_one_line(fly("-o a.mp4 --size 95x54"), 2, "even sides");
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"path.json"});
}

TEST_F(Fly, AStoppedFlightLeavesNothing) {
    for (const std::string output : {"frames", "video.mp4"}) {
        const StandIn ffmpeg("echo begun > \"${@: -1}\"; exec /bin/sleep 100\n");
        Process flying(folder_.path(), words("fly path.json --size 640x360 --fps 100 -o " + output), ffmpeg.in_path());
        const auto there = [&] { return folder_.names().size() > 1; };
        for (int i = 0; i < 1000 && !there(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        EXPECT_TRUE(there());
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        ::kill(flying.id(), SIGINT);
        EXPECT_EQ(flying.wait().status, 128 + SIGINT);
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"path.json"}) << output;
    }
}

TEST_F(Fly, AKilledFlightGoesOn) {
    ASSERT_EQ(fly("-o whole").status, 0);
    const std::string line = "fly path.json --fps 5 --size 96x54 -o frames";
    Process flying(folder_.path(), words(line));
    for (int i = 0; i < 2000 && !begun(2); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(flying.id(), SIGKILL);
    ASSERT_EQ(flying.wait().status, 128 + SIGKILL);
    const auto folder = OutputFolder::left_behind(folder_ / "frames");
    ASSERT_TRUE(folder);
    std::filesystem::resize_file(*folder / "frame_000000.png", 300);
    expect_one_line(run(folder_.path(), words(line + " --resume --fov 30")), 2, "another flight");
    expect_one_line(fly("-o a.mp4 --resume"), 2, "cannot be gone on with");
    const Outcome resumed = run(folder_.path(), words(line + " --resume"));
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    for (int i = 0; i < 14; ++i) EXPECT_TRUE(frame("frames", i) == frame("whole", i)) << i;
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"frames", "path.json", "whole"}));
    const std::filesystem::directory_iterator files(folder_ / "frames");
    EXPECT_EQ(std::distance(begin(files), end(files)), 14);
}

TEST_F(Fly, RefusesOutputsItCannotMake) {
    std::filesystem::create_directory(folder_ / "full");
    write(folder_ / "full" / "file", "x");
    expect_one_line(fly("-o full"), 2, "not empty");
    expect_one_line(fly("-o flight.png"), 2, "is no video");
    expect_one_line(fly("-o none/flight"), 2, "cannot be made");
    expect_one_line(fly("-o f --frames 3:99"), 2, "99 is not in the flight; accepted: 0 to 13");
    expect_one_line(fly("-o f --frames 5"), 2, "FIRST:LAST");
    expect_one_line(fly("-o f --size 9000x9000"), 2, "too large for frames");
}

struct BadPath {
    const char* name;
    const char* text;
    const char* said;
};

TEST(FlyPaths, WhatIsWrongIsOneLine) {
    const BadPath paths[] = {
        {"empty", "", "empty"},
        {"no JSON", "{\"keys\": [", "byte"},
        {"NaN", R"({"keys": [{"at": [NaN, 0], "range": 1000}, {"at": [1, 1]}]})", "byte"},
        {"nothing in it", "{}", "holds no keys"},
        {"a list", "[1, 2]", "holds no keys"},
        {"keys that are none", R"({"keys": 7})", "is no list"},
        {"one key", R"({"keys": [{"at": [1, 1], "range": 1000}]})", "holds 1; accepted: 2"},
        {"a number as a key", R"({"keys": [1, 2]})", "key 1: is no object"},
        {"an unknown word", R"({"keys": [{"at": [1, 1], "range": 1000, "zoom": 3}, {"range": 10}]})", "key 1 'zoom'"},
        {"an unknown word above", R"({"keys": [{}, {}], "loop": true})", "'loop': is unknown"},
        {"no place", R"({"keys": [{"range": 1000}, {"range": 10}]})", "key 1: has no place"},
        {"no distance", R"({"keys": [{"at": [1, 1]}, {"range": 10}]})", "key 1: has no distance"},
        {"two distances", R"({"keys": [{"at": [1, 1], "range": 10, "height": 9}, {"range": 10}]})", "and a height"},
        {"beyond the pole", R"({"keys": [{"at": [1, 1], "range": 10}, {"at": [91, 0]}]})", "key 2 'at': latitude 91"},
        {"a long place", R"({"keys": [{"at": [1, 1, 1], "range": 10}, {"at": [1, 0]}]})", "key 1 'at'"},
        {"a wrong kind", R"({"keys": [{"at": [1, 1], "range": true}, {"at": [1, 0]}]})", "is not a distance"},
        {"a range below the ground", R"({"keys": [{"at": [1, 1], "range": -5}, {"at": [1, 0]}]})", "out of range"},
        {"a pitch beyond", R"({"keys": [{"at": [1, 1], "range": 5, "pitch": -100}, {"at": [1, 0]}]})", "'pitch'"},
        {"times going back", R"({"keys": [{"at": [1, 1], "range": 5, "seconds": 3}, {"at": [1, 2], "seconds": 2}]})",
         "seconds that grow"},
        {"the same time twice", R"({"keys": [{"at": [1, 1], "range": 5}, {"at": [1, 2], "seconds": 0}]})",
         "seconds that grow"},
        {"a wrong day", R"({"keys": [{"at": [1, 1], "range": 5, "time": "2026-02-30"}, {"at": [1, 2]}]})", "'time'"},
        {"two lines", R"({"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]], [[2, 2], [3, 3]]]})",
         "holds 2 lines"},
        {"no line", R"({"type": "Point", "coordinates": [0, 0]})", "holds 0 lines"},
        {"a line of no length", R"({"type": "LineString", "coordinates": [[0, 0], [0, 1e-7]]})", "shorter than 1 m"},
    };
    const ScratchFolder folder;
    for (const BadPath& each : paths) {
        write(folder / "bad.json", each.text);
        const Outcome outcome = run(folder.path(), words("fly bad.json -o frames"));
        SCOPED_TRACE(each.name);
        expect_one_line(outcome, 3, each.said);
        EXPECT_NE(outcome.err.find("bad.json"), std::string::npos) << outcome.err;
        EXPECT_EQ(folder.names(), std::vector<std::string>{"bad.json"});
    }
    std::string many = R"({"keys": [{"at": [1, 1], "range": 10})";
    for (int i = 0; i < 200'000; ++i) many += R"(, {"heading": 1})";
    write(folder / "bad.json", many + "]}");
    expect_one_line(run(folder.path(), words("fly bad.json")), 3, "holds 200001; accepted: 2 to 10000");
    expect_one_line(run(folder.path(), words("fly none.json")), 3, "none.json");
    expect_one_line(run(folder.path(), words("fly")), 2, "path");
}

}  // namespace
}  // namespace render
