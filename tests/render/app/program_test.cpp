// The program as a user meets it: exit status, one line on standard error, no file left behind.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tests/render/app/program_process.h"

namespace render {
namespace {

namespace fs = std::filesystem;

struct BadCall {
    const char* arguments;  ///< separated by blanks; '' is an empty one
    int status;
    const char* line;  ///< what the one line on standard error begins with
};

void PrintTo(const BadCall& call, std::ostream* out) {
    *out << call.arguments;
}

class BadCalls : public testing::TestWithParam<BadCall> {};

TEST_P(BadCalls, OneLineAndNoFile) {
    const ScratchFolder folder;
    std::ofstream(folder / "empty.tif").flush();
    std::ofstream(folder / "text.tif") << "this is no picture\n";
    const auto before = folder.names();
    const Outcome outcome = run(folder.path(), words(GetParam().arguments));
    EXPECT_EQ(outcome.status, GetParam().status);
    EXPECT_TRUE(outcome.err.starts_with(GetParam().line)) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("; accepted: "), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(folder.names(), before);
}

constexpr BadCall bad_calls[] = {
    {"", 2, "octaglobe: command: none given"},
    {"rendr", 2, "octaglobe: command: 'rendr' is unknown"},
    {"--frobnicate", 2, "octaglobe: command: '--frobnicate' is no option"},
    {"render --frobnicate", 2, "octaglobe: render: '--frobnicate' is no option"},
    {"render picture.png", 2, "octaglobe: render: 'picture.png' is too much"},
    {"render --at 91,0 -o x.png", 2, "octaglobe: --at: latitude 91 is out of range"},
    {"render --at 0,-181", 2, "octaglobe: --at: longitude -181 is out of range"},
    {"render --at nan,nan", 2, "octaglobe: --at: 'nan,nan' is not a place"},
    {"render --at -inf,0", 2, "octaglobe: --at: '-inf,0' is not a place"},
    {"render --at ''", 2, "octaglobe: --at: '' is not a place"},
    {"render --at 1,2x", 2, "octaglobe: --at: '1,2x' is not a place"},
    {"render --at 1,2 --at 3,4", 2, "octaglobe: render: --at"},
    {"render --at", 2, "octaglobe: render: --at"},
    {"render --range 0", 2, "octaglobe: --range: '0' is out of range"},
    {"render --range -5km", 2, "octaglobe: --range: '-5km' is out of range"},
    {"render --range 5parsec", 2, "octaglobe: --range: '5parsec' is not a distance"},
    {"render --range 1km --height 1km", 2, "octaglobe: render: "},
    {"render --height inf", 2, "octaglobe: --height: 'inf' is not a distance"},
    {"render --heading 361", 2, "octaglobe: --heading: '361' is out of range"},
    {"render --pitch -91", 2, "octaglobe: --pitch: '-91' is out of range"},
    {"render --fov 0", 2, "octaglobe: --fov: '0' is out of range"},
    {"render --size 0x0", 2, "octaglobe: --size: '0x0' is out of range"},
    {"render --size 70000x70000", 2, "octaglobe: --size: '70000x70000' is out of range"},
    {"render --size 1920", 2, "octaglobe: --size: '1920' is not a size"},
    {"render --time tomorrow", 2, "octaglobe: --time"},
    {"render --time 2026-02-30", 2, "octaglobe: --time"},
    {"render --exaggeration nan", 2, "octaglobe: --exaggeration: 'nan' is not a number"},
    {"render --exaggeration -1", 2, "octaglobe: --exaggeration: '-1' is out of range"},
    {"render --max-pixel-deviation 0", 2, "octaglobe: --max-pixel-deviation: '0' is out of range"},
    {"render --show mesh,nets", 2, "octaglobe: --show: 'nets' is unknown"},
    {"render --show mesh,mesh", 2, "octaglobe: --show: 'mesh' is given twice"},
    {"render --backend vulkan", 2, "octaglobe: --backend: 'vulkan' is unknown"},
    {"render --samples 3", 2, "octaglobe: --samples: '3' is unknown"},
    {"render --threads 1000", 2, "octaglobe: --threads: '1000' is out of range"},
    {"render --elevation-datum egm96", 2, "octaglobe: render: --elevation-datum"},
    {"render --elevation empty.tif --elevation-datum msl", 2, "octaglobe: --elevation-datum: 'msl' is unknown"},
    {"render --store a --elevation b", 2, "octaglobe: render: "},
    {"render -o picture.bmp", 2, "octaglobe: --output: 'picture.bmp' has no ending of a picture"},
    {"render -o no/such/folder/x.png", 2, "octaglobe: --output: "},
    {"render -o ''", 2, "octaglobe: --output: "},
    {"render --json no/such/folder/x.json", 2, "octaglobe: --json: "},
    {"query", 2, "octaglobe: query: none given"},
    {"query depth 1,2", 2, "octaglobe: query: 'depth' is unknown"},
    {"query height", 2, "octaglobe: query height: place"},
    {"query height 91,0", 2, "octaglobe: place: latitude 91 is out of range"},
    {"query distance 1,2 3,4 5,6", 2, "octaglobe: query distance: '5,6' is too much"},
    {"query distance 1,2", 2, "octaglobe: query distance: to"},
    {"query distance 1,2 nan,3", 2, "octaglobe: to: 'nan,3' is not a place"},
    {"query height 1,2 --elevation missing.tif", 3, "octaglobe: missing.tif: "},
    {"query height 1,2 --elevation empty.tif", 3, "octaglobe: empty.tif: "},
    {"query height 1,2 --elevation text.tif", 3, "octaglobe: text.tif: "},
    {"info extra", 3, "octaglobe: extra: no such file"},
    {"check --json .", 2, "octaglobe: --json: "},
};

INSTANTIATE_TEST_SUITE_P(Table, BadCalls, testing::ValuesIn(bad_calls));

TEST(Program, EveryCommandHasHelpWithAnExample) {
    const ScratchFolder folder;
    for (const char* command : {"render", "query", "query height", "query profile", "query distance", "query area",
                                "query line-of-sight", "query viewshed", "check", "info"}) {
        const Outcome outcome = run(folder.path(), words(std::string(command) + " --help"));
        EXPECT_EQ(outcome.status, 0) << command;
        EXPECT_NE(outcome.out.find(std::string("Example:\n  octaglobe ") + command), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.err, "");
    }
    EXPECT_EQ(run(folder.path(), {"--help"}).status, 0);
    EXPECT_TRUE(run(folder.path(), {"--version"}).out.starts_with("octaglobe "));
}

TEST(Program, DistancePrintsMetresFirst) {
    const ScratchFolder folder;
    // A nearly antipodal pair: Karney, "Algorithms for geodesics", Journal of Geodesy 87 (2013), table 5.
    const Outcome outcome = run(folder.path(), words("query distance -30,0 29.9,179.8 --json d.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_NEAR(std::strtod(outcome.out.c_str(), nullptr), 19989832.827610, 2e-4);
    const auto json = nlohmann::json::parse(content(folder / "d.json"));
    EXPECT_NEAR(json.at("distance_m").get<double>(), 19989832.827610, 1e-6);
    EXPECT_NEAR(json.at("start_azimuth_deg").get<double>(), 161.890524736, 1e-8);
}

TEST(Program, HeightOfTheShippedEarth) {
    const ScratchFolder folder;
    const ScratchVariable data("OCTAGLOBE_DATA", OCTAGLOBE_SOURCE_DIR "/data");
    // Blanca Peak is 4372 m high; the surface through every other 3" sample is some tens of metres lower.
    const Outcome peak = run(folder.path(), words("query height 37.5767,-105.4858 --json h.json"));
    EXPECT_EQ(peak.status, 0) << peak.err;
    EXPECT_NEAR(std::strtod(peak.out.c_str(), nullptr), 4372, 100);
    const auto json = nlohmann::json::parse(content(folder / "h.json"));
    EXPECT_NEAR(json.at("height_m").get<double>(), 4372, 100);
    EXPECT_GT(json.at("height_bound_m").get<double>(), 10);
    EXPECT_EQ(json.at("ellipsoidal_height_m").get<double>(),
              json.at("height_m").get<double>() + json.at("geoid_undulation_m").get<double>());
    EXPECT_TRUE(run(folder.path(), words("query height -20.5,180")).out.starts_with("0.00 m"));
}

TEST(Program, NegativePlacesAreValues) {
    const ScratchFolder folder;
    for (const char* call : {"query distance -16.5,180 -16.5,-180", "query distance -.5,180 -.5,-180",
                             "query distance -- -16.5,-180 -16.5,180"}) {
        const Outcome outcome = run(folder.path(), words(call));
        EXPECT_EQ(outcome.status, 0) << call << outcome.err;
        EXPECT_TRUE(outcome.out.starts_with("0.0000 m")) << outcome.out;
    }
}

TEST(Program, InfoTellsOfEveryWayIntoOpenGl) {
    const ScratchFolder folder;
    const Outcome outcome = run(folder.path(), words("info --json info.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(content(folder / "info.json"));
    ASSERT_EQ(json.at("backends").size(), 3u);
    for (const auto& backend : json.at("backends"))
        EXPECT_NE(backend.at("available").get<bool>(), backend.at("gl_renderer").get<std::string>().empty()) << backend;
    EXPECT_NE(outcome.out.find("osmesa"), std::string::npos);
}

TEST(Program, FullStandardOutputIsAnError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const std::string call = OCTAGLOBE_PROGRAM " query distance 0,0 1,1 >/dev/full 2>/dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(call.c_str())), 2);
}

// The shipped data, by links, with one file more whose content a test may change.
class Certificate : public testing::Test {
  protected:
    Certificate() {
        const fs::path shipped = OCTAGLOBE_SOURCE_DIR "/data";
        for (const auto& entry : fs::directory_iterator(shipped))
            if (entry.path().filename() != "SHA256SUMS")
                fs::create_symlink(entry.path(), data_.path() / entry.path().filename());
        std::ofstream(data_ / "a.txt") << "abc";
        std::ofstream(data_ / "SHA256SUMS")
            << content(shipped / "SHA256SUMS")
            << "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  a.txt\n";
    }
    void check() {
        const ScratchVariable data("OCTAGLOBE_DATA", data_.path().c_str());
        const ScratchFolder folder;
        outcome_ = run(folder.path(), words("check --json check.json"));
        json_ = nlohmann::json::parse(content(folder / "check.json"));
        EXPECT_EQ(json_.at("checks"), json_.at("rows").size());
        EXPECT_EQ(json_.at("passed"), outcome_.status == 0);
    }
    /// How many rows have names that begin so.
    long rows(std::string_view beginning) const {
        const auto& rows = json_.at("rows");
        return std::count_if(rows.begin(), rows.end(), [&](const auto& row) {
            return row.at("name").template get<std::string>().starts_with(beginning);
        });
    }
    ScratchFolder data_;
    Outcome outcome_;
    nlohmann::json json_;
};

TEST_F(Certificate, HoldsOnIntactData) {
    check();
    EXPECT_EQ(outcome_.status, 0) << outcome_.out << outcome_.err;
    EXPECT_EQ(json_.at("passed"), true);
    for (const char* part : {"vertex position ", "grid ", "drawn ", "mesh ", "checksum of "})
        EXPECT_GT(rows(part), json_.at("skipped").empty() || std::string_view(part) != "drawn " ? 0 : -1) << part;
}

// One bad row is a failure. No OpenGL is none: what needs it is skipped, and says why; all else is measured.
TEST_F(Certificate, FailsOnOneChangedByteAndGoesOnWithoutOpenGl) {
    std::ofstream(data_ / "a.txt") << "abd";
    const ScratchVariable egl("OCTAGLOBE_EGL_LIBRARY", "/nonexistent/libEGL.so");
    const ScratchVariable osmesa("OCTAGLOBE_OSMESA_LIBRARY", "/nonexistent/libOSMesa.so");
    check();
    EXPECT_EQ(outcome_.status, 1);
    EXPECT_TRUE(outcome_.err.starts_with("octaglobe: check: 1 of ")) << outcome_.err;
    EXPECT_EQ(json_.at("failed"), 1);
    EXPECT_NE(outcome_.out.find("a.txt: not what was shipped"), std::string::npos) << outcome_.out;
    EXPECT_EQ(rows("drawn "), 0);
    EXPECT_GT(rows("mesh "), 0);
    ASSERT_EQ(json_.at("skipped").size(), 1u);
    EXPECT_NE(json_.at("skipped")[0].get<std::string>().find("/nonexistent/"), std::string::npos);
    EXPECT_NE(outcome_.out.find("skipped: drawn positions: "), std::string::npos);
}

TEST_F(Certificate, FailsWithoutData) {
    for (const auto& name : data_.names()) fs::remove(data_.path() / name);
    check();
    EXPECT_EQ(outcome_.status, 1);
    EXPECT_EQ(json_.at("failed"), 2);  // meshes and checksums
    EXPECT_EQ(json_.at("reasons").size(), 2u);
    EXPECT_GT(rows("grid "), 0);
}

}  // namespace
}  // namespace render
