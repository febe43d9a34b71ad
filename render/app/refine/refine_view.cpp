#include "render/app/refine/refine_view.h"

#include <cmath>
#include <limits>

#include "planet/error.h"
#include "planet/frames.h"
#include "render/app/mesh/mesh_places.h"

namespace render {

glm::dvec3 eye_of(const RefineView& view, const planet::Progressive& mesh, const RefineMeaning& meaning) {
    const bool ecef = meaning.reference.frame == planet::MeshFrame::ecef;
    const glm::dvec3 foot = meaning.in_metres(MeshPlaces(meaning.reference, "--view").in_mesh(view.place));
    if (std::isnan(foot.x))
        throw planet::Error(planet::Fault::bad_usage, "--view", "the mesh's CRS does not reach that place",
                            "a place nearer to the mesh");
    const glm::dvec3 up =
        ecef ? planet::normal_from_geodetic(view.place.latitude, view.place.longitude) : glm::dvec3(0, 0, 1);
    double nearest = std::numeric_limits<double>::infinity(), height = 0;
    for (const glm::dvec3& p : mesh.places()) {
        const glm::dvec3 away = p - foot;
        const double above = glm::dot(away, up), across = glm::length(away - above * up);
        // Not the other side of a planet.
        if ((ecef && glm::dot(p, up) < 0) || across >= nearest) continue;
        nearest = across;
        height = above;
    }
    return foot + (height + view.range) * up;
}

bool seen_coarse(const planet::Progressive& mesh, planet::Progressive::Index vertex, const glm::dvec3& eye) {
    const planet::SplitSide side = mesh.ends(vertex);
    const glm::dvec3 a = mesh.place(side.a), b = mesh.place(side.b);
    return glm::distance(a, b) > view_share * glm::distance(eye, (a + b) * 0.5);
}

}  // namespace render
