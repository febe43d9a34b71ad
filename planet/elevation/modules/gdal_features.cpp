// The module octaglobe_gdal: points, lines and polygons through OGR, GDAL's half for vector files.

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <span>

#include "planet/elevation/features.h"
#include "planet/elevation/modules/gdal_crs.h"
#include "planet/elevation/modules/gdal_messages.h"
#include "planet/error.h"

namespace planet {
namespace {

constexpr const char* vector_file = "a vector file with points, lines or polygons, e.g. GeoJSON, GeoPackage, Shapefile";
constexpr double chord_degrees = 4;  // of arc, where curves become lines

using Dataset = std::unique_ptr<GDALDataset, void (*)(GDALDataset*)>;

// What makes a driver give all it has and write nothing beside the file.
CPLStringList open_options(const std::string& driver, const std::string& path) {
    CPLStringList options;
    std::error_code failed;
    if (driver == "GML") options.SetNameValue("WRITE_GFS", "NO");
    // Without this SQLite makes files of its own beside one whose journal is a write-ahead log; they must be read if
    // they are there.
    if (driver == "GPKG" && !std::filesystem::exists(path + "-wal", failed)) options.SetNameValue("IMMUTABLE", "YES");
    if (driver == "CSV") {
        options.SetNameValue("GEOM_POSSIBLE_NAMES", "wkt,wkt_geom,geom,geometry,the_geom");
        options.SetNameValue("X_POSSIBLE_NAMES", "lon,long,lng,longitude,x,easting");
        options.SetNameValue("Y_POSSIBLE_NAMES", "lat,latitude,y,northing");
        options.SetNameValue("Z_POSSIBLE_NAMES", "z,ele,elev,elevation,height,alt,altitude");
    }
    return options;
}

Dataset open(const std::string& path) {
    const GdalMessages messages;
    const auto driver_for = [&](unsigned kind) {
        auto* driver = static_cast<GDALDriver*>(GDALIdentifyDriverEx(path.c_str(), kind, nullptr, nullptr));
        return driver ? std::string(driver->GetDescription()) : std::string();
    };
    const std::string vector = driver_for(GDAL_OF_VECTOR), raster = driver_for(GDAL_OF_RASTER);
    const CPLStringList options = open_options(vector, path);
    Dataset dataset(static_cast<GDALDataset*>(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_VERBOSE_ERROR, nullptr,
                                                         options.List(), nullptr)),
                    [](GDALDataset* d) { GDALClose(d); });
    if (dataset) return dataset;
    if (vector.empty() && !raster.empty())
        throw Error(Fault::bad_data, path, "is a raster (" + raster + "), not features", vector_file);
    throw Error(Fault::bad_data, path, "cannot be read: " + messages.last(), vector_file);
}

bool is_wgs84(const OGRSpatialReference& crs) {
    OGRSpatialReference wgs84;
    wgs84.SetWellKnownGeogCS("WGS84");
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return crs.IsSame(&wgs84);
}

OGRSpatialReference flat(OGRSpatialReference crs) {
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    crs.StripVertical();
    crs.DemoteTo2D(nullptr);
    return crs;
}

// None: coordinates stay as they are.
std::optional<OGRSpatialReference> target_crs(const FeatureOptions& options) {
    if (options.plain) return std::nullopt;
    const GdalMessages quiet;
    OGRSpatialReference crs;
    const char* const text = options.crs.empty() ? "EPSG:4326" : options.crs.c_str();
    if (crs.SetFromUserInput(text, OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE)
        throw Error(Fault::bad_usage, options.crs, "is no CRS", "e.g. EPSG:32633");
    return flat(crs);
}

enum class Heights { as_they_are, zero_is_none, none };

// KML and GPX have 0 where no height is known: KML because its altitudes count for nothing unless they are called
// absolute, GPX within lines of which other vertices have one.
Heights heights_of(const std::string& driver, const OGRFeature& feature) {
    if (driver == "GPX") return Heights::zero_is_none;
    if (driver != "LIBKML" && driver != "KML") return Heights::as_they_are;
    const int mode = feature.GetFieldIndex("altitudeMode");
    if (mode < 0 || !feature.IsFieldSetAndNotNull(mode)) return Heights::zero_is_none;
    return std::string_view(feature.GetFieldAsString(mode)) == "absolute" ? Heights::as_they_are : Heights::none;
}

// From the coordinates of a layer to those asked for.
class Placement {
  public:
    Placement(const OGRSpatialReference* own, const std::optional<OGRSpatialReference>& target, const std::string& path)
        : path_(path), metres_per_z_(metres_per_height(own)) {
        if (!target) return;
        const GdalMessages messages;
        const bool named = own && !own->IsEmpty() && !own->IsLocal();
        OGRSpatialReference from = named ? flat(*own) : *target;
        if (from.IsGeocentric())
            throw Error(Fault::bad_data, path, "is in geocentric coordinates", "a CRS with longitudes or eastings");
        if (from.IsGeographic()) pole_ = 0.5 * std::numbers::pi / from.GetAngularUnits() * (1 + 1e-9);
        // Files of other planets must say WGS84 where their format knows nothing else (GeoJSON, KML, GPX).
        const double radius_m = target->GetSemiMajor();
        if (std::abs(radius_m - from.GetSemiMajor()) > 0.01 * radius_m && is_wgs84(from)) {
            const std::unique_ptr<OGRSpatialReference> there(target->CloneGeogCS());
            if (there) from = flat(*there);
        }
        if (from.IsSame(&*target)) return;
        transformation_ = make_transformation(from, *target);
        if (!transformation_)
            throw Error(Fault::bad_data, path, "its CRS cannot be turned into the one wanted: " + messages.last(),
                        "a CRS that PROJ knows");
    }

    void set_heights(Heights heights) { heights_ = heights; }

    void apply(std::vector<glm::dvec3>& vertices) {
        for (glm::dvec3& v : vertices) {
            if (!std::isfinite(v.x) || !std::isfinite(v.y) || std::isinf(v.z))
                throw Error(Fault::bad_data, path_, "holds the coordinates " + text(v), "finite numbers");
            if (std::abs(v.y) > pole_)
                throw Error(Fault::bad_data, path_, "holds the longitude and latitude " + text(v),
                            "latitudes from -90 to 90, or a file that names its CRS");
            const bool no_height = heights_ == Heights::none || (heights_ == Heights::zero_is_none && v.z == 0);
            v.z = no_height ? std::numeric_limits<double>::quiet_NaN() : v.z * metres_per_z_;
        }
        if (transformation_) transform(vertices);
    }

  private:
    void transform(std::vector<glm::dvec3>& vertices) {
        const GdalMessages quiet;
        const std::size_t n = vertices.size();
        x_.resize(n), y_.resize(n), ok_.resize(n);
        for (std::size_t i = 0; i < n; ++i) x_[i] = vertices[i].x, y_[i] = vertices[i].y;
        transformation_->Transform(static_cast<int>(n), x_.data(), y_.data(), nullptr, ok_.data());
        for (std::size_t i = 0; i < n; ++i) {
            if (!ok_[i] || !std::isfinite(x_[i]) || !std::isfinite(y_[i]))
                throw Error(Fault::bad_data, path_, text(vertices[i]) + " has no place in the CRS wanted",
                            "features within the reach of that CRS");
            vertices[i].x = x_[i], vertices[i].y = y_[i];
        }
    }

    static std::string text(const glm::dvec3& v) {
        return CPLSPrintf(std::isnan(v.z) ? "(%.10g, %.10g)" : "(%.10g, %.10g, %.10g)", v.x, v.y, v.z);
    }

    const std::string& path_;
    Heights heights_ = Heights::as_they_are;
    double metres_per_z_ = 1;
    double pole_ = std::numeric_limits<double>::infinity();  // the largest latitude in units of the layer's CRS
    Transformation transformation_{nullptr, [](OGRCoordinateTransformation*) {}};
    std::vector<double> x_, y_;
    std::vector<int> ok_;
};

// Takes geometries apart.
class FeatureCollector {
  public:
    FeatureCollector(const std::string& path, std::int64_t max_vertices) : path_(path), room_(max_vertices) {
        too_many_ = "at most " + std::to_string(max_vertices) + " vertices";
    }

    void add(const OGRGeometry& geometry, Placement& placement) {
        const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
        if (geometry.IsEmpty() && !(type == wkbPoint && is_half_a_number(*geometry.toPoint()))) return;
        if (type == wkbPoint)
            add_point(*geometry.toPoint(), placement);
        else if (type == wkbLineString)
            add_line(vertices_of(*geometry.toLineString(), placement));
        else if (type == wkbPolygon || type == wkbTriangle)
            add_polygon(*geometry.toPolygon(), placement);
        else if (type == wkbPolyhedralSurface || type == wkbTIN)
            for (const auto* face : *geometry.toPolyhedralSurface()) add_polygon(*face, placement);
        else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection))
            for (const auto* part : *geometry.toGeometryCollection()) add(*part, placement);
        else if (OGR_GT_IsNonLinear(type))
            add(*chords_of(geometry), placement);
        else
            throw Error(Fault::bad_data, path_, std::string("holds a ") + geometry.getGeometryName(), vector_file);
    }

    /// Before a feature's geometries are added, and after.
    void begin_feature() {
        ++features_.feature_count;
        points_before_ = features_.points.size();
        lines_before_ = features_.lines.size();
        polygons_before_ = features_.polygons.size();
    }
    void name_feature(const std::string& text) {
        if (text.empty()) return;
        const bool of_point = features_.points.size() > points_before_;
        if (const auto place = place_of_feature()) features_.names.push_back({text, *place, of_point});
    }

    Features take() {
        if (features_.points.empty() && features_.lines.empty() && features_.polygons.empty())
            throw Error(Fault::bad_data, path_, "holds no points, lines or polygons", vector_file);
        return std::move(features_);
    }

  private:
    std::optional<glm::dvec2> place_of_feature() const {
        const auto since = [](const auto& list, std::size_t before) { return std::span(list).subspan(before); };
        if (const auto points = since(features_.points, points_before_); !points.empty())
            return glm::dvec2(points.front());
        if (const auto polygons = since(features_.polygons, polygons_before_); !polygons.empty())
            return centroid(std::ranges::max_element(polygons, {}, [](const Polygon& p) {
                                return std::abs(doubled_area(p.outer));
                            })->outer);
        const auto lines = since(features_.lines, lines_before_);
        if (lines.empty()) return std::nullopt;
        const auto& longest = *std::ranges::max_element(lines, {}, [](const auto& line) { return line.size(); });
        return glm::dvec2(longest[longest.size() / 2]);
    }

    static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }
    static double doubled_area(const std::vector<glm::dvec3>& ring) {
        double sum = 0;
        const glm::dvec2 from(ring.front());
        for (std::size_t i = 1; i < ring.size(); ++i)
            sum += cross(glm::dvec2(ring[i - 1]) - from, glm::dvec2(ring[i]) - from);
        return sum;
    }
    static glm::dvec2 centroid(const std::vector<glm::dvec3>& ring) {
        const double area = doubled_area(ring);
        const glm::dvec2 from(ring.front());
        if (area == 0) return from;
        glm::dvec2 sum(0);
        for (std::size_t i = 1; i < ring.size(); ++i) {
            const glm::dvec2 a = glm::dvec2(ring[i - 1]) - from, b = glm::dvec2(ring[i]) - from;
            sum += cross(a, b) * (a + b);
        }
        return from + sum / (3 * area);
    }

    // To OGR a point with a coordinate that is not a number is empty, as one with two such coordinates truly is.
    static bool is_half_a_number(const OGRPoint& p) { return std::isnan(p.getX()) != std::isnan(p.getY()); }

    void reserve(std::int64_t count) {
        if (count > room_) throw Error(Fault::bad_data, path_, "holds too many vertices", too_many_);
        room_ -= count;
    }

    std::unique_ptr<OGRGeometry> chords_of(const OGRGeometry& curved) {
        // Arcs have two vertices each, 16 bytes or more as WKB; what they could become is not made just to be refused.
        const double most = static_cast<double>(curved.WkbSize()) / 32 * (360 / chord_degrees);
        if (curved.hasCurveGeometry(TRUE) && most > static_cast<double>(room_) + 1000)
            throw Error(Fault::bad_data, path_, "holds curves of too many vertices", too_many_);
        std::unique_ptr<OGRGeometry> chords(curved.getLinearGeometry(chord_degrees));
        if (!chords || chords->hasCurveGeometry())
            throw Error(Fault::bad_data, path_, "holds curves that cannot be made into lines", vector_file);
        return chords;
    }

    void add_point(const OGRPoint& p, Placement& placement) {
        reserve(1);
        std::vector<glm::dvec3>& v = one_;
        v.assign(1, {p.getX(), p.getY(), p.Is3D() ? p.getZ() : nan});
        placement.apply(v);
        features_.points.push_back(v.front());
    }

    std::vector<glm::dvec3> vertices_of(const OGRSimpleCurve& curve, Placement& placement, bool ring = false) {
        const int n = curve.getNumPoints();
        reserve(n);
        std::vector<glm::dvec3> vertices;
        vertices.reserve(static_cast<std::size_t>(n) + 1);
        for (int i = 0; i < n; ++i)
            vertices.emplace_back(curve.getX(i), curve.getY(i), curve.Is3D() ? curve.getZ(i) : nan);
        placement.apply(vertices);
        const auto same = [](glm::dvec3 a, glm::dvec3 b) { return a.x == b.x && a.y == b.y; };
        if (ring && !vertices.empty() && !same(vertices.front(), vertices.back())) {
            reserve(1);
            vertices.push_back(vertices.front());
        }
        return vertices;
    }

    void add_line(std::vector<glm::dvec3> vertices) {
        if (vertices.size() == 1) features_.points.push_back(vertices.front());
        if (vertices.size() > 1) features_.lines.push_back(std::move(vertices));
    }

    void add_polygon(const OGRPolygon& source, Placement& placement) {
        if (source.IsEmpty()) return;
        Polygon polygon;
        polygon.outer = vertices_of(*source.getExteriorRing(), placement, true);
        for (int i = 0; i < source.getNumInteriorRings(); ++i) {
            auto hole = vertices_of(*source.getInteriorRing(i), placement, true);
            if (hole.size() < 4)
                add_line(std::move(hole));
            else
                polygon.holes.push_back(std::move(hole));
        }
        if (polygon.outer.size() >= 4) {
            features_.polygons.push_back(std::move(polygon));
            return;
        }
        add_line(std::move(polygon.outer));
        for (auto& hole : polygon.holes) add_line(std::move(hole));
    }

    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::string& path_;
    std::int64_t room_;
    std::string too_many_;
    Features features_;
    std::size_t points_before_ = 0, lines_before_ = 0, polygons_before_ = 0;
    std::vector<glm::dvec3> one_;
};

// The layers that repeat the vertices of others.
bool repeats(const std::string& driver, OGRLayer& layer) {
    const std::string name = layer.GetName();
    return driver == "GPX" && (name == "route_points" || name == "track_points");
}

// A FlatGeobuf file that is cut between two features looks to OGR as if it ended there; its head says how many it has.
bool is_cut(const std::string& driver, GDALDataset& dataset, std::int64_t features_read) {
    if (driver != "FlatGeobuf") return false;
    std::int64_t promised = 0;
    for (OGRLayer* layer : dataset.GetLayers()) promised += layer->GetFeatureCount(FALSE);
    return features_read < promised;
}

// The attribute that names features, of whatever layers have it.
class NameField {
  public:
    NameField(const std::string& name, const std::string& path) : name_(name), path_(path) {}

    std::string of(const OGRFeature& feature) {
        if (name_.empty()) return {};
        const int index = feature.GetFieldIndex(name_.c_str());
        if (index < 0 && !found_) note_fields(feature);
        found_ = found_ || index >= 0;
        return index >= 0 && feature.IsFieldSetAndNotNull(index) ? feature.GetFieldAsString(index) : "";
    }
    void check() const {
        if (!name_.empty() && !found_)
            throw Error(Fault::bad_usage, path_, "has no attribute '" + name_ + "'",
                        fields_.empty() ? "none: it has no attributes" : fields_);
    }

  private:
    void note_fields(const OGRFeature& feature) {
        if (!fields_.empty()) return;
        for (int i = 0; i < std::min(feature.GetFieldCount(), 12); ++i)
            fields_ += (i > 0 ? ", " : "") + std::string(feature.GetFieldDefnRef(i)->GetNameRef());
    }

    const std::string &name_, &path_;
    bool found_ = false;
    std::string fields_;
};

class GdalFeatureDriver : public FeatureDriver {
  public:
    GdalFeatureDriver() {
        const GdalMessages quiet;
        GDALAllRegister();
    }

    Features read(const std::string& path, const FeatureOptions& options) const override {
        const CPLConfigOptionSetter gpx_heights("GPX_ELE_AS_25D", "YES", false);
        const std::optional<OGRSpatialReference> target = target_crs(options);
        const Dataset dataset = open(path);
        const std::string driver = dataset->GetDriverName();
        FeatureCollector collector(path, options.max_vertices);
        std::map<const OGRGeomFieldDefn*, Placement> placements;
        const GdalMessages messages;
        std::int64_t features_read = 0;
        NameField names(options.name_field, path);
        OGRLayer* layer = nullptr;
        while (const OGRFeatureUniquePtr feature{dataset->GetNextFeature(&layer, nullptr, nullptr, nullptr)}) {
            ++features_read;
            if (repeats(driver, *layer)) continue;
            collector.begin_feature();
            for (int i = 0; i < feature->GetGeomFieldCount(); ++i) {
                const OGRGeometry* geometry = feature->GetGeomFieldRef(i);
                if (!geometry) continue;
                const OGRGeomFieldDefn* field = feature->GetGeomFieldDefnRef(i);
                auto at = placements.find(field);
                if (at == placements.end())
                    at = placements.try_emplace(field, field->GetSpatialRef(), target, path).first;
                at->second.set_heights(heights_of(driver, *feature));
                collector.add(*geometry, at->second);
            }
            collector.name_feature(names.of(*feature));
        }
        if (!messages.last().empty() || is_cut(driver, *dataset, features_read))
            throw Error(Fault::bad_data, path, "is damaged or cut short: " + messages.last(), vector_file);
        names.check();
        return collector.take();
    }
};

}  // namespace
}  // namespace planet

extern "C" __attribute__((visibility("default"))) const planet::FeatureDriver* octaglobe_gdal_features_2() {
    static const planet::GdalFeatureDriver driver;
    return &driver;
}
