#include "planet/streaming/mesh_ahead.h"

#include <cassert>
#include <chrono>

namespace planet {

void MeshAhead::begin(const SegmentView& next, const std::optional<SegmentView>& ahead, std::size_t most, int threads) {
    assert(!making_.valid());
    making_ = std::async(std::launch::async, [=, this] {
        const auto start = std::chrono::steady_clock::now();
        segments_.invalidate(tiles_.update(next, ahead ? &*ahead : nullptr, most));
        segments_.prepare(tiles_, next, threads);
        seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    });
}

bool MeshAhead::finish() {
    if (!making_.valid()) return false;
    making_.get();
    return true;
}

}  // namespace planet
