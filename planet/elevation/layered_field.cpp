#include "planet/elevation/layered_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include "planet/error.h"

namespace planet {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t piece = 4096;
constexpr std::size_t most_points = std::size_t{1} << 19;  // of a whole blend: 45 MB
constexpr std::size_t most_in_region = std::size_t{1} << 17;
constexpr std::size_t probe = 64;  // of so many border points one is counted
constexpr Cap everywhere{{0, 0, 1}, 4};

}  // namespace

LayeredField::LayeredField(std::vector<std::shared_ptr<const ElevationField>> layers, VerticalDatum datum,
                           GeoidFunction geoid, double radius_m, std::size_t blend_bytes)
    : layers_(std::move(layers)), datum_(datum), geoid_(std::move(geoid)), radius_m_(radius_m) {
    if (layers_.empty()) throw Error(Fault::bad_usage, "elevation", "has no layer", "at least one");
    for (const auto& layer : layers_)
        if (layer->datum() != datum_ && !geoid_)
            throw Error(Fault::bad_usage, "elevation", "layers of different vertical datums need a geoid",
                        "all above egm96 or all above the ellipsoid, or a geoid grid");
    blends_.reserve(layers_.size());
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        reaches_.push_back(most_reach(i));
        blends_.push_back(make_blend(i, blend_bytes / layers_.size()));
    }
}

void LayeredField::to_common_datum(const ElevationField& layer, std::span<const glm::dvec3> normals,
                                   std::span<float> h) const {
    if (layer.datum() == datum_) return;
    constexpr std::size_t few = 256;
    GeoidUndulation undulation[few];
    for (std::size_t first = 0; first < normals.size(); first += few) {
        const std::size_t n = std::min(few, normals.size() - first);
        const std::span<float> some = h.subspan(first, n);
        if (std::all_of(some.begin(), some.end(), [](float v) { return std::isnan(v); })) continue;
        geoid_(normals.subspan(first, n), {undulation, n});
        for (std::size_t i = 0; i < n; ++i) {
            const double height = static_cast<double>(some[i]);
            some[i] =
                static_cast<float>(datum_ == VerticalDatum::ellipsoid ? (OrthometricHeight{height} + undulation[i]).m
                                                                      : (EllipsoidalHeight{height} - undulation[i]).m);
        }
    }
}

void LayeredField::heights(std::span<const glm::dvec3> normals, std::span<float> out) const {
    heights_of_lowest(layers_.size(), normals, out);
}

void LayeredField::heights_of_lowest(std::size_t count, std::span<const glm::dvec3> normals,
                                     std::span<float> out) const {
    assert(out.size() == normals.size());
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        heights_of_piece(count, normals.subspan(first, n), out.subspan(first, n));
    }
}

// From the highest layer down: who has no answer yet takes along the corrections of the layers it has passed.
void LayeredField::heights_of_piece(std::size_t count, std::span<const glm::dvec3> normals,
                                    std::span<float> out) const {
    std::fill(out.begin(), out.end(), nan);
    std::vector<glm::dvec3> left;
    std::vector<std::size_t> index;
    std::vector<double> correction;
    std::vector<float> h;
    if (count > 0) {  // the highest one has most answers: without copies
        layers_[count - 1]->heights(normals, out);
        to_common_datum(*layers_[count - 1], normals, out);
    }
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (!std::isnan(out[i])) continue;
        left.push_back(normals[i]);
        index.push_back(i);
    }
    correction.resize(left.size());
    for (std::size_t layer = count; layer-- > 0 && !left.empty();) {
        blends_[layer].add(left, correction);
        if (layer == 0) break;
        h.resize(left.size());
        layers_[layer - 1]->heights(left, h);
        to_common_datum(*layers_[layer - 1], left, h);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (!std::isnan(h[i])) {
                out[index[i]] = static_cast<float>(static_cast<double>(h[i]) + correction[i]);
                continue;
            }
            correction[kept] = correction[i];
            left[kept] = left[i];
            index[kept++] = index[i];
        }
        left.resize(kept);
        index.resize(kept);
        correction.resize(kept);
    }
    for (std::size_t i = 0; i < left.size(); ++i)
        out[index[i]] = std::isnan(left[i].x + left[i].y + left[i].z) ? nan : static_cast<float>(correction[i]);
}

double LayeredField::spacing_of_lowest(std::size_t count, const glm::dvec3& normal) const {
    for (std::size_t i = count; i-- > 0;)
        if (!std::isnan(layers_[i]->height(normal))) return layers_[i]->spacing({normal, 0});
    return std::numeric_limits<double>::infinity();
}

double LayeredField::most_reach(std::size_t layer) const {
    double spacing = 0;
    const auto take = [&](const ElevationField& field) {
        for (const SourceInfo& s : field.sources()) spacing = std::max(spacing, 1.5 * s.spacing_m);
        const double least = field.spacing(everywhere);
        if (std::isfinite(least)) spacing = std::max(spacing, least);
    };
    for (std::size_t i = 0; i <= layer; ++i) take(*layers_[i]);
    return std::clamp(2 * spacing / radius_m_, 1e-9, 0.5);
}

// That of the middle of a cell of 1/64, about a degree: it hardly changes within one.
double LayeredField::reach_around(std::size_t layer, const glm::dvec3& normal) const {
    const glm::dvec3 middle = glm::normalize((glm::floor(normal * 64.0) + 0.5) / 64.0);
    double spacing = spacing_of_lowest(layer, middle);
    if (std::isinf(spacing)) spacing = spacing_of_lowest(layer, normal);
    if (std::isinf(spacing)) spacing = layers_[layer]->spacing({normal, 1e-6});
    return std::clamp(2 * spacing / radius_m_, 1e-9, 0.5);
}

RegionalBlend LayeredField::make_blend(std::size_t layer, std::size_t bytes) const {
    const std::size_t points = layers_[layer]->border_size();
    const double reach = reaches_[layer];
    if (points > most_points && RegionalBlend::has_regions(reach)) {
        const auto make = [this, layer](const Cap& region, const Cap& around) {
            return blend_of_region(layer, region, around);
        };
        return {make, 1.1 * reach, bytes};  // a little more than the reach, for the clearance
    }
    const std::size_t every = std::max<std::size_t>(1, (points + most_points - 1) / most_points);
    std::vector<glm::dvec3> normals;
    layers_[layer]->border(everywhere, every, normals);
    return RegionalBlend(blend_of(layer, normals, 0, every));
}

BorderBlend LayeredField::blend_of_region(std::size_t layer, const Cap& region, const Cap& around) const {
    const ElevationField& field = *layers_[layer];
    std::vector<glm::dvec3> normals, far;
    field.border(around, probe, far);
    if (far.size() * probe <= most_in_region) {
        field.border(around, 1, normals);
        return blend_of(layer, normals, normals.size(), 1);
    }
    // Nearer points by as much as they are too many, if they were spread evenly.
    const std::size_t every = far.size() * probe / most_in_region + 1;
    Cap near = around;
    near.angle = std::max(region.angle, around.angle / std::sqrt(static_cast<double>(every)));
    far.clear();
    field.border(near, 1, normals);
    field.border(around, every, far);
    const std::size_t single = normals.size();
    const double chord = 2 * std::sin(0.5 * near.angle);
    for (const glm::dvec3& n : far)
        if (glm::distance(n, near.centre) > chord) normals.push_back(n);
    return blend_of(layer, normals, single, every);
}

BorderBlend LayeredField::blend_of(std::size_t layer, std::span<const glm::dvec3> normals, std::size_t single,
                                   std::size_t every) const {
    std::vector<float> fine(normals.size()), coarse(normals.size());
    layers_[layer]->heights(normals, fine);
    to_common_datum(*layers_[layer], normals, fine);
    heights_of_lowest(layer, normals, coarse);

    std::map<std::array<int, 3>, double> reaches;
    std::vector<BorderBlend::Point> points;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(fine[i]) || std::isnan(coarse[i])) continue;
        const glm::ivec3 key(glm::floor(normals[i] * 64.0));
        double& reach = reaches[{key.x, key.y, key.z}];
        if (reach == 0) reach = std::min(reach_around(layer, normals[i]), reaches_[layer]);
        points.push_back({normals[i], static_cast<double>(fine[i]) - static_cast<double>(coarse[i]), reach,
                          i < single ? 1.0 : static_cast<double>(every)});
    }
    // Border points lie half a sample apart along the border; corners are up to 0.36 of one from the nearest.
    double fine_spacing = std::numeric_limits<double>::infinity();
    if (!points.empty()) fine_spacing = layers_[layer]->spacing({points.front().normal, 1e-6});
    const double clearance = 0.36 * fine_spacing * (single > 0 ? 1.0 : static_cast<double>(every)) / radius_m_;
    return BorderBlend(std::move(points), std::isinf(fine_spacing) ? 0 : clearance);
}

double LayeredField::spacing(const Cap& cap) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& layer : layers_) least = std::min(least, layer->spacing(cap));
    return least;
}

void LayeredField::hide_covered(std::size_t layer, std::span<const std::size_t> higher,
                                std::span<const glm::dvec3> normals, std::span<float> h) const {
    to_common_datum(*layers_[layer], normals, h);
    std::vector<float> above(normals.size());
    std::vector<double> correction(normals.size());
    for (const std::size_t i : higher) {
        layers_[i]->heights(normals, above);
        for (std::size_t k = 0; k < h.size(); ++k)
            if (!std::isnan(above[k])) h[k] = nan;
        blends_[i].add(normals, correction);
    }
    if (!higher.empty())
        for (std::size_t k = 0; k < h.size(); ++k) h[k] = static_cast<float>(static_cast<double>(h[k]) + correction[k]);
}

void LayeredField::sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const {
    std::vector<float> shown;
    for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
        std::vector<std::size_t> higher;  // that may cover samples, or whose blend may change them
        for (std::size_t i = layers_.size(); i-- > layer + 1;) {
            const Cap wider{area.cap.centre, area.cap.angle + 2 * std::asin(std::min(1.0, 0.5 * reaches_[i]))};
            if (std::isfinite(layers_[i]->spacing(wider))) higher.push_back(i);
        }
        if (higher.empty() && layers_[layer]->datum() == datum_) {
            layers_[layer]->sample_rows(area, visit);
            continue;
        }
        layers_[layer]->sample_rows(area, [&](std::span<const glm::dvec3> normals, std::span<const float> heights) {
            shown.assign(heights.begin(), heights.end());
            hide_covered(layer, higher, normals, shown);
            visit(normals, shown);
        });
    }
}

void LayeredField::samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const {
    append_samples(*this, cap, normals, heights);
}

std::vector<SourceInfo> LayeredField::sources() const {
    std::vector<SourceInfo> all;
    for (const auto& layer : layers_)
        for (SourceInfo& s : layer->sources()) all.push_back(std::move(s));
    return all;
}

}  // namespace planet
