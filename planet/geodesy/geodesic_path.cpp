#include "planet/geodesy/geodesic_path.h"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/GeodesicLine.hpp>
#include <algorithm>
#include <cassert>

#include "planet/error.h"
#include "planet/geodesy/geodetic.h"

namespace planet {

struct GeodesicPath::Lines {
    std::vector<GeographicLib::GeodesicLine> legs;
};

GeodesicPath::GeodesicPath(const Geodesics& geodesics, std::span<const Geodetic> places) : ends_{0} {
    assert(places.size() >= 2);
    const GeographicLib::Geodesic geodesic(geodesics.ellipsoid().a, geodesics.ellipsoid().f);
    auto lines = std::make_shared<Lines>();
    for (std::size_t i = 1; i < places.size(); ++i) {
        const Geodetic &p = places[i - 1], &q = places[i];
        lines->legs.push_back(geodesic.InverseLine(latitude_degrees(p.latitude), p.longitude / degrees,
                                                   latitude_degrees(q.latitude), q.longitude / degrees));
        ends_.push_back(ends_.back() + lines->legs.back().Distance());
    }
    if (!std::isfinite(length()))
        throw Error(Fault::bad_usage, "path", "goes through a place that is none", "latitudes -90 to 90, all finite");
    lines_ = std::move(lines);
}

GeodesicPoint GeodesicPath::at(double distance_m) const {
    const double s = std::clamp(distance_m, 0.0, length());
    const auto after = std::upper_bound(ends_.begin() + 1, ends_.end() - 1, s);
    const auto leg = static_cast<std::size_t>(after - ends_.begin()) - 1;
    double latitude = 0, longitude = 0, azimuth = 0;
    lines_->legs[leg].Position(s - ends_[leg], latitude, longitude, azimuth);
    return {latitude * degrees, longitude * degrees, azimuth * degrees};
}

}  // namespace planet
