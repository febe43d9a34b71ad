#include "planet/elevation/elevation_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace planet {

std::string_view name_of(VerticalDatum datum) {
    return datum == VerticalDatum::ellipsoid ? "ellipsoid" : "egm96";
}

SampleArea::SampleArea(const Corners& cell) : cap(cap_of(cell)) {
    sides = {glm::cross(cell.left, cell.right), glm::cross(cell.right, cell.apex), glm::cross(cell.apex, cell.left)};
    if (glm::dot(sides[0], cell.apex) < 0)
        for (glm::dvec3& side : sides) side = -side;
}

std::vector<SourceFile> source_files(std::span<const SourceInfo> sources) {
    std::vector<SourceFile> files;
    for (std::size_t s = 0; s < sources.size(); ++s) {
        for (const std::string& name : sources[s].files) files.push_back({s, name});
        if (sources[s].files.empty()) files.push_back({s, sources[s].name});
    }
    return files;
}

void ElevationField::heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                                          std::span<WeighedOrigin> origins) const {
    heights(normals, out);
    std::fill(origins.begin(), origins.end(), WeighedOrigin{{1, 1}, 1});
}

void ElevationField::sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const {
    std::vector<glm::dvec3> normals;
    std::vector<float> heights;
    samples(area.cap, normals, heights);
    if (!normals.empty()) visit(normals, heights);
}

void append_samples(const ElevationField& field, const Cap& cap, std::vector<glm::dvec3>& normals,
                    std::vector<float>& heights) {
    const double least_cosine = std::cos(std::min(cap.angle, std::numbers::pi));
    field.sample_rows(cap, [&](std::span<const glm::dvec3> n, std::span<const float> h) {
        std::size_t kept = normals.size();
        normals.resize(kept + n.size());
        heights.resize(kept + n.size());
        for (std::size_t i = 0; i < n.size(); ++i) {
            normals[kept] = n[i];
            heights[kept] = h[i];
            kept += glm::dot(n[i], cap.centre) >= least_cosine && !std::isnan(h[i]) ? 1 : 0;
        }
        normals.resize(kept);
        heights.resize(kept);
    });
}

}  // namespace planet
