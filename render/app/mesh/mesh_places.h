#pragma once
// Places on the Earth from the coordinates of a mesh, and back.

#include <memory>
#include <string_view>

#include "planet/frames.h"
#include "planet/geodesy/geoid.h"
#include "planet/mesh/surface_mesh.h"

namespace render {

/// Of meshes that are local, Earth-centred, in UTM or in degrees; coordinates as their files have them.
class MeshPlaces {
  public:
    /// @param where the option that needs places, for errors
    /// @param geoid if given, heights above EGM96 become ellipsoidal ones; else they are taken for such as they are
    /// Throws planet::Error(bad_usage) for meshes in another CRS, or none.
    MeshPlaces(const planet::MeshReference& reference, std::string_view where,
               std::shared_ptr<const planet::Geoid> geoid = nullptr);

    /// NaN where the CRS has no place.
    planet::Geodetic geodetic(const glm::dvec3& p) const;
    glm::dvec3 in_mesh(const planet::Geodetic& place) const;

  private:
    planet::Geodetic flat_geodetic(const glm::dvec3& p) const;

    planet::MeshReference reference_;
    std::shared_ptr<const planet::Geoid> geoid_;
    int zone_ = 0;  ///< of UTM; 0: UPS
    bool north_ = true;
};

}  // namespace render
