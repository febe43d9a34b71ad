#pragma once
// Where heights came from, for reports.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planet/elevation/elevation_field.h"
#include "planet/store/surface_cursor.h"

namespace render {

/// A list of objects: name, sha256, crs, vertical_datum, spacing_m, and the files of a mosaic.
nlohmann::ordered_json sources_json(const std::vector<planet::SourceInfo>& sources);

/// What the files of a store's sources are called where a height is said to be from one of them. Names that several files
/// have get the number of their source, from 1.
class SourceNames {
  public:
    explicit SourceNames(const std::vector<planet::SourceInfo>& sources);

    /// Of a store that does not say it but has a single file it is that one, where there are samples.
    planet::SurfaceOrigin known(const planet::SurfaceOrigin& origin, bool has_samples) const;

    /// "from a.tif", "from a.tif, blended with b.tif", "from one of a.tif, b.tif".
    std::string text(const planet::SurfaceOrigin& origin) const;
    /// Sets source (null: none), source_index (in the list of sources), blended_with; or source_one_of if it is not known.
    void set(nlohmann::ordered_json& json, const planet::SurfaceOrigin& origin) const;
    /// The names of the columns that csv() fills.
    static constexpr const char* csv_columns = "source,blended_with";
    /// Several in one column with a semicolon between them; quoted where need be.
    std::string csv(const planet::SurfaceOrigin& origin) const;

  private:
    std::string name(std::uint32_t file) const;
    std::vector<std::string> blended_with(const planet::SurfaceOrigin& origin) const;

    std::vector<std::string> sources_;
    std::vector<planet::SourceFile> files_;
};

/// A CRS for a line of text: as it is if it is short, else the name that its WKT begins with.
std::string crs_text(const std::string& crs);

}  // namespace render
