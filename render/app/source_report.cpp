#include "render/app/source_report.h"

#include <map>

namespace render {
namespace {

std::string joined(const std::vector<std::string>& names, const char* between) {
    std::string text;
    for (const std::string& name : names) text.append(text.empty() ? "" : between).append(name);
    return text;
}

/// As RFC 4180 has it.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

}  // namespace

nlohmann::ordered_json sources_json(const std::vector<planet::SourceInfo>& sources) {
    auto list = nlohmann::ordered_json::array();
    for (const auto& source : sources) {
        list.push_back({{"name", source.name},
                        {"sha256", source.checksum},
                        {"crs", source.crs},
                        {"vertical_datum", planet::name_of(source.datum)},
                        {"spacing_m", source.spacing_m}});
        if (!source.files.empty()) list.back()["files"] = source.files;
    }
    return list;
}

SourceNames::SourceNames(const std::vector<planet::SourceInfo>& sources) : files_(planet::source_files(sources)) {
    for (const auto& source : sources) sources_.push_back(source.name);
    std::map<std::string, int> uses;
    for (const auto& file : files_) ++uses[file.name];
    for (auto& file : files_)
        if (uses[file.name] > 1) file.name += " (source " + std::to_string(file.source + 1) + ")";
}

planet::SurfaceOrigin SourceNames::known(const planet::SurfaceOrigin& origin, bool has_samples) const {
    return origin.count == 0 && files_.size() == 1 && has_samples ? planet::SurfaceOrigin{{1}, 1} : origin;
}

std::string SourceNames::name(std::uint32_t file) const {
    return file == 0 ? "no source" : files_[file - 1].name;
}

std::vector<std::string> SourceNames::blended_with(const planet::SurfaceOrigin& origin) const {
    std::vector<std::string> names;
    for (std::uint32_t i = 1; i < origin.count; ++i) names.push_back(name(origin.files[i]));
    return names;
}

std::string SourceNames::text(const planet::SurfaceOrigin& origin) const {
    if (origin.count == 0) return "from one of " + joined(sources_, ", ");
    const std::string others = joined(blended_with(origin), " and ");
    return "from " + name(origin.files[0]) + (others.empty() ? "" : ", blended with " + others);
}

void SourceNames::set(nlohmann::ordered_json& json, const planet::SurfaceOrigin& origin) const {
    const bool is_file = origin.count > 0 && origin.files[0] > 0;
    json["source"] = is_file ? nlohmann::ordered_json(name(origin.files[0])) : nlohmann::ordered_json();
    if (origin.count == 0) {
        json["source_one_of"] = sources_;
        return;
    }
    json["source_index"] =
        is_file ? nlohmann::ordered_json(files_[origin.files[0] - 1].source) : nlohmann::ordered_json();
    json["blended_with"] = blended_with(origin);
}

std::string SourceNames::csv(const planet::SurfaceOrigin& origin) const {
    if (origin.count == 0) return csv_field("one of " + joined(sources_, "; ")) + ",";
    return csv_field(name(origin.files[0])) + "," + csv_field(joined(blended_with(origin), "; "));
}

std::string crs_text(const std::string& crs) {
    const auto first = crs.find('"'), last = crs.find('"', first + 1);
    if (crs.empty()) return "none";
    return last == crs.npos ? crs : crs.substr(first + 1, last - first - 1);
}

}  // namespace render
