#include "planet/geodesy/local_frame.h"

#include "planet/geodesy/geodetic.h"

namespace planet {

LocalFrame::LocalFrame(const Ellipsoid& e, const Geodetic& origin)
    : origin_(ecef_from_geodetic(e, origin)), axes_(planet::ecef_from_enu(origin.latitude, origin.longitude)) {}

glm::dmat4 LocalFrame::ecef_from_enu_matrix() const {
    glm::dmat4 m(axes_);
    m[3] = glm::dvec4(origin_, 1);
    return m;
}

glm::dmat4 LocalFrame::enu_from_ecef_matrix() const {
    const glm::dmat3 back = glm::transpose(axes_);
    glm::dmat4 m(back);
    m[3] = glm::dvec4(-(back * origin_), 1);
    return m;
}

}  // namespace planet
