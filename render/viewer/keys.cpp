#include "render/viewer/keys.h"

namespace render {

namespace {

using enum Action;

struct Entry {
    Binding binding;
    const char* keys;
    const char* what;
};

// Every binding with a line in the help; a second key of the same action has none.
constexpr Entry views[] = {
    {{Key::home, false, false, home}, "Home", "the whole globe"},
    {{key_of('N'), false, false, north_up}, "N", "north up (or click the compass)"},
    {{key_of('D'), false, false, look_down}, "D", "look straight down"},
    {{key_of('G'), false, false, go_to}, "G", "go to a place"},
    {{Key::backspace, false, false, back}, "Backspace", "back to the last place"},
};
constexpr Entry mesh[] = {
    {{key_of('W'), false, false, show_mesh}, "W", "wireframe"},
    {{key_of('L'), false, false, show_levels}, "L", "bisection levels"},
    {{key_of('V'), false, false, show_deviations}, "V", "deviations"},
    {{key_of('S'), false, false, show_segments}, "S", "segments"},
    {{key_of('K'), false, false, show_curve}, "K", "Sierpinski curve"},
    {{key_of('F'), false, false, freeze_culling}, "F", "freeze culling, look from outside"},
    {{Key::f3, false, false, statistics}, "F3", "statistics"},
};
constexpr Entry picture[] = {
    {{Key::tab, false, false, settings}, "Tab", "time, heights, layers"},
    {{Key::left_bracket, false, false, hour_back}, "[", "an hour back (Shift: a day)"},
    {{Key::right_bracket, false, false, hour_on}, "]", "an hour on (Shift: a day)"},
    {{key_of('E'), false, false, steeper}, "E", "heights steeper (Shift: flatter)"},
    {{key_of('R'), false, false, show_graticule}, "R", "graticule"},
    {{key_of('O'), false, false, show_coastlines}, "O", "coastlines"},
    {{key_of('J'), false, false, show_borders}, "J", "borders of countries"},
    {{key_of('I'), false, false, show_relief}, "I", "imagery, or heights as colours"},
    {{key_of('U'), false, false, place_format}, "U", "degrees, minutes, UTM, MGRS"},
};
constexpr Entry program[] = {
    {{key_of('C'), false, false, copy_line}, "C", "copy the view as a command"},
    {{key_of('P'), false, false, save_file}, "P", "save a picture"},
    {{key_of('B'), false, false, panels}, "B", "nothing but the globe"},
    {{Key::f11, false, false, full_screen}, "F11", "full screen"},
    {{key_of('H'), false, false, help}, "H, F1", "these keys"},
    {{Key::escape, false, false, close}, "Esc", "close a panel"},
    {{key_of('Q'), false, true, leave}, "Ctrl+Q", "leave"},
};
constexpr Binding silent[] = {
    {Key::f1, false, false, help},
    {Key::left_bracket, true, false, day_back},
    {Key::right_bracket, true, false, day_on},
    {key_of('E'), true, false, flatter},
    {key_of('C'), false, true, copy_line},
};

struct Group {
    const char* title;
    std::span<const Entry> entries;
};
constexpr Group groups[] = {{"Picture", picture}, {"Views", views}, {"Mesh", mesh}, {"Program", program}};

bool fits(const Binding& b, const InputEvent& e) {
    return b.key == e.key && b.shift == e.shift && b.control == e.control;
}

}  // namespace

std::optional<Action> action_of(const InputEvent& event) {
    if (event.kind != InputEvent::Kind::press) return std::nullopt;
    for (const Group& group : groups)
        for (const Entry& entry : group.entries)
            if (fits(entry.binding, event)) return entry.binding.action;
    for (const Binding& binding : silent)
        if (fits(binding, event)) return binding.action;
    return std::nullopt;
}

std::vector<HelpGroup> help_groups() {
    std::vector<HelpGroup> all{{"Mouse",
                                {{"Drag", "hold the ground, or the sky"},
                                 {"Wheel", "nearer and farther, at the cursor"},
                                 {"Right drag", "turn and tilt (also Ctrl+drag)"},
                                 {"Double click", "fly there"}}},
                               {"Moving",
                                {{"Arrows", "over the ground"},
                                 {"Shift+arrows", "turn and tilt"},
                                 {"+  -  PgUp  PgDn", "nearer and farther"}}}};
    for (const Group& group : groups) {
        HelpGroup& to = all.emplace_back(HelpGroup{group.title, {}});
        for (const Entry& entry : group.entries) to.lines.push_back({entry.keys, entry.what});
    }
    return all;
}

std::string key_text(Action action) {
    for (const Group& group : groups)
        for (const Entry& entry : group.entries)
            if (entry.binding.action == action) return entry.keys;
    return {};
}

}  // namespace render
