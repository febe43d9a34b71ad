#pragma once
// A store as an elevation field: the height of the surface that is drawn, and how far it can be from its source.

#include <memory>
#include <optional>

#include "planet/elevation/elevation_field.h"
#include "planet/store/surface_cursor.h"
#include "planet/store/tile_cache.h"

namespace planet {

/// How far a surface can be from the samples it was made of, metres.
struct SurfaceBound {
    double resampling = 0;  ///< of the finest surface: no source sample in the tile is farther from it
    double deviation = 0;   ///< of the level asked for from the finest surface; 0 on the finest
    double total() const { return resampling + deviation; }
};

/// Heights by the planes of the lattice's cells, along the geodetic normal. Safe to read from several threads.
class StoreField final : public ElevationField {
  public:
    /// @param memory_bytes of the tiles kept in memory
    explicit StoreField(std::shared_ptr<const ElevationStore> store, std::size_t memory_bytes = std::size_t{256} << 20);

    VerticalDatum datum() const override { return store_->metadata().datum; }
    /// On the finest surface. Fastest where normals that follow each other are near each other. Not a finite direction:
    /// NaN.
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override;
    /// Of a store that does not say where its heights come from: its first file.
    void heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                              std::span<WeighedOrigin> origins) const override;
    /// Of the lattice: mean vertex spacing of the finest level in the cap.
    double spacing(const Cap& cap) const override;
    /// None: a store keeps the lattice, not the samples.
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override { return store_->metadata().sources; }

    /// On the lattice of a bisection level, or of the finest one there is at that place. Metres above datum().
    float height_at(const glm::dvec3& normal, int bisection_level = max_bisection_level) const;
    /// The bound of height_at() with the same arguments. In a damaged tile the resampling is infinite.
    SurfaceBound bound_at(const glm::dvec3& normal, int bisection_level = max_bisection_level) const;

    const TileCache& cache() const { return cache_; }
    const ElevationStore& store() const { return *store_; }

    /// One thread's way through the surface; the field must outlive it.
    SurfaceCursor cursor() const;

  private:
    int finest_level_in(const Cap& cap, LocationCode root, int known) const;

    std::shared_ptr<const ElevationStore> store_;
    TileCache cache_;
};

}  // namespace planet
