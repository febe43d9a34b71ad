#pragma once
// What lies over the picture, as data: the module that draws it knows no planet, and the viewer no widgets.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace render {

/// A figure of the last frames, oldest first.
struct Plot {
    std::string name, unit;
    std::vector<float> values;
    float top = 1;     ///< of the vertical axis
    float marked = 0;  ///< a line across, such as the time of a frame at 60 a second; 0: none
};

struct HelpLine {
    std::string keys, what;
};
struct HelpGroup {
    std::string title;
    std::vector<HelpLine> lines;
};

/// Something to switch in the settings.
struct Switch {
    std::string name, key;
    bool on = false;
    bool changed = false;  ///< by the user, since the last draw
};

/// A layer of the user's in the settings.
struct LayerRow {
    std::string name;
    std::array<float, 3> color{};  ///< sRGB, 0..1
    bool on = true;
    float opacity = 1;     ///< 0..1
    int raise = 0;         ///< 1: over the next one, -1: below the one before
    bool changed = false;  ///< any of it, by the user, since the last draw
};

struct Panels {
    bool shown = true;  ///< none at all: the picture alone

    // Always there: one line below, a scale bar, a compass.
    std::string cursor_place;  ///< place and height under the cursor; empty: nothing there
    std::string eye_line;      ///< height of the eye, heading
    std::string activity;      ///< what is being loaded; empty: settled
    std::string scale_text;    ///< "20 km"
    float scale_px = 0;        ///< its length; 0: no bar
    float compass = 0;         ///< heading, rad
    float tilt = 0;            ///< pitch above straight down, rad

    /// A line that fades after some seconds, and one that stays while something takes long.
    std::string notice;
    float notice_fade = 1;     ///< 0..1
    std::string progress;      ///< empty: none
    float progress_part = -1;  ///< 0..1; below 0: not known

    // When asked for.
    bool help = false, settings = false, statistics = false, go_to = false;
    std::vector<HelpGroup> help_groups;
    std::vector<std::string> facts;  ///< "triangles\t105 074": a line each, name and value
    std::vector<Plot> plots;
    std::vector<Switch> layers, modes;
    std::vector<LayerRow> own_layers;  ///< the highest first
    std::string time_text;
    float day_hours = 0;  ///< UTC, 0..24
    float year_day = 0;   ///< 0..365
    float exaggeration = 1;
    std::string go_to_text, go_to_answer;  ///< what is typed, and why it is no place

    // What the user did in them.
    bool north_pressed = false, go_to_entered = false, time_changed = false, exaggeration_changed = false;
    bool wants_frame = false;  ///< something in them moves: draw again soon
};

}  // namespace render
