#include "render/passes/overlay.h"

#include "render/passes/terrain.h"

namespace render {

namespace {

struct OverlayVertex {
    planet::GridPosition position;
    std::uint32_t corner_and_level;
};

// In a strip the curve enters triangle (a, b, c) through side a-b and leaves it through b-c: b is its pivot.
std::vector<OverlayVertex> expand(const planet::Segments& segments) {
    std::vector<OverlayVertex> list;
    list.reserve(segments.leaf_count() * 3);
    for (const planet::Segment& s : segments.segments()) {
        std::size_t leaf = s.first_leaf;
        const std::uint32_t* index = segments.indices().data() + s.first_index;
        for (std::uint32_t i = 0; i + 2 < s.index_count; ++i) {
            const std::uint32_t a = index[i], b = index[i + 1], c = index[i + 2];
            if (a == b || b == c || a == c) continue;
            const std::uint32_t level = static_cast<std::uint32_t>(segments.leaf_levels()[leaf++]) << 2;
            const auto add = [&](std::uint32_t vertex, std::uint32_t corner) {
                list.push_back({segments.vertices()[s.first_vertex + vertex].position, level | corner});
            };
            add(b, 0);
            add(i & 1 ? a : c, 1);
            add(i & 1 ? c : a, 2);
        }
    }
    return list;
}

}  // namespace

OverlayPass::OverlayPass(Show show) : show_(show) {
    if (show.any()) program_ = Program::link({"overlay.vert.glsl", "overlay.frag.glsl"});
}

void OverlayPass::upload(const planet::Segments& segments) {
    if (!show_.any()) return;
    const std::vector<OverlayVertex> list = expand(segments);
    count_ = static_cast<GLsizei>(list.size());
    vertices_ = Buffer(bytes_of(list));
    array_ = VertexArray::create();
    const auto grid = grid_attributes();
    const Attribute attributes[] = {grid[0],
                                    grid[1],
                                    {.location = 2,
                                     .components = 1,
                                     .type = GL_UNSIGNED_INT,
                                     .offset = 16,
                                     .conversion = Attribute::Conversion::integer}};
    array_.set_vertices(0, vertices_, sizeof(OverlayVertex), attributes);
}

void OverlayPass::draw(const Camera& camera, const PicturePart& part) {
    if (count_ == 0) return;
    program_.use();
    set_grid_camera(program_, camera, part);
    program_.set("show", glm::ivec3(show_.mesh, show_.levels, show_.curve));
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_GEQUAL);
    gl().DepthMask(GL_FALSE);
    gl().Enable(GL_CULL_FACE);
    // The same vertices in another order: depths between them may part by some roundings.
    gl().Enable(GL_POLYGON_OFFSET_FILL);
    gl().PolygonOffset(1.0f, 64.0f);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    array_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, count_);
    gl().Disable(GL_BLEND);
    gl().Disable(GL_POLYGON_OFFSET_FILL);
    gl().Disable(GL_CULL_FACE);
    gl().DepthMask(GL_TRUE);
}

}  // namespace render
