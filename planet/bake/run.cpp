#include "planet/bake/run.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "planet/error.h"
#include "planet/parallel.h"
#include "planet/store/ladder.h"

namespace planet {

namespace {

constexpr std::size_t transaction_bytes = 2 << 20;

// Estimates, of a thread's scratch, of a tile in the frontier without its records and heights, and of all else.
constexpr std::size_t thread_bytes = std::size_t{3} << 19;
constexpr std::size_t frontier_tile_bytes = 2 * 189 * sizeof(SideSteps) + 768;
constexpr std::size_t fixed_bytes = (std::size_t{4} << 20) + transaction_bytes;

std::size_t threads_of(const BakeOptions& options) {
    return options.threads > 0 ? static_cast<std::size_t>(options.threads)
                               : std::max(1u, std::thread::hardware_concurrency());
}

// An eighth is for what the allocator loses to tiles of many sizes that come and go.
std::size_t usable_bytes(const BakeOptions& options) {
    return options.memory_bytes - options.memory_bytes / 8;
}

// Before the first tile.
std::size_t least_bytes(const BakeOptions& options, const TilePlan& plan) {
    return plan.bytes() + fixed_bytes + threads_of(options) * (thread_bytes + 2 * sizeof(TileRecords));
}

// FNV-1a, 64 bits: enough to find damage.
std::uint64_t checksum_of(std::span<const std::uint8_t> bytes) {
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const std::uint8_t byte : bytes) h = (h ^ byte) * 0x100000001b3u;
    return h;
}

// What is known of a tile with tiles below, as a row of `unfinished`.
std::vector<std::uint8_t> saved(InnerTile& inner) {
    std::vector<std::uint8_t> bytes;
    const auto put = [&](std::span<const float> values) {
        const auto* begin = reinterpret_cast<const std::uint8_t*>(values.data());
        bytes.insert(bytes.end(), begin, begin + values.size_bytes());
    };
    std::vector<float> deviation(tile_vertices);
    for (std::size_t v = 0; v < deviation.size(); ++v)
        deviation[v] = std::atomic_ref(inner.records->deviation[v]).load(std::memory_order_relaxed);
    const float range[2] = {inner.tile.min_height, inner.tile.max_height};
    put(range);
    put(deviation);
    put(inner.records->radius);
    put(inner.tile.child_deviation);
    put(inner.tile.child_radius);
    const std::uint64_t checksum = checksum_of(bytes);
    bytes.resize(bytes.size() + sizeof checksum);
    std::memcpy(bytes.data() + bytes.size() - sizeof checksum, &checksum, sizeof checksum);
    return bytes;
}

// The larger of what is known and what was. False: the bytes are damaged.
bool merge(std::span<const std::uint8_t> bytes, InnerTile& inner) {
    std::uint64_t checksum;
    const std::size_t size = sizeof(float) * (2 + 2 * tile_vertices + 2 * inner.tile.child_deviation.size());
    if (bytes.size() != size + sizeof checksum) return false;
    std::memcpy(&checksum, bytes.data() + size, sizeof checksum);
    if (checksum != checksum_of(bytes.first(size))) return false;
    const std::uint8_t* at = bytes.data();
    const auto next = [&] {
        float value;
        std::memcpy(&value, at, sizeof value);
        at += sizeof value;
        return value;
    };
    inner.tile.min_height = std::min(inner.tile.min_height, next());
    inner.tile.max_height = std::max(inner.tile.max_height, next());
    for (float& d : inner.records->deviation) d = std::max(d, next());
    for (float& r : inner.records->radius) r = std::max(r, next());
    for (float& d : inner.tile.child_deviation) d = std::max(d, next());
    for (float& r : inner.tile.child_radius) r = std::max(r, next());
    return true;
}

}  // namespace

bool has_memory_for(const BakeOptions& options, const TilePlan& plan) {
    return least_bytes(options, plan) <= usable_bytes(options);
}

void refuse_memory(const BakeOptions& options) {
    throw Error(Fault::bad_usage, "bake",
                "this elevation needs more than " + std::to_string(options.memory_bytes >> 20) + " MiB of memory",
                "more memory (what is baked can be resumed), fewer threads or a lower finest level");
}

BakeRun::BakeRun(const BakeScene& scene, TilePlan& plan, BakeFile& file)
    : scene_(scene),
      plan_(plan),
      file_(file),
      threads_(threads_of(scene.options)),
      least_bytes_(least_bytes(scene.options, plan)),
      frontier_(plan) {}

void BakeRun::run() {
    mark_written();
    std::vector<LocationCode> faces;
    for (int face = 0; face < face_count; ++face) faces.push_back(LocationCode::face_root(face));
    open_.push_back({nullptr, faces});
    const std::thread::id caller = std::this_thread::get_id();
    parallel_for(threads_, static_cast<unsigned>(threads_), [&](std::size_t) {
        try {
            work(std::this_thread::get_id() == caller);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
            changed_.notify_all();
            throw;
        }
    });
    Lock lock(mutex_);
    if (!to_write_.empty()) write(lock);
    assert(frontier_.size() == 0 && inner_.empty());
}

void BakeRun::mark_written() {
    for (const LocationCode root : file_.tiles()) {
        const int depth = plan_.depth(root);
        if (depth == 0)
            throw Error(Fault::bad_data, "bake", "the store holds tile " + to_string(root) + ", which is not planned");
        plan_.mark_final(root);
        vertices_resumed_ += tile_layout().vertex_count[static_cast<std::size_t>(depth)];
    }
    vertices_ = vertices_resumed_;
    resampling_max_m_ = file_.metadata().resampling_max_m;
}

void BakeRun::work(bool tells) {
    TileMaker maker(scene_);
    Lock lock(mutex_);
    keep_within_memory();
    while (!stopped_) {
        if (tells) tell_progress(lock);
        ++working_;
        const bool worked = work_once(maker, lock);
        --working_;
        if (worked) {
            changed_.notify_all();
            continue;
        }
        if (working_ == 0) break;
        changed_.wait(lock);
    }
    stopped_ = true;
    changed_.notify_all();
    for (std::size_t s = 0; s < bake_steps; ++s) seconds_[s] += maker.seconds()[s];
}

void BakeRun::tell_progress(Lock& lock) {
    if (!scene_.options.progress || vertices_ - vertices_told_ < 1 + plan_.vertices() / 1000) return;
    vertices_told_ = vertices_;
    const double fraction = static_cast<double>(vertices_) / static_cast<double>(plan_.vertices());
    lock.unlock();
    scene_.options.progress("tiles", fraction);
    lock.lock();
}

bool BakeRun::work_once(TileMaker& maker, Lock& lock) {
    if (!writing_ && (to_write_bytes_ >= transaction_bytes ||
                      to_write_.size() >= static_cast<std::size_t>(scene_.options.transaction_tiles))) {
        write(lock);
    } else if (auto final = frontier_.next_final()) {
        finish(maker, lock, std::move(final));
    } else if (FrontierTile* told = frontier_.next_to_settle()) {
        settle(maker, lock, *told);
    } else if (!complete_below_.empty()) {
        enter_frontier(maker, lock);
    } else if (const auto next = next_to_measure()) {
        if (next->has_tiles_below)
            open(maker, lock, *next);
        else
            measure(maker, lock, *next);
    } else {
        return false;
    }
    return true;
}

std::optional<BakeRun::Next> BakeRun::next_to_measure() {
    while (!opening_ && !open_.empty()) {
        OpenLevel& level = open_.back();
        if (level.next == level.below.size()) {
            open_.pop_back();
            continue;
        }
        const LocationCode root = level.below[level.next++];
        if (!plan_.is_final(root)) return Next{root, level.above, plan_.has_tiles_below(root)};
    }
    return std::nullopt;
}

void BakeRun::open(TileMaker& maker, Lock& lock, const Next& next) {
    opening_ = true;
    lock.unlock();
    std::unique_ptr<InnerTile> opened = maker.open(next.root, next.above);
    const bool restored = restore(*opened);
    lock.lock();
    opening_ = false;
    InnerTile& inner = *opened;
    inner_bytes_ += InnerTile::bytes;
    inner_.emplace(next.root.bits(), std::move(opened));
    open_.push_back({&inner, plan_.below(next.root)});
    const std::vector<LocationCode>& below = open_.back().below;
    const auto is_final = [&](LocationCode root) { return plan_.is_final(root); };
    inner.waiting = below.size() - static_cast<std::size_t>(std::count_if(below.begin(), below.end(), is_final));
    if (inner.waiting < below.size() && !restored)
        throw Error(Fault::bad_data, "bake",
                    "the store lost what it knew of the unfinished tile " + to_string(next.root), "--replace");
    if (inner.waiting == 0) complete_below(inner);
    keep_within_memory();
}

// What an interrupted bake knew of the tiles below that are written.
bool BakeRun::restore(InnerTile& inner) {
    if (vertices_resumed_ == 0) return false;
    const auto row = file_.unfinished(inner.tile.root);
    if (row && !merge(*row, inner))
        throw Error(Fault::bad_data, "bake",
                    "what the store knows of the unfinished tile " + to_string(inner.tile.root) + " is damaged",
                    "--replace");
    return row.has_value();
}

void BakeRun::complete_below(InnerTile& inner) {
    to_save_.push_back({inner.tile.root, saved(inner)});
    complete_below_.push_back(std::move(inner_.extract(inner.tile.root.bits()).mapped()));
}

void BakeRun::measure(TileMaker& maker, Lock& lock, const Next& next) {
    std::unique_ptr<TileRecords> records = frontier_.spare_records();
    std::vector<SideSteps> theirs = told_by_file(lock, next.root);
    lock.unlock();
    std::unique_ptr<FrontierTile> tile = maker.measure(next.root, next.above, std::move(theirs), std::move(records));
    lock.lock();
    vertices_ += tile->height.size();
    frontier_.add(std::move(tile));
    keep_within_memory();
}

void BakeRun::enter_frontier(TileMaker& maker, Lock& lock) {
    std::unique_ptr<InnerTile> inner = std::move(complete_below_.front());
    complete_below_.pop_front();
    std::vector<SideSteps> theirs = told_by_file(lock, inner->tile.root);
    lock.unlock();
    std::unique_ptr<FrontierTile> tile = maker.enter_frontier(std::move(inner), std::move(theirs));
    lock.lock();
    vertices_ += tile_layout().vertex_count[static_cast<std::size_t>(tile->depth)];
    frontier_.add(std::move(tile));
}

// The sides of the tiles beside that an interrupted bake has written. Others beside a tile that is not measured yet are
// not final.
std::vector<SideSteps> BakeRun::told_by_file(Lock& lock, LocationCode root) {
    if (vertices_resumed_ == 0) return {};
    const auto sides = side_cells(plan_.depth(root));
    std::vector<SideSteps> told(sides.size());
    for (const Side side : {Side::split, Side::left_leg, Side::right_leg}) {
        const LocationCode beside = neighbor(root, side);
        if (!plan_.contains(beside) || !plan_.is_final(beside)) continue;
        lock.unlock();
        const auto bytes = file_.tile(beside);
        assert(bytes);
        const Tile tile = decode_tile(beside, *bytes, scene_.scale);
        lock.lock();
        for (std::size_t k = 0; k < sides.size(); ++k) {
            const unsigned j = side_cells(tile_levels)[side_cells_across()[k]].cell;
            if (sides[k].side != side || j >= tile.deviation.size()) continue;
            told[k] = {static_cast<std::uint16_t>(deviation_code(tile.deviation[j])),
                       static_cast<std::uint16_t>(radius_code(tile.radius[j]))};
        }
    }
    return told;
}

void BakeRun::settle(TileMaker& maker, Lock& lock, FrontierTile& tile) {
    const std::vector<SideSteps> theirs = tile.theirs;
    std::unique_ptr<TileRecords> records = tile.records ? nullptr : frontier_.spare_records();
    lock.unlock();
    maker.settle(tile, theirs, std::move(records));
    lock.lock();
    frontier_.settled(tile);
    keep_within_memory();
}

void BakeRun::finish(TileMaker& maker, Lock& lock, std::unique_ptr<FrontierTile> tile) {
    lock.unlock();
    std::vector<std::uint8_t> bytes = maker.encode(*tile);
    const Tile& encoded = maker.encoded();
    lock.lock();
    resampling_max_m_ = std::max(resampling_max_m_, static_cast<double>(encoded.resampling));
    to_write_bytes_ += bytes.size();
    to_write_.push_back({tile->root, std::move(bytes)});
    if (tile->inner) inner_bytes_ -= InnerTile::bytes;
    if (!tile->above) return;
    report_above(*tile, encoded.min_height, encoded.max_height);
    if (--tile->above->waiting == 0) complete_below(*tile->above);
}

// One transaction: a resumed bake must find what the tiles above learned from the tiles that are written.
void BakeRun::write(Lock& lock) {
    writing_ = true;
    const std::vector<TileRow> tiles = std::exchange(to_write_, {});
    to_write_bytes_ = 0;
    std::vector<TileRow> unfinished = std::exchange(to_save_, {});
    for (auto& [bits, inner] : inner_)
        if (inner->changed.exchange(false)) unfinished.push_back({LocationCode(bits), saved(*inner)});
    const double resampling_max_m = resampling_max_m_;
    lock.unlock();
    const auto begin = std::chrono::steady_clock::now();
    file_.write(tiles, unfinished, resampling_max_m);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    lock.lock();
    writing_seconds_ += took.count();
    writing_ = false;
}

// Records of tiles in the frontier are kept in what is left of the memory.
void BakeRun::keep_within_memory() {
    const std::size_t limit = usable_bytes(scene_.options);
    const std::size_t needed = least_bytes_ + inner_bytes_ + to_write_bytes_ + frontier_.size() * frontier_tile_bytes +
                               frontier_.height_bytes();
    if (needed > limit) refuse_memory(scene_.options);
    frontier_.keep_at_most((limit - needed) / sizeof(TileRecords));
    most_bytes_ = std::max(most_bytes_, needed + frontier_.kept() * sizeof(TileRecords));
}

}  // namespace planet
