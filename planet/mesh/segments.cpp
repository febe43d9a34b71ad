#include "planet/mesh/segments.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

#include "planet/parallel.h"

namespace planet {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Room made at once, see segment_arrays.cpp.
constexpr std::size_t usual_blocks = 1 << 16;

/// Finds a cell that is split in a mesh.
PlacedCell find_split_cell(const TileSource& tiles, LocationCode cell) {
    const int below = cell.bisection_level() - tiles.layers().root_level(cell.bisection_level());
    const PlacedTile* tile = tiles.tile(cell.ancestor(cell.bisection_level() - below));
    assert(tile != nullptr);
    return {tile, static_cast<unsigned>(cell.bits() & ((1u << below) - 1)) | 1u << below};
}

}  // namespace

/// A segment of a block, before it has a place.
struct Segments::Part {
    static constexpr std::uint32_t none = 0xffffffff;

    LocationCode cell;
    std::uint32_t leaves;
    std::uint32_t piece;  ///< as it is in the block, or whose cell is built anew, or none
    bool is_new;
    BuiltSegment built{};
};

/// A block to be brought up to date.
struct Segments::Job {
    PlacedCell cell;
    std::uint32_t block;
    Worker* worker = nullptr;
    std::size_t first_part = 0, part_count = 0;  ///< of the worker's

    std::span<const Part> parts() const;
};

/// What a thread has built.
struct Segments::Worker {
    SegmentBuilder builder;
    std::vector<BuiltSegment> built;
    std::vector<Part> parts;
};

std::span<const Segments::Part> Segments::Job::parts() const {
    return std::span<const Part>(worker->parts).subspan(first_part, part_count);
}

Segments::Segments() = default;
Segments::Segments(Segments&&) noexcept = default;
Segments& Segments::operator=(Segments&&) noexcept = default;
Segments::~Segments() = default;

void Segments::Sums::add(const Piece& piece, double ratio) {
    leaves += piece.segment.leaves;
    vertices += piece.segment.vertex_count;
    indices += piece.segment.index_count;
    damaged = damaged || piece.damaged;
    ratio_max = std::max(ratio_max, ratio);
    deviation_max = std::max(deviation_max, piece.deviation_max);
}

void Segments::Sums::add(const Sums& other) {
    leaves += other.leaves;
    vertices += other.vertices;
    indices += other.indices;
    damaged = damaged || other.damaged;
    ratio_max = std::max(ratio_max, other.ratio_max);
    deviation_max = std::max(deviation_max, other.deviation_max);
}

// Keeps the storage: blocks come and go with patches.
void Segments::Block::clear() {
    pieces.clear();
    expires = SegmentNode::never;
    sums = {};
}

void Segments::build(const TileSource& tiles, const SegmentView& view, int threads) {
    clear();
    update(tiles, view, threads);
}

void Segments::update(const TileSource& tiles, const SegmentView& view, int threads) {
    arrays_.begin_changes();
    if (tiles_from_ != &tiles || !view.same_but_for_eye_and_culling(view_)) clear();
    const bool at_rest = listed_ && view.test.eye == view_.test.eye && view.culling == view_.culling;
    tiles_from_ = &tiles;
    view_ = view;
    if (at_rest) return;
    const auto workers = static_cast<std::size_t>(std::max(threads, 1));
    arrays_.write(view.morph, workers);
    make(tiles, view, workers);
    arrays_.write(view.morph, workers);
    arrays_.end_changes();
    list();
    shed_unseen();
    listed_ = true;
}

void Segments::prepare(const TileSource& tiles, const SegmentView& view, int threads) {
    if (tiles_from_ != &tiles || !view.same_but_for_eye_and_culling(view_) || !arrays_.all_written()) return;
    listed_ = false;
    make(tiles, view, static_cast<std::size_t>(std::max(threads, 1)));
}

/// Brings everything up to date but what can be asked of segments: arrays, lists and sums.
void Segments::make(const TileSource& tiles, const SegmentView& view, std::size_t threads) {
    if (made_ && view.test.eye == made_for_.test.eye && view.culling == made_for_.culling) return;
    made_for_ = view;
    tree_.update(tiles, view);
    release_dropped();
    std::vector<Job> jobs = stale_blocks();
    build_all(tiles, jobs, threads);
    for (const Job& job : jobs) place(job);
    made_ = true;
}

void Segments::invalidate(std::span<const LocationCode> tile_roots) {
    tree_.invalidate(tile_roots);
    release_dropped();
    listed_ = listed_ && tile_roots.empty();
    made_ = made_ && tile_roots.empty();
}

void Segments::clear() {
    tree_.clear();
    free_blocks_.clear();
    for (std::size_t i = blocks_.size(); i-- > 0;) {
        blocks_[i].clear();
        free_blocks_.push_back(static_cast<std::uint32_t>(i));
    }
    segments_.clear();
    arrays_.clear();
    listed_ = made_ = false;
    total_leaves_ = 0;
}

std::vector<Segments::Job> Segments::stale_blocks() {
    std::vector<Job> jobs;
    if (blocks_.empty()) blocks_.reserve(usual_blocks);
    in_view_.clear();
    for (const auto [i, open] : tree_.in_view()) {
        SegmentNode& n = tree_.node(i);
        if (n.content == SegmentNode::none) {
            if (free_blocks_.empty()) {
                n.content = static_cast<std::uint32_t>(blocks_.size());
                blocks_.emplace_back();
            } else {
                n.content = free_blocks_.back();
                free_blocks_.pop_back();
            }
        }
        in_view_.push_back({n.content, open});
        if (tree_.odometer() >= blocks_[n.content].expires) jobs.push_back({{n.tile, n.local}, n.content});
    }
    return jobs;
}

// Neighbours share tiles, so a thread takes several in a row.
void Segments::build_all(const TileSource& tiles, std::span<Job> jobs, std::size_t threads) {
    constexpr std::size_t run = 4;
    const std::size_t workers = std::min(threads, (jobs.size() + run - 1) / run);
    while (workers_.size() < workers) workers_.push_back(std::make_unique<Worker>());
    std::atomic<std::size_t> next = 0;
    parallel_for(workers, static_cast<unsigned>(workers), [&](std::size_t w) {
        Worker& worker = *workers_[w];
        worker.builder.begin(tiles, made_for_);
        worker.parts.clear();
        for (std::size_t first; (first = next.fetch_add(run, std::memory_order_relaxed)) < jobs.size();)
            for (Job& job : jobs.subspan(first, std::min(run, jobs.size() - first))) build(tiles, job, worker);
    });
}

// What has expired is built again and may come out as several; where halves have become small enough to be one segment,
// it is made of them. Both depend on nothing but the leaves there are.
void Segments::build(const TileSource& tiles, Job& job, Worker& worker) const {
    const Block& block = blocks_[job.block];
    const LocationCode half = job.cell.code();
    std::vector<Part>& parts = worker.parts;
    std::vector<BuiltSegment>& built = worker.built;
    job.worker = &worker;
    job.first_part = parts.size();
    const auto add = [&](const Part& part) {
        parts.push_back(part);
        while (parts.size() > job.first_part + 1) {
            Part &a = parts[parts.size() - 2], &b = parts.back();
            if (a.cell == half || a.cell.sibling() != b.cell ||
                a.leaves + b.leaves > static_cast<std::uint32_t>(made_for_.segment_leaves))
                return;
            a = {.cell = a.cell.parent(), .leaves = a.leaves + b.leaves, .piece = Part::none, .is_new = true};
            parts.pop_back();
        }
    };
    const auto build_cell = [&](const PlacedCell& cell, LocationCode code, std::uint32_t piece) {
        built.clear();
        worker.builder.build(cell, half, built);
        for (const BuiltSegment& b : built)
            add({.cell = b.cell,
                 .leaves = b.leaves,
                 .piece = b.cell == code ? piece : Part::none,
                 .is_new = true,
                 .built = b});
    };
    if (block.pieces.empty()) build_cell(job.cell, half, Part::none);
    for (std::uint32_t k = 0; k < block.pieces.size(); ++k) {
        const Piece& piece = block.pieces[k];
        if (tree_.odometer() < piece.expires)
            add({.cell = piece.segment.root, .leaves = piece.segment.leaves, .piece = k, .is_new = false});
        else
            build_cell(piece.root, piece.segment.root, k);
    }
    job.part_count = parts.size() - job.first_part;
    for (std::size_t p = job.first_part; p < parts.size(); ++p) {
        if (!parts[p].is_new || parts[p].built.leaves != 0) continue;
        built.clear();
        worker.builder.build(find_split_cell(tiles, parts[p].cell), half, built);
        assert(built.size() == 1 && built[0].cell == parts[p].cell && built[0].leaves == parts[p].leaves);
        parts[p].built = built[0];
    }
}

/// Gives places to the new parts of a block.
void Segments::place(const Job& job) {
    Block& block = blocks_[job.block];
    std::vector<Piece> old;
    if (!block.pieces.empty()) old.swap(block.pieces);
    std::size_t next = 0;  // parts name old pieces in order: those between them go
    const auto release_until = [&](std::size_t end) {
        for (; next < end; ++next) release(old[next]);
    };
    block.expires = block.least_reach = infinity;
    block.odometer = tree_.odometer();
    block.sums = {};
    block.pieces.reserve(job.part_count);
    for (const Part& part : job.parts()) {
        const Piece* named = nullptr;
        if (part.piece != Part::none) {
            release_until(part.piece);
            named = &old[next++];
        }
        const Piece& piece =
            block.pieces.emplace_back(part.is_new ? new_piece(part.built, job.worker->builder, named) : *named);
        block.expires = std::min(block.expires, piece.expires);
        block.least_reach = std::min(block.least_reach, piece.least_reach);
        block.odometer = std::min(block.odometer, piece.odometer);
        block.sums.add(piece, piece.ratio_max);
    }
    release_until(old.size());
}

/// @param old of the same cell, or nullptr
Segments::Piece Segments::new_piece(const BuiltSegment& b, const SegmentBuilder& builder, const Piece* old) {
    if (old) total_leaves_ -= old->segment.leaves;
    total_leaves_ += b.leaves;
    const SegmentPlace place = arrays_.place(b, builder, old ? &old->place : nullptr);
    return {.segment = {.root = b.cell,
                        .patch = b.patch,
                        .first_vertex = place.vertices.first,
                        .vertex_count = b.vertices,
                        .first_index = place.indices.first,
                        .index_count = b.indices,
                        .leaves = b.leaves,
                        .first_leaf = place.indices.first,
                        .detailed = b.detailed},
            .place = place,
            .sphere = b.sphere,
            .expires = tree_.expiry(b.slack),
            .ratio_max = b.ratio_max,
            .least_reach = b.least_reach,
            .deviation_max = b.deviation_max,
            .odometer = tree_.odometer(),
            .root = b.root,
            .damaged = b.damaged};
}

// While the slack holds, what could be split needs not: its ratio is at most 1. What lacks a tile has come nearer by what
// the eye went at most, and the nearest by the largest factor.
double Segments::ratio_since(double odometer, double ratio_max, double least_reach) const {
    const double gone = tree_.odometer() - odometer;
    if (gone == 0 || ratio_max == 0) return ratio_max;
    if (least_reach == infinity) return 1;
    return gone < least_reach ? std::max(1.0, ratio_max * (least_reach / (least_reach - gone))) : infinity;
}

void Segments::list() {
    segments_.clear();
    sums_ = {};
    block_leaves_ = 0;
    const CullingTest culling(view_.culling);
    for (std::size_t k = 0; k < in_view_.size(); ++k) {
        if (k + 8 < in_view_.size()) __builtin_prefetch(blocks_[in_view_[k + 8].block].pieces.data());
        const Block& block = blocks_[in_view_[k].block];
        block_leaves_ += block.sums.leaves;
        if (in_view_[k].open != 0) {
            list_culled(block, culling, in_view_[k].open);
            continue;
        }
        for (const Piece& p : block.pieces) segments_.push_back(p.segment);
        Sums sums = block.sums;
        sums.ratio_max = ratio_since(block.odometer, sums.ratio_max, block.least_reach);
        sums_.add(sums);
    }
    kept_ = total_leaves_ - block_leaves_;
}

void Segments::list_culled(const Block& block, const CullingTest& culling, unsigned open) {
    for (const Piece& p : block.pieces) {
        unsigned still_open = open;
        if (culling.hidden(p.sphere.centre, p.sphere.radius, still_open)) continue;
        segments_.push_back(p.segment);
        sums_.add(p, ratio_since(p.odometer, p.ratio_max, p.least_reach));
    }
}

void Segments::release_dropped() {
    for (const std::uint32_t i : tree_.dropped()) {
        for (const Piece& p : blocks_[i].pieces) release(p);
        blocks_[i].clear();
        free_blocks_.push_back(i);
    }
    tree_.clear_dropped();
}

void Segments::release(const Piece& p) {
    arrays_.release(p.place);
    total_leaves_ -= p.segment.leaves;
}

void Segments::shed_unseen() {
    if (kept_ <= view_.kept_leaves) return;
    for (const std::uint32_t i : tree_.hidden_longest_first()) {
        tree_.drop(i);
        release_dropped();
        kept_ = total_leaves_ - block_leaves_;
        if (kept_ <= view_.kept_leaves) return;
    }
}

std::uint64_t Segments::hash() const {
    std::uint64_t h = 0xcbf29ce484222325u;
    const auto add = [&](std::uint64_t word) { h = (h ^ word) * 0x9e3779b97f4a7c15u, h ^= h >> 29; };
    for (const Segment& s : segments_) {
        for (const std::uint64_t word : {s.root.bits(), s.patch.bits(), std::uint64_t{s.vertex_count},
                                         std::uint64_t{s.index_count}, std::uint64_t{s.leaves * 2 + s.detailed}})
            add(word);
        const auto words = [&](const auto* data, std::size_t count) {
            for (std::size_t k = 0; k < count; ++k) add(data[k]);
        };
        for (const SegmentVertex& v : vertices().subspan(s.first_vertex, s.vertex_count)) {
            std::uint64_t word[3];
            std::memcpy(word, &v, sizeof v);
            words(word, 3);
        }
        if (view_.morph)
            for (const MorphVertex& m : morphs().subspan(s.first_vertex, s.vertex_count)) {
                std::uint64_t word[3];
                std::memcpy(word, &m, sizeof m);
                words(word, 3);
            }
        words(&indices()[s.first_index], s.index_count);
        words(&leaf_levels()[s.first_leaf], s.leaves);
    }
    return h;
}

}  // namespace planet
