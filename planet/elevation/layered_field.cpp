#include "planet/elevation/layered_field.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

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
    first_file_.push_back(0);
    for (const auto& layer : layers_)
        first_file_.push_back(first_file_.back() + static_cast<std::uint32_t>(source_files(layer->sources()).size()));
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

void LayeredField::heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                                        std::span<WeighedOrigin> origins) const {
    assert(origins.size() == normals.size());
    heights_of_lowest(layers_.size(), normals, out, origins);
}

void LayeredField::heights_of_layer(std::size_t layer, std::span<const glm::dvec3> normals, std::span<float> out,
                                    std::span<WeighedOrigin> origins) const {
    if (origins.empty()) {
        layers_[layer]->heights(normals, out);
    } else {
        layers_[layer]->heights_with_origins(normals, out, origins);
        const std::uint32_t below = first_file_[layer];
        for (std::size_t i = 0; i < origins.size() && below > 0; ++i)
            for (std::uint32_t* file : {&origins[i].origin.file, &origins[i].origin.other})
                *file += *file > 0 ? below : 0;
    }
    to_common_datum(*layers_[layer], normals, out);
}

namespace {

/// The two files with the greatest weights at a place, as they are found from the highest layer down.
class OriginMix {
  public:
    /// @param weight  0..1, of what has none yet
    void add(std::uint32_t file, double weight) {
        take(file, left_ * weight);
        left_ *= 1 - weight;
    }
    /// All that has none yet.
    void end(const WeighedOrigin& origin) {
        const auto weight = static_cast<double>(origin.weight);
        take(origin.origin.file, left_ * weight);
        if (origin.origin.blended()) take(origin.origin.other, left_ * (1 - weight));
    }
    WeighedOrigin origin() const {
        const bool blended = most_[1].weight > 0;
        return {{most_[0].file, most_[blended ? 1 : 0].file}, static_cast<float>(most_[0].weight)};
    }

  private:
    void take(std::uint32_t file, double weight) {
        BorderShare one{weight, file};
        for (BorderShare& known : most_)
            if (known.weight > 0 && known.file == file) one.weight += std::exchange(known.weight, 0);
        // Of equal ones the first: what lies higher.
        if (most_[1].weight > most_[0].weight) std::swap(most_[0], most_[1]);
        if (one.weight > most_[0].weight) std::swap(one, most_[0]);
        if (one.weight > most_[1].weight) most_[1] = one;
    }
    std::array<BorderShare, 2> most_{};
    double left_ = 1;
};

}  // namespace

/// Some thousands of places, from the highest layer down: those without an answer yet take along the corrections of the
/// layers they have passed.
class LayeredField::Piece {
  public:
    Piece(const LayeredField& field, std::span<const glm::dvec3> normals, std::span<float> out,
          std::span<WeighedOrigin> origins)
        : field_(field), normals_(normals), out_(out), origins_(origins) {}

    void find(std::size_t count) {
        ask_highest(count);
        correction_.resize(left_.size());
        mix_.resize(origins_.empty() ? 0 : left_.size());
        for (std::size_t layer = count; layer-- > 0 && !left_.empty();) {
            blend(layer);
            if (layer > 0) ask(layer - 1);
        }
        for (std::size_t i = 0; i < left_.size(); ++i) {
            const glm::dvec3& n = left_[i];
            answer(i, std::isnan(n.x + n.y + n.z) ? nan : 0.0f, {});
        }
    }

  private:
    // It has most answers: without copies.
    void ask_highest(std::size_t count) {
        std::fill(out_.begin(), out_.end(), nan);
        if (count > 0) field_.heights_of_layer(count - 1, normals_, out_, origins_);
        for (std::size_t i = 0; i < normals_.size(); ++i) {
            if (!std::isnan(out_[i])) continue;
            left_.push_back(normals_[i]);
            index_.push_back(i);
        }
    }

    void blend(std::size_t layer) {
        share_.assign(mix_.size(), {});
        field_.blends_[layer].add(left_, correction_, share_);
        for (std::size_t i = 0; i < mix_.size(); ++i)
            if (share_[i].weight > 0) mix_[i].add(share_[i].file, share_[i].weight);
    }

    void ask(std::size_t layer) {
        height_.resize(left_.size());
        origin_.resize(mix_.size());
        field_.heights_of_layer(layer, left_, height_, origin_);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < left_.size(); ++i) {
            if (!std::isnan(height_[i])) {
                answer(i, height_[i], mix_.empty() ? WeighedOrigin{} : origin_[i]);
                continue;
            }
            correction_[kept] = correction_[i];
            left_[kept] = left_[i];
            if (!mix_.empty()) mix_[kept] = mix_[i];
            index_[kept++] = index_[i];
        }
        left_.resize(kept);
        index_.resize(kept);
        correction_.resize(kept);
        if (!mix_.empty()) mix_.resize(kept);
    }

    void answer(std::size_t i, float height, const WeighedOrigin& origin) {
        out_[index_[i]] = static_cast<float>(static_cast<double>(height) + correction_[i]);
        if (mix_.empty()) return;
        mix_[i].end(origin);
        origins_[index_[i]] = mix_[i].origin();
    }

    const LayeredField& field_;
    std::span<const glm::dvec3> normals_;
    std::span<float> out_;
    std::span<WeighedOrigin> origins_;  // empty: nobody asks
    // Of the places without an answer; the last two only if somebody asks for origins.
    std::vector<glm::dvec3> left_;
    std::vector<std::size_t> index_;
    std::vector<double> correction_;
    std::vector<BorderShare> share_;
    std::vector<OriginMix> mix_;
    std::vector<float> height_;  // of one layer
    std::vector<WeighedOrigin> origin_;
};

void LayeredField::heights_of_lowest(std::size_t count, std::span<const glm::dvec3> normals, std::span<float> out,
                                     std::span<WeighedOrigin> origins) const {
    assert(out.size() == normals.size());
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        Piece(*this, normals.subspan(first, n), out.subspan(first, n),
              origins.empty() ? origins : origins.subspan(first, n))
            .find(count);
    }
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
    std::vector<WeighedOrigin> origins(normals.size());
    heights_of_layer(layer, normals, fine, origins);
    heights_of_lowest(layer, normals, coarse);

    std::map<std::array<int, 3>, double> reaches;
    std::vector<BorderBlend::Point> points;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        if (std::isnan(fine[i]) || std::isnan(coarse[i])) continue;
        const glm::ivec3 key(glm::floor(normals[i] * 64.0));
        double& reach = reaches[{key.x, key.y, key.z}];
        if (reach == 0) reach = std::min(reach_around(layer, normals[i]), reaches_[layer]);
        points.push_back({normals[i], static_cast<double>(fine[i]) - static_cast<double>(coarse[i]), reach,
                          i < single ? 1.0f : static_cast<float>(every), origins[i].origin.file});
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
