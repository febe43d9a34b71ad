#pragma once
// Every key of the viewer, once: what runs and what the help shows.

#include <optional>
#include <span>
#include <vector>

#include "render/gl/window.h"
#include "render/viewer/panels.h"

namespace render {

enum class Action {
    help,
    settings,
    statistics,
    panels,
    full_screen,
    close,
    leave,
    home,
    north_up,
    look_down,
    go_to,
    back,
    copy_line,
    save_file,
    place_format,
    hour_back,
    hour_on,
    day_back,
    day_on,
    flatter,
    steeper,
    show_mesh,
    show_levels,
    show_curve,
    show_segments,
    show_deviations,
    freeze_culling,
    show_graticule,
    show_coastlines,
    show_borders,
    show_relief,
};

struct Binding {
    Key key;
    bool shift = false, control = false;
    Action action;
};

std::optional<Action> action_of(const InputEvent& event);

/// Titles, keys and what they do, in the order of the help.
std::vector<HelpGroup> help_groups();

/// The key of an action as the help writes it, "Shift+E"; empty if it has none.
std::string key_text(Action action);

}  // namespace render
