#pragma once
// Polygons that say which triangles of a mesh are refined.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planet/bisection/bisection.h"
#include "planet/elevation/features.h"
#include "render/app/mesh/mesh_places.h"
#include "render/app/refine/refine_base.h"

namespace render {

class RefineRegion {
  public:
    /// Reads the polygons in the mesh's CRS; of a local or Earth-centred mesh in longitude and latitude; of one without a CRS
    /// in the coordinates that both files have. Throws planet::Error(bad_data) for a file without polygons.
    RefineRegion(const std::string& path, const RefineMeaning& meaning);

    /// Whether a triangle and a polygon have a point in common. Sides are straight in the polygons' coordinates.
    bool meets(const planet::TrianglePlaces& triangle) const;

  private:
    struct Area {
        std::vector<std::vector<glm::dvec2>> rings;  ///< closed
        glm::dvec2 low, high;
    };
    glm::dvec2 in_plan(const glm::dvec3& p) const;
    bool near_pole(const std::array<glm::dvec2, 3>& triangle) const;

    RefineMeaning meaning_;
    std::optional<MeshPlaces> places_;  ///< of local and Earth-centred meshes
    bool turns_ = false;                ///< x is a longitude
    std::vector<Area> areas_;
};

}  // namespace render
