// What the status line says of places, heights and lengths.

#include "render/viewer/place_text.h"

#include <gtest/gtest.h>

#include "planet/error.h"
#include "planet/geodesy/utm.h"

namespace render {
namespace {

using planet::degrees;

const planet::Geodetic blanca{37.5767 * degrees, -105.4858 * degrees, {}};

TEST(PlaceText, InDegreesAsFineAsAPixel) {
    EXPECT_EQ(place_text(blanca, PlaceFormat::degrees, 12), "37.5767\xc2\xb0 N  105.4858\xc2\xb0 W");
    EXPECT_EQ(place_text(blanca, PlaceFormat::degrees, 20'000), "37.6\xc2\xb0 N  105.5\xc2\xb0 W");
    EXPECT_EQ(place_text({0, 0, {}}, PlaceFormat::degrees, 1e5), "0.0\xc2\xb0 N  0.0\xc2\xb0 E");
}

TEST(PlaceText, InSecondsThatNeverReadSixty) {
    EXPECT_EQ(place_text(blanca, PlaceFormat::minutes_seconds, 5),
              "37\xc2\xb0 34\xe2\x80\xb2 36.1\xe2\x80\xb3 N  105\xc2\xb0 29\xe2\x80\xb2 08.9\xe2\x80\xb3 W");
    const planet::Geodetic almost{(46 - 1e-9) * degrees, (8 - 1e-9) * degrees, {}};
    EXPECT_EQ(place_text(almost, PlaceFormat::minutes_seconds, 5),
              "46\xc2\xb0 00\xe2\x80\xb2 00.0\xe2\x80\xb3 N  8\xc2\xb0 00\xe2\x80\xb2 00.0\xe2\x80\xb3 E");
}

TEST(PlaceText, InUtmAndMgrs) {
    const planet::Utm utm = planet::utm_from_geodetic(blanca);
    EXPECT_EQ(utm.zone, 13);
    EXPECT_EQ(place_text(blanca, PlaceFormat::utm, 10), "13N 457 104 E 4 158 962 N");
    const std::string square = place_text(blanca, PlaceFormat::mgrs, 1);
    EXPECT_EQ(square, planet::mgrs_from_geodetic(blanca, 5));
    EXPECT_EQ(place_text(blanca, PlaceFormat::mgrs, 1000), planet::mgrs_from_geodetic(blanca, 2));
    EXPECT_TRUE(place_text({90 * degrees, 0, {}}, PlaceFormat::utm, 1).starts_with("UPS N "));
}

TEST(PlaceText, Heights) {
    EXPECT_EQ(heights_text({4372.44}, {4356.12}, 10), "H 4 372.4 m   h 4 356.1 m");
    EXPECT_EQ(heights_text({-0.01}, {-16.4}, 1000), "H 0 m   h -16 m");
}

TEST(PlaceText, Lengths) {
    EXPECT_EQ(length_text(0.5), "0.50 m");
    EXPECT_EQ(length_text(850), "850 m");
    EXPECT_EQ(length_text(999.7), "1.00 km");
    EXPECT_EQ(length_text(12'400), "12.4 km");
    EXPECT_EQ(length_text(18'500'000), "18 500 km");
}

TEST(ScaleBars, AreRoundAndFit) {
    for (double pixel = 0.001; pixel < 1e5; pixel *= 1.37) {
        const ScaleBar bar = scale_bar(pixel, 200);
        EXPECT_LE(bar.pixels, 200.000001);
        EXPECT_GT(bar.pixels, 79) << pixel;
        EXPECT_NEAR(bar.pixels * pixel, bar.metres, 1e-9 * bar.metres);
    }
    EXPECT_EQ(scale_bar(100, 210).text, "20 km");
    EXPECT_EQ(scale_bar(1, 600).text, "500 m");
    EXPECT_EQ(scale_bar(0.001, 250).text, "0.2 m");
}

TEST(PlacesFromText, DegreesAndSquares) {
    for (const char* text : {"37.5767,-105.4858", " 37.5767 , -105.4858 ", "37.5767 -105.4858", "37.5767, 254.5142"}) {
        const planet::Geodetic place = place_from_text(text);
        EXPECT_NEAR(place.latitude, blanca.latitude, 1e-9) << text;
        EXPECT_NEAR(place.longitude, blanca.longitude, 1e-9) << text;
    }
    const planet::Geodetic square = place_from_text(planet::mgrs_from_geodetic(blanca, 5));
    EXPECT_NEAR(square.latitude, blanca.latitude, 1e-6);
    for (const char* text : {"", "somewhere", "91, 0", "10", "10, 20, 30", "nan, 3", "10, 400"})
        EXPECT_THROW(place_from_text(text), planet::Error) << text;
}

}  // namespace
}  // namespace render
