#pragma once
// A rough analytic planet for tests: rugged everywhere, finely sampled within a cap, coarsely elsewhere.

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/elevation/elevation_field.h"

namespace planet::testing {

class BumpyField final : public ElevationField {
  public:
    BumpyField(double coarse_m, Cap fine, double fine_m) : coarse_m_(coarse_m), fine_(fine), fine_m_(fine_m) {}

    VerticalDatum datum() const override { return VerticalDatum::egm96; }

    static double exact(const glm::dvec3& n) {
        double h = 0, amplitude = 2500, k = 7;
        for (int octave = 0; octave < 11; ++octave, amplitude *= 0.55, k *= 2.13)
            h += amplitude * std::sin(k * n.x + octave) * std::sin(k * n.y + 2 * octave) * std::cos(k * n.z - octave);
        return h;
    }
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override {
        for (std::size_t i = 0; i < normals.size(); ++i) out[i] = static_cast<float>(exact(normals[i]));
    }
    double spacing(const Cap& cap) const override {
        const double apart = std::acos(std::clamp(glm::dot(cap.centre, fine_.centre), -1.0, 1.0));
        return apart <= cap.angle + fine_.angle ? fine_m_ : coarse_m_;
    }
    void samples(const Cap& cap, std::vector<glm::dvec3>& normals, std::vector<float>& heights) const override {
        for (const glm::dvec3& n : extra_samples) {
            if (glm::dot(n, cap.centre) < std::cos(cap.angle)) continue;
            normals.push_back(n);
            heights.push_back(static_cast<float>(exact(n)));
        }
    }
    std::vector<SourceInfo> sources() const override {
        return {{"bumps", std::string(64, 'b'), "", VerticalDatum::egm96, coarse_m_}};
    }

    std::vector<glm::dvec3> extra_samples;

  private:
    double coarse_m_;
    Cap fine_;
    double fine_m_;
};

/// A smooth made-up geoid, +-60 m.
inline void bumpy_undulation(std::span<const glm::dvec3> normals, std::span<GeoidUndulation> out) {
    for (std::size_t i = 0; i < normals.size(); ++i)
        out[i].m = 60 * std::sin(3 * normals[i].x + 1) * std::cos(5 * normals[i].y) * std::sin(4 * normals[i].z + 2);
}

}  // namespace planet::testing
