#pragma once
// Elevation files as one field: what a user names, in the order in which he names it.

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/layered_field.h"

namespace planet {

/// One argument of the user: a file, a name that GDAL knows ("/vsizip/..."), or a pattern of file names ("tiles/*.hgt",
/// with *, ? and [...], in folders too).
struct SourceSpec {
    std::string pattern;
    /// What its heights are measured from; else what the file says: EGM96 (EPSG:5773) or the ellipsoid (a CRS of three
    /// axes, e.g. EPSG:4979); else egm96, which SourceInfo::datum_assumed tells.
    std::optional<VerticalDatum> datum{};
};

struct SourceOptions {
    VerticalDatum datum = VerticalDatum::egm96;  ///< of the field that is made
    LayeredField::GeoidFunction geoid{};         ///< needed if a source has another datum
    double radius_m = 6378137;                   ///< of the planet
    /// Of samples and blends, GDAL's own blocks included. A raster of up to an eighth is kept in memory, as long as
    /// all of those take no more than half; others are read in blocks.
    std::size_t memory_bytes = std::size_t{512} << 20;
    std::shared_ptr<const ElevationField> base{};  ///< below all sources; may be null
    /// Called from time to time with the fraction done of reading all sources once, 0..1.
    std::function<void(double)> progress{};
};

/// The later a source, the higher it is; voids show what is below, and H = 0 is below all (layered_field.h). The files of
/// a pattern come in the order of their names. Those with the same CRS and sample distances that lie on one grid are one
/// source, a mosaic, without seams: where they overlap the samples of the later one count, and files that are missing
/// are voids. The others are sources of their own.
///
/// Reads every file once, in full: 60,000 x 60,000 samples of 16 bits take about 25 s of processor time. Files must not
/// change afterwards: heights() and all others throw Error(bad_data) with the file's name if one does or cannot be read.
///
/// Throws Error: bad_usage for no source, or a geoid that is missing; bad_data for a pattern that matches nothing, what
/// read_raster() refuses, a vertical datum that is neither EGM96 nor the ellipsoid, or a file whose compressed strips
/// do not fit half of memory_bytes.
std::shared_ptr<const ElevationField> open_elevation_sources(std::span<const SourceSpec> sources,
                                                             const SourceOptions& options);

/// The files that a pattern names, sorted by name; the name itself if there is such a file or GDAL may know it.
/// Throws Error(bad_data) if there are none.
std::vector<std::string> files_of_pattern(const std::string& pattern);

}  // namespace planet
