#pragma once
// Meshes in another frame than that of their file.

#include <optional>

#include "render/app/mesh/mesh_places.h"
#include "render/app/refine/refine_base.h"

namespace render {

/// The frame asked for, else that of the mesh, else, where a format cannot hold that, a local one.
planet::MeshFrame frame_for(const std::optional<planet::MeshFrame>& asked, const planet::MeshReference& reference,
                            planet::MeshFormat format);

class FrameChange {
  public:
    /// @param mesh as its file has it: a local frame begins below its middle
    /// Throws planet::Error(bad_usage) if the mesh is at no known place, or for frame source.
    FrameChange(const planet::MeshReference& from, planet::MeshFrame to, const planet::SurfaceMesh& mesh);

    const planet::MeshReference& reference() const { return to_; }
    /// Throws planet::Error(bad_usage) if the frame does not reach all vertices.
    void apply(planet::SurfaceMesh& mesh, planet::MeshLooks& looks) const;

  private:
    glm::dvec3 changed(const glm::dvec3& p) const { return to_places_->in_mesh(from_places_->geodetic(p)); }

    planet::MeshReference from_, to_;
    std::optional<MeshPlaces> from_places_, to_places_;
};

}  // namespace render
