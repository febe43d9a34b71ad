#pragma once
// The state of a viewer's window; viewer.cpp has its loop, viewer_panels.cpp what its panels say.

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/app/view/globe_data.h"
#include "render/app/view/live_mesh.h"
#include "render/app/view/view_frame.h"
#include "render/app/view/viewer.h"
#include "render/gl/context.h"
#include "render/gl/window.h"
#include "render/viewer/frame_pace.h"
#include "render/viewer/ground_pick.h"
#include "render/viewer/keys.h"
#include "render/viewer/navigator.h"
#include "render/viewer/panels.h"
#include "render/viewer/place_text.h"

namespace render {

class ViewerSession {
  public:
    explicit ViewerSession(const ViewerOptions& options);
    ViewerReport run();

  private:
    /// A window and its context; in this order they go last.
    struct Stage {
        std::unique_ptr<Window> window;
        Context context;
    };
    static Stage open_stage(const ViewerOptions& options);

    // viewer.cpp
    bool load();
    void begin();
    void warn();
    bool step();
    Steering steering() const;
    void step_view(double dt);
    void update_globe();
    void draw();
    void present();
    bool finish_when_done();
    void fill_report();
    void save_screenshot();
    void count_errors();
    Lens lens() const;
    double patience() const;
    Camera shown_camera() const { return resting_ ? data_.surface->camera(*resting_) : camera_; }
    void draw_labels();
    std::optional<glm::dvec3> point_under(const glm::dvec3& origin, const glm::dvec3& way);
    std::optional<glm::dvec3> mesh_at(const glm::dvec2& pixel) const;
    /// Whether the frames that were asked for are still being drawn.
    bool counts_frames() const { return report_.frames < static_cast<std::uint64_t>(options_.frames); }
    bool automatic() const { return options_.frames > 0 || !options_.screenshot.empty(); }

    // viewer_actions.cpp
    void act(Action action);
    void set_time(planet::UtcTime time);
    void set_exaggeration(double factor);
    void show_layers();
    void toggle(Overlay overlay);
    void toggle_frozen();
    void copy_view();
    void save_picture();
    void go_to_typed();

    // viewer_panels.cpp
    void fill_panels();
    void fill_status();
    std::string text_under_cursor(const Pose& pose, const Lens& lens);
    void fill_statistics();
    void fill_settings();
    void take_panel_changes();
    void take_layer_changes();
    void notice(std::string text);

    const ViewerOptions& options_;
    RenderOptions render_;  ///< as the user has changed it
    Stage stage_;
    Window& window_ = *stage_.window;
    Panels panels_;

    std::optional<GlobeLoading> loading_;
    GlobeData data_;
    GlobeLooks looks_;
    std::optional<LiveMesh> mesh_;
    LiveAir air_;
    ViewFrame frame_;
    GroundPick pick_;
    std::optional<FramePace> pace_;
    std::optional<Navigator> navigator_;
    std::optional<planet::Culling> frozen_;

    // The view of this step, and whether it rests.
    Camera camera_;
    std::optional<RenderOptions> resting_;  ///< what the settled picture is of
    double moved_at_ = 0;                   ///< seconds on the window's clock
    bool mesh_changed_ = true, air_changed_ = true, look_changed_ = true;
    bool started_still_ = false;  ///< the settled picture has been begun
    bool picture_new_ = false;    ///< to be shown

    glm::dvec2 cursor_{-1};
    PlaceFormat place_format_ = PlaceFormat::degrees;
    std::vector<Sight> places_;  ///< to go back to
    double notice_ends_ = -1e9;  ///< seconds on the window's clock
    bool leaving_ = false, input_ = true;
    bool worked_ = true;  ///< the last turn of the loop drew something
    bool save_next_ = false, saved_ = false;

    std::deque<double> frame_seconds_, update_seconds_;
    std::vector<double> all_frame_seconds_, all_update_seconds_;
    double last_step_ = 0, last_swap_ = 0, last_preview_ = 0;
    ViewerReport report_;
};

}  // namespace render
