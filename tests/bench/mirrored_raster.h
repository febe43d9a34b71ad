#pragma once
// The raster of the benchmarks: real terrain, of a size that large DEMs have.

#include "planet/elevation/raster_io.h"
#include "planet/patches/patch_mesh.h"

namespace planet::bench {

/// The shipped DEM of the Sangre de Cristo, 2401 x 1201, reflected about its last row and column until `size` samples
/// are there both ways. 3 arc-seconds a sample, EPSG:4326, from 37 to 38 degrees north.
inline Raster mirrored_raster(int size) {
    const Raster source = read_raster(OCTAGLOBE_SOURCE_DIR "/data/sangre_de_cristo.tif");
    const auto& from = std::get<std::vector<std::int16_t>>(source.samples);
    const auto reflected = [](int i, int count) {
        const int in_period = i % (2 * count - 2);
        return in_period < count ? in_period : 2 * count - 2 - in_period;
    };
    Raster mirrored = source;
    mirrored.width = mirrored.height = size;
    std::vector<std::int16_t> samples;
    samples.reserve(mirrored.count());
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            samples.push_back(from[static_cast<std::size_t>(reflected(y, source.height) * source.width +
                                                            reflected(x, source.width))]);
    mirrored.samples = std::move(samples);
    return mirrored;
}

/// One patch, 2^12 + 1 samples a side, with what is made of it: once for all benchmarks.
struct Terrain {
    std::shared_ptr<const Raster> source = std::make_shared<Raster>(mirrored_raster(4097));
    PatchRaster raster{*source};
    DenseQuadtree<float> deviation = patch_deviations(raster);

    PatchTriangulation refined(double tolerance) const {
        PatchTriangulation mesh = coarsest(raster);
        refine_to_tolerance(mesh, deviation, tolerance);
        return mesh;
    }
};

inline const Terrain& terrain() {
    static const Terrain t;
    return t;
}

/// Metres.
inline constexpr double bench_tolerance = 20;

}  // namespace planet::bench
