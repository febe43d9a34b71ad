#pragma once
// What a viewer loads before there is a globe, beside its window.

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "render/app/picture/drawn_surface.h"
#include "render/app/picture/earth_store.h"
#include "render/app/picture/imagery.h"
#include "render/app/picture/layer_data.h"
#include "render/app/picture/render_options.h"
#include "render/sky/stars.h"

namespace render {

struct GlobeData {
    std::unique_ptr<DrawnSurface> surface;
    Imagery imagery;
    std::vector<Star> stars;
    std::vector<std::vector<std::uint8_t>> noise;
    LayerData layers;
};

/// Loads on a thread of its own.
class GlobeLoading {
  public:
    /// @param options must outlive this
    explicit GlobeLoading(const RenderOptions& options);
    /// Gives up at the next step that tells of its progress, and waits for that.
    ~GlobeLoading();

    bool ready() const { return wait(std::chrono::milliseconds(0)); }
    /// Waits for no longer than that until it is.
    bool wait(std::chrono::milliseconds most) const { return data_.wait_for(most) == std::future_status::ready; }
    /// Once it is ready. Throws what the loading threw.
    GlobeData take() { return data_.get(); }

    struct Progress {
        std::string step;
        double part = 0;  ///< 0..1, or NaN
    };
    Progress progress() const;

  private:
    GlobeData load();
    void note(std::string_view step, double part);

    const RenderOptions& options_;
    std::atomic<bool> given_up_ = false;
    mutable std::mutex mutex_;
    Progress progress_{"opening", 0};
    std::future<GlobeData> data_;  // last: uses the above
};

}  // namespace render
