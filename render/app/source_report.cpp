#include "render/app/source_report.h"

namespace render {

nlohmann::ordered_json sources_json(const std::vector<planet::SourceInfo>& sources) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& source : sources)
        list.push_back({{"name", source.name},
                        {"sha256", source.checksum},
                        {"crs", source.crs},
                        {"vertical_datum", planet::name_of(source.datum)},
                        {"spacing_m", source.spacing_m}});
    return list;
}

std::string crs_text(const std::string& crs) {
    const auto first = crs.find('"'), last = crs.find('"', first + 1);
    if (crs.empty()) return "none";
    return last == crs.npos ? crs : crs.substr(first + 1, last - first - 1);
}

}  // namespace render
