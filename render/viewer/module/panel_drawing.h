#pragma once
// Panels drawn by Dear ImGui.

#include <memory>

#include "render/viewer/help_layout.h"

struct GLFWwindow;
struct ImDrawList;
struct ImFont;

namespace render {

class PanelDrawing {
  public:
    /// After the window's own callbacks are set. @param scale pixels of the display in one of the panels' units
    PanelDrawing(GLFWwindow* window, double scale);
    ~PanelDrawing();
    PanelDrawing(const PanelDrawing&) = delete;
    PanelDrawing& operator=(const PanelDrawing&) = delete;

    void draw(Panels& panels);

    /// Whether a widget wants what the user types, or what the mouse does.
    static bool takes_keys();
    static bool takes_mouse();

  private:
    void draw_overlay(Panels& panels);
    void draw_status(Panels& panels);
    void draw_scale_bar(const Panels& panels);
    void draw_compass(Panels& panels);
    void draw_notice(const Panels& panels);
    void draw_help(Panels& panels);
    void help_column(const HelpLayout::Column& column, const HelpDensity& density);
    void draw_settings(Panels& panels);
    void draw_layer_rows(std::vector<LayerRow>& rows);
    void draw_statistics(Panels& panels);
    void draw_go_to(Panels& panels);
    bool begin_panel(const char* title, float x, float y, float pivot_x, float pivot_y, float width);
    float panel_room(float above) const;
    void end_panel();
    float unit(float u) const { return u * scale_; }

    float scale_;
    ImFont *text_ = nullptr, *small_ = nullptr, *title_ = nullptr;
};

}  // namespace render
