#include "planet/elevation/georeference.h"

#include "planet/elevation/module.h"

namespace planet {

std::optional<RasterHeader> georeference_of(const std::string& path) {
    using Read = bool (*)(const char*, RasterHeader*);
    static const auto read = reinterpret_cast<Read>(
        module_symbol("octaglobe_gdal", "octaglobe_gdal_georeference_1", "reading where pictures lie"));
    RasterHeader header;
    if (!read(path.c_str(), &header)) return std::nullopt;
    return header;
}

}  // namespace planet
