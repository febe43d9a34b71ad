#include "render/app/tin/tin_tile_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace render {

/// Whether a tile has a triangle at a sample: a unit square of it there has three valid corners, the sample one of them.
bool TileSamples::covers(std::size_t tile, glm::ivec2 p, const TileWindow& w) const {
    const glm::ivec2 low = tiling_.low(tile), high = tiling_.high(tile);
    for (int y = std::max(low.y, p.y - 1); y < std::min(high.y, p.y + 1); ++y)
        for (int x = std::max(low.x, p.x - 1); x < std::min(high.x, p.x + 1); ++x)
            if (w.valid({x, y}) + w.valid({x + 1, y}) + w.valid({x, y + 1}) + w.valid({x + 1, y + 1}) >= 3)
                return w.valid(p);
    return false;
}

bool TileSamples::counts_here(std::size_t tile, glm::ivec2 p, bool covered, const TileWindow& w) const {
    for (const std::size_t other : tiling_.tiles_at(p)) {
        if (other == tile) continue;
        if (covers(other, p, w) ? other > tile || !covered : other > tile && !covered) return false;
    }
    return true;
}

SampleCount TileSamples::count(std::size_t tile, const TileWindow& w, const std::vector<float>& deviation) {
    SampleCount found;
    const glm::ivec2 end(tiling_.width() - 1, tiling_.height() - 1);
    std::size_t i = 0;
    for (int y = w.low.y; y <= w.high.y; ++y)
        for (int x = w.low.x; x <= w.high.x; ++x, ++i) {
            const float off = deviation.empty() ? std::nanf("") : deviation[i];
            const bool covered = !std::isnan(off);
            const bool on_border = x == w.low.x || y == w.low.y || x == w.high.x || y == w.high.y;
            if (on_border && !counts_here(tile, {x, y}, covered, w)) continue;
            const bool valid = w.valid({x, y});
            found.covered += valid && covered;
            found.uncovered += valid && !covered;
            found.voids += !valid;
            if (valid && covered) found.squares += static_cast<double>(off) * static_cast<double>(off);
            const bool next_tiles = (x == w.high.x && x < end.x) || (y == w.high.y && y < end.y);
            if (!error_grid_ || !next_tiles || !covered) continue;
            const std::lock_guard lock(mutex_);
            kept_[{y, x}] = off;
        }
    if (error_grid_) write(w, deviation);
    return found;
}

/// Without the last row and column, which the next tile has, too.
void TileSamples::write(const TileWindow& w, const std::vector<float>& deviation) {
    const glm::ivec2 size = w.high - w.low + 1;
    const planet::SampleWindow own{w.low.x, w.low.y, size.x - (w.high.x < tiling_.width() - 1),
                                   size.y - (w.high.y < tiling_.height() - 1)};
    std::vector<float> samples;
    for (int y = 0; y < own.rows && !deviation.empty(); ++y) {
        const auto row = deviation.begin() + std::ptrdiff_t{y} * size.x;
        samples.insert(samples.end(), row, row + own.columns);
    }
    samples.resize(own.count(), std::nanf(""));
    const std::lock_guard lock(mutex_);
    error_grid_->write(own, samples);
}

void TileSamples::write_the_rest() {
    for (const auto& [p, deviation] : kept_) error_grid_->write({p.second, p.first, 1, 1}, std::span(&deviation, 1));
}

}  // namespace render
