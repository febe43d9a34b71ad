#pragma once
// Segments as what they are drawn as: strips on the GPU, or a list of triangles.

#include <array>
#include <span>
#include <vector>

#include "planet/mesh/segments.h"
#include "render/gl/buffer.h"
#include "render/passes/terrain.h"

namespace render::testing {

struct SegmentTriangle {
    std::array<std::uint32_t, 3> vertex;  ///< into Segments::vertices(), counter-clockwise from outside
    std::uint32_t segment;                ///< into Segments::segments()
    planet::LocationCode leaf;
};

/// The leaf that follows on the curve, given its bisection level: the next cell after `last` in its segment.
inline planet::LocationCode next_leaf(planet::LocationCode last, int bisection_level) {
    const std::uint64_t end = last.bits() + 1;  // the curve's place behind `last`, in codes of its level
    const int deeper = bisection_level - last.bisection_level();
    return planet::LocationCode(deeper >= 0 ? end << deeper : end >> -deeper);
}

/// All triangles in the order of the curve.
inline std::vector<SegmentTriangle> triangles_of(const planet::Segments& segments) {
    std::vector<SegmentTriangle> list;
    for (std::uint32_t number = 0; number < segments.segments().size(); ++number) {
        const planet::Segment& s = segments.segments()[number];
        const std::uint32_t* index = segments.indices().data() + s.first_index;
        std::size_t leaf = s.first_leaf;
        planet::LocationCode code = s.root;
        for (std::uint32_t i = 0; i + 2 < s.index_count; ++i) {
            std::array<std::uint32_t, 3> t{index[i], index[i + 1], index[i + 2]};
            if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
            if (i & 1) std::swap(t[0], t[1]);
            for (std::uint32_t& v : t) v += s.first_vertex;
            const int level = segments.leaf_levels()[leaf];
            code = leaf == s.first_leaf ? planet::LocationCode(s.root.bits() << (level - s.root.bisection_level()))
                                        : next_leaf(code, level);
            ++leaf;
            list.push_back({t, number, code});
        }
    }
    return list;
}

/// Segments on the GPU, with the attributes of terrain.vert.glsl that a position needs.
class SegmentBuffers {
  public:
    SegmentBuffers(std::span<const planet::SegmentVertex> vertices, std::span<const std::uint32_t> indices)
        : vertices_(bytes_of(vertices)), indices_(bytes_of(indices)), array_(VertexArray::create()) {
        array_.set_vertices(0, vertices_, sizeof(planet::SegmentVertex), grid_attributes());
        array_.set_indices(indices_);
    }
    /// Morphs too, if there are any.
    explicit SegmentBuffers(const planet::Segments& segments)
        : SegmentBuffers(segments.vertices(), segments.indices()) {
        if (segments.morphs().empty()) return;
        morphs_ = Buffer(bytes_of(segments.morphs()));
        array_.set_vertices(2, morphs_, sizeof(planet::MorphVertex), morph_attributes());
    }

    void bind() const { array_.bind(); }
    /// Draws the strips of those that `wanted(segment)`, with the program in use.
    template <class Wanted>
    void draw_strips(std::span<const planet::Segment> segments, Wanted wanted) const {
        bind();
        for (const planet::Segment& s : segments)
            if (wanted(s))
                gl().DrawElementsBaseVertex(GL_TRIANGLE_STRIP, static_cast<GLsizei>(s.index_count), GL_UNSIGNED_INT,
                                            reinterpret_cast<const void*>(std::size_t{s.first_index} * 4),
                                            static_cast<GLint>(s.first_vertex));
    }
    void draw_strips(std::span<const planet::Segment> segments) const {
        draw_strips(segments, [](const planet::Segment&) { return true; });
    }
    /// Draws the indices as a list of triangles.
    void draw_list(std::size_t count) const {
        bind();
        gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, nullptr);
    }

  private:
    Buffer vertices_, indices_, morphs_;
    VertexArray array_;
};

}  // namespace render::testing
