#pragma once
// The same height everywhere.

#include <algorithm>

#include "planet/elevation/elevation_field.h"

namespace planet {

class ConstantField : public ElevationField {
  public:
    /// @param height_m finite
    explicit ConstantField(double height_m = 0, VerticalDatum datum = VerticalDatum::egm96)
        : height_m_(static_cast<float>(height_m)), datum_(datum) {}

    VerticalDatum datum() const override { return datum_; }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override {
        std::transform(normals.begin(), normals.end(), out.begin(), [this](const glm::dvec3& n) {
            const float zero = static_cast<float>(0 * (n.x + n.y + n.z));  // NaN for NaN
            return height_m_ + zero;
        });
    }
    /// Any spacing will do; half the way around the Earth stands for that, so that it is still a length.
    double spacing(const Cap&) const override { return 2e7; }
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override;

  private:
    float height_m_;
    VerticalDatum datum_;
};

}  // namespace planet
