#pragma once
// From a raster's samples to the frame in which a mesh of it is written.

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/raster.h"
#include "planet/geodesy/geoid.h"
#include "planet/geodesy/local_frame.h"
#include "planet/geodesy/utm_parallels.h"
#include "planet/mesh/surface_mesh.h"

namespace planet {

class RasterFrame {
  public:
    /// @param datum of the raster's heights; source and utm keep them as they are, enu and ecef need heights above the
    ///        ellipsoid @param geoid for datum egm96 with enu and ecef; else may be null
    /// @param exaggeration heights are multiplied by it, above 0; those above the geoid before they become ellipsoidal
    /// Heights of a raster on another planet are of no datum here, and it has no utm, enu or ecef: Error(bad_usage).
    /// A raster that is `plain` has its own coordinates in enu too, and no utm or ecef: Error(bad_usage).
    RasterFrame(std::shared_ptr<const Raster> raster, MeshFrame frame, VerticalDatum datum,
                std::shared_ptr<const Geoid> geoid, double exaggeration = 1);

    /// The same frame for a window of the raster: column and row count from its first sample. Places have the same bits.
    RasterFrame window(glm::ivec2 first) const {
        RasterFrame out(*this);
        out.first_ += glm::dvec2(first);
        return out;
    }

    const MeshReference& reference() const { return reference_; }
    /// Whether x and y are affine in column and row, and up is z: deviations are those of the lattice.
    bool affine() const { return affine_; }
    /// Whether counter-clockwise in the lattice (column right, row up) is clockwise seen from above.
    bool mirrored() const { return raster_->grid.determinant() < 0; }
    /// Of x and y where they are affine.
    SampleGrid grid() const {
        return {raster_->grid.crs_from_sample(first_), raster_->grid.per_column, raster_->grid.per_row};
    }
    double exaggeration() const { return exaggeration_; }
    /// Metres in a unit of x and of y, near the middle of the raster.
    glm::dvec2 metres_per_unit() const;

    /// Places samples or points between them. All spans of one length. @param at (column, row) @param height of the
    /// source, metres @param up empty, or the vertical there. NaN where the frame does not reach: utm far from its zone,
    /// or a CRS beyond its bounds.
    void place(std::span<const glm::dvec2> at, std::span<const double> height, std::span<glm::dvec3> position,
               std::span<glm::vec3> up) const;

  private:
    struct Longitude {
        double radians, cosine, sine;
    };
    /// With the distances from the foot of a normal along it to the axis and to the plane of the equator, metres.
    struct Latitude {
        double radians, cosine, sine, to_axis, to_equator;
    };
    /// Where columns are meridians and rows parallels: so that samples need no trigonometry.
    struct Graticule {
        std::vector<Longitude> column;
        std::vector<Latitude> row;
    };

    void set_local_frame();
    bool is_graticule() const;
    void set_graticule();
    void set_parallels();
    bool is_sample(const glm::dvec2& at) const;
    static Longitude longitude_of(double degrees_east);
    static Latitude latitude_of(double degrees_north);
    UtmParallels::Place on_parallel(const glm::dvec2& at) const;
    UtmParallels::Place in_utm(const glm::dvec2& degrees_east_north) const;
    void place_in_utm(std::span<const glm::dvec2> at, std::span<const double> height, std::span<glm::dvec3> position,
                      std::span<glm::vec3> up) const;
    void geodetic(std::span<const glm::dvec2> at, std::span<glm::dvec2> longitude_latitude) const;
    bool all_in_graticule(std::span<const glm::dvec2> at) const;
    template <class LongitudeOf, class LatitudeOf>
    void place_at(const LongitudeOf& longitude, const LatitudeOf& latitude, std::span<const double> height,
                  std::span<glm::dvec3> position, std::span<glm::vec3> up) const;
    void place_on_ellipsoid(std::span<const glm::dvec2> at, std::span<const double> height,
                            std::span<glm::dvec3> position, std::span<glm::vec3> up) const;

    std::shared_ptr<const Raster> raster_;
    VerticalDatum datum_;
    std::shared_ptr<const Geoid> geoid_;
    MeshReference reference_;
    double exaggeration_;
    glm::dvec2 first_{0};  ///< of the window
    bool affine_;
    LocalFrame local_{wgs84, Geodetic{}};
    std::shared_ptr<const Graticule> graticule_;     ///< may be null
    std::shared_ptr<const UtmParallels> parallels_;  ///< of a graticule in utm; may be null
    int zone_ = 0;
    bool north_ = true;
};

}  // namespace planet
