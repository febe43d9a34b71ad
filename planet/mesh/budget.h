#pragma once
// A limit of triangles: how fine a view may be.

#include <cstddef>

#include "planet/mesh/segment_tree.h"

namespace planet {

/// What a limit of triangles leaves of a view's K.
struct TriangleBudget {
    double K;
    /// Triangles of the segments in view at that K, as Segments::leaf_count() will say.
    std::size_t triangles;
    /// >= 1, the K wanted over the K given: the picture's largest projected deviation is certified to be at most
    /// max_pixel_deviation times this.
    double coarsening;
};

/// The largest K of view.test.K * 2^(-j/70), j = 0, 1, ... whose picture is found to have at most so many triangles. Of two
/// limits the larger one never gives the smaller K. Counts leaves, builds nothing; tiles are looked at as by
/// Segments::build(), of coarser meshes than the view wants, too. The same for any number of threads.
/// Throws Error(bad_usage) if the view has more triangles at K = 0 than allowed.
TriangleBudget fit_triangles(const TileSource& tiles, SegmentView view, std::size_t max_triangles, int threads = 1);

/// The triangles of the segments in view, or any number above `limit` if there are more.
std::size_t count_triangles(const TileSource& tiles, const SegmentView& view, std::size_t limit, int threads = 1);

/// For moving eyes: K in steps of 2^(1/4), one a frame, and not back and forth.
class BudgetSteps {
  public:
    /// @param triangles of the last frame @param max_triangles > 0
    void after_frame(std::size_t triangles, std::size_t max_triangles);

    /// What to multiply the wanted K with, and the pixel deviation to divide by: 2^(-step/4).
    double factor() const;
    int step() const { return step_; }

  private:
    int step_ = 0;
};

}  // namespace planet
