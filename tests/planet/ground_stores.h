#pragma once
// Small stores for tests of the ground: a level sea, and hills with a fine part.

#include <memory>
#include <numbers>
#include <random>

#include "bumpy_field.h"
#include "planet/bake/bake.h"
#include "planet/elevation/constant_field.h"
#include "planet/geodesy/geodesic.h"
#include "planet/geodesy/geodetic.h"
#include "planet/store/store_field.h"

namespace planet::testing {

inline Geodetic place(double latitude, double longitude) {
    return {latitude * degrees, longitude * degrees, {}};
}

inline glm::dvec3 normal_of(const Geodetic& g) {
    return normal_from_geodetic(g.latitude, g.longitude);
}

/// Height 0 on the ellipsoid, in cells of 176 km: nothing sags more.
inline const StoreField& level_sea() {
    static const StoreField field(std::make_shared<const ElevationStore>([] {
        BakeOptions options;
        options.least_level = 12;
        return bake_in_memory(ConstantField(0, VerticalDatum::ellipsoid), options);
    }()));
    return field;
}

/// Where the hills are fine.
inline const Geodetic hills_middle = place(46.3, 8.7);

/// Steep hills between 600 and 2,400 m.
class HillField final : public ElevationField {
  public:
    VerticalDatum datum() const override { return VerticalDatum::egm96; }
    static double exact(const glm::dvec3& n) {
        const glm::dvec3 p = wgs84.a * n;
        return 1500 + 600 * std::sin(p.x / 2900 + std::sin(p.y / 3100)) * std::cos(p.z / 2300) +
               150 * std::sin(p.y / 900) * std::sin(p.x / 800 + 2);
    }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override {
        for (std::size_t i = 0; i < normals.size(); ++i) out[i] = static_cast<float>(exact(normals[i]));
    }
    double spacing(const Cap& cap) const override {
        const double apart = std::acos(std::clamp(glm::dot(cap.centre, normal_of(hills_middle)), -1.0, 1.0));
        return apart <= cap.angle + 0.006 ? 700 : 1e5;
    }
    void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const override {
        for (const glm::dvec3& n : scattered()) {
            if (glm::dot(n, cap.centre) < std::cos(cap.angle)) continue;
            normals.push_back(n);
            heights.push_back(static_cast<float>(exact(n)));
        }
    }
    std::vector<SourceInfo> sources() const override {
        return {{"hills", std::string(64, 'h'), "", VerticalDatum::egm96, 700}};
    }

    /// Samples within 30 km of the middle, on Vogel's spiral.
    static const std::vector<glm::dvec3>& scattered() {
        static const std::vector<glm::dvec3> all = [] {
            constexpr int count = 1000;
            std::vector<glm::dvec3> normals;
            for (int i = 0; i < count; ++i) {
                const double r = 0.005 * std::sqrt((i + 0.5) / count), a = 2.399963 * i;
                normals.push_back(
                    normal_from_geodetic(hills_middle.latitude + r * std::sin(a),
                                         hills_middle.longitude + r * std::cos(a) / std::cos(hills_middle.latitude)));
            }
            return normals;
        }();
        return all;
    }
};

/// 700 m between vertices within 38 km of the middle, 100 km elsewhere; over a made-up geoid.
inline const StoreField& hills() {
    static const StoreField field(std::make_shared<const ElevationStore>([] {
        BakeOptions options;
        options.undulation = bumpy_undulation;
        return bake_in_memory(HillField(), options);
    }()));
    return field;
}

/// Evenly by distance and azimuth around the middle of the hills.
class PlacesInHills {
  public:
    explicit PlacesInHills(unsigned seed = 5) : random_(seed) {}
    Geodetic next(double radius_m = 32000) {
        const Geodesics lines(wgs84);
        const GeodesicPoint p = lines.direct(hills_middle, 2 * std::numbers::pi * unit(), radius_m * unit());
        return {p.latitude, p.longitude, {}};
    }
    double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  private:
    std::mt19937_64 random_;
};

}  // namespace planet::testing
