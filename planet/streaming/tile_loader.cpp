#include "planet/streaming/tile_loader.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace planet {

namespace {

// Equally wanted: along the curve, so that one thread loads the same order every time.
bool less_wanted(const TileRequest& a, const TileRequest& b) {
    return a.priority != b.priority ? a.priority < b.priority : b.root < a.root;
}

}  // namespace

TileLoader::TileLoader(Load load, unsigned threads) : load_(std::move(load)) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    for (unsigned t = 0; t < threads; ++t) threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
}

TileLoader::~TileLoader() {
    request({});
    for (std::jthread& t : threads_) t.request_stop();
}

void TileLoader::request(std::vector<TileRequest> wanted) {
    {
        const std::lock_guard lock(mutex_);
        std::erase_if(wanted, [&](const TileRequest& r) { return begun_.contains(r.root.bits()); });
        waiting_ = std::move(wanted);
        std::make_heap(waiting_.begin(), waiting_.end(), less_wanted);
    }
    work_to_do_.notify_all();
    loaded_or_idle_.notify_all();
}

std::vector<LoadedTile> TileLoader::take(std::size_t most) {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    const auto end = loaded_.begin() + static_cast<std::ptrdiff_t>(std::min(most, loaded_.size()));
    std::vector<LoadedTile> taken(std::move_iterator(loaded_.begin()), std::move_iterator(end));
    loaded_.erase(loaded_.begin(), end);
    for (const LoadedTile& tile : taken) begun_.erase(tile.root.bits());
    return taken;
}

void TileLoader::wait(std::size_t tiles) {
    std::unique_lock lock(mutex_);
    loaded_or_idle_.wait(lock,
                         [&] { return loaded_.size() >= tiles || failure_ || (waiting_.empty() && loading_ == 0); });
}

std::size_t TileLoader::on_their_way() const {
    const std::lock_guard lock(mutex_);
    return waiting_.size() + loading_ + loaded_.size();
}

void TileLoader::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (work_to_do_.wait(lock, stop, [&] { return !waiting_.empty(); })) {
        std::pop_heap(waiting_.begin(), waiting_.end(), less_wanted);
        const LocationCode root = waiting_.back().root;
        waiting_.pop_back();
        begun_.insert(root.bits());
        ++loading_;
        lock.unlock();
        LoadedTile tile{root, nullptr, false, {}};
        std::exception_ptr failure;
        try {
            tile = load_(root);
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        --loading_;
        if (failure) {
            failure_ = failure;
            begun_.erase(root.bits());
        } else {
            loaded_.push_back(std::move(tile));
        }
        loaded_or_idle_.notify_all();
    }
}

}  // namespace planet
