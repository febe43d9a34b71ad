#include "render/picture/relief_patches.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "planet/octahedron/octahedron_map.h"
#include "planet/parallel.h"
#include "render/gl/buffer.h"

namespace render {

namespace {

/// The surface is flat between its vertices: differences are taken over at least their distance, up to this many texels,
/// so that normals turn smoothly where texels are finer than the data.
constexpr int longest_step = 8;

/// Direction at lattice point (i, j), 0..64, of the square whose near half is `near` and far half `far`. Linear in each
/// half; beyond the border the halves go on.
glm::dvec3 lattice_normal(const planet::Corners& near, const planet::Corners& far, int i, int j) {
    const double u = i / 64.0, v = j / 64.0;
    const glm::dvec3 n = i + j <= 64 ? near.apex + u * (near.left - near.apex) + v * (near.right - near.apex)
                                     : far.apex + (1 - u) * (far.left - far.apex) + (1 - v) * (far.right - far.apex);
    return glm::normalize(n);
}

/// One patch's 65 x 65 texels from the finest surface by central differences.
void make_patch(planet::LocationCode patch, const PatchSurface& surface, double radius_m, std::int16_t* texels) {
    const planet::Corners near = planet::corners(patch), far = planet::corners(planet::neighbor(patch));
    const double texel_m = glm::distance(near.apex, near.left) * radius_m / (patch_side - 1);
    const int step =
        static_cast<int>(std::clamp(std::ceil(surface.spacing(lattice_normal(near, far, 32, 32)) / texel_m), 1.0,
                                    static_cast<double>(longest_step)));
    const int ringed = patch_side + 2 * step;
    const auto samples = static_cast<std::size_t>(ringed * ringed);
    std::vector<glm::dvec3> normal(samples), place(samples);
    std::vector<float> height(samples);
    for (int j = 0; j < ringed; ++j)
        for (int i = 0; i < ringed; ++i)
            normal[static_cast<std::size_t>(j * ringed + i)] = lattice_normal(near, far, i - step, j - step);
    surface.heights(normal, height);
    for (std::size_t k = 0; k < samples; ++k) place[k] = normal[k] * (radius_m + static_cast<double>(height[k]));
    for (int j = 0; j < patch_side; ++j)
        for (int i = 0; i < patch_side; ++i) {
            const std::size_t k = static_cast<std::size_t>((j + step) * ringed + i + step);
            const auto across = static_cast<std::size_t>(step), down = static_cast<std::size_t>(step * ringed);
            const glm::dvec3& n = normal[k];
            glm::dvec3 t =
                glm::normalize(glm::cross(place[k + across] - place[k - across], place[k + down] - place[k - down]));
            if (glm::dot(t, n) < 0) t = -t;
            // The gradient as a vector along the ground: exaggeration scales it, and normalizing n + offset gives t back.
            const glm::dvec3 offset = t / std::max(glm::dot(t, n), 0.05) - n;
            std::int16_t* texel = texels + (j * patch_side + i) * 4;
            for (int c = 0; c < 3; ++c)
                texel[c] = static_cast<std::int16_t>(
                    std::lround(std::clamp(offset[c] / static_cast<double>(patch_range), -1.0, 1.0) * 32767));
            texel[3] = 32767;
        }
}

/// Halves a level of side n to n / 2 by areas: with odd n texels overlap three of the finer ones.
void halve(const std::int16_t* fine, int n, std::int16_t* coarse, int m) {
    const double ratio = static_cast<double>(n) / m;
    const auto weight = [&](int to, int from) {
        return std::max(0.0, std::min((to + 1) * ratio, from + 1.0) - std::max(to * ratio, static_cast<double>(from)));
    };
    for (int y = 0; y < m; ++y)
        for (int x = 0; x < m; ++x) {
            double sum[4] = {}, total = 0;
            for (int v = static_cast<int>(y * ratio); v < n && v < (y + 1) * ratio; ++v)
                for (int u = static_cast<int>(x * ratio); u < n && u < (x + 1) * ratio; ++u) {
                    const double w = weight(x, u) * weight(y, v);
                    total += w;
                    for (int k = 0; k < 4; ++k) sum[k] += w * fine[(v * n + u) * 4 + k];
                }
            for (int k = 0; k < 4; ++k)
                coarse[(y * m + x) * 4 + k] = static_cast<std::int16_t>(std::lround(sum[k] / total));
        }
}

}  // namespace

std::vector<std::vector<std::int16_t>> make_relief_patch(planet::LocationCode patch, const PatchSurface& surface,
                                                         double radius_m) {
    std::vector<std::vector<std::int16_t>> levels(static_cast<std::size_t>(mip_levels(patch_side, patch_side)));
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const int side = patch_side >> l;
        levels[l].resize(static_cast<std::size_t>(side * side) * 4);
        if (l == 0)
            make_patch(patch, surface, radius_m, levels[0].data());
        else
            halve(levels[l - 1].data(), patch_side >> (l - 1), levels[l].data(), side);
    }
    return levels;
}

void ReliefPatches::build(const planet::Segments& segments, const PatchSurface& surface, double radius_m, int threads) {
    layers_.clear();
    std::vector<planet::LocationCode> codes;
    std::unordered_map<std::uint64_t, std::int32_t> layer_of;
    for (const planet::Segment& s : segments.segments()) {
        if (!s.detailed) {
            layers_.push_back(-1);
            continue;
        }
        const auto [found, is_new] = layer_of.try_emplace(s.patch.bits(), static_cast<std::int32_t>(codes.size()));
        if (is_new) codes.push_back(s.patch);
        layers_.push_back(found->second);
    }
    count_ = codes.size();

    levels_.assign(static_cast<std::size_t>(mip_levels(patch_side, patch_side)), {});
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const auto side = static_cast<std::size_t>(patch_side >> l);
        levels_[l].resize(count_ * side * side * 4);
    }
    planet::parallel_for(count_, static_cast<unsigned>(std::max(threads, 1)), [&](std::size_t p) {
        make_patch(codes[p], surface, radius_m, levels_[0].data() + p * patch_side * patch_side * 4);
        for (std::size_t l = 1; l < levels_.size(); ++l) {
            const int n = patch_side >> (l - 1), m = patch_side >> l;
            halve(levels_[l - 1].data() + p * static_cast<std::size_t>(n * n) * 4, n,
                  levels_[l].data() + p * static_cast<std::size_t>(m * m) * 4, m);
        }
    });
}

Texture ReliefPatches::upload() const {
    Texture t =
        Texture::make_2d_array(GL_RGBA16_SNORM, patch_side, patch_side,
                               static_cast<int>(std::max<std::size_t>(count_, 1)), static_cast<int>(levels_.size()));
    if (count_ > 0)
        for (int l = 0; l < t.levels(); ++l) t.upload(l, bytes_of(levels_[static_cast<std::size_t>(l)]));
    return t;
}

}  // namespace render
