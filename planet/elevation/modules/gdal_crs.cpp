#include "planet/elevation/modules/gdal_crs.h"

#include <cpl_conv.h>

#include <mutex>
#include <vector>

#include "planet/elevation/modules/gdal_messages.h"
#include "planet/error.h"

namespace planet {
namespace {

using Transformation = std::unique_ptr<OGRCoordinateTransformation, void (*)(OGRCoordinateTransformation*)>;

Transformation make_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to) {
    return {OGRCreateCoordinateTransformation(&from, &to),
            [](OGRCoordinateTransformation* t) { OGRCoordinateTransformation::DestroyCT(t); }};
}

// A PROJ transformation belongs to one thread at a time.
class ProjTransform : public CoordinateTransform {
  public:
    ProjTransform(Transformation forward, Transformation inverse)
        : forward_(std::move(forward)), inverse_(std::move(inverse)) {}

    void crs_from_geodetic(std::span<glm::dvec2> points) const override { apply(*forward_, points); }
    void geodetic_from_crs(std::span<glm::dvec2> points) const override { apply(*inverse_, points); }

  private:
    void apply(OGRCoordinateTransformation& t, std::span<glm::dvec2> points) const {
        const std::lock_guard lock(mutex_);
        const GdalMessages quiet;
        std::vector<double> x(points.size()), y(points.size());
        std::vector<int> ok(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) x[i] = points[i].x, y[i] = points[i].y;
        t.Transform(static_cast<int>(points.size()), x.data(), y.data(), nullptr, ok.data());
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool good = ok[i] && std::isfinite(x[i]) && std::isfinite(y[i]);
            points[i] = good ? glm::dvec2(x[i], y[i]) : glm::dvec2(nan, nan);
        }
    }

    mutable std::mutex mutex_;
    Transformation forward_, inverse_;
};

// Whether x and y are longitude (any turn) and latitude already, tried over the whole raster.
bool is_identity(const Raster& raster, const CoordinateTransform& transform) {
    std::vector<glm::dvec2> xy;
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i)
            xy.push_back(raster.grid.crs_from_sample({i * 0.25 * (raster.width - 1), j * 0.25 * (raster.height - 1)}));
    std::vector<glm::dvec2> lonlat = xy;
    transform.geodetic_from_crs(lonlat);
    for (std::size_t i = 0; i < xy.size(); ++i) {
        if (std::isnan(lonlat[i].x) || std::abs(xy[i].y - lonlat[i].y) > 1e-9) return false;
        if (std::abs(std::remainder(xy[i].x - lonlat[i].x, 360)) > 1e-9 && std::abs(xy[i].y) < 90 - 1e-9) return false;
    }
    return true;
}

std::string name_of_crs(const OGRSpatialReference& crs) {
    const char* authority = crs.GetAuthorityName(nullptr);
    const char* code = crs.GetAuthorityCode(nullptr);
    if (authority && code) return std::string(authority) + ":" + code;
    char* text = nullptr;
    const char* const options[] = {"FORMAT=WKT2_2018", "MULTILINE=NO", nullptr};
    crs.exportToWkt(&text, options);
    std::string wkt = text ? text : "";
    CPLFree(text);
    return wkt;
}

}  // namespace

void set_crs(Raster& raster, OGRSpatialReference& crs, const std::string& path) {
    const GdalMessages messages;
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    crs.StripVertical();
    raster.crs = name_of_crs(crs);
    raster.radius_m = crs.GetSemiMajor();
    OGRSpatialReference wgs84;
    wgs84.SetWellKnownGeogCS("WGS84");
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    if (crs.IsSame(&wgs84)) return;

    // Another planet has no way to WGS84: its rasters are read in its own latitude and longitude.
    OGRSpatialReference geographic = wgs84;
    if (std::abs(raster.radius_m - wgs84.GetSemiMajor()) > 0.01 * wgs84.GetSemiMajor()) {
        const std::unique_ptr<OGRSpatialReference> own(crs.CloneGeogCS());
        if (own) geographic = *own;
        geographic.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        if (crs.IsSame(&geographic)) return;
    }
    Transformation forward = make_transformation(geographic, crs);
    Transformation inverse = make_transformation(crs, geographic);
    if (!forward || !inverse)
        throw Error(Fault::bad_data, path, "its CRS cannot be turned into latitude and longitude: " + messages.last(),
                    "a CRS that PROJ knows");
    auto transform = std::make_shared<ProjTransform>(std::move(forward), std::move(inverse));
    if (!(crs.IsGeographic() && is_identity(raster, *transform))) raster.transform = std::move(transform);
}

}  // namespace planet
