// What the program writes: whole files or none, reports, remembered checksums.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "planet/error.h"
#include "render/app/arguments.h"
#include "render/app/checksum.h"
#include "render/app/data_path.h"
#include "render/app/output_file.h"
#include "render/app/report.h"
#include "tests/render/app/scratch_folder.h"

namespace render {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsOnlyWhenCommitted) {
    const ScratchFolder folder;
    const fs::path target = folder / "report.json";
    {
        const OutputFile abandoned("--json", target);
        EXPECT_FALSE(fs::exists(target));
    }
    EXPECT_TRUE(folder.names().empty());
    OutputFile file("--json", target);
    file.commit("whole");
    EXPECT_EQ(content(target), "whole");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"report.json"});
}

TEST(OutputFile, TakesItsBytesInPieces) {
    const ScratchFolder folder;
    OutputFile file("--output", folder / "x");
    file.append("one, ");
    file.append("");
    file.append("two");
    EXPECT_FALSE(fs::exists(folder / "x"));
    file.commit();
    EXPECT_EQ(content(folder / "x"), "one, two");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"x"});
}

TEST(OutputFile, OldContentStaysUntilTheNewIsWhole) {
    const ScratchFolder folder;
    std::ofstream(folder / "old") << "old";
    {
        const OutputFile abandoned("--json", folder / "old");
        EXPECT_EQ(content(folder / "old"), "old");
    }
    EXPECT_EQ(content(folder / "old"), "old");
}

TEST(OutputFile, FollowsLinksAndLeavesThem) {
    const ScratchFolder folder;
    fs::create_directory(folder / "real");
    std::ofstream(folder / "real/file") << "old";
    fs::create_symlink("real/file", folder / "link");
    OutputFile("--json", folder / "link").commit("new");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(content(folder / "real/file"), "new");
}

TEST(OutputFile, WritesADeviceInPlace) {
    EXPECT_NO_THROW(OutputFile("--json", "/dev/null").commit("gone"));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    EXPECT_THROW(OutputFile("--json", "/dev/full").commit("too much"), planet::Error);
}

TEST(OutputFile, RefusesWhatCannotBeWritten) {
    const ScratchFolder folder;
    for (const fs::path& target : {folder / "no/such/folder/x", folder.path(), fs::path()}) try {
            OutputFile("--json", target).commit("x");
            ADD_FAILURE() << target;
        } catch (const planet::Error& error) {
            EXPECT_EQ(error.fault(), planet::Fault::bad_usage);
            EXPECT_TRUE(std::string(error.what()).starts_with("--json: ")) << error.what();
        }
    EXPECT_TRUE(folder.names().empty());
}

TEST(OutputFile, HasTheRightsOfTheUmask) {
    const ScratchFolder folder;
    const mode_t before = ::umask(027);
    OutputFile("--json", folder / "x").commit("");
    ::umask(before);
    EXPECT_EQ(fs::status(folder / "x").permissions(), fs::perms{0640});
}

TEST(Report, IsFlatJsonWithTheStandingKeys) {
    const ScratchFolder folder;
    Report report("test", folder / "report.json");
    report.set("triangles", 12);
    report.set("deviation_max_m", std::nan(""));
    report.set("name", "bad utf8 \xff");
    { const auto step = report.step("draw"); }
    report.add_seconds("draw", 2);
    report.write();
    const auto json = nlohmann::json::parse(content(folder / "report.json"));
    EXPECT_EQ(json.at("command"), "test");
    EXPECT_EQ(json.at("triangles"), 12);
    EXPECT_TRUE(json.at("deviation_max_m").is_null());
    EXPECT_FALSE(json.at("version").get<std::string>().empty());
    EXPECT_GE(json.at("seconds").at("draw").get<double>(), 2);
    EXPECT_GE(json.at("seconds_total").get<double>(), 0);
    EXPECT_GT(json.at("peak_memory_bytes").get<double>(), 1e6);
}

TEST(Report, UnwritablePathIsRefusedBeforeTheWork) {
    EXPECT_THROW(Report("test", "/no/such/folder/report.json"), planet::Error);
}

TEST(Arguments, NegativeFractionsAreValues) {
    EXPECT_EQ(with_negative_values({"-.5,180", "-16.5,1", "-o", "-.", "--at", "x-.5"}),
              (std::vector<std::string>{"-0.5,180", "-16.5,1", "-o", "-.", "--at", "x-.5"}));
}

// Two seconds must pass before a file is believed not to change within one tick of the clock.
void let_settle() {
    std::this_thread::sleep_for(std::chrono::milliseconds(2100));
}

TEST(ChecksumIndex, RemembersUntilTheFileChanges) {
    const ScratchFolder folder;
    std::ofstream(folder / "a") << "abc";
    const std::string abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";  // FIPS 180-4, B.1
    {
        ChecksumIndex fresh(folder / "index");
        EXPECT_EQ(fresh.sha256(folder / "a"), abc);
        fresh.save();  // too new to be believed: nothing is kept
        EXPECT_FALSE(fs::exists(folder / "index"));
    }
    let_settle();
    {
        ChecksumIndex index(folder / "index");
        EXPECT_EQ(index.sha256(folder / "a"), abc);
        EXPECT_EQ(index.computed(), 1);
        index.save();
    }
    ChecksumIndex known(folder / "index");
    EXPECT_EQ(known.sha256(folder / "a"), abc);
    EXPECT_EQ(known.computed(), 0);

    // The same size, and the old time of modification put back: the time of change tells.
    const auto time = fs::last_write_time(folder / "a");
    std::ofstream(folder / "a") << "xyz";
    fs::last_write_time(folder / "a", time);
    EXPECT_NE(known.sha256(folder / "a"), abc);
    EXPECT_EQ(known.computed(), 1);
}

TEST(ChecksumIndex, DamagedIndexIsEmpty) {
    const ScratchFolder folder;
    std::ofstream(folder / "a") << "abc";
    std::ofstream(folder / "index") << "rubbish\n\n" << std::string(64, 'a') << "\n" << std::string(5000, '\0');
    ChecksumIndex index(folder / "index");
    EXPECT_EQ(index.sha256(folder / "a").substr(0, 8), "ba7816bf");
    EXPECT_THROW(index.sha256(folder / "missing"), planet::Error);
    EXPECT_THROW(index.sha256(folder.path()), planet::Error);
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_THROW(index.sha256(folder / "pipe"), planet::Error) << "and does not wait for a writer";
}

TEST(DataPath, TheVariableIsTheOnlyPlace) {
    const ScratchFolder folder;
    const ScratchVariable data("OCTAGLOBE_DATA", folder.path().c_str());
    EXPECT_EQ(data_folder(), folder.path());
    std::ofstream(folder / "x.tif") << "x";
    EXPECT_EQ(data_file("x.tif"), folder / "x.tif");
    try {
        data_file("missing.tif");
        ADD_FAILURE();
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), planet::Fault::bad_data);
        EXPECT_NE(std::string(error.what()).find(folder.path().native()), std::string::npos);
    }
}

TEST(CacheFolder, FollowsTheEnvironment) {
    const ScratchFolder folder;
    const ScratchVariable home("HOME", (folder / "home").c_str());
    {
        const ScratchVariable xdg("XDG_CACHE_HOME", (folder / "xdg").c_str());
        EXPECT_EQ(cache_folder(), folder / "xdg/octaglobe");
        EXPECT_TRUE(fs::is_directory(folder / "xdg/octaglobe"));
    }
    const ScratchVariable relative("XDG_CACHE_HOME", "relative");  // to be ignored, says the XDG specification
    EXPECT_EQ(cache_folder(), folder / "home/.cache/octaglobe");
    const ScratchVariable no_home("HOME", "/dev/null");
    EXPECT_EQ(cache_folder(), std::nullopt);
}

}  // namespace
}  // namespace render
