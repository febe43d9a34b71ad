#include "render/viewer/patch_cache.h"

#include <algorithm>

#include "render/gl/buffer.h"

namespace render {

namespace {

constexpr int first_layers = 128;

Texture make_texture(int layers) {
    return Texture::make_2d_array(GL_RGBA16_SNORM, patch_side, patch_side, layers, mip_levels(patch_side, patch_side));
}

}  // namespace

PatchCache::PatchCache(PatchSurface surface, double radius_m, unsigned threads, std::size_t capacity)
    : surface_(std::move(surface)), radius_m_(radius_m), capacity_(static_cast<int>(capacity)) {
    grow(std::min(first_layers, capacity_));
    for (unsigned i = 0; i < std::max(threads, 1u); ++i) threads_.emplace_back([this] { work(); });
}

PatchCache::~PatchCache() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_all();
}

void PatchCache::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [this] { return ending_ || !wanted_.empty(); });
        if (ending_) return;
        const planet::LocationCode code = wanted_.back();
        wanted_.pop_back();
        in_the_making_.insert(code.bits());
        lock.unlock();
        Levels levels = make_relief_patch(code, surface_, radius_m_);
        lock.lock();
        made_.push_back({code, std::move(levels)});
        done_.notify_all();
    }
}

void PatchCache::grow(int layers) {
    Texture larger = make_texture(layers);
    const int had = texture_ ? texture_.depth() : 0;
    for (int level = 0; level < larger.levels() && had > 0; ++level)
        gl().CopyImageSubData(texture_.name(), GL_TEXTURE_2D_ARRAY, level, 0, 0, 0, larger.name(), GL_TEXTURE_2D_ARRAY,
                              level, 0, 0, 0, larger.width(level), larger.height(level), had);
    for (int layer = layers; layer-- > had;) free_.push_back(layer);
    texture_ = std::move(larger);
}

/// -1 if all are in use.
int PatchCache::free_layer() {
    if (free_.empty() && texture_.depth() < capacity_) grow(std::min(2 * texture_.depth(), capacity_));
    if (free_.empty()) {
        const auto oldest = std::min_element(
            kept_.begin(), kept_.end(), [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
        if (oldest->second.used == frame_) return -1;
        free_.push_back(oldest->second.layer);
        kept_.erase(oldest);
    }
    const int layer = free_.back();
    free_.pop_back();
    return layer;
}

void PatchCache::take_in(const Made& made) {
    const int layer = free_layer();
    if (layer < 0) return;
    for (int level = 0; level < texture_.levels(); ++level)
        texture_.upload_layer(level, layer, bytes_of(made.levels[static_cast<std::size_t>(level)]));
    kept_.emplace(made.code.bits(), Kept{layer, frame_});
}

void PatchCache::wait() {
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return !made_.empty() || (wanted_.empty() && in_the_making_.empty()); });
}

bool PatchCache::update(const planet::Segments& segments, bool segments_changed, std::size_t most) {
    std::vector<Made> made;
    {
        const std::lock_guard lock(mutex_);
        const std::size_t count = std::min(most, made_.size());
        made.assign(std::make_move_iterator(made_.begin()),
                    std::make_move_iterator(made_.begin() + std::ptrdiff_t(count)));
        made_.erase(made_.begin(), made_.begin() + std::ptrdiff_t(count));
        for (const Made& m : made) in_the_making_.erase(m.code.bits());
    }
    if (made.empty() && !segments_changed) return false;
    ++frame_;
    for (const planet::Segment& s : segments.segments())
        if (s.detailed)
            if (const auto found = kept_.find(s.patch.bits()); found != kept_.end()) found->second.used = frame_;
    for (const Made& m : made) take_in(m);

    layers_.clear();
    std::vector<planet::LocationCode> lacking;
    std::unordered_set<std::uint64_t> asked;
    for (const planet::Segment& s : segments.segments()) {
        const auto found = s.detailed ? kept_.find(s.patch.bits()) : kept_.end();
        layers_.push_back(found == kept_.end() ? -1 : found->second.layer);
        if (s.detailed && found == kept_.end() && asked.insert(s.patch.bits()).second) lacking.push_back(s.patch);
    }
    missing_ = lacking.size();
    {
        const std::lock_guard lock(mutex_);
        for (const Made& m : made_) asked.erase(m.code.bits());
        std::erase_if(lacking, [&](planet::LocationCode c) {
            return in_the_making_.contains(c.bits()) || !asked.contains(c.bits());
        });
        wanted_ = std::move(lacking);
    }
    wake_.notify_all();
    return true;
}

}  // namespace render
