#include "render/app/values.h"

#include <gtest/gtest.h>

#include <numbers>

#include "planet/error.h"

namespace render {
namespace {

constexpr double pi = std::numbers::pi;

/// The error line, or "" if the call was accepted.
template <class Call>
std::string refusal(const Call& call) {
    try {
        call();
    } catch (const planet::Error& error) {
        EXPECT_EQ(error.fault(), planet::Fault::bad_usage);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        EXPECT_TRUE(std::string(error.what()).starts_with("--it: ")) << error.what();
        EXPECT_NE(std::string(error.what()).find("; accepted: "), std::string::npos) << error.what();
        return error.what();
    }
    return "";
}

TEST(Values, PlaceInRadians) {
    const auto place = parse_place("--it", "37.58,-105.49");
    EXPECT_DOUBLE_EQ(place.latitude, 37.58 * pi / 180);
    EXPECT_DOUBLE_EQ(place.longitude, -105.49 * pi / 180);
    EXPECT_EQ(place.h.m, 0);
}

TEST(Values, PlaceWrapsLongitudeAtTheSeam) {
    EXPECT_EQ(parse_place("--it", "0,180").longitude, pi);
    EXPECT_EQ(parse_place("--it", "0,-180").longitude, -pi);
    EXPECT_EQ(parse_place("--it", "0,360").longitude, 0);
    EXPECT_EQ(parse_place("--it", "0,270").longitude, -pi / 2);
    EXPECT_EQ(parse_place("--it", "90,0").latitude, pi / 2);
    EXPECT_EQ(parse_place("--it", "-90,0").latitude, -pi / 2);
}

TEST(Values, PlaceTakesBlanksSignsAndExponents) {
    for (const char* text : {" -16.5 , 180 ", "-16.5,+180", "-1.65e1,1.8E2", "-16.50,180."}) {
        const auto place = parse_place("--it", text);
        EXPECT_EQ(place.latitude, -16.5 * planet::degrees) << text;
        EXPECT_EQ(place.longitude, pi) << text;
    }
    EXPECT_EQ(parse_place("--it", "-.5,.5").latitude, -0.5 * planet::degrees);
}

TEST(Values, PlaceRefusesEverythingElse) {
    for (const char* text :
         {"",       " ",          ",",     "1",      "1,",    ",1",    "1,2,3",      "1 2",     "1;2",
          "91,0",   "-90.0001,0", "0,361", "0,-181", "nan,0", "0,nan", "inf,0",      "0,-inf",  "1e999,0",
          "0x10,0", "1,2x",       "+-1,2", "--1,2",  "1,2\n", "1,2,",  "infinity,1", "NAN,NAN", "1e,2"})
        EXPECT_NE(refusal([&] { parse_place("--it", text); }), "") << text;
    EXPECT_NE(refusal([] { parse_place("--it", "91,0"); }).find("latitude 91 is out of range"), std::string::npos);
}

TEST(Values, DistanceUnits) {
    const Range range{1, 1e9};
    EXPECT_EQ(parse_distance("--it", "60km", range), 60000);
    EXPECT_EQ(parse_distance("--it", "500m", range), 500);
    EXPECT_EQ(parse_distance("--it", "2e7", range), 2e7);
    EXPECT_EQ(parse_distance("--it", "12 nmi", range), 22224);
    EXPECT_EQ(parse_distance("--it", "1000ft", range), 304.8);
    EXPECT_DOUBLE_EQ(parse_distance("--it", " 3mi ", range), 4828.032);
    EXPECT_EQ(parse_distance("--it", "1e3 km", range), 1e6);
    EXPECT_EQ(parse_distance("--it", "1", range), 1);
    for (const char* text : {"", "km", "60 kilometres", "60KM", "60kmm", "-5km", "0", "0.99", "1e10", "2e6km", "nan",
                             "inf", "1e400", "5 5", "5,5", "1km2", "m", "+"})
        EXPECT_NE(refusal([&] { parse_distance("--it", text, range); }), "") << text;
}

TEST(Values, Memory) {
    constexpr std::size_t low = 1 << 20, high = std::size_t{1} << 40;
    EXPECT_EQ(parse_memory("--it", "1048576", low, high), low);
    EXPECT_EQ(parse_memory("--it", "512MiB", low, high), std::size_t{512} << 20);
    EXPECT_EQ(parse_memory("--it", "512M", low, high), std::size_t{512} << 20);
    EXPECT_EQ(parse_memory("--it", " 1.5 GiB ", low, high), std::size_t{1536} << 20);
    EXPECT_EQ(parse_memory("--it", "2000MB", low, high), 2'000'000'000u);
    EXPECT_EQ(parse_memory("--it", "2000000 B", low, high), 2'000'000u);
    EXPECT_EQ(parse_memory("--it", "1T", low, high), high);
    for (const char* text : {"", "M", "1", "1048575", "1e30", "2T", "nan", "inf", "-1G", "512Mi", "512MiBB", "512 Mb",
                             "1 parsec", "0x10M", "1M1"})
        EXPECT_NE(refusal([&] { parse_memory("--it", text, low, high); }), "") << text;
}

TEST(Values, NumbersAndAngles) {
    EXPECT_EQ(parse_number("--it", "-0", {-1, 1}), 0);
    EXPECT_FALSE(std::signbit(parse_number("--it", "-0", {-1, 1})));
    EXPECT_EQ(parse_angle("--it", "-90", {-90, 90}), -pi / 2);
    EXPECT_EQ(parse_angle("--it", "360", {0, 360}), 2 * pi);
    for (const char* text : {"", "-91", "90.01", "nan", "-inf", "12deg", "1 2", "1e309", "."})
        EXPECT_NE(refusal([&] { parse_angle("--it", text, {-90, 90}); }), "") << text;
    EXPECT_EQ(parse_whole("--it", "256", 0, 256), 256);
    for (const char* text : {"", "-1", "257", "1.5", "1e2", "99999999999999999999", "x", "0x1"})
        EXPECT_NE(refusal([&] { parse_whole("--it", text, 0, 256); }), "") << text;
}

TEST(Values, Sizes) {
    EXPECT_EQ(parse_size("--it", "1920x1080"), (PictureSize{1920, 1080}));
    EXPECT_EQ(parse_size("--it", "1X1"), (PictureSize{1, 1}));
    EXPECT_EQ(parse_size("--it", "65535x65535"), (PictureSize{65535, 65535}));
    for (const char* text :
         {"", "x", "0x0", "70000x70000", "65536x1", "1x65536", "1920", "1920x", "x1080", "1920x1080x3", "-1x5", "5x-1",
          "1e3x1e3", "1920 x1080", "99999999999999999999x1", "1920*1080"})
        EXPECT_NE(refusal([&] { parse_size("--it", text); }), "") << text;
}

TEST(Values, WholeNumbersInALine) {
    EXPECT_EQ(parse_wholes("--it", "50, 150,250", 3, 300), (std::vector<std::size_t>{50, 150, 250}));
    for (const char* text : {"", "50,", ",50", "50;60", "50,2", "301", "5.5"})
        EXPECT_NE(refusal([&] { parse_wholes("--it", text, 3, 300); }), "") << text;
}

TEST(Values, ChoicesAreExact) {
    EXPECT_EQ(parse_choice("--it", "b", {"a", "b"}), 1u);
    EXPECT_EQ(parse_choices("--it", "c, a", {"a", "b", "c"}), (std::vector<std::size_t>{2, 0}));
    for (const char* text : {"", "A", "a,", ",a", "a,a", "d", "a;b"})
        EXPECT_NE(refusal([&] { parse_choices("--it", text, {"a", "b", "c"}); }), "") << text;
    EXPECT_NE(refusal([] { parse_choice("--it", "", {"a"}); }), "");
}

TEST(Values, QuotingIsSafeToPrint) {
    EXPECT_EQ(shown("a\x1b[31m\n\xff"), "'a?[31m\?\?'");
    EXPECT_EQ(shown(std::string(1000, 'x')).size(), 65u);
}

}  // namespace
}  // namespace render
