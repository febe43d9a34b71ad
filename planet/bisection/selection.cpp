#include <cassert>

#include "planet/bisection/progressive.h"

namespace planet {

using Index = Progressive::Index;

Selection::Selection(const Progressive& mesh) : mesh_(&mesh), in_(mesh.vertex_count(), 0) {
    set_prefix(0);
}

std::size_t Selection::insert(Index vertex) {
    const std::size_t before = count_;
    stack_.assign(1, vertex);
    while (!stack_.empty()) {
        const Index v = stack_.back();
        stack_.pop_back();
        if (in_[v]) continue;
        in_[v] = 1;
        ++count_;
        for (const Index needed : mesh_->dependencies(v))
            if (needed != Progressive::none && !in_[needed]) stack_.push_back(needed);
    }
    return count_ - before;
}

std::size_t Selection::remove(Index vertex) {
    assert(vertex >= mesh_->base_vertex_count());
    const std::size_t before = count_;
    stack_.assign(1, vertex);
    while (!stack_.empty()) {
        const Index v = stack_.back();
        stack_.pop_back();
        if (!in_[v]) continue;
        in_[v] = 0;
        --count_;
        for (const Index needing : mesh_->dependents(v))
            if (contains(needing)) stack_.push_back(needing);
    }
    return before - count_;
}

void Selection::set_prefix(Index splits) {
    assert(splits <= mesh_->split_count());
    count_ = std::size_t{mesh_->base_vertex_count()} + splits;
    std::fill(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(count_), std::uint8_t{1});
    std::fill(in_.begin() + static_cast<std::ptrdiff_t>(count_), in_.end(), std::uint8_t{0});
}

void Selection::select(const std::function<bool(Index vertex)>& wanted) {
    set_prefix(0);
    for (Index v = mesh_->base_vertex_count(); v < mesh_->vertex_count(); ++v)
        if (wanted(v)) insert(v);
}

Selection::Children Selection::children(Index name) const {
    if (!contains(mesh_->splitter(name))) return {};
    const auto half = mesh_->halves(name);
    if (mesh_->becomes_four(name) && contains(mesh_->splitter(half[0].name)) && contains(mesh_->splitter(half[1].name)))
        return {mesh_->four(name), 4};
    return {{half[0], half[1]}, 2};
}

std::vector<std::array<Index, 3>> Selection::triangles() const {
    std::vector<std::array<Index, 3>> out;
    std::vector<Progressive::Child> stack;
    for (Index t = 0; t < mesh_->base().triangles.size(); ++t) {
        stack.push_back({t, mesh_->base_corners(t)});
        while (!stack.empty()) {
            const Progressive::Child top = stack.back();
            stack.pop_back();
            const Children below = children(top.name);
            if (below.count == 0) out.push_back(top.corners);
            for (int i = below.count; i-- > 0;) stack.push_back(below.child[static_cast<std::size_t>(i)]);
        }
    }
    return out;
}

PlainMesh Selection::mesh(const std::function<double(Index vertex)>& fraction) const {
    PlainMesh out;
    std::vector<Index> number(mesh_->vertex_count());
    std::vector<glm::dvec3> moved;
    if (fraction) moved.assign(mesh_->places().begin(), mesh_->places().end());
    const std::size_t width = mesh_->base().attribute_width;
    const std::vector<float> attributes = width == 0 ? std::vector<float>() : mesh_->attributes(mesh_->vertex_count());
    out.vertices.reserve(count_);
    for (Index v = 0; v < number.size(); ++v) {
        if (!in_[v]) continue;
        if (fraction && v >= mesh_->base_vertex_count()) {
            const auto [a, b] = mesh_->ends(v);
            moved[v] = morphed(moved[a], moved[b], mesh_->place(v), fraction(v));
        }
        number[v] = static_cast<Index>(out.vertices.size());
        out.vertices.push_back(fraction ? moved[v] : mesh_->place(v));
        for (std::size_t i = 0; i < width; ++i) out.attributes.push_back(attributes[v * width + i]);
    }
    out.attribute_width = width;
    out.triangles = triangles();
    for (auto& t : out.triangles)
        for (Index& v : t) v = number[v];
    return out;
}

}  // namespace planet
