#pragma once
// The surface that is drawn, and where the eye stands above it.

#include <memory>
#include <optional>

#include "planet/geodesy/geoid.h"
#include "planet/store/store_field.h"
#include "planet/streaming/store_tiles.h"
#include "render/app/picture/render_options.h"
#include "render/layers/draped_lines.h"
#include "render/picture/camera.h"
#include "render/picture/relief_patches.h"

namespace render {

struct DrawnSurface {
    std::shared_ptr<const planet::ElevationStore> store;
    double exaggeration;
    planet::StoreField field;
    planet::StoreTiles tiles;
    std::optional<planet::Geoid> geoid;  ///< a store that knows no geoid is drawn on the ellipsoid

    DrawnSurface(std::shared_ptr<const planet::ElevationStore> store, const RenderOptions& options);

    /// What normals per pixel are made from. Refers to this.
    PatchSurface for_patches() const;
    /// The radius of a ball about the planet's centre below all terrain, m.
    double occluder_radius() const;
    /// What layers lie on in a part of a picture. Refers to this and to the segments.
    /// @param scale see RenderOptions
    DrapeGround for_layers(const planet::Segments& segments, const Camera& camera, const PicturePart& part,
                           double scale) const;
    /// The drawn ground at a unit geodetic normal, exaggeration and geoid included: metres above the ellipsoid.
    double ground(const glm::dvec3& normal) const { return ground(normal, exaggeration); }
    /// The same were it drawn with another exaggeration.
    double ground(const glm::dvec3& normal, double exaggerated) const;
    /// An eye, ecef, or where it is that far above the ground of ground(normal, exaggerated) if it is lower.
    glm::dvec3 above_ground(const glm::dvec3& eye, double exaggerated, double clearance_m) const;
    /// The camera of a picture: over the ground as it is drawn, exaggeration and geoid included, never below it.
    Camera camera(const RenderOptions& options) const;
};

}  // namespace render
