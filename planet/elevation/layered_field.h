#pragma once
// Several elevation fields as one, by priority.

#include <functional>
#include <memory>

#include "planet/elevation/elevation_field.h"
#include "planet/elevation/regional_blend.h"

namespace planet {

/// The later a layer, the higher its priority. Where a layer has an answer no lower one alters it. Outside it, voids
/// included, the lower ones are led up to its border over two of their samples (border_blend.h). Where no layer has an
/// answer the height is 0, led up to borders in the same way, over two samples of the layer that ends there: a layered
/// field answers everywhere.
///
/// The blend of a long border (more than 2^19 points, e.g. of a raster with many voids) is made in regions when places
/// there are asked for. A region with more than 2^17 points around it keeps the nearest ones, and of the others every
/// n-th, which then counts n times. Where the lower layer's samples are so far apart (160 km) that there are no regions
/// every n-th point of all is kept: lower layers then meet the border between those with a mean of what they are short of
/// at the ones around.
class LayeredField : public ElevationField {
  public:
    /// The geoid above the ellipsoid at unit normals, e.g. Geoid::undulations; spans of the same size. Must be safe from
    /// several threads.
    using GeoidFunction = std::function<void(std::span<const glm::dvec3>, std::span<GeoidUndulation>)>;

    /// @param layers   lowest first; at least one
    /// @param datum    what all heights are turned into
    /// @param geoid    needed if a layer's datum is another one, else Error(bad_usage)
    /// @param radius_m of the planet, turns sample spacings into angles
    /// @param blend_bytes  kept of the blends that are made in regions
    LayeredField(std::vector<std::shared_ptr<const ElevationField>> layers, VerticalDatum datum,
                 GeoidFunction geoid = {}, double radius_m = 6378137, std::size_t blend_bytes = std::size_t{64} << 20);

    LayeredField(const LayeredField&) = delete;
    LayeredField& operator=(const LayeredField&) = delete;

    VerticalDatum datum() const override { return datum_; }
    /// Finite for every normal but NaN, which gives NaN.
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override;
    /// In a blend the higher layer's weight is the smooth step by which its border fades out, and the lower ones share the
    /// rest.
    void heights_with_origins(std::span<const glm::dvec3> normals, std::span<float> out,
                              std::span<WeighedOrigin> origins) const override;
    /// The least of the layers'.
    double spacing(const Cap& cap) const override;
    /// Samples that a higher layer covers are left out; those in a blend are as blended.
    void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const override;
    void sample_rows(const SampleArea& area, const SampleRowVisitor& visit) const override;
    /// Lowest first, each with its own datum.
    std::vector<SourceInfo> sources() const override;

  private:
    void to_common_datum(const ElevationField& layer, std::span<const glm::dvec3> normals, std::span<float> h) const;
    class Piece;
    /// The surface of the lowest `count` layers. @param origins  may be empty
    void heights_of_lowest(std::size_t count, std::span<const glm::dvec3> normals, std::span<float> out,
                           std::span<WeighedOrigin> origins = {}) const;
    /// A layer's own, above datum_. @param origins  may be empty
    void heights_of_layer(std::size_t layer, std::span<const glm::dvec3> normals, std::span<float> out,
                          std::span<WeighedOrigin> origins) const;
    /// Corrects the samples of a layer; those that one of the `higher` layers covers become NaN.
    void hide_covered(std::size_t layer, std::span<const std::size_t> higher, std::span<const glm::dvec3> normals,
                      std::span<float> h) const;
    RegionalBlend make_blend(std::size_t layer, std::size_t bytes) const;
    BorderBlend blend_of_region(std::size_t layer, const Cap& region, const Cap& around) const;
    /// Blends points of a layer's border, the first `single` of which count once and the others `every` times.
    BorderBlend blend_of(std::size_t layer, std::span<const glm::dvec3> normals, std::size_t single,
                         std::size_t every) const;
    /// No border point of a layer reaches farther than this chord.
    double most_reach(std::size_t layer) const;
    double reach_around(std::size_t layer, const glm::dvec3& normal) const;
    /// The sample spacing in metres of the highest of the lowest `count` layers that answers there.
    double spacing_of_lowest(std::size_t count, const glm::dvec3& normal) const;

    std::vector<std::shared_ptr<const ElevationField>> layers_;
    std::vector<std::uint32_t> first_file_;  // by layer: how many files there are below it
    std::vector<double> reaches_;            // by layer
    std::vector<RegionalBlend> blends_;      // by layer; of the lowest `blends_.size()` while the rest is being made
    VerticalDatum datum_;
    GeoidFunction geoid_;
    double radius_m_;
};

}  // namespace planet
