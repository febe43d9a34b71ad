#include "planet/streaming/resident_tiles.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "planet/streaming/view_needs.h"

namespace planet {

namespace {

constexpr std::size_t typical_tile_bytes = 100'000;
constexpr double infinity = std::numeric_limits<double>::infinity();

bool needs_the_same(const SegmentView& a, const SegmentView& b) {
    return a.test.eye == b.test.eye && a.test.K == b.test.K && a.culling.eye == b.culling.eye &&
           a.culling.inward == b.culling.inward && a.culling.occluder_radius == b.culling.occluder_radius &&
           a.segment_angle == b.segment_angle && a.radius_m == b.radius_m;
}

// Of a face that cannot be read nothing is known but that it is there.
bool may_show(const PlacedTile& face, const SegmentView& view) {
    constexpr double relief = 2e4;
    const glm::dvec3 centre = ecef_from_grid(face.position[3]);
    double radius = 0;
    for (std::size_t v = 0; v < 3; ++v)
        radius = std::max(radius, glm::distance(centre, ecef_from_grid(face.position[v])));
    return !view.culling.hidden(centre, radius + relief);
}

std::uint64_t last_use(const ResidentTile& tile) {
    return std::max(tile.needed, tile.wanted);
}

}  // namespace

SegmentView view_ahead(const SegmentView& view, const glm::dvec3& velocity_m_s, double seconds) {
    SegmentView ahead = view;
    ahead.test.eye += velocity_m_s * seconds;
    ahead.culling.eye += velocity_m_s * seconds;
    return ahead;
}

SegmentView view_after(const SegmentView& before, const SegmentView& now) {
    SegmentView after = now;
    after.test.eye += now.test.eye - before.test.eye;
    after.culling.eye += now.culling.eye - before.culling.eye;
    for (std::size_t k = 0; k < now.culling.inward.size(); ++k) {
        const glm::dvec3 turn = now.culling.inward[k] - before.culling.inward[k];
        if (turn != glm::dvec3(0) && now.culling.inward[k] != glm::dvec3(0))
            after.culling.inward[k] = glm::normalize(now.culling.inward[k] + turn);
    }
    return after;
}

ResidentTiles::ResidentTiles(const TileCache& cache, const Placement& placement, unsigned threads,
                             const TileReader* reader)
    : cache_(cache),
      reader_(reader ? *reader : cache),
      placement_(placement),
      set_(cache.store().metadata().layers),
      loader_([this](LocationCode root) { return load(root); }, threads) {
    std::vector<TileRequest> faces;
    for (int face = 0; face < face_count; ++face) faces.push_back({LocationCode::face_root(face), 0});
    loader_.request(faces);
    while (set_.size() < face_count) {
        loader_.wait();
        take_in();
    }
    set_.settle();
    count_memory();
}

ResidentTiles::~ResidentTiles() {
    cache_.count_drawn_bytes(-static_cast<std::ptrdiff_t>(counted_bytes_));
}

// On the loader's threads.
LoadedTile ResidentTiles::load(LocationCode root) const {
    const std::shared_ptr<const Tile> tile = reader_.tile(root);
    LoadedTile loaded{root, nullptr, tile && tile->damaged, {}};
    if (tile && (!tile->damaged || root.bisection_level() == 0)) {
        loaded.tile = std::make_unique<PlacedTile>(*tile, placement_);
        loaded.tile->close();
        loaded.tile->set_no_children();
        loaded.support = tile_support(root, tile->depth);
    }
    return loaded;
}

void ResidentTiles::take_in(std::size_t most) {
    for (LoadedTile& loaded : loader_.take(most)) take_in(std::move(loaded));
}

void ResidentTiles::take_in(LoadedTile loaded) {
    asked_ = false;
    if (loaded.damaged) damaged_.insert(loaded.root.bits());
    if (!loaded.tile) {
        absent_.insert(loaded.root.bits());
        return;
    }
    ++loaded_;
    // The tile above may have been dropped meanwhile: then nothing needs this one.
    if (loaded.root.bisection_level() > 0 && !set_.find(layers().above(loaded.root))) return;
    set_.insert(std::move(loaded.tile), loaded.support);
}

bool ResidentTiles::up_to_date(const SegmentView& view, const SegmentView* ahead) const {
    if (!asked_ || !needs_the_same(view, view_) || (ahead != nullptr) != ahead_.has_value()) return false;
    return !ahead || needs_the_same(*ahead, *ahead_);
}

std::span<const LocationCode> ResidentTiles::update(const SegmentView& view, const SegmentView* ahead,
                                                    std::size_t most) {
    finish_asking();
    take_in(most);
    if (!up_to_date(view, ahead)) {
        view_ = view;
        ahead_ = ahead ? std::optional(*ahead) : std::nullopt;
        if (!ahead) wanted_mark_ = 0;
        std::size_t bytes = 0;
        std::vector<TileRequest> requests = find_needs(bytes);
        keep_within_limit();
        set_.settle();
        count_memory();
        ask(std::move(requests), bytes);
        asked_ = true;
    }
    changes_ = set_.take_changes();
    return changes_;
}

/// @param bytes becomes the memory of what is needed and there
std::vector<TileRequest> ResidentTiles::find_needs(std::size_t& bytes) {
    residency_ = {};
    ViewNeeds needs(set_, &ResidentTile::needed, needed_mark_ = ++mark_);
    needs.add(view_);
    bytes = 0;
    for (ResidentTile* const t : needs.there()) {
        set_.open_for(*t, view_.test);
        bytes += t->bytes;
    }
    std::vector<TileRequest> requests;
    for (const MissingTile& m : needs.missing()) {
        const bool damaged = damaged_.contains(m.root.bits());
        if (!damaged && absent_.contains(m.root.bits())) continue;
        ++(damaged ? residency_.damaged : residency_.pending);
        residency_.hidden_deviation_m = std::max(residency_.hidden_deviation_m, static_cast<double>(m.deviation));
        residency_.hidden_ratio = std::max(residency_.hidden_ratio, m.ratio);
        if (!damaged) requests.push_back({m.root, m.ratio});
    }
    for (int face = 0; face < face_count; ++face)
        if (const PlacedTile& t = *set_.tile(LocationCode::face_root(face)); t.damaged && may_show(t, view_)) {
            ++residency_.damaged;
            residency_.hidden_deviation_m = residency_.hidden_ratio = infinity;
        }
    return requests;
}

// What lies ahead is found by another thread until the next call: nothing else changes tiles meanwhile, and only their
// stamps are written. What is dropped before is what the view ahead of the last update did not want.
void ResidentTiles::ask(std::vector<TileRequest> requests, std::size_t bytes) {
    if (!ahead_) return loader_.request(std::move(requests));
    asking_ = std::async(std::launch::async, [this, bytes, requests = std::move(requests)]() mutable {
        find_needs_ahead(bytes, requests);
        loader_.request(std::move(requests));
    });
}

void ResidentTiles::finish_asking() {
    if (asking_.valid()) asking_.get();
}

void ResidentTiles::wait() {
    finish_asking();
    loader_.wait();
}

std::size_t ResidentTiles::on_their_way() {
    finish_asking();
    return loader_.on_their_way();
}

// Within the limit, of which tiles that are needed now take `bytes`, and after all that is needed now.
void ResidentTiles::find_needs_ahead(std::size_t bytes, std::vector<TileRequest>& requests) {
    ViewNeeds needs(set_, &ResidentTile::wanted, wanted_mark_ = ++mark_);
    needs.add(*ahead_);
    bytes += requests.size() * typical_tile_bytes;
    for (const ResidentTile* t : needs.there())
        if (t->needed != needed_mark_) bytes += t->bytes;
    std::vector<MissingTile> missing = needs.missing();
    std::sort(missing.begin(), missing.end(), [](const MissingTile& a, const MissingTile& b) {
        return a.ratio > b.ratio || (a.ratio == b.ratio && a.root < b.root);
    });
    for (const MissingTile& m : missing) {
        bytes += typical_tile_bytes;
        if (bytes > cache_.memory_limit_bytes()) break;
        if (!absent_.contains(m.root.bits())) requests.push_back({m.root, -1 / m.ratio});
    }
}

bool ResidentTiles::is_held(const ResidentTile& tile) const {
    return tile.needed == needed_mark_ || (wanted_mark_ != 0 && tile.wanted == wanted_mark_);
}

// Drops tiles that neither view needs, those first that were needed or wanted last the longest ago. Tiles that are not
// listed have been so later: the list holds until it is used up.
void ResidentTiles::keep_within_limit() {
    const std::size_t limit = cache_.memory_limit_bytes();
    for (bool listed = false; set_.bytes() > limit; idle_.pop_back()) {
        if (idle_.empty() && !std::exchange(listed, true)) list_idle();
        if (idle_.empty()) return;
        const IdleTile& idle = idle_.back();
        if (last_use(*idle.tile) == idle.last && idle.tile->children == 0) set_.erase(idle.root);
    }
}

void ResidentTiles::list_idle() {
    for (ResidentTile* t : set_.all())
        if (t->root.bisection_level() > 0 && !is_held(*t)) idle_.push_back({last_use(*t), t->root, t});
    // A tile is needed whenever one below it is: of equals, the deeper goes first.
    std::sort(idle_.begin(), idle_.end(), [](const IdleTile& a, const IdleTile& b) {
        return a.last != b.last ? a.last > b.last : a.root < b.root;
    });
}

void ResidentTiles::count_memory() {
    const std::size_t bytes = set_.bytes();
    cache_.count_drawn_bytes(static_cast<std::ptrdiff_t>(bytes) - static_cast<std::ptrdiff_t>(counted_bytes_));
    counted_bytes_ = bytes;
}

std::span<const LocationCode> ResidentTiles::settle(const SegmentView& view) {
    std::vector<LocationCode> all;
    for (;;) {
        const auto changes = update(view);
        all.insert(all.end(), changes.begin(), changes.end());
        if (residency_.pending == 0) break;
        // Many at once: every update walks the whole view.
        loader_.wait(1 + residency_.pending / 2);
    }
    changes_ = std::move(all);
    return changes_;
}

std::span<const LocationCode> ResidentTiles::place(const Placement& placement) {
    finish_asking();
    loader_.request({});
    while (loader_.on_their_way() > 0) {
        loader_.wait();
        take_in();
    }
    take_in();
    placement_ = placement;
    set_.place(placement);
    set_.settle();
    count_memory();
    asked_ = false;
    changes_ = set_.take_changes();
    return changes_;
}

ResidentCounts ResidentTiles::counts() const {
    return {.tiles = set_.size(),
            .tile_bytes = set_.bytes(),
            .tiles_loaded = loaded_,
            .memory_limit_bytes = cache_.memory_limit_bytes(),
            .memory_peak_bytes = cache_.memory_peak_bytes()};
}

}  // namespace planet
