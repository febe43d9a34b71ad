#pragma once
// The mesh and the air of a moving view: what is there now is drawn now, and what is missing is asked for. At rest both
// come to be, bit by bit, what a picture of the view has.

#include <chrono>
#include <future>
#include <optional>

#include "planet/mesh/budget.h"
#include "planet/mesh/segments.h"
#include "planet/streaming/mesh_ahead.h"
#include "planet/streaming/resident_tiles.h"
#include "render/app/picture/drawn_surface.h"
#include "render/sky/atmosphere.h"
#include "render/viewer/patch_cache.h"

namespace render {

class LiveMesh {
  public:
    /// Both must outlive it.
    LiveMesh(const RenderOptions& options, const DrawnSurface& surface, std::size_t patch_capacity);

    struct Wanted {
        const Camera& camera;                      ///< of the whole view, in full size
        glm::dvec3 velocity_m_s{0};                ///< of the eye, ecef; 0: as it went since the last update
        bool at_rest = false;                      ///< as fine as a picture, whatever it takes
        std::size_t max_triangles = 1'000'000;     ///< while it moves
        std::optional<planet::Culling> culling{};  ///< instead of the camera's: to look at it from outside
    };
    /// One step. Returns whether the mesh has changed.
    bool update(const Wanted& wanted) { return step(wanted, false); }
    /// While the mesh of the last update is drawn, another thread makes that of the next, if the motion goes on as it is.
    /// What can be asked stays as it is but for tiles(), which are not to be looked at until the next update.
    void make_next();
    /// The same for a view that is known, to be settled.
    void make_next(const Camera& camera);
    /// After update(): whether patches came, or the mesh has changed. Takes time for at most `most` patches.
    bool update_patches(bool mesh_changed, std::size_t most);

    /// The mesh of a picture with its patches, whatever was seen before; waits for all it needs. Of a view that moves on
    /// (Wanted::velocity_m_s) what comes next is loaded ahead.
    void settle(Wanted wanted);

    /// At rest, with nothing missing: the mesh of a picture.
    bool complete() const;
    /// Heights are placed anew by DrawnSurface::exaggeration.
    void place_anew();

    const planet::Segments& segments() const { return segments_; }
    const planet::TileSource& tiles() const { return tiles_; }
    const PatchCache& patches() const { return patches_; }
    /// K if vertices morph, else 0: only where the budget leaves more than a pixel of deviation.
    double morph_reach() const { return view_.morph ? view_.test.K : 0; }
    double pixel_deviation() const;
    double deviation_m() const;
    const planet::Residency& residency() const { return residency_; }
    const planet::ResidentCounts& counts() const { return counts_; }
    double update_seconds() const { return update_seconds_; }
    bool exhausted() const { return steps_.step() > 0; }

  private:
    bool step(const Wanted& wanted, bool wait);
    void begin_next(const planet::SegmentView& next);
    std::optional<planet::SegmentView> view_ahead(const planet::SegmentView& view) const;
    std::size_t most_tiles() const;
    planet::SegmentView view_of(const Wanted& wanted) const;

    const RenderOptions& options_;
    const DrawnSurface& surface_;
    planet::ResidentTiles tiles_;
    planet::Segments segments_;
    planet::MeshAhead mesh_ahead_{tiles_, segments_};
    planet::SegmentView view_, view_before_;  ///< of the last two updates
    bool goes_on_ = false;                    ///< a motion, which began before the last update
    glm::dvec3 velocity_m_s_{0};
    double frame_seconds_ = 0;
    planet::Residency residency_;
    planet::ResidentCounts counts_;
    planet::BudgetSteps steps_;
    PatchCache patches_;
    std::optional<planet::Culling> seen_;           ///< of the last update
    std::optional<planet::TriangleBudget> fitted_;  ///< of the view at rest
    double angle_factor_ = 1;                       ///< of segment_angle
    double coarsening_ = 1;                         ///< what the budget left of the deviation wanted
    bool at_rest_ = false;
    std::chrono::steady_clock::time_point updated_{};
    double update_seconds_ = 0;
};

/// The tables of the air for an eye and a sun that move: one is made beside the drawing, always for the latest.
class LiveAir {
  public:
    explicit LiveAir(unsigned threads) : threads_(threads) {}

    /// The table that has become ready, if any. Asks for the one given unless it is there or on its way; while the eye
    /// moves, only so often that processors have time for the rest.
    std::optional<ViewTable> update(const glm::dvec3& eye, planet::UtcTime time, bool moving);
    /// Whether the last table handed out is for just these.
    bool is_for(const glm::dvec3& eye, planet::UtcTime time) const { return done_ == Key{eye, time}; }
    const AtmosphereTables& tables() const { return tables_; }

  private:
    struct Key {
        glm::dvec3 eye{0};
        planet::UtcTime time{};
        friend bool operator==(const Key&, const Key&) = default;
    };
    unsigned threads_;
    AtmosphereTables tables_ = make_tables();
    std::optional<Key> done_, making_;
    std::chrono::steady_clock::time_point begun_{};
    std::future<ViewTable> table_;  // last: uses tables_
};

}  // namespace render
