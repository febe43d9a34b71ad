#pragma once
// Made-up relief: a band-limited fractal of gradient noise.
//
// The sum over octaves k = 0, 1, ... of a_k noise_k(p / l_k), p on the sphere of radius_m, with wavelengths
// l_k = longest_m / 2^k down to shortest_m and amplitudes a_k = amplitude_m * 2^(-k hurst). noise_k is Perlin's
// gradient noise in three dimensions ("Improving noise", SIGGRAPH 2002: quintic blend, twelve gradients), scaled to
// root mean square 1, with lattice and gradients of its own for every octave and seed. Each octave's power lies around
// its own wave number (most of it within an octave), so the power spectrum of a profile falls as wave number^-(2 hurst
// + 1), and there is next to nothing beyond 2 / shortest_m. `ridged` folds every octave: sqrt(3) (1 - 2 |noise_k|)
// (mean near 0) makes crests of its zeros (Musgrave, in "Texturing and Modeling: A Procedural Approach").
//
// Being a function of the position in space it has no poles and no seams. Integer hashing, additions and products only:
// the same bits on every machine.

#include <cstdint>

#include "planet/elevation/elevation_field.h"

namespace planet {

struct FractalParameters {
    std::uint32_t seed = 1;
    double amplitude_m = 2000;  ///< root mean square of the longest octave; finite, >= 0
    double longest_m = 4e6;     ///< the longest wavelength
    double shortest_m = 500;    ///< the shortest, in (radius / 1e9, longest_m]
    double hurst = 0.9;         ///< roughness, [0, 2]: the larger the smoother
    bool ridged = false;
    double radius_m = 6371008.8;
    VerticalDatum datum = VerticalDatum::egm96;
};

class FractalField : public ElevationField {
  public:
    /// Throws Error(bad_usage) for a parameter outside its range.
    explicit FractalField(const FractalParameters& parameters);

    VerticalDatum datum() const override { return parameters_.datum; }
    /// About 25 ns an octave and point.
    void heights(std::span<const glm::dvec3> normals, std::span<float> out) const override;
    /// A quarter of the shortest wavelength present.
    double spacing(const Cap& cap) const override;
    void samples(const Cap&, std::vector<glm::dvec3>&, std::vector<float>&) const override {}
    std::vector<SourceInfo> sources() const override;

  private:
    struct Octave {
        double frequency;  // lattice cells a radius
        double amplitude;
        glm::dvec3 shift;  // of the lattice, so that octaves do not share their zeros
        std::uint32_t seed;
    };
    FractalParameters parameters_;
    std::vector<Octave> octaves_;
};

}  // namespace planet
