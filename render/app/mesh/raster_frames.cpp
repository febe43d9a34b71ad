#include "render/app/mesh/raster_frames.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "planet/error.h"
#include "render/app/data_path.h"

namespace render {

using planet::MeshFormat;
using planet::MeshFrame;

MeshFrame usual_frame(MeshFormat format) {
    return format == MeshFormat::glb || format == MeshFormat::stl ? MeshFrame::enu : MeshFrame::source;
}

planet::RasterFrame frame_of_raster(std::shared_ptr<const planet::Raster> raster, MeshFrame frame,
                                    planet::VerticalDatum datum, double exaggeration) {
    const bool needs_ellipsoidal = frame == MeshFrame::enu || frame == MeshFrame::ecef;
    std::shared_ptr<const planet::Geoid> geoid;
    if (needs_ellipsoidal && !raster->plain && datum == planet::VerticalDatum::egm96)
        geoid = std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm"));
    return {std::move(raster), frame, datum, geoid, exaggeration};
}

bool is_nowhere(const glm::dvec3& place) {
    return std::isnan(place.x + place.y);
}

void check_reach(const planet::RasterFrame& frame, const planet::RasterHeader& raster) {
    std::vector<glm::dvec2> at;
    for (const double row : {0, raster.height - 1})
        for (int column = 0; column < raster.width; ++column) at.emplace_back(column, row);
    for (const double column : {0, raster.width - 1})
        for (int row = 0; row < raster.height; ++row) at.emplace_back(column, row);
    const std::vector<double> heights(at.size());
    std::vector<glm::dvec3> places(at.size());
    frame.place(at, heights, places, {});
    if (std::ranges::any_of(places, is_nowhere)) refuse_reach(raster.name);
}

void refuse_reach(const std::string& raster) {
    throw planet::Error(planet::Fault::bad_usage, "--frame", "does not reach all of " + raster,
                        "another frame, e.g. source");
}

}  // namespace render
