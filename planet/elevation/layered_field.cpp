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

}  // namespace

LayeredField::LayeredField(std::vector<std::shared_ptr<const ElevationField>> layers, VerticalDatum datum,
                           GeoidFunction geoid, double radius_m)
    : layers_(std::move(layers)), datum_(datum), geoid_(std::move(geoid)), radius_m_(radius_m) {
    if (layers_.empty()) throw Error(Fault::bad_usage, "elevation", "has no layer", "at least one");
    for (const auto& layer : layers_)
        if (layer->datum() != datum_ && !geoid_)
            throw Error(Fault::bad_usage, "elevation", "layers of different vertical datums need a geoid",
                        "all above egm96 or all above the ellipsoid, or a geoid grid");
    blends_.reserve(layers_.size());
    for (std::size_t i = 0; i < layers_.size(); ++i) blends_.push_back(make_blend(i));
}

void LayeredField::to_common_datum(const ElevationField& layer, std::span<const glm::dvec3> normals,
                                   std::span<float> h) const {
    if (layer.datum() == datum_) return;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(h[i])) continue;
        const double height = static_cast<double>(h[i]);
        const GeoidUndulation N = geoid_(normals[i]);
        h[i] = static_cast<float>(datum_ == VerticalDatum::ellipsoid ? (OrthometricHeight{height} + N).m
                                                                     : (EllipsoidalHeight{height} - N).m);
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
    std::vector<glm::dvec3> left(normals.begin(), normals.end());
    std::vector<std::size_t> index(left.size());
    for (std::size_t i = 0; i < index.size(); ++i) index[i] = i;
    std::vector<double> correction(left.size(), 0.0);
    std::vector<float> h(left.size());
    for (std::size_t layer = count; layer-- > 0 && !left.empty();) {
        h.resize(left.size());
        layers_[layer]->heights(left, h);
        to_common_datum(*layers_[layer], left, h);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (!std::isnan(h[i])) {
                out[index[i]] = static_cast<float>(static_cast<double>(h[i]) + correction[i]);
                continue;
            }
            correction[kept] = correction[i] + blends_[layer](left[i]);
            left[kept] = left[i];
            index[kept++] = index[i];
        }
        left.resize(kept);
        index.resize(kept);
    }
    for (std::size_t i = 0; i < left.size(); ++i)
        out[index[i]] = std::isnan(left[i].x + left[i].y + left[i].z) ? nan : static_cast<float>(correction[i]);
}

double LayeredField::spacing_of_lowest(std::size_t count, const glm::dvec3& normal) const {
    for (std::size_t i = count; i-- > 0;)
        if (!std::isnan(layers_[i]->height(normal))) return layers_[i]->spacing({normal, 0});
    return std::numeric_limits<double>::infinity();
}

BorderBlend LayeredField::make_blend(std::size_t layer) const {
    std::vector<glm::dvec3> normals;
    layers_[layer]->border(normals);
    std::vector<float> fine(normals.size()), coarse(normals.size());
    layers_[layer]->heights(normals, fine);
    to_common_datum(*layers_[layer], normals, fine);
    heights_of_lowest(layer, normals, coarse);

    // One spacing for each of the cells of 1/64, about a degree: it hardly changes within one.
    std::map<std::array<int, 3>, double> reaches;
    std::vector<BorderBlend::Point> points;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(fine[i]) || std::isnan(coarse[i])) continue;
        const glm::ivec3 key(glm::floor(normals[i] * 64.0));
        double& reach = reaches[{key.x, key.y, key.z}];
        if (reach == 0) {
            double spacing = spacing_of_lowest(layer, normals[i]);
            if (std::isinf(spacing)) spacing = layers_[layer]->spacing({normals[i], 1e-6});
            reach = std::clamp(2 * spacing / radius_m_, 1e-9, 0.5);
        }
        points.push_back({normals[i], static_cast<double>(fine[i]) - static_cast<double>(coarse[i]), reach});
    }
    // Border points lie half a sample apart along the border; corners are up to 0.36 of one from the nearest.
    double fine_spacing = std::numeric_limits<double>::infinity();
    if (!points.empty()) fine_spacing = layers_[layer]->spacing({points.front().normal, 1e-6});
    return BorderBlend(std::move(points), std::isinf(fine_spacing) ? 0 : 0.36 * fine_spacing / radius_m_);
}

double LayeredField::spacing(const Cap& cap) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& layer : layers_) least = std::min(least, layer->spacing(cap));
    return least;
}

void LayeredField::keep_visible(std::size_t layer, std::vector<glm::dvec3>& normals, std::vector<float>& h) const {
    to_common_datum(*layers_[layer], normals, h);
    std::vector<float> above(normals.size());
    for (std::size_t higher = layers_.size(); higher-- > layer + 1;) {
        above.resize(normals.size());
        layers_[higher]->heights(normals, above);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < normals.size(); ++i) {
            if (!std::isnan(above[i])) continue;
            h[kept] = static_cast<float>(static_cast<double>(h[i]) + blends_[higher](normals[i]));
            normals[kept++] = normals[i];
        }
        normals.resize(kept);
        h.resize(kept);
    }
}

void LayeredField::samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const {
    std::vector<glm::dvec3> n;
    std::vector<float> h;
    for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
        n.clear();
        h.clear();
        layers_[layer]->samples(cap, n, h);
        keep_visible(layer, n, h);
        normals.insert(normals.end(), n.begin(), n.end());
        heights.insert(heights.end(), h.begin(), h.end());
    }
}

std::vector<SourceInfo> LayeredField::sources() const {
    std::vector<SourceInfo> all;
    for (const auto& layer : layers_)
        for (SourceInfo& s : layer->sources()) all.push_back(std::move(s));
    return all;
}

}  // namespace planet
