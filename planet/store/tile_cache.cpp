#include "planet/store/tile_cache.h"

#include <algorithm>
#include <exception>
#include <limits>

#include "planet/error.h"
#include "planet/octahedron/octahedron_map.h"

namespace planet {

std::size_t bytes_of(const Tile& tile) {
    return sizeof(Tile) + sizeof(GeoidUndulation) * tile.undulation.capacity() + tile.origins.bytes() +
           sizeof(float) * (tile.height.capacity() + tile.deviation.capacity() + tile.radius.capacity());
}

TileCache::TileCache(const ElevationStore& store, std::size_t memory_bytes) : store_(&store), limit_(memory_bytes) {}

std::shared_ptr<const Tile> TileCache::tile(LocationCode root) const {
    std::unique_lock lock(mutex_);
    loaded_.wait(lock, [&] { return !loading_.contains(root.bits()); });
    if (const auto found = index_.find(root.bits()); found != index_.end()) {
        recent_.splice(recent_.begin(), recent_, found->second);
        return found->second->tile;
    }
    loading_.insert(root.bits());
    lock.unlock();
    std::shared_ptr<const Tile> tile;
    std::exception_ptr failure;
    try {
        tile = load(root);
    } catch (...) {
        failure = std::current_exception();
    }
    lock.lock();
    loading_.erase(root.bits());
    if (tile) keep(root.bits(), tile);
    lock.unlock();
    loaded_.notify_all();
    if (failure) std::rethrow_exception(failure);
    return tile;
}

void TileCache::keep(std::uint64_t code, const std::shared_ptr<const Tile>& tile) const {
    recent_.push_front({code, tile});
    index_.emplace(code, recent_.begin());
    decoded_bytes_ += bytes_of(*tile);
    drop_beyond_limit();
}

void TileCache::drop_beyond_limit() const {
    while (decoded_bytes_ + drawn_bytes_ > limit_ && recent_.size() > 1) {
        decoded_bytes_ -= bytes_of(*recent_.back().tile);
        index_.erase(recent_.back().code);
        recent_.pop_back();
    }
    peak_bytes_ = std::max(peak_bytes_, decoded_bytes_ + drawn_bytes_);
}

void TileCache::count_drawn_bytes(std::ptrdiff_t change) const {
    const std::lock_guard lock(mutex_);
    drawn_bytes_ += static_cast<std::size_t>(change);
    drop_beyond_limit();
}

std::shared_ptr<const Tile> TileCache::load(LocationCode root) const {
    bool damaged = false;
    {
        const std::lock_guard lock(mutex_);
        damaged = damaged_.contains(root.bits());
    }
    if (!damaged) try {
            std::optional<Tile> read = store_->read(root);
            return read ? std::make_shared<const Tile>(std::move(*read)) : nullptr;
        } catch (const Error& error) {
            if (error.fault() != Fault::bad_data) throw;
            const std::lock_guard lock(mutex_);
            if (damaged_.insert(root.bits()).second) damage_.emplace_back(error.what());
        }
    return stand_in(root);
}

namespace {

// The vertex of a face's tile at one of its corners, left, right, apex: their vertex indices are 0, 1, 2.
std::optional<std::size_t> corner_at(int face, const glm::dvec3& normal) {
    const Corners c = face_corners(face);
    if (c.left == normal) return 0;
    if (c.right == normal) return 1;
    if (c.apex == normal) return 2;
    return std::nullopt;
}

// To a tile of depth 1.
void copy_vertex(const Tile& from, std::size_t v, Tile& to, std::size_t w) {
    to.height[w] = from.height[v];
    if (from.undulation.empty()) return;
    to.undulation.resize(4);
    to.undulation[w] = from.undulation[v];
}

}  // namespace

// A damaged face has its corners from the first face there that can be read. Past the cache: threads with two damaged
// faces would wait for each other.
void TileCache::take_corners_of_other_faces(Tile& tile) const {
    const Corners c = face_corners(tile.root.face());
    const glm::dvec3 normal[3] = {c.left, c.right, c.apex};
    for (int face = 0; face < face_count; ++face) {
        std::optional<Tile> other;
        try {
            if (face != tile.root.face()) other = store_->read(LocationCode::face_root(face));
        } catch (const Error&) {
        }
        if (!other) continue;
        for (std::size_t v = 0; v < 3; ++v)
            if (const auto corner = corner_at(face, normal[v])) copy_vertex(*other, *corner, tile, v);
    }
}

std::shared_ptr<const Tile> TileCache::stand_in(LocationCode root) const {
    Tile t;
    t.root = root;
    t.depth = 1;
    t.damaged = true;
    t.resampling = std::numeric_limits<float>::infinity();
    t.height.assign(4, 0.0f);
    t.deviation.assign(2, 0.0f);
    t.radius.assign(2, 0.0f);
    if (root.bisection_level() == 0) {
        take_corners_of_other_faces(t);
    } else if (const TileLayers layers = store_->metadata().layers; const auto parent = tile(layers.above(root))) {
        const auto& corner = tile_layout().corners[layers.local_above(root)];
        for (std::size_t v = 0; v < 3 && !parent->damaged; ++v) copy_vertex(*parent, corner[v], t, v);
    }
    t.height[3] = 0.5f * (t.height[0] + t.height[1]);
    if (!t.undulation.empty()) t.undulation[3].m = 0.5 * (t.undulation[0].m + t.undulation[1].m);
    t.min_height = *std::min_element(t.height.begin(), t.height.end());
    t.max_height = *std::max_element(t.height.begin(), t.height.end());
    return std::make_shared<const Tile>(std::move(t));
}

std::size_t TileCache::memory_bytes() const {
    const std::lock_guard lock(mutex_);
    return decoded_bytes_ + drawn_bytes_;
}

std::size_t TileCache::memory_peak_bytes() const {
    const std::lock_guard lock(mutex_);
    return peak_bytes_;
}

std::vector<std::string> TileCache::damage() const {
    const std::lock_guard lock(mutex_);
    return damage_;
}

}  // namespace planet
