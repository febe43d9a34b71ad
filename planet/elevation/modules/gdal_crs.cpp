#include "planet/elevation/modules/gdal_crs.h"

#include <cpl_conv.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "planet/elevation/modules/gdal_messages.h"
#include "planet/error.h"

namespace planet {
namespace {

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

// 25 places all over the raster, the middle and the corners among them.
std::vector<glm::dvec2> places_on(const RasterHeader& raster) {
    std::vector<glm::dvec2> xy;
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i)
            xy.push_back(raster.grid.crs_from_sample({i * 0.25 * (raster.width - 1), j * 0.25 * (raster.height - 1)}));
    return xy;
}

// Whether x and y are longitude (any turn) and latitude already.
bool is_identity(const std::vector<glm::dvec2>& xy, const std::vector<glm::dvec2>& lonlat) {
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

Transformation make_transformation(const OGRSpatialReference& from, const OGRSpatialReference& to) {
    return {OGRCreateCoordinateTransformation(&from, &to),
            [](OGRCoordinateTransformation* t) { OGRCoordinateTransformation::DestroyCT(t); }};
}

double metres_per_height(const OGRSpatialReference* crs) {
    if (!crs || !crs->IsCompound()) return 1;
    const double metres = crs->GetTargetLinearUnits("VERT_CS");
    return metres > 0 ? metres : 1;
}

std::string vertical_of(const OGRSpatialReference* crs) {
    if (!crs || crs->IsEmpty() || crs->IsLocal()) return {};
    if (!crs->IsCompound()) return crs->GetAxesCount() == 3 ? "ellipsoid" : "";
    const char* const type = crs->GetAttrValue("VERT_DATUM", 1);
    if (type && std::string_view(type) == "2002") return "ellipsoid";  // WKT 1: a height above the ellipsoid
    const char* const authority = crs->GetAuthorityName("VERT_CS");
    const char* const code = crs->GetAuthorityCode("VERT_CS");
    if (authority && code) return std::string(authority) + ":" + code;
    for (const char* node : {"VERT_CS", "VERTCRS"})
        if (const char* name = crs->GetAttrValue(node)) return name;
    return "an unnamed vertical datum";
}

bool read_grid(GDALDataset& dataset, RasterHeader& raster) {
    double g[6];
    if (dataset.GetGeoTransform(g) != CE_None) return false;
    raster.grid = {{g[0] + 0.5 * (g[1] + g[2]), g[3] + 0.5 * (g[4] + g[5])}, {g[1], g[4]}, {g[2], g[5]}};
    const glm::dvec2 last = raster.grid.crs_from_sample({raster.width, raster.height});
    return std::isfinite(last.x + last.y) && std::abs(raster.grid.determinant()) > 0;
}

void set_crs(RasterHeader& raster, OGRSpatialReference& crs, const std::string& path) {
    const GdalMessages messages;
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    crs.StripVertical();
    if (crs.GetAxesCount() == 3) crs.DemoteTo2D(nullptr);
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
    const auto refuse = [&](const std::string& why) {
        throw Error(Fault::bad_data, path, "its CRS cannot be turned into latitude and longitude" + why,
                    "a CRS that PROJ knows");
    };
    if (!forward || !inverse) refuse(": " + messages.last());
    auto transform = std::make_shared<ProjTransform>(std::move(forward), std::move(inverse));
    const std::vector<glm::dvec2> xy = places_on(raster);
    std::vector<glm::dvec2> lonlat = xy;
    transform->geodetic_from_crs(lonlat);
    // PROJ makes transformations of projections it does not know, too; they fail everywhere.
    if (std::all_of(lonlat.begin(), lonlat.end(), [](glm::dvec2 p) { return std::isnan(p.x); }))
        refuse(" anywhere on the raster");
    if (!(crs.IsGeographic() && is_identity(xy, lonlat))) raster.transform = std::move(transform);
}

}  // namespace planet
