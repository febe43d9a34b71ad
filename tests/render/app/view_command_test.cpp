// octaglobe view in an X server without a screen, with real keys, buttons and motions.

#include <fcntl.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "planet/elevation/image_io.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/horizon.h"
#include "render/app/values.h"
#include "render/viewer/camera.h"
#include "tests/render/app/picture_difference.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

using namespace std::chrono_literals;

void rest(std::chrono::milliseconds time) {
    std::this_thread::sleep_for(time);
}

/// Starts a program found on PATH; its output goes nowhere but to the descriptor that stays open.
pid_t start(const std::vector<std::string>& command, int kept = -1) {
    const pid_t id = ::fork();
    if (id != 0) return id;
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
    if (kept >= 0) ::fcntl(kept, F_SETFD, 0);
    std::vector<char*> argv;
    for (const auto& word : command) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
}

int run_quietly(const std::vector<std::string>& command) {
    int status = 0;
    ::waitpid(start(command), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// An X server of its own on a display that is free.
class Screen {
  public:
    Screen() {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) return;
        server_ = start({"Xvfb", "-displayfd", std::to_string(ends[1]), "-screen", "0", "1400x900x24", "-nolisten",
                         "tcp", "-noreset"},
                        ends[1]);
        ::close(ends[1]);
        char c = 0;
        while (::read(ends[0], &c, 1) == 1 && c != '\n') name_ += c;
        ::close(ends[0]);
        if (!name_.empty()) name_ = ":" + name_;
    }
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;
    ~Screen() { end(); }

    /// Kills it, as a crash or the end of a session does.
    void end() {
        if (server_ <= 0) return;
        ::kill(server_, SIGKILL);
        ::waitpid(std::exchange(server_, 0), nullptr, 0);
    }
    const std::string& name() const { return name_; }
    explicit operator bool() const { return !name_.empty(); }

  private:
    pid_t server_ = 0;
    std::string name_;
};

/// The baked Earth that all tests share.
std::filesystem::path default_store() {
    const char* cache = ::getenv("XDG_CACHE_HOME");
    if (cache != nullptr)
        for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(cache) / "octaglobe"))
            if (entry.path().extension() == ".octa") return entry.path();
    throw std::runtime_error("no baked Earth");
}

bool has_program(const std::string& name) {
    return run_quietly({"sh", "-c", "command -v " + name}) == 0;
}

std::string last_line(std::string text) {
    if (!text.empty() && text.back() == '\n') text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

class ViewCommand : public testing::Test {
  protected:
    void SetUp() override {
        if (!has_program("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
        if (!has_program("xdotool")) GTEST_SKIP() << "xdotool is not installed";
        screen_.emplace();
        ASSERT_TRUE(*screen_) << "Xvfb does not start";
        display_.emplace("DISPLAY", screen_->name().c_str());
    }

    Process view(const std::string& arguments) { return Process(folder_.path(), words("view " + arguments)); }
    nlohmann::json report(const std::string& arguments) {
        const Outcome outcome = run(folder_.path(), words("view " + arguments + " --json report.json"));
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return nlohmann::json::parse(content(folder_ / "report.json"), nullptr, false);
    }
    static void type(const std::vector<std::string>& command) {
        std::vector<std::string> all{"xdotool"};
        all.insert(all.end(), command.begin(), command.end());
        EXPECT_EQ(run_quietly(all), 0) << command.front();
    }
    void wait_for_window() {
        for (int i = 0; i < 300; ++i, rest(100ms))
            if (run_quietly({"xdotool", "search", "--onlyvisible", "--name", "^Octaglobe$"}) == 0) return;
        FAIL() << "no window";
    }
    /// While it loads, keys do nothing: there is a globe once C gives a line.
    std::string wait_for_globe(const Process& process) {
        wait_for_window();
        for (int i = 0; i < 100 && process.out_so_far().empty(); ++i, rest(200ms)) type({"key", "c"});
        return copy_view(process);
    }
    /// The line of a view that rests.
    std::string copy_view(const Process& process) {
        rest(800ms);
        return copy_now(process);
    }
    std::string copy_now(const Process& process) {
        const std::size_t before = process.out_so_far().size();
        type({"key", "c"});
        for (int i = 0; i < 400 && process.out_so_far().size() == before; ++i) rest(50ms);
        return last_line(process.out_so_far());
    }
    /// Types, and returns once the window has taken it and drawn two frames since, however slow the machine: each line comes from a
    /// frame of its own. A panel is there in the second frame after its key.
    void type_and_see(const Process& process, const std::vector<std::string>& command) {
        type(command);
        for (int i = 0; i < 2; ++i) copy_now(process);
    }
    void click(const Process& process, const glm::ivec2& at) {
        type_and_see(process, {"mousemove", std::to_string(at.x), std::to_string(at.y)});
        type_and_see(process, {"mousedown", "1"});
        type_and_see(process, {"mouseup", "1"});
    }

    ScratchFolder folder_;
    std::optional<Screen> screen_;
    std::optional<ScratchVariable> display_;
};

/// The value behind an option in a command line.
std::string value_of(const std::string& line, const std::string& option) {
    const std::vector<std::string> all = words(line);
    const auto found = std::find(all.begin(), all.end(), option);
    return found == all.end() || found + 1 == all.end() ? "" : found[1];
}

/// The pose that a copied line says, over ground at h = 0.
Pose pose_of_line(const std::string& line) {
    const planet::Geodetic at = parse_place("--at", value_of(line, "--at"));
    const std::string heading = value_of(line, "--heading");
    return {planet::normal_from_geodetic(at.latitude, at.longitude),
            parse_distance("--height", value_of(line, "--height"), {0, 1e9}),
            heading.empty() ? 0 : parse_angle("--heading", heading, {0, 360}),
            parse_angle("--pitch", value_of(line, "--pitch"), {-90, 90})};
}

constexpr const char* track =
    R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"Ridge"},"geometry":)"
    R"({"type":"LineString","coordinates":[[-105.52,37.55],[-105.49,37.58],[-105.45,37.6]]}},{"type":"Feature",)"
    R"("properties":{"name":"Area"},"geometry":{"type":"Polygon","coordinates":[[[-105.5,37.56],[-105.46,37.56],)"
    R"([-105.47,37.59],[-105.5,37.56]]]}}]})";

class SettledView : public ViewCommand, public testing::WithParamInterface<const char*> {};

// The view as a command line gives the picture that the window shows.
TEST_P(SettledView, IsThePictureOfItsCommandLine) {
    std::ofstream(folder_ / "track.geojson") << track;
    const auto view = report(std::string(GetParam()) + " --bare --size 240x136 --screenshot window.png");
    ASSERT_TRUE(view.contains("view"));
    EXPECT_TRUE(view["settled"].get<bool>());
    EXPECT_EQ(view["gl_errors"], 0);
    std::vector<std::string> arguments = words(view["view"].get<std::string>() + " -o picture.png");
    arguments.erase(arguments.begin());
    const Outcome outcome = run(folder_.path(), arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const PictureDifference d =
        compare(planet::read_image(folder_ / "window.png"), planet::read_image(folder_ / "picture.png"), 3);
    EXPECT_GT(d.pixels, 0u);
    EXPECT_LE(d.share(), 0.0005) << view["view"] << ", the worst by " << d.worst;
}

INSTANTIATE_TEST_SUITE_P(
    Views, SettledView,
    testing::Values(
        "", "--at 37.58,-105.49 --range 20km --heading 30 --pitch -15 --show graticule",
        "--at 89.5,20 --range 900km --pitch -50 --exaggeration 3 --show mesh,levels --max-pixel-deviation 3",
        "--at 37.58,-105.49 --range 60km --pitch -40 --max-triangles 9000",
        "--at 37.58,-105.49 --range 12km --heading 30 --pitch -20 --show coastlines,relief "
        "--layer track.geojson,width=3,opacity=0.8,label=name"));

/// Where the only layer's row is in the panel, pixels of the window.
constexpr glm::ivec2 layer_row_box{43, 377}, layer_row_slider{190, 377};

// The panel's box of the only layer: off, it is no longer in the line; on, it is; its slider changes the opacity.
TEST_F(ViewCommand, ThePanelSwitchesLayers) {
    std::ofstream(folder_ / "track.geojson") << track;
    Process process = view("--at 37.58,-105.49 --range 40km --size 640x560 --layer track.geojson");
    EXPECT_EQ(value_of(wait_for_globe(process), "--layer"), "track.geojson,color=#ffcc00");
    type_and_see(process, {"key", "Tab"});
    click(process, layer_row_box);
    EXPECT_EQ(value_of(copy_now(process), "--layer"), "");
    click(process, layer_row_box);
    EXPECT_EQ(value_of(copy_now(process), "--layer"), "track.geojson,color=#ffcc00");
    click(process, layer_row_slider);
    EXPECT_NE(value_of(copy_now(process), "--layer").find(",opacity=0."), std::string::npos);
    type({"key", "o"});
    type({"key", "i"});
    EXPECT_EQ(value_of(copy_view(process), "--show"), "coastlines,relief");
    type({"key", "ctrl+q"});
    EXPECT_EQ(process.wait().status, 0);
}

// 1,000 frames that each turn the view: no OpenGL error, and no memory but what caches may take.
TEST_F(ViewCommand, AThousandFramesLeakNothing) {
    const auto view = report("--at 37.58,-105.49 --range 900km --pitch -50 --size 320x240 --frames 1000 --turn 0.36");
    EXPECT_EQ(view["frames"], 1000);
    EXPECT_EQ(view["gl_errors"], 0) << view["first_gl_error"];
    const double early = view["memory_early_bytes"], late = view["memory_late_bytes"];
    EXPECT_GT(early, 1e7);
    EXPECT_LT(late - early, 64e6) << early << " after 100 frames, " << late << " after 1,000";
}

/// How far what a pixel showed of the sea is from another one now.
double pixels_off(const std::string& line_before, const glm::dvec2& was, const std::string& line_after,
                  const glm::dvec2& is) {
    const Lens lens{focal_length_px(40 * planet::degrees, 640, 480), 640, 480};
    const Pose before = pose_of_line(line_before), after = pose_of_line(line_after);
    const glm::dvec3 way = ray(before, lens, was);
    const glm::dvec3 point = before.eye() + *planet::distance_to_ellipsoid(planet::wgs84, before.eye(), way) * way;
    const auto at = pixel_of_point(after, lens, point);
    return at ? glm::distance(*at, is) : 1e9;
}

// Over the sea, where the ground is the geoid: what was under the button when it went down is under it at the end.
TEST_F(ViewCommand, ADragHoldsTheGround) {
    Process process = view("--at 0,-30 --range 600km --size 640x480");
    const std::string before = wait_for_globe(process);
    type({"mousemove", "200", "150"});
    rest(200ms);
    type({"mousedown", "1"});
    for (int i = 1; i <= 10; ++i) {
        rest(40ms);
        type({"mousemove", std::to_string(200 + 20 * i), std::to_string(150 + 14 * i)});
    }
    copy_view(process);  // a hand that rests throws nothing: so long until the viewer has seen it rest
    type({"mouseup", "1"});
    const std::string after = copy_view(process);
    EXPECT_NE(before, after);
    EXPECT_LT(pixels_off(before, {200, 150}, after, {400, 290}), 1) << before << '\n' << after;
    type({"key", "ctrl+q"});
    EXPECT_EQ(process.wait().status, 0);
}

TEST_F(ViewCommand, TheWheelZoomsToTheCursor) {
    Process process = view("--at 0,-30 --range 600km --size 640x480");
    const std::string before = wait_for_globe(process);
    type({"mousemove", "450", "130"});
    for (int i = 0; i < 4; ++i) {
        rest(100ms);
        type({"click", "4"});
    }
    rest(500ms);
    const std::string after = copy_view(process);
    EXPECT_LT(pose_of_line(after).h, 0.6 * pose_of_line(before).h);
    EXPECT_LT(pixels_off(before, {450, 130}, after, {450, 130}), 1) << before << '\n' << after;
    type({"key", "ctrl+q"});
    EXPECT_EQ(process.wait().status, 0);
}

TEST_F(ViewCommand, PanelsAndKeysDoNotDisturbIt) {
    Process process = view("--size 800x600");
    wait_for_globe(process);
    for (const char* key :
         {"h", "F3",           "Tab", "u",       "r", "l", "w",    "s",      "v",   "k",   "f",  "f",    "b",
          "b", "bracketright", "e",   "shift+e", "n", "d", "Home", "Escape", "F11", "F11", "Up", "plus", "g"}) {
        type({"key", key});
        rest(60ms);
    }
    type({"type", "37.58, -105.49"});
    type({"key", "Return"});
    rest(300ms);
    EXPECT_TRUE(copy_view(process).starts_with("octaglobe render --at "));
    type({"key", "ctrl+q"});
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
}

// What is open stays open: the file is gone, and the window goes on.
TEST_F(ViewCommand, AStoreThatIsRemovedWhileOpen) {
    std::filesystem::copy_file(default_store(), folder_ / "earth.octa");
    Process process = view("--store earth.octa --at 46,8 --range 3000km --size 400x300");
    wait_for_globe(process);
    std::filesystem::remove(folder_ / "earth.octa");
    type({"key", "Home"});
    rest(300ms);
    for (int i = 0; i < 6; ++i) type({"click", "4"});
    EXPECT_TRUE(copy_view(process).starts_with("octaglobe render --at "));
    type({"key", "ctrl+q"});
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(ViewCommand, ADisplayThatGoesAwayIsOneLine) {
    Process process = view("--size 400x300");
    wait_for_window();
    rest(800ms);
    screen_->end();
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.err, "octaglobe: window: the display has gone away\n");
}

TEST_F(ViewCommand, ClosedWhileItLoadsItLeavesNothingHalfDone) {
    const ScratchFolder cache;
    const ScratchVariable variable("XDG_CACHE_HOME", cache.path().c_str());
    Process process = view("--size 400x300");  // bakes the Earth: tens of seconds
    wait_for_window();
    rest(700ms);
    type({"key", "ctrl+q"});
    const auto pressed = std::chrono::steady_clock::now();
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_LT(std::chrono::steady_clock::now() - pressed, 15s);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache.path()))
        EXPECT_EQ(entry.path().native().find(".octa"), std::string::npos) << entry.path();
}

TEST_F(ViewCommand, WithoutAFontItStillReads) {
    const ScratchVariable font("OCTAGLOBE_FONT", "/dev/null");
    EXPECT_EQ(report("--size 400x300 --frames 3")["gl_errors"], 0);
}

TEST_F(ViewCommand, AScreenshotThatCannotBeWrittenIsRefusedFirst) {
    const Outcome outcome = run(folder_.path(), words("view --screenshot nowhere/x.png"));
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("nowhere"), std::string::npos) << outcome.err;
}

TEST(ViewCommandAlone, WithoutADisplayItSaysSo) {
    const ScratchFolder folder;
    const ScratchVariable display("DISPLAY", ""), wayland("WAYLAND_DISPLAY", "");
    const Outcome outcome = run(folder.path(), words("view"));
    EXPECT_EQ(outcome.status, 4);
    EXPECT_TRUE(outcome.err.starts_with("octaglobe: window: ")) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

// The program alone, as where GLFW is missing: everything else works, and view says what it lacks.
TEST(ViewCommandAlone, WithoutTheModuleItSaysSo) {
    const ScratchFolder folder;
    const std::filesystem::path program = folder / "octaglobe";
    std::filesystem::copy_file(OCTAGLOBE_PROGRAM, program);
    const std::string shell = "OCTAGLOBE_MODULES= " + program.native() + " view 2> " + (folder / "err").native();
    EXPECT_EQ(run_quietly({"sh", "-c", shell}), 4);
    EXPECT_NE(content(folder / "err").find("octaglobe_window"), std::string::npos) << content(folder / "err");
}

TEST(ViewCommandAlone, AStoreThatIsNoneIsRefusedBeforeAWindowOpens) {
    const ScratchFolder folder;
    const ScratchVariable display("DISPLAY", ""), wayland("WAYLAND_DISPLAY", "");  // a window would be another fault
    std::ofstream(folder / "bad.octa") << "no store";
    std::ofstream(folder / "empty.octa") << "";
    for (const char* name : {"bad.octa", "empty.octa", "missing.octa"}) {
        const Outcome outcome = run(folder.path(), words(std::string("view --store ") + name));
        EXPECT_EQ(outcome.status, 3) << outcome.err;
        EXPECT_NE(outcome.err.find(name), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
}

/// Libraries that the loader finds first, and that are none.
void hide_libraries(const ScratchFolder& folder, const std::vector<std::string>& names) {
    for (const std::string& name : names) std::ofstream(folder.path() / name) << "";
}

TEST_F(ViewCommand, WithEglAloneItOpensPanelsAndAll) {
    const ScratchFolder hidden;
    hide_libraries(hidden, {"libGLX.so.0", "libGL.so.1", "libGL.so"});
    const ScratchVariable path("LD_LIBRARY_PATH", hidden.path().c_str());
    const auto view = report("--size 400x300 --frames 3");
    EXPECT_EQ(view["context"], "EGL");
    EXPECT_EQ(view["gl_errors"], 0);
}

// OSMesa, which has no windows, may be there.
TEST_F(ViewCommand, WithNeitherGlxNorEglItSaysSo) {
    const ScratchFolder hidden;
    hide_libraries(hidden, {"libGLX.so.0", "libGL.so.1", "libGL.so", "libEGL.so.1"});
    const ScratchVariable path("LD_LIBRARY_PATH", hidden.path().c_str());
    const Outcome outcome = run(folder_.path(), words("view --size 400x300 --frames 3"));
    EXPECT_EQ(outcome.status, 4);
    for (const char* part : {"octaglobe: window: ", "GLX", "EGL", "octaglobe render"})
        EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

/// For windows that open from now on. @param dots an inch, 96: as usual
int set_density(int dots) {
    return run_quietly({"xprop", "-root", "-f", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER",
                        "Xft.dpi: " + std::to_string(dots)});
}

// Twice the density: the line of status is 64 pixels high and not 32.
TEST_F(ViewCommand, PanelsFollowTheDensityOfTheDisplay) {
    if (!has_program("xprop")) GTEST_SKIP() << "xprop is not installed";
    const auto darkened = [&](int above_bottom) {
        report("--size 400x300 --screenshot panels.png");
        report("--size 400x300 --screenshot bare.png --bare");
        const planet::Image panels = planet::read_image(folder_ / "panels.png"),
                            bare = planet::read_image(folder_ / "bare.png");
        return panels.pixel(200, 300 - above_bottom)[2] < bare.pixel(200, 300 - above_bottom)[2];
    };
    EXPECT_TRUE(darkened(24));
    EXPECT_FALSE(darkened(48));
    ASSERT_EQ(set_density(192), 0);
    EXPECT_TRUE(darkened(48));
}

// Lines and letters too, and the command line says by how much.
TEST_F(ViewCommand, LinesAndLettersFollowTheDensityOfTheDisplay) {
    if (!has_program("xprop")) GTEST_SKIP() << "xprop is not installed";
    std::ofstream(folder_ / "line.geojson") << R"({"type":"LineString","coordinates":[[-40,0.3],[-20,0.3]]})";
    const std::string view =
        "--at 0.3,-30 --range 90km --show graticule --size 400x300 --bare --layer line.geojson,color=#ff0000,width=4";
    const auto red_rows = [&](const std::string& more, const std::string& scale) {
        const auto seen = report(view + more + " --screenshot window.png");
        const std::string line = seen["view"];
        EXPECT_EQ(value_of(line, "--scale"), scale);
        std::vector<std::string> arguments = words(line + " -o picture.png");
        arguments.erase(arguments.begin());
        EXPECT_EQ(run(folder_.path(), arguments).status, 0) << line;
        const planet::Image window = planet::read_image(folder_ / "window.png");
        EXPECT_LE(compare(window, planet::read_image(folder_ / "picture.png"), 3).share(), 0.0005) << line;
        int red = 0;
        for (int y = 0; y < window.height; ++y) red += window.pixel(90, y)[0] > 200 && window.pixel(90, y)[1] < 60;
        return red;
    };
    EXPECT_NEAR(red_rows("", ""), 4, 1);
    ASSERT_EQ(set_density(144), 0);
    EXPECT_NEAR(red_rows("", "1.5"), 6, 1);
    EXPECT_NEAR(red_rows(" --scale 3", "3"), 12, 1);
    EXPECT_NEAR(red_rows(" --scale 1", ""), 4, 1);
}

// In the middle of the window, above the line of status, where it stays for some seconds.
TEST_F(ViewCommand, APictureThatCannotBeReadIsANotice) {
    planet::write_image(folder_ / "photo.png", {8, 8, 3, std::vector<std::uint8_t>(8 * 8 * 3, 90)});
    ASSERT_EQ(run(folder_.path(), {"tin", OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif", "--max-deviation", "500",
                                   "--drape", "photo.png", "-o", "t.glb"})
                  .status,
              0);
    std::string bytes = content(folder_ / "t.glb");
    bytes.replace(bytes.rfind("\x89PNG"), 4, "none");
    std::ofstream(folder_ / "t.glb", std::ios::binary) << bytes;
    const std::string view = "view --at 10,10 --range 9000km --size 640x360 --layer t.glb --screenshot ";
    const Outcome outcome = run(folder_.path(), words(view + "told.png"));
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.err.rfind("octaglobe: warning: t.glb: is no picture", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    ASSERT_EQ(run(folder_.path(), words(view + "silent.png --bare")).status, 0);
    const planet::Image told = planet::read_image(folder_ / "told.png"),
                        silent = planet::read_image(folder_ / "silent.png");
    int different = 0;
    for (int x = 220; x < 420; ++x) different += std::abs(told.pixel(x, 264)[2] - silent.pixel(x, 264)[2]) > 20;
    EXPECT_GT(different, 100);
}

/// 6000 m above the geoid over Blanca Peak.
constexpr const char* plate =
    "ply\nformat ascii 1.0\ncomment frame source\ncomment crs EPSG:4326\ncomment vertical_datum egm96\n"
    "comment xy_unit degrees\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "-105.52 37.55 6000\n-105.46 37.55 6000\n-105.46 37.61 6000\n-105.52 37.61 6000\n3 0 1 2\n3 0 2 3\n";

// Four notches bring the eye to exp(-0.96) of its distance from what is under the cursor: the plate, not the ground.
TEST_F(ViewCommand, AMeshUnderTheCursorIsWhatAHandTakesHoldOf) {
    std::ofstream(folder_ / "plate.ply") << plate;
    Process process = view("--at 37.58,-105.49 --range 10km --size 401x301 --layer plate.ply");
    const auto height = [](const std::string& line) {
        return parse_distance("--height", value_of(line, "--height"), {0, 1e9});
    };
    const double before = height(wait_for_globe(process));
    type_and_see(process, {"mousemove", "200", "150"});
    for (int i = 0; i < 4; ++i) type({"click", "4"});
    rest(1s);
    const double after = height(copy_view(process));
    constexpr double ground_m = 4195, plate_m = 5983;  // above the ellipsoid
    EXPECT_NEAR(after, before - (1 - std::exp(-0.96)) * (before + ground_m - plate_m), 50);
    type({"key", "ctrl+q"});
    EXPECT_EQ(process.wait().status, 0);
}

}  // namespace
}  // namespace render
