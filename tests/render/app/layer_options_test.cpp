#include "render/app/picture/layer_options.h"

#include <gtest/gtest.h>

#include "planet/error.h"

namespace render {
namespace {

TEST(LayerOptions, TextAndOptionsAreTheSame) {
    for (const char* text :
         {"a.geojson", "a, b=c.gpx", "x.kml,color=#ff8000", "x.kml,width=0.5,opacity=0.25,fill=0",
          "x.kml,color=#010203,width=12.5,opacity=0.1,fill=0.7,label=NAME FIELD", "dir,with/comma.shp,label=a,b"})
        EXPECT_EQ(layer_text(parse_layer("--layer", text)), text);
}

TEST(LayerOptions, KeysInAnyOrder) {
    const LayerOptions layer = parse_layer("--layer", "t.gpx,label=Name,opacity=0.5,width=3,color=#0080ff");
    EXPECT_EQ(layer.file, "t.gpx");
    EXPECT_EQ(layer.label, "Name");
    EXPECT_EQ(layer.opacity, 0.5);
    EXPECT_EQ(layer.width, 3);
    ASSERT_TRUE(layer.color);
    EXPECT_NEAR(layer.color->g, 128.0f / 255, 1e-6f);
    EXPECT_TRUE(layer.shown);
}

TEST(LayerOptions, RefusesWhatItCannotRead) {
    for (const char* text : {"", ",color=#ffffff", "x,color=red", "x,color=#ffff", "x,color=#gggggg", "x,width=0",
                             "x,width=", "x,opacity=2", "x,fill=nan", "x,label=", "x,width=1,width=2"})
        EXPECT_THROW(parse_layer("--layer", text), planet::Error) << text;
}

TEST(LayerOptions, MeshesByTheirEnding) {
    EXPECT_TRUE(is_mesh(parse_layer("--layer", "a.GLB,opacity=0.5")));
    EXPECT_TRUE(is_mesh(parse_layer("--layer", "a.ply")));
    EXPECT_FALSE(is_mesh(parse_layer("--layer", "a.gpkg")));
}

}  // namespace
}  // namespace render
