#include "planet/tin/delaunay.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace planet {

Delaunay::Delaunay(std::span<const int> columns, std::span<const int> rows) {
    assert(columns.size() >= 2 && rows.size() >= 2);
    const auto w = static_cast<Index>(columns.size()), h = static_cast<Index>(rows.size());
    for (const int y : rows)
        for (const int x : columns) point_.emplace_back(x, y);
    out_.resize(point_.size());
    origin_.resize(std::size_t{6} * (w - 1) * (h - 1));
    twin_.resize(origin_.size(), none);
    const auto first = [w](Index i, Index j) { return 6 * (j * (w - 1) + i); };
    for (Index j = 0; j + 1 < h; ++j)
        for (Index i = 0; i + 1 < w; ++i) {
            const Index v = j * w + i, e = first(i, j);
            set_triangle(e / 3, v, v + 1, v + w + 1);
            set_triangle(e / 3 + 1, v, v + w + 1, v + w);
            link(e + 2, e + 3);
            if (i > 0) link(e + 5, first(i - 1, j) + 1);
            if (j > 0) link(e, first(i, j - 1) + 4);
        }
}

Delaunay::Delaunay(glm::ivec2 low, glm::ivec2 high) : Delaunay(std::array{low.x, high.x}, std::array{low.y, high.y}) {}

Delaunay::Delaunay(std::vector<glm::ivec2> points, std::span<const std::array<Index, 3>> triangles)
    : point_(std::move(points)) {
    out_.resize(point_.size(), none);
    origin_.resize(3 * triangles.size());
    twin_.resize(origin_.size(), none);
    for (Index t = 0; t < triangles.size(); ++t) set_triangle(t, triangles[t][0], triangles[t][1], triangles[t][2]);
    link_twins();
    for (Index e = 0; e < origin_.size(); ++e) {
        const Index f = twin_[e];
        if (f == none || f < e) continue;
        const auto c = corners(e / 3);
        if (in_circle(c[0], c[1], c[2], point_[origin_[previous(f)]])) hold(e);
    }
}

// Half-edges are met by their lower ends, those of one end side by side.
void Delaunay::link_twins() {
    const auto low_end = [this](Index e) { return std::min(origin_[e], origin_[next(e)]); };
    std::vector<Index> end(point_.size() + 1, 0), by_low_end(origin_.size());
    for (Index e = 0; e < origin_.size(); ++e) ++end[low_end(e) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    for (Index e = 0; e < origin_.size(); ++e) by_low_end[end[low_end(e)]++] = e;
    for (Index v = 0, first = 0; v < point_.size(); first = end[v++])
        for (Index i = first; i < end[v]; ++i)
            for (Index j = first; j < i && twin_[by_low_end[i]] == none; ++j) {
                const Index e = by_low_end[i], f = by_low_end[j];
                if (origin_[e] == origin_[next(f)] && origin_[next(e)] == origin_[f]) link(e, f);
            }
}

void Delaunay::reserve(std::size_t triangles) {
    origin_.reserve(3 * triangles);
    twin_.reserve(3 * triangles);
    point_.reserve(triangles / 2 + 16);
    out_.reserve(triangles / 2 + 16);
}

Delaunay::Index Delaunay::new_triangle() {
    if (!free_triangles_.empty()) {
        const Index t = free_triangles_.back();
        free_triangles_.pop_back();
        return t;
    }
    const auto t = static_cast<Index>(triangle_slots());
    origin_.resize(origin_.size() + 3);
    twin_.resize(twin_.size() + 3);
    if (!constrained_.empty()) constrained_.resize(origin_.size());
    return t;
}

void Delaunay::set_triangle(Index t, Index a, Index b, Index c) {
    origin_[3 * t] = a;
    origin_[3 * t + 1] = b;
    origin_[3 * t + 2] = c;
    out_[a] = 3 * t;
    out_[b] = 3 * t + 1;
    out_[c] = 3 * t + 2;
}

// ---- locating ----

Delaunay::Location Delaunay::locate_in(glm::ivec2 p, Index triangle) const {
    Location at{triangle};
    for (Index e = 3 * triangle; e < 3 * triangle + 3; ++e) {
        if (point_[origin_[e]] == p) at.vertex = origin_[e];
        if (orientation(point_[origin_[e]], point_[origin_[next(e)]], p) == 0) at.side = e;
    }
    return at;
}

// Sides are tried from another one on at every step: with constrained sides a walk of fixed order can go in circles.
Delaunay::Location Delaunay::locate(glm::ivec2 p, Index from) const {
    Index t = from < triangle_slots() && alive(from) ? from : 0;
    while (!alive(t)) ++t;
    std::uint32_t dice = 1;
    for (std::size_t steps = 0; steps <= 8 * triangle_slots(); ++steps) {
        dice = dice * 1664525 + 1013904223;
        Index e = 3 * t + (dice >> 16) % 3, beyond = none;
        for (int k = 0; k < 3 && beyond == none; ++k, e = next(e))
            if (orientation(point_[origin_[e]], point_[origin_[next(e)]], p) < 0) beyond = twin_[e];
        if (beyond == none) return locate_in(p, t);
        t = beyond / 3;
    }
    assert(false && "a point outside the triangulation");
    return {t};
}

// ---- insertion ----

void Delaunay::plan_insertion(glm::ivec2 p, const Location& at) {
    assert(at.vertex == none);
    planned_point_ = p;
    ring_.clear();
    boundary_.clear();
    cavity_.assign(1, at.triangle);
    stack_.clear();
    split_ends_[0] = split_ends_[1] = none;
    open_ = at.side != none && twin_[at.side] == none;
    const Index first = at.side == none ? 3 * at.triangle : at.side;
    const bool splits_constrained = at.side != none && constrained(at.side);
    if (splits_constrained) {
        split_ends_[0] = origin_[at.side];
        split_ends_[1] = origin_[next(at.side)];
    }
    stack_.push_back(previous(first));
    stack_.push_back(next(first));
    if (!open_) stack_.push_back(first);
    while (!stack_.empty()) {
        const Index e = stack_.back(), f = twin_[e];
        stack_.pop_back();
        const bool fixed = constrained(e) && !(splits_constrained && e == at.side);
        if (f != none && !fixed) {
            const Index right = next(f), left = previous(f);
            if ((splits_constrained && e == at.side) ||
                in_circle(point_[origin_[f]], point_[origin_[right]], point_[origin_[left]], p)) {
                cavity_.push_back(f / 3);
                stack_.push_back(left);
                stack_.push_back(right);
                continue;
            }
        }
        ring_.push_back(origin_[e]);
        boundary_.push_back({f, fixed});
    }
    if (open_) ring_.push_back(origin_[first]);
}

Delaunay::Index Delaunay::insert_planned() {
    Index v;
    if (free_vertices_.empty()) {
        v = static_cast<Index>(point_.size());
        point_.push_back(planned_point_);
        out_.push_back(none);
    } else {
        v = free_vertices_.back();
        free_vertices_.pop_back();
        point_[v] = planned_point_;
    }
    const std::size_t n = boundary_.size();
    changed_.assign(cavity_.begin(), cavity_.end());
    while (changed_.size() < n) changed_.push_back(new_triangle());
    for (std::size_t i = 0; i < n; ++i) {
        const Index t = changed_[i], b = ring_[i + 1 < ring_.size() ? i + 1 : 0];
        origin_[3 * t] = ring_[i];
        origin_[3 * t + 1] = b;
        origin_[3 * t + 2] = v;
        out_[ring_[i]] = 3 * t;
        out_[b] = 3 * t + 1;
        link(3 * t, boundary_[i].outer);
        if (i > 0) link(3 * t + 2, 3 * changed_[i - 1] + 1);
    }
    const Index front = 3 * changed_.front() + 2, back = 3 * changed_.back() + 1;
    if (open_)
        twin_[front] = twin_[back] = none;
    else
        link(front, back);
    out_[v] = front;
    recent_ = changed_.front();
    if (has_constraints()) {
        for (std::size_t i = 0; i < n; ++i) {
            const Index e = 3 * changed_[i];
            constrained_[e] = boundary_[i].constrained;
            constrained_[e + 1] = constrained_[e + 2] = 0;
        }
        for (const Index end : split_ends_)
            if (end != none)
                set_constrained(side_between(v, end) != none ? side_between(v, end) : side_between(end, v));
    }
    return v;
}

Delaunay::Index Delaunay::insert(glm::ivec2 p, const Location& at) {
    changed_.clear();
    if (at.vertex != none) return at.vertex;
    plan_insertion(p, at);
    return insert_planned();
}

// ---- removal ----

bool Delaunay::collect_star(Index v) {
    ring_.clear();
    boundary_.clear();
    cavity_.clear();
    Index e = out_[v];
    do {
        const Index across = next(e);
        if (constrained(e)) return false;
        ring_.push_back(origin_[across]);
        boundary_.push_back({twin_[across], constrained(across)});
        cavity_.push_back(e / 3);
        e = twin_[previous(e)];
    } while (e != none && e != out_[v]);
    return e != none;
}

// Of the corners left: whether the triangle of one and its neighbours lies in the polygon, with no other in its circle.
bool Delaunay::is_ear(std::span<const Index> polygon, std::size_t i) const {
    const std::size_t n = left_.size();
    const glm::ivec2 a = point_[polygon[left_[(i + n - 1) % n]]], b = point_[polygon[left_[i]]],
                     c = point_[polygon[left_[(i + 1) % n]]];
    if (orientation(a, b, c) <= 0) return false;
    for (std::size_t k = 2; k + 1 < n; ++k)
        if (in_circle(a, b, c, point_[polygon[left_[(i + k) % n]]])) return false;
    return true;
}

bool Delaunay::begin_removal(Index v) {
    if (!collect_star(v)) return false;
    planned_vertex_ = v;
    filling_.clear();
    ears_.clear();
    left_.clear();
    for (std::uint32_t i = 0; i < ring_.size(); ++i) left_.push_back(i);
    ear_ = 0;
    return true;
}

// Two places are left after the last ear; more if there is none.
bool Delaunay::cut_ear() {
    const std::size_t n = left_.size();
    if (n < 3) return false;
    if (n == 3) ear_ = 1;
    for (std::size_t missed = 0; !is_ear(ring_, ear_); ++missed) {
        if (n == 3 || missed == n) return false;
        ear_ = ear_ + 1 < n ? ear_ + 1 : 0;
    }
    ears_.push_back({left_[(ear_ + n - 1) % n], left_[ear_], left_[(ear_ + 1) % n]});
    filling_.push_back({ring_[ears_.back()[0]], ring_[ears_.back()[1]], ring_[ears_.back()[2]]});
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear_));
    if (ear_ + 1 == n) ear_ = 0;
    return true;
}

void Delaunay::remove_planned() {
    changed_.assign(cavity_.begin(), cavity_.begin() + static_cast<std::ptrdiff_t>(filling_.size()));
    const auto attach = [this](Index e, const Boundary& beyond) {
        link(e, beyond.outer);
        if (has_constraints()) constrained_[e] = beyond.constrained;
    };
    for (std::size_t i = 0; i < filling_.size(); ++i) {
        const Index t = changed_[i];
        set_triangle(t, filling_[i][0], filling_[i][1], filling_[i][2]);
        attach(3 * t, boundary_[ears_[i][0]]);
        attach(3 * t + 1, boundary_[ears_[i][1]]);
        const bool last = i + 1 == filling_.size();
        if (last) attach(3 * t + 2, boundary_[ears_[i][2]]);
        boundary_[ears_[i][0]] = {3 * t + 2, false};
        if (!last && has_constraints()) constrained_[3 * t + 2] = 0;
    }
    for (std::size_t i = filling_.size(); i < cavity_.size(); ++i) {
        origin_[3 * cavity_[i]] = none;
        free_triangles_.push_back(cavity_[i]);
    }
    out_[planned_vertex_] = none;
    free_vertices_.push_back(planned_vertex_);
    recent_ = changed_.front();
}

// ---- the whole ----

Delaunay Delaunay::compacted() const {
    glm::ivec2 low(max_coordinate), high(-max_coordinate);
    for (Index v = 0; v < vertex_slots(); ++v)
        if (vertex_alive(v)) {
            low = glm::min(low, point_[v]);
            high = glm::max(high, point_[v]);
        }
    Delaunay out(low, high);
    out.reserve(triangle_count());
    std::vector<Index> number(vertex_slots(), none);
    for (Index v = 0; v < vertex_slots(); ++v)
        if (vertex_alive(v)) number[v] = out.insert(point_[v]);
    for (Index e = 0; e < origin_.size() && has_constraints(); ++e)
        if (alive(e / 3) && constrained(e) && (twin_[e] == none || e < twin_[e]))
            out.constrain(number[origin_[e]], number[origin_[next(e)]]);
    return out;
}

// ---- the check ----

std::string Delaunay::check() const {
    std::size_t border = 0, sides = 0, triangles = 0;
    for (Index t = 0; t < triangle_slots(); ++t) {
        if (!alive(t)) continue;
        ++triangles;
        const auto p = corners(t);
        const std::string name = "triangle " + std::to_string(t);
        if (orientation(p[0], p[1], p[2]) <= 0) return name + " does not turn left";
        for (Index e = 3 * t; e < 3 * t + 3; ++e) {
            const Index f = twin_[e];
            sides += f == none || e < f;
            border += f == none;
            if (out_[origin_[e]] == none) return name + " has a removed vertex";
            if (f == none) continue;
            if (twin_[f] != e || !alive(f / 3)) return name + " is not linked back";
            if (origin_[f] != origin_[next(e)] || origin_[next(f)] != origin_[e]) return name + " is linked askew";
            if (constrained(e) != constrained(f)) return name + " has a side constrained on one side of it only";
            if (!constrained(e) && in_circle(p[0], p[1], p[2], point_[origin_[previous(f)]]))
                return name + " is not Delaunay";
        }
    }
    std::size_t vertices = 0;
    for (Index v = 0; v < vertex_slots(); ++v) {
        if (out_[v] == none) continue;
        ++vertices;
        if (origin_[out_[v]] != v) return "vertex " + std::to_string(v) + " is not where it says";
    }
    if (triangles != triangle_count() || vertices != vertex_count()) return "what is alive is not what is counted";
    if (vertices + triangles != sides + 1) return "it is no disc";
    if (border < 4) return "it has no border";
    return {};
}

}  // namespace planet
