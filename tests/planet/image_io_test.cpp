#include "planet/elevation/image_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <sstream>

#include "planet/error.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::TemporaryFolder;
using testing::write_bytes;

std::string bytes_of(const std::string& path) {
    std::stringstream s;
    s << std::ifstream(path, std::ios::binary).rdbuf();
    return s.str();
}

template <class Run>
std::string error_of(Fault fault, Run run) {
    try {
        run();
    } catch (const Error& e) {
        EXPECT_EQ(e.fault(), fault) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        return e.what();
    }
    return "";
}

#define EXPECT_ERROR(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

template <class Sample>
BasicImage<Sample> pattern(int width, int height, int channels) {
    BasicImage<Sample> image{width, height, channels, {}};
    for (std::size_t i = 0; i < image.row_size() * static_cast<std::size_t>(height); ++i)
        image.pixels.push_back(static_cast<Sample>(i * 2654435761u % 251));
    return image;
}

std::size_t files_in(const TemporaryFolder& folder) {
    std::size_t n = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++n;
    return n;
}

TEST(ImageIo, EightBitPicturesComeBackAsTheyWere) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.tif"})
        for (const int channels : {3, 4}) {
            const Image image = pattern<std::uint8_t>(37, 21, channels);
            write_image(folder / name, image);
            const Image back = read_image(folder / name);
            EXPECT_EQ(back.width, 37);
            EXPECT_EQ(back.height, 21);
            EXPECT_EQ(back.channels, channels);
            EXPECT_EQ(back.pixels, image.pixels) << name << channels;
        }
}

TEST(ImageIo, SameBytesEachTimeAndNoTimes) {
    const TemporaryFolder folder;
    const Image image = pattern<std::uint8_t>(64, 64, 3);
    const FloatImage light{2, 1, 3, {0, 0.5f, 1, 2, 3, 4}};
    const std::time_t now = std::time(nullptr);
    const std::string year = std::to_string(1900 + std::localtime(&now)->tm_year);
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.exr"}) {
        const auto write = [&] {
            if (std::string(name) == "a.exr")
                write_image(folder / name, light);
            else
                write_image(folder / name, image);
            return bytes_of(folder / name);
        };
        const std::string first = write();
        EXPECT_EQ(first, write()) << name;
        EXPECT_EQ(first.find("tIME"), std::string::npos);
        EXPECT_EQ(first.find(year + ":"), std::string::npos) << name;
    }
    EXPECT_EQ(files_in(folder), 4u);
}

TEST(ImageIo, DeepAndFloatPictures) {
    const TemporaryFolder folder;
    DeepImage deep{3, 1, 3, {0, 1000, 65535, 32768, 257, 1, 2, 3, 4}};
    write_image(folder / "a.tif", deep);
    write_image(folder / "a.png", deep);
    for (const char* name : {"a.tif", "a.png"}) {
        const Image bytes = read_image(folder / name);
        for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(bytes.pixels[i], deep.pixels[i] / 257.0, 0.51) << name << i;
    }
    FloatImage light{2, 1, 4, {0, 0.5f, 1, 1, 20, 0.25f, 1e-4f, 0.5f}};
    write_image(folder / "a.exr", light);
    const FloatImage back = read_float_image(folder / "a.exr");
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(back.pixels[i], light.pixels[i], 1e-6) << i;
    const Image bytes = read_image(folder / "a.exr");
    EXPECT_EQ(bytes.pixels[1], 188);  // 0.5 in linear light
    EXPECT_EQ(bytes.pixels[4], 255);  // clamped
    EXPECT_EQ(bytes.pixels[7], 128);  // alpha is not encoded
}

TEST(ImageIo, GreyBecomesRgb) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.pgm", std::string("P5\n2 2\n255\n") + '\x01' + '\x80' + '\xff' + '\x00');
    const Image image = read_image(folder / "a.pgm");
    EXPECT_EQ(image.pixels, (std::vector<std::uint8_t>{1, 1, 1, 128, 128, 128, 255, 255, 255, 0, 0, 0}));
}

TEST(ImageIo, ReducedPicturesAreMeansOfLight) {
    const TemporaryFolder folder;
    Image image{5, 2, 3, std::vector<std::uint8_t>(30, 0)};
    for (int c = 0; c < 3; ++c)
        image.pixels[static_cast<std::size_t>(c)] = image.pixels[static_cast<std::size_t>(18 + c)] = 255;
    for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(12 + c)] = 255;
    write_image(folder / "a.png", image);
    ImageOptions options;
    options.max_width = 3;
    const Image small = read_image(folder / "a.png", options);
    ASSERT_EQ(small.width, 3);
    ASSERT_EQ(small.height, 1);
    EXPECT_EQ(small.pixel(0, 0)[0], 188);  // half of the light
    EXPECT_EQ(small.pixel(1, 0)[1], 0);
    EXPECT_EQ(small.pixel(2, 0)[2], 188);  // the last column alone
}

TEST(ImageIo, RowsCanBeStreamed) {
    const TemporaryFolder folder;
    const Image image = pattern<std::uint8_t>(100, 90, 3);
    write_image(folder / "whole.png", image);
    ImageWriter writer(folder / "rows.png", 100, 90, 3, SampleType::uint8);
    for (int y = 0; y < 90; y += 9) {
        EXPECT_FALSE(std::filesystem::exists(folder / "rows.png"));
        writer.write_rows(image.pixel(0, y), 9);
    }
    writer.finish();
    EXPECT_EQ(bytes_of(folder / "rows.png"), bytes_of(folder / "whole.png"));
    EXPECT_EQ(files_in(folder), 2u);
}

TEST(ImageIo, AnUnfinishedPictureLeavesTheOldOne) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.png", "old");
    {
        const Image image = pattern<std::uint8_t>(10, 10, 3);
        ImageWriter writer(folder / "a.png", 10, 10, 3, SampleType::uint8);
        writer.write_rows(image.pixels.data(), 5);
    }
    EXPECT_EQ(bytes_of(folder / "a.png"), "old");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(ImageIo, ReadsTheBytesOfAFile) {
    const TemporaryFolder folder;
    const Image image = pattern<std::uint8_t>(64, 48, 3);
    for (const char* name : {"a.png", "a.tif"}) {
        write_image(folder / name, image);
        EXPECT_EQ(read_image_bytes(bytes_of(folder / name), "mesh.glb").pixels, image.pixels) << name;
    }
    const std::string whole = bytes_of(folder / "a.png");
    for (const std::string& bad : {std::string(), std::string("GIF"), whole.substr(0, whole.size() / 2)})
        EXPECT_ERROR(error_of(Fault::bad_data, [&] { read_image_bytes(bad, "mesh.glb"); }),
                     "mesh.glb: is no picture that can be read");
}

// Offsets of 32 bits end at 4 GiB: what may become larger says from its first bytes on that it has 64.
TEST(ImageIo, ATiffThatMayPassFourGigabytesIsBig) {
    const auto version = [](int width, int height) {
        const TemporaryFolder folder;
        const ImageWriter writer(folder / "a.tif", width, height, 3, SampleType::uint8);
        const auto entry = *std::filesystem::directory_iterator(folder.path());
        return static_cast<int>(bytes_of(entry.path().string()).at(2));
    };
    constexpr int classic = 42, big = 43;
    EXPECT_EQ(version(40000, 20000), classic);
    EXPECT_EQ(version(60000, 30000), big);
    EXPECT_EQ(version(36000, 36000), classic);
    EXPECT_EQ(version(36100, 36100), big);
}

TEST(ImageIo, EachBadFileGetsItsOwnLine) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& path) { return error_of(Fault::bad_data, [&] { read_image(path); }); };
    EXPECT_ERROR(read(folder / "missing.png"), "no such file");
    write_bytes(folder / "empty.png", "");
    EXPECT_ERROR(read(folder / "empty.png"), "is empty");
    write_bytes(folder / "text.png", "Dear all,\nthis is not a picture.\n");
    EXPECT_ERROR(read(folder / "text.png"), "cannot be read");
    EXPECT_ERROR(read(folder.path().string()), "is not a file");
    const Image image = pattern<std::uint8_t>(64, 64, 3);
    for (const char* name : {"cut.png", "cut.jpg", "cut.tif"}) {
        write_image(folder / name, image);
        const std::string whole = bytes_of(folder / name);
        for (const std::size_t part : {2u, 3u, 10u}) {
            write_bytes(folder / name, whole.substr(0, whole.size() / part));
            EXPECT_NE(read(folder / name), "") << name << " cut to 1/" << part;
        }
    }
    write_image(folder / "large.png", image);
    ImageOptions small;
    small.max_pixels = 1000;
    EXPECT_ERROR(error_of(Fault::bad_data, [&] { read_image(folder / "large.png", small); }),
                 "64x64 pixels are too many; accepted: at most 1000");
}

TEST(ImageIo, WhatCannotBeWrittenIsRefusedInOneLine) {
    const TemporaryFolder folder;
    const Image image = pattern<std::uint8_t>(4, 4, 3);
    const auto write = [&](const std::string& path, const auto& picture) {
        return error_of(Fault::bad_usage, [&] { write_image(path, picture); });
    };
    EXPECT_ERROR(write(folder / "no/such/folder/a.png", image), "cannot be written");
    EXPECT_ERROR(write(folder / "a.gif", image), "accepted: .png, .jpg, .tif or .exr");
    std::filesystem::create_directory(folder / "folder.png");
    EXPECT_ERROR(write(folder / "folder.png", image), "is not a file");
    EXPECT_ERROR(write("/dev/full/a.png", image), "cannot be written");
    EXPECT_ERROR(write(folder / "a.jpg", pattern<std::uint8_t>(4, 4, 4)), "number of channels 4");
    EXPECT_ERROR(write(folder / "a.png", pattern<float>(4, 4, 3)), "does not hold these samples");
    EXPECT_ERROR(error_of(Fault::bad_usage, [&] { ImageWriter(folder / "a.png", 0, 4, 3, SampleType::uint8); }),
                 "width 0");
    EXPECT_ERROR(error_of(Fault::bad_usage, [&] { ImageWriter(folder / "a.png", 4, 70000, 3, SampleType::uint8); }),
                 "1 to 65535");
    EXPECT_EQ(files_in(folder), 1u);
}

}  // namespace
}  // namespace planet
