#pragma once
// An elevation field answers heights at directions and says how fine it is where. Its vertical datum is part of it.

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planet/frames.h"

namespace planet {

/// What a field's heights are measured from.
enum class VerticalDatum {
    egm96,      ///< orthometric: H above the EGM96 geoid
    ellipsoid,  ///< h above the reference ellipsoid
};

/// "egm96" or "ellipsoid".
std::string_view name_of(VerticalDatum datum);

/// A cap on the sphere of geodetic normals.
struct Cap {
    glm::dvec3 centre{0, 0, 1};  ///< unit
    double angle = 0;            ///< rad, 0..pi
};

/// What a report says of a source.
struct SourceInfo {
    std::string name;      ///< file name without its folder, or a description of a made-up field
    std::string checksum;  ///< SHA-256 of what determines the heights, 64 hex digits
    std::string crs;       ///< "EPSG:4326" or WKT; empty for made-up fields
    VerticalDatum datum = VerticalDatum::egm96;
    double spacing_m = 0;  ///< sqrt(dx dy) of its samples on the ground at its centre; 0: as fine as you like
};

/// Implementations are immutable after construction and safe to read from several threads.
class ElevationField {
  public:
    virtual ~ElevationField() = default;

    virtual VerticalDatum datum() const = 0;

    /// Heights in metres above datum() at unit geodetic normals; NaN where the field has no answer (outside, void).
    /// out.size() == normals.size().
    virtual void heights(std::span<const glm::dvec3> normals, std::span<float> out) const = 0;

    /// The least sample spacing in metres (sqrt(dx dy) on the ground) of any part of the field that meets the cap;
    /// infinity where it has no answer.
    virtual double spacing(const Cap& cap) const = 0;

    /// Appends the source samples whose position lies in the cap: normals and heights. Used to certify what resampling
    /// lost. Fields without samples append nothing.
    virtual void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const = 0;

    virtual std::vector<SourceInfo> sources() const = 0;

    /// Appends directions just inside the border of what the field covers, voids included, about two a sample: where a
    /// coarser field must be led up to this one. Fields that cover everything append nothing.
    virtual void border(std::vector<glm::dvec3>& normals) const { (void)normals; }

    float height(const glm::dvec3& normal) const {
        float h = 0;
        heights({&normal, 1}, {&h, 1});
        return h;
    }
};

}  // namespace planet
