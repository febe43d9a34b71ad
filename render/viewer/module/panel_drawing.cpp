#include "render/viewer/module/panel_drawing.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "planet/error.h"
#include "render/viewer/module/fonts.h"

namespace render {
namespace {

// One dark glass, through which no name can be read, two greys, one accent. All distances are multiples of 8.
constexpr ImU32 ink = IM_COL32(236, 240, 244, 255), quiet = IM_COL32(160, 170, 181, 255),
                accent = IM_COL32(255, 196, 84, 255), glass = IM_COL32(13, 17, 22, 250),
                thin_glass = IM_COL32(13, 17, 22, 184), shade = IM_COL32(0, 0, 0, 210),
                line = IM_COL32(255, 255, 255, 26);

ImVec4 color(ImU32 c) {
    return ImGui::ColorConvertU32ToFloat4(c);
}

ImU32 faded(ImU32 c, float alpha) {
    const auto a = static_cast<ImU32>(static_cast<float>(c >> IM_COL32_A_SHIFT) * std::clamp(alpha, 0.0f, 1.0f));
    return (c & ~IM_COL32_A_MASK) | a << IM_COL32_A_SHIFT;
}

void set_style(float scale) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    style.WindowPadding = {16, 16};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 8};
    style.WindowRounding = style.FrameRounding = style.GrabRounding = 4;
    style.WindowBorderSize = 0;
    style.GrabMinSize = 12;
    style.ScrollbarSize = 8;
    style.ScaleAllSizes(scale);
    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = color(ink);
    c[ImGuiCol_TextDisabled] = color(quiet);
    c[ImGuiCol_WindowBg] = color(glass);
    c[ImGuiCol_FrameBg] = color(IM_COL32(255, 255, 255, 20));
    c[ImGuiCol_FrameBgHovered] = color(IM_COL32(255, 255, 255, 34));
    c[ImGuiCol_FrameBgActive] = color(IM_COL32(255, 255, 255, 44));
    c[ImGuiCol_SliderGrab] = c[ImGuiCol_SliderGrabActive] = c[ImGuiCol_CheckMark] = color(accent);
    c[ImGuiCol_TextSelectedBg] = color(IM_COL32(255, 196, 84, 90));
    c[ImGuiCol_Button] = c[ImGuiCol_FrameBg];
    c[ImGuiCol_ButtonHovered] = c[ImGuiCol_FrameBgHovered];
    c[ImGuiCol_ButtonActive] = c[ImGuiCol_FrameBgActive];
    c[ImGuiCol_Separator] = color(line);
}

/// Text that can be read over any ground.
void shaded_text(ImDrawList& list, ImVec2 at, ImU32 ink_color, const char* text, const char* end = nullptr) {
    for (const ImVec2 off : {ImVec2(1, 1), ImVec2(-1, 1), ImVec2(1, -1), ImVec2(-1, -1)})
        list.AddText({at.x + off.x, at.y + off.y}, shade, text, end);
    list.AddText(at, ink_color, text, end);
}

void accent_text_wrapped(const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, color(accent));
    ImGui::TextWrapped("%s", text.c_str());
    ImGui::PopStyleColor();
}

}  // namespace

PanelDrawing::PanelDrawing(GLFWwindow* window, double scale) : scale_(static_cast<float>(scale)) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // nothing is written beside the user's files
    io.LogFilename = nullptr;
    set_style(scale_);
    const Fonts fonts = load_fonts(scale_);
    text_ = fonts.text;
    small_ = fonts.small;
    title_ = fonts.title;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    if (!ImGui_ImplOpenGL3_Init("#version 450 core"))
        throw planet::Error(planet::Fault::no_graphics, "window", "Dear ImGui finds no OpenGL",
                            "libGL.so.1 or libEGL.so.1");
}

PanelDrawing::~PanelDrawing() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

bool PanelDrawing::takes_keys() {
    return ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantTextInput;
}

bool PanelDrawing::takes_mouse() {
    return ImGui::GetCurrentContext() != nullptr && ImGui::GetIO().WantCaptureMouse;
}

void PanelDrawing::draw(Panels& panels) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    panels.wants_frame = false;
    if (panels.shown) {
        if (panels.progress.empty()) draw_overlay(panels);
        if (panels.help) {
            draw_help(panels);  // instead of the others, which it would lie over in a small window
        } else {
            if (panels.settings) draw_settings(panels);
            if (panels.statistics) draw_statistics(panels);
        }
        if (panels.go_to) draw_go_to(panels);
        draw_notice(panels);
    }
    // A press is told by the frame in which a widget sees it, and changes show in the next.
    panels.wants_frame |= ImGui::IsAnyItemActive() || ImGui::IsAnyMouseDown();
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void PanelDrawing::draw_overlay(Panels& panels) {
    draw_status(panels);
    draw_scale_bar(panels);
    draw_compass(panels);
}

void PanelDrawing::draw_status(Panels& panels) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float height = unit(32), top = size.y - height,
                text_y = std::round(top + 0.5f * (height - ImGui::GetFontSize()));
    list.AddRectFilled({0, top}, size, thin_glass);
    const float eye_width = ImGui::CalcTextSize(panels.eye_line.c_str()).x;
    const float right = size.x - unit(16) - eye_width;
    list.AddText({right, text_y}, ink, panels.eye_line.c_str());
    float x = unit(16);
    const auto room = [&](const std::string& text) {
        return x + ImGui::CalcTextSize(text.c_str()).x < right - unit(16);
    };
    if (!panels.cursor_place.empty() && room(panels.cursor_place)) {
        list.AddText({x, text_y}, ink, panels.cursor_place.c_str());
        x += ImGui::CalcTextSize(panels.cursor_place.c_str()).x + unit(24);
    }
    if (!panels.activity.empty() && room(panels.activity)) {
        list.AddCircleFilled({x + unit(4), top + 0.5f * height}, unit(3), accent);
        list.AddText({x + unit(16), text_y}, quiet, panels.activity.c_str());
    }
}

void PanelDrawing::draw_scale_bar(const Panels& panels) {
    if (panels.scale_px <= 0) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float x1 = std::round(size.x - unit(16)), x0 = std::round(x1 - panels.scale_px),
                y = std::round(size.y - unit(48));
    const float tick = unit(6);
    const ImVec2 points[] = {{x0, y - tick}, {x0, y}, {x1, y}, {x1, y - tick}};
    list.AddPolyline(points, 4, shade, 0, unit(4));
    list.AddPolyline(points, 4, ink, 0, unit(1.5f));
    const float width = ImGui::CalcTextSize(panels.scale_text.c_str()).x;
    shaded_text(list, {std::round(0.5f * (x0 + x1 - width)), y - tick - ImGui::GetFontSize()}, ink,
                panels.scale_text.c_str());
}

void PanelDrawing::draw_compass(Panels& panels) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize, middle{size.x - unit(16 + 24), unit(16 + 24)};
    const float radius = unit(24);
    list.AddCircleFilled(middle, radius, thin_glass, 48);
    const float s = std::sin(panels.compass), c = std::cos(panels.compass);
    const auto at = [&](float across, float along) {  // along: towards north
        return ImVec2(middle.x + unit(across) * c - unit(along) * s, middle.y - unit(across) * s - unit(along) * c);
    };
    list.AddTriangleFilled(at(-5, 0), at(0, 14), at(5, 0), accent);
    list.AddTriangleFilled(at(5, 0), at(0, -14), at(-5, 0), IM_COL32(236, 240, 244, 150));
    const ImVec2 letter = at(0, 19);
    const float small = unit(10);
    const ImVec2 extent = text_->CalcTextSizeA(small, 1e6f, 0, "N");
    list.AddText(text_, small, {std::round(letter.x - 0.5f * extent.x), std::round(letter.y - 0.5f * extent.y)}, ink,
                 "N");
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const bool over = std::hypot(mouse.x - middle.x, mouse.y - middle.y) < radius;
    if (over) list.AddCircle(middle, radius, faded(ink, 0.6f), 48, unit(1));
    panels.north_pressed = over && ImGui::IsMouseClicked(0) && !takes_mouse();
}

void PanelDrawing::draw_notice(const Panels& panels) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const auto box = [&](const std::string& text, float y, float alpha, float part) {
        const float most = size.x - unit(96);
        const ImVec2 extent = ImGui::CalcTextSize(text.c_str(), nullptr, false, most);
        const float bar = part >= 0 ? unit(16) : 0, width = std::max(extent.x, part >= 0 ? unit(240) : 0);
        const ImVec2 from{std::round(0.5f * (size.x - width) - unit(16)), y};
        const ImVec2 to{from.x + width + unit(32), y + extent.y + unit(16) + bar};
        list.AddRectFilled(from, to, faded(glass, alpha), unit(4));
        list.AddText(text_, ImGui::GetFontSize(), {from.x + unit(16), from.y + unit(8)}, faded(ink, alpha),
                     text.c_str(), nullptr, most);
        if (part < 0) return;
        const ImVec2 left{from.x + unit(16), to.y - unit(14)}, right{to.x - unit(16), to.y - unit(10)};
        list.AddRectFilled(left, right, line, unit(2));
        list.AddRectFilled(left, {left.x + (right.x - left.x) * std::min(part, 1.0f), right.y}, accent, unit(2));
    };
    if (!panels.notice.empty()) {
        const ImVec2 extent = ImGui::CalcTextSize(panels.notice.c_str(), nullptr, false, size.x - unit(96));
        box(panels.notice, size.y - unit(32 + 48 + 16) - extent.y, panels.notice_fade, -1);
    }
    if (!panels.progress.empty()) box(panels.progress, 0.5f * size.y - unit(24), 1, panels.progress_part);
}

/// For a panel below some room above it: above the line of status, with as much room below as there is at the sides.
float PanelDrawing::panel_room(float above) const {
    return ImGui::GetIO().DisplaySize.y - unit(32 + 16) - above;
}

bool PanelDrawing::begin_panel(const char* title, float x, float y, float pivot_x, float pivot_y, float width) {
    ImGui::SetNextWindowPos({x, y}, ImGuiCond_Always, {pivot_x, pivot_y});
    ImGui::SetNextWindowSizeConstraints({width, 0}, {width > 0 ? width : 1e6f, panel_room(pivot_y > 0 ? unit(16) : y)});
    constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                       ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                       ImGuiWindowFlags_NoNav;
    const bool open = ImGui::Begin(title, nullptr, flags);
    ImGui::PushFont(title_);
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
    return open;
}

void PanelDrawing::end_panel() {
    ImGui::End();
}

void PanelDrawing::draw_help(Panels& panels) {
    const ImVec2 size = ImGui::GetIO().DisplaySize, padding = ImGui::GetStyle().WindowPadding;
    ImFont* const fonts[] = {text_, small_};
    const HelpLayout layout = lay_out_help(
        panels.help_groups,
        [&](const std::string& text, float font) {
            return text_->CalcTextSizeA(unit(font), 1e6f, 0, text.c_str()).x / scale_;
        },
        (size.x - 2 * padding.x) / scale_, (panel_room(unit(16)) - 2 * padding.y) / scale_ - 24);
    const HelpDensity& density = help_densities[layout.density];
    begin_panel("Keys", 0.5f * size.x, 0.5f * (size.y - unit(32)), 0.5f, 0.5f, 0);
    ImGui::PushFont(fonts[layout.density]);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, unit(density.row_gap)));
    for (std::size_t i = 0; i < layout.columns.size(); ++i) {
        if (i > 0) ImGui::SameLine(0, unit(density.column_gap));
        help_column(layout.columns[i], density);
    }
    ImGui::PopStyleVar();
    ImGui::PopFont();
    end_panel();
}

void PanelDrawing::help_column(const HelpLayout::Column& column, const HelpDensity& density) {
    ImGui::BeginGroup();
    const float left = ImGui::GetCursorPosX();
    for (const HelpGroup& group : column.groups) {
        ImGui::Dummy({0, unit(density.group_gap - density.row_gap)});
        ImGui::TextColored(color(accent), "%s", group.title.c_str());
        for (const HelpLine& help : group.lines) {
            ImGui::TextUnformatted(help.keys.c_str());
            ImGui::SameLine(0, 0);
            ImGui::SetCursorPosX(left + unit(column.keys + density.key_gap));
            ImGui::TextDisabled("%s", help.what.c_str());
        }
    }
    ImGui::EndGroup();
}

void PanelDrawing::draw_settings(Panels& panels) {
    begin_panel("View", unit(16), unit(16), 0, 0, unit(304));
    ImGui::TextDisabled("%s", panels.time_text.c_str());
    // The value beside the name, so that the grab hides no digit.
    const auto slider = [&](const char* name, const char* id, float& value, float low, float high, const char* format) {
        ImGui::TextUnformatted(name);
        char text[32];
        std::snprintf(text, sizeof text, format, static_cast<double>(value));
        ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(text).x);
        ImGui::TextDisabled("%s", text);
        ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(unit(8), 0));
        ImGui::SetNextItemWidth(-1);
        const bool changed = ImGui::SliderFloat(id, &value, low, high, "", ImGuiSliderFlags_NoInput);
        ImGui::PopStyleVar();
        return changed;
    };
    panels.time_changed |= slider("Hour, UTC", "##hour", panels.day_hours, 0, 24, "%.2f");
    panels.time_changed |= slider("Day of year", "##day", panels.year_day, 1, 366, "%.0f");
    panels.exaggeration_changed |= slider("Heights", "##heights", panels.exaggeration, 0, 10, "%.1f \xc3\x97");
    const auto switches = [&](const char* title, std::vector<Switch>& list) {
        if (list.empty()) return;
        ImGui::Dummy({0, unit(4)});
        ImGui::TextColored(color(accent), "%s", title);
        for (Switch& s : list) {
            s.changed |= ImGui::Checkbox(s.name.c_str(), &s.on);
            ImGui::SameLine(unit(264));
            ImGui::TextDisabled("%s", s.key.c_str());
        }
    };
    switches("Layers", panels.layers);
    draw_layer_rows(panels.own_layers);
    switches("Mesh", panels.modes);
    end_panel();
}

void PanelDrawing::draw_layer_rows(std::vector<LayerRow>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        LayerRow& row = rows[i];
        ImGui::PushID(static_cast<int>(i));
        // The box is of the layer's colour, so that a name finds its lines.
        ImGui::PushStyleColor(ImGuiCol_CheckMark, ImVec4(row.color[0], row.color[1], row.color[2], 1));
        row.changed |= ImGui::Checkbox("##on", &row.on);
        ImGui::PopStyleColor();
        ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float height = ImGui::GetFrameHeight();
        ImGui::PushClipRect(at, {at.x + unit(88), at.y + height}, true);
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(row.name.c_str());
        ImGui::PopClipRect();
        ImGui::SameLine(unit(136));
        ImGui::SetNextItemWidth(unit(88));
        row.changed |= ImGui::SliderFloat("##opacity", &row.opacity, 0, 1, "", ImGuiSliderFlags_NoInput);
        const auto arrow = [&](const char* id, ImGuiDir way, bool there, int raise) {
            ImGui::SameLine(0, unit(4));
            if (!there) return ImGui::Dummy({height, height});
            if (!ImGui::ArrowButton(id, way)) return;
            row.raise = raise;
            row.changed = true;
        };
        arrow("##up", ImGuiDir_Up, i > 0, 1);
        arrow("##down", ImGuiDir_Down, i + 1 < rows.size(), -1);
        ImGui::PopID();
    }
}

void PanelDrawing::draw_statistics(Panels& panels) {
    // Below the compass, beside the settings in any window that is wide enough for both.
    begin_panel("Statistics", ImGui::GetIO().DisplaySize.x - unit(16), unit(16 + 48 + 16), 1, 0, unit(304));
    for (const Plot& plot : panels.plots) {
        ImGui::TextDisabled("%s", plot.name.c_str());
        ImGui::SameLine(unit(112));
        const float last = plot.values.empty() ? 0 : plot.values.back();
        ImGui::Text("%.1f %s", static_cast<double>(last), plot.unit.c_str());
        const ImVec2 from = ImGui::GetCursorScreenPos(), extent{unit(272), unit(40)};
        ImGui::Dummy(extent);
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled(from, {from.x + extent.x, from.y + extent.y}, IM_COL32(255, 255, 255, 12));
        const auto y_of = [&](float v) { return from.y + extent.y * (1 - std::clamp(v / plot.top, 0.0f, 1.0f)); };
        const float step = extent.x / 160;
        const std::size_t n = std::min<std::size_t>(plot.values.size(), 160);
        for (std::size_t i = 0; i < n; ++i) {
            const float right = from.x + extent.x - static_cast<float>(n - 1 - i) * step;
            list.AddRectFilled({right - step, y_of(plot.values[plot.values.size() - n + i])},
                               {right, from.y + extent.y}, IM_COL32(255, 196, 84, 170));
        }
        if (plot.marked > 0)
            list.AddLine({from.x, y_of(plot.marked)}, {from.x + extent.x, y_of(plot.marked)},
                         IM_COL32(255, 255, 255, 90));
    }
    for (const std::string& fact : panels.facts) {
        const std::size_t tab = fact.find('\t');
        ImGui::TextDisabled("%s", fact.substr(0, tab).c_str());
        ImGui::SameLine(unit(136));
        ImGui::TextUnformatted(fact.c_str() + std::min(tab, fact.size() - 1) + 1);
    }
    end_panel();
}

void PanelDrawing::draw_go_to(Panels& panels) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    begin_panel("Go to", 0.5f * size.x, unit(96), 0.5f, 0, unit(416));
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1);
    panels.go_to_entered |=
        ImGui::InputTextWithHint("##place", "46.85, -121.76   or   10TES 94 89", &panels.go_to_text,
                                 ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    if (ImGui::IsKeyPressed(ImGui::GetIO().KeyMap[ImGuiKey_Escape])) panels.go_to = false;
    if (panels.go_to_answer.empty())
        ImGui::TextDisabled("Degrees, or an MGRS square. Enter flies there.");
    else
        accent_text_wrapped(panels.go_to_answer);
    panels.wants_frame = true;  // the text cursor blinks
    end_panel();
}

}  // namespace render
