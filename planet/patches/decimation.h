#pragma once
// Decimation by priority: from a full triangulation, vertices are removed, cheapest first, each with its merging domain
// and at the cost of all of it. After Balmelli, Kovacevic and Vetterli, "Solving the Coplanarity Problem of Regular Embedded
// Triangulations": the "true" cost of a removal is that of the whole domain.
//
//   max   the largest deviation in the full domain: saturated, so that a vertex costs at least what any vertex that depends
//         on it costs, whatever the mesh. Decimation to a cost is the walk "split iff the saturated deviation > cost".
//   rms   squared deviation added, m^2, per triangle removed, in the present mesh. May be negative. (At the raster's border
//         a removal can save no triangle: it is then free, or never made if it adds to the deviation.)
//
// Squared deviations and triangles of a mesh are sums over its leaves. What a removal changes is a sum over its *maximal
// merged* triangles: in each, one triangle for all the leaves below it. Those differences are kept for every cell, exact at
// all times: a merged triangle takes its own from the cells above it. A domain is then costed by visiting its maximal
// merged triangles only, constantly many in expectation, and nothing below them.
//
// Costs change as the mesh does. Of the vertices that a removed vertex depends on, none gets cheaper: what is left of its
// domain is dearer than what was removed, or it would have been cheaper than that before. They are costed again when
// their turn comes by their old cost, and wait if it has grown. Others can get cheaper, where a removal has taken a dear
// part of their domain: those are costed at once, from the domain's border upwards as long as costs fall. (A cost that fell
// above one that did not is noticed late: then the order is not strictly cheapest first, though every cost paid is true.)

#include <functional>
#include <limits>
#include <span>

#include "planet/patches/squared_deviation.h"

namespace planet {

enum class DecimationPriority { max, rms };

/// Ends as soon as either limit holds, or nothing is left to remove.
struct DecimationOptions {
    DecimationPriority priority = DecimationPriority::rms;
    /// Removes until there are at most so many (as triangles_of_leaf counts).
    std::size_t max_triangles = 0;
    /// Removes nothing dearer: m (max), m^2 a triangle (rms).
    double max_cost = std::numeric_limits<double>::infinity();
    /// Vertices that stay, with all that they depend on. Samples that are no vertices of the given mesh are ignored.
    std::span<const glm::ivec2> keep = {};
    /// Told now and then which part of the triangles to be removed are, 0..1.
    std::function<void(double)> progress = {};
};

struct DecimationReport {
    std::size_t triangles_before = 0, triangles = 0;
    std::size_t removals = 0;        ///< each of a vertex with its domain
    std::size_t costed_domains = 0;  ///< how often a cost was worked out; 0 for max
    double highest_cost = 0;         ///< of a removal, as max_cost
    double rms_m = 0;                ///< over the raster's valid samples; rms only, else 0
};

/// The largest deviation of a diamond's cells and of everything that depends on it: by cell, the same for both cells of a
/// diamond, and never less than further down. A mesh of the cells for which it exceeds a tolerance is conforming.
DenseQuadtree<float> saturated(const PatchGrid& grid, const DenseQuadtree<float>& deviation);

/// Cells that mix valid and void samples stay split. What weighs nothing (padding, voids) goes first under `rms`.
/// Deterministic: costs are compared as floats, equal ones go finest first, then by code. Throws Error(bad_usage) for a max_cost that is no number.
/// @param mesh conforming; the full triangulation to reach any other
/// @param deviation as patch_deviations(raster) gives it
DecimationReport decimate(PatchTriangulation& mesh, const PatchRaster& raster, const DenseQuadtree<float>& deviation,
                          const DecimationOptions& options);

}  // namespace planet
