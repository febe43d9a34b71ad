#pragma once
// An elevation field answers heights at directions and says how fine it is where. Its vertical datum is part of it.

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planet/elevation/height_origin.h"
#include "planet/frames.h"
#include "planet/octahedron/cap.h"

namespace planet {

/// What a field's heights are measured from.
enum class VerticalDatum {
    egm96,      ///< orthometric: H above the EGM96 geoid
    ellipsoid,  ///< h above the reference ellipsoid
};

/// "egm96" or "ellipsoid".
std::string_view name_of(VerticalDatum datum);

/// Where samples are asked for: in a cap or, in a cell, on the inner side of its three sides.
struct SampleArea {
    /* implicit */ SampleArea(const Cap& whole) : cap(whole) {}
    explicit SampleArea(const Corners& cell);

    Cap cap;  ///< holds the area
    /// What is in the area has dot(side, n) >= -1e-15 for each. Shorter than 1; all 0: the whole cap is meant.
    std::array<glm::dvec3, 3> sides{};

    bool is_cell() const { return sides[0] != glm::dvec3(0); }
};

/// Normals and heights in metres, of the same size; good for the time of the call.
using SampleRowVisitor = std::function<void(std::span<const glm::dvec3> normals, std::span<const float> heights)>;

/// What a report says of a source.
struct SourceInfo {
    std::string name;      ///< file name without its folder, or a description of a made-up field
    std::string checksum;  ///< SHA-256 of what determines the heights, 64 hex digits
    std::string crs;       ///< "EPSG:4326" or WKT; empty for made-up fields
    VerticalDatum datum = VerticalDatum::egm96;
    double spacing_m = 0;        ///< sqrt(dx dy) of its samples on the ground at its centre; 0: as fine as you like
    bool datum_assumed = false;  ///< neither the file nor the user said so
    /// Of a mosaic: the names of its files in the order of their numbers. Empty: `name` is the only one.
    std::vector<std::string> files{};
};

/// A file of a source.
struct SourceFile {
    std::size_t source = 0;  ///< which of the sources
    std::string name;
};

/// Of all sources, the one with number 1 (HeightOrigin::file) first.
std::vector<SourceFile> source_files(std::span<const SourceInfo> sources);

/// Implementations are immutable after construction and safe to read from several threads.
class ElevationField {
  public:
    virtual ~ElevationField() = default;

    virtual VerticalDatum datum() const = 0;

    /// Heights in metres above datum() at unit geodetic normals; NaN where the field has no answer (outside, void).
    /// out.size() == normals.size().
    virtual void heights(std::span<const glm::dvec3> normals, std::span<float> out) const = 0;

    /// The same heights, and the file of sources() that each came from; where there is no answer nothing is meant by it.
    /// A field of one file need not override this.
    virtual void heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                                      std::span<WeighedOrigin> origins) const;

    /// The least sample spacing in metres (sqrt(dx dy) on the ground) of any part of the field that meets the cap;
    /// infinity where it has no answer.
    virtual double spacing(const Cap& cap) const = 0;

    /// Appends the source samples whose position lies in the cap: normals and heights. Used to certify what resampling
    /// lost. Fields without samples append nothing.
    virtual void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const = 0;

    /// Calls visit with some hundreds of samples at a time, row by row of a source: every sample in the area once, and
    /// some outside of it. Voids and samples that do not show are NaN. Faster than samples(), which copies.
    virtual void sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const;

    virtual std::vector<SourceInfo> sources() const = 0;

    /// Appends directions in the cap just inside the border of what the field covers, voids included, about two a
    /// sample: where a coarser field must be led up to this one. Fields that cover everything append nothing.
    /// @param every  1, or n for those of every n-th sample only
    virtual void border(const Cap& cap, std::size_t every, std::vector<glm::dvec3>& normals) const {
        static_cast<void>(cap);
        static_cast<void>(every);
        static_cast<void>(normals);
    }
    /// How many directions border() has in all.
    virtual std::size_t border_size() const { return 0; }

    float height(const glm::dvec3& normal) const {
        float h = 0;
        heights({&normal, 1}, {&h, 1});
        return h;
    }
};

/// Appends what sample_rows() visits, but for NaN and what is outside of the cap.
void append_samples(const ElevationField& field, const Cap& cap, std::vector<glm::dvec3>& normals,
                    std::vector<float>& heights);

}  // namespace planet
