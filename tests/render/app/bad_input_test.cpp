// Files that are not what they should be, through the whole program: one line that names the file, the right exit
// status, nothing left behind: no picture, no report, no temporary file, no half-baked Earth in the cache.
// Bad usage is in program_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "tests/planet/raster_files.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

namespace fs = std::filesystem;

const fs::path data = OCTAGLOBE_SOURCE_DIR "/data";

struct BadFile {
    const char* name;
    void (*write)(const fs::path& path);
};
void PrintTo(const BadFile& file, std::ostream* out) {
    *out << file.name;
}

void write_first_part(const fs::path& path, const fs::path& whole, double share) {
    const std::string bytes = content(whole);
    std::ofstream(path, std::ios::binary)
        << bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size())));
}

/// A GeoTIFF whose tag GDAL_NODATA (42113, ASCII) is "0" and whose samples are all 0.
std::string nodata_tiff() {
    // 16-bit samples in one strip a row; the tags are those of tiff_bytes() and one more, which sorts last.
    std::string bytes = planet::testing::tiff_bytes(40, 30, true, [](int, int) { return std::int16_t{0}; });
    const auto u16 = [&](std::size_t at) {
        return static_cast<unsigned>(static_cast<unsigned char>(bytes[at])) |
               static_cast<unsigned>(static_cast<unsigned char>(bytes[at + 1])) << 8;
    };
    const auto put32 = [](std::string& to, std::size_t v) {
        for (int i = 0; i < 4; ++i) to += static_cast<char>(v >> (8 * i) & 255);
    };
    // The directory goes to the end with a tag more: offsets of its values stay.
    const unsigned tags = u16(8);
    std::string directory;
    directory += static_cast<char>(tags + 1);
    directory += '\0';
    directory += bytes.substr(10, tags * 12);
    directory += std::string(
        "\x81\xa4\x02\x00\x02\x00\x00\x00"
        "0\0\0\0",
        12);  // 42113, ASCII, 2 bytes, "0"
    put32(directory, 0);
    std::string offset;
    put32(offset, bytes.size());
    bytes.replace(4, 4, offset);
    return bytes + directory;
}

constexpr BadFile bad_elevations[] = {
    {"missing", [](const fs::path&) {}},
    {"folder", [](const fs::path& path) { fs::create_directory(path); }},
    {"empty", [](const fs::path& path) { std::ofstream(path).flush(); }},
    {"text", [](const fs::path& path) { std::ofstream(path) << "ncols 4\nthis is no picture\n"; }},
    {"zeros", [](const fs::path& path) { std::ofstream(path) << std::string(5000, '\0'); }},
    {"cut_in_the_header", [](const fs::path& path) { write_first_part(path, data / "sangre_de_cristo.tif", 1e-4); }},
    {"cut_in_the_middle", [](const fs::path& path) { write_first_part(path, data / "sangre_de_cristo.tif", 0.5); }},
    {"cut_at_the_end", [](const fs::path& path) { write_first_part(path, data / "sangre_de_cristo.tif", 0.999); }},
    {"only_nodata", [](const fs::path& path) { std::ofstream(path, std::ios::binary) << nodata_tiff(); }},
    {"picture", [](const fs::path& path) { fs::copy_file(data / "water_mask.png", path); }},
};

constexpr BadFile bad_pictures[] = {
    {"missing", [](const fs::path&) {}},
    {"folder", [](const fs::path& path) { fs::create_directory(path); }},
    {"empty", [](const fs::path& path) { std::ofstream(path).flush(); }},
    {"text", [](const fs::path& path) { std::ofstream(path) << "this is no picture\n"; }},
    {"cut_in_the_header", [](const fs::path& path) { write_first_part(path, data / "blue_marble.jpg", 1e-4); }},
    {"cut_in_the_middle", [](const fs::path& path) { write_first_part(path, data / "blue_marble.jpg", 0.5); }},
};

class BadFiles : public testing::TestWithParam<BadFile> {
  protected:
    /// Runs in a folder that holds the bad file.
    void expect_refused(const std::string& arguments, const std::string& file) {
        const ScratchFolder folder;
        GetParam().write(folder / file.c_str());
        const auto before = folder.names();
        const Outcome outcome = run(folder.path(), words(arguments));
        EXPECT_EQ(outcome.status, 3) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("octaglobe: " + file + ": ")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(folder.names(), before);
    }
};

class BadElevation : public BadFiles {};

TEST_P(BadElevation, IsRefusedByQuery) {
    expect_refused("query height 37.5,-105.5 --json q.json --elevation bad.tif", "bad.tif");
}

TEST_P(BadElevation, IsRefusedByRender) {
    const ScratchFolder cache;
    const ScratchVariable variable("XDG_CACHE_HOME", cache.path().c_str());
    expect_refused("render --size 64x64 -o r.png --json r.json --elevation bad.tif", "bad.tif");
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(cache / "octaglobe", none))
        EXPECT_EQ(entry.path().filename(), "checksums");
}

INSTANTIATE_TEST_SUITE_P(Files, BadElevation, testing::ValuesIn(bad_elevations),
                         [](const auto& each) { return std::string(each.param.name); });

class BadImagery : public BadFiles {};

TEST_P(BadImagery, IsRefusedByRender) {
    expect_refused("render --size 64x64 -o r.png --json r.json --imagery bad.jpg", "bad.jpg");
}

INSTANTIATE_TEST_SUITE_P(Files, BadImagery, testing::ValuesIn(bad_pictures),
                         [](const auto& each) { return std::string(each.param.name); });

// A machine without OpenGL: pictures are refused, everything else goes on.
class NoGraphics : public testing::Test {
  protected:
    const ScratchVariable egl_{"OCTAGLOBE_EGL_LIBRARY", "/nonexistent/libEGL.so"},
        osmesa_{"OCTAGLOBE_OSMESA_LIBRARY", "/nonexistent/libOSMesa.so"};
    const ScratchFolder folder_;
};

TEST_F(NoGraphics, RefusesAPicture) {
    for (const char* way : {"auto", "egl", "egl-device", "egl-surfaceless", "osmesa"}) {
        const Outcome outcome =
            run(folder_.path(), words("render --size 64x64 -o r.png --json r.json --backend " + std::string(way)));
        EXPECT_EQ(outcome.status, 4) << way << ": " << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_NE(outcome.err.find("/nonexistent/"), std::string::npos) << outcome.err;  // says what was tried
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(folder_.names().empty());
    }
}

TEST_F(NoGraphics, InfoSaysWhy) {
    const Outcome outcome = run(folder_.path(), words("info --json i.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto json = nlohmann::json::parse(content(folder_ / "i.json"));
    ASSERT_EQ(json.at("backends").size(), 3u);
    for (const auto& way : json.at("backends")) {
        EXPECT_EQ(way.at("available"), false);
        EXPECT_NE(way.at("reason").get<std::string>().find("/nonexistent/"), std::string::npos) << way;
    }
}

TEST_F(NoGraphics, QueriesAreAnswered) {
    EXPECT_EQ(run(folder_.path(), words("query height 27.9881,86.925")).status, 0);
}

// An output that cannot be written is refused, and what stood there stays.
TEST(Unwritable, OutputIsRefused) {
    const ScratchFolder folder;
    fs::create_directory(folder / "folder.png");
    std::ofstream(folder / "file") << "kept";
    for (const char* output : {"folder.png", "no/such/folder/x.png", "file/x.png", "/proc/x.png"}) {
        const Outcome outcome = run(folder.path(), words("render --size 64x64 -o " + std::string(output)));
        EXPECT_EQ(outcome.status, 2) << output << ": " << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("octaglobe: --output: ")) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"file", "folder.png"}));
    EXPECT_EQ(content(folder / "file"), "kept");
}

TEST(Unwritable, ReportIsRefusedBeforeTheWork) {
    const ScratchFolder folder;
    const Outcome outcome = run(folder.path(), words("render --size 64x64 -o x.png --json no/such/folder/x.json"));
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace render
