#include "render/passes/overlay.h"

#include <algorithm>
#include <cmath>

#include "planet/geodesy/geodetic.h"
#include "planet/octahedron/octahedron_map.h"
#include "render/layers/graticule.h"
#include "render/passes/terrain.h"

namespace render {

namespace {

struct OverlayVertex {
    planet::GridPosition position;
    std::uint32_t traits;  ///< corner 0-1, bisection level 2-7, colour of the segment 8-15, deviation 16-23
};

/// The certified deviation of a leaf, metres.
double leaf_deviation(const planet::TileSource& tiles, const glm::dvec3& middle, int level) {
    constexpr double stretch = (planet::wgs84.a / planet::wgs84.b) * (planet::wgs84.a / planet::wgs84.b);
    const planet::LocationCode cell = planet::cell_at({middle.x, middle.y, middle.z * stretch}, level);
    // The first cell of a tile has its record above, too: the tile need not be there.
    const int below = level > 0 && level % planet::tile_levels == 0 ? planet::tile_levels : level % planet::tile_levels;
    const planet::PlacedTile* tile = tiles.tile(cell.ancestor(level - below));
    if (tile == nullptr) return 0;
    const auto last = static_cast<unsigned>(cell.bits() & ((1u << below) - 1));
    if (below == planet::tile_levels)
        return static_cast<double>(tile->child_bound.empty() ? 0 : tile->child_bound[last].deviation);
    const unsigned local = last | 1u << below;
    return below < tile->depth ? std::abs(static_cast<double>(tile->split[local].deviation)) : 0;
}

/// 0..255 for 1/4 m to 1 km, by its logarithm.
std::uint32_t deviation_class(double metres) {
    return static_cast<std::uint32_t>(std::clamp((std::log2(std::max(metres, 1e-6)) + 2) / 12, 0.0, 1.0) * 255);
}

std::uint32_t segment_color(planet::LocationCode root) {
    return static_cast<std::uint32_t>(root.bits() * 0x9e3779b97f4a7c15u >> 56);
}

// In a strip the curve enters triangle (a, b, c) through side a-b and leaves it through b-c: b is its pivot.
std::vector<OverlayVertex> expand(const planet::Segments& segments, const planet::TileSource* tiles) {
    std::vector<OverlayVertex> list;
    list.reserve(segments.leaf_count() * 3);
    for (const planet::Segment& s : segments.segments()) {
        std::size_t leaf = s.first_leaf;
        const std::uint32_t* index = segments.indices().data() + s.first_index;
        const auto position = [&](std::uint32_t v) { return segments.vertices()[s.first_vertex + v].position; };
        for (std::uint32_t i = 0; i + 2 < s.index_count; ++i) {
            const std::uint32_t a = index[i], b = index[i + 1], c = index[i + 2];
            if (a == b || b == c || a == c) continue;
            const std::uint32_t level = segments.leaf_levels()[leaf++];
            std::uint32_t traits = level << 2 | segment_color(s.root) << 8;
            if (tiles != nullptr) {
                const glm::dvec3 sum = planet::ecef_from_grid(position(a)) + planet::ecef_from_grid(position(b)) +
                                       planet::ecef_from_grid(position(c));
                traits |= deviation_class(leaf_deviation(*tiles, sum, static_cast<int>(level))) << 16;
            }
            list.push_back({position(b), traits});
            list.push_back({position(i & 1 ? a : c), traits | 1});
            list.push_back({position(i & 1 ? c : a), traits | 2});
        }
    }
    return list;
}

}  // namespace

OverlayPass::OverlayPass(Show show) : show_(show) {
    if (show.any()) program_ = Program::link({"overlay.vert.glsl", "overlay.frag.glsl"});
}

void OverlayPass::upload(const planet::Segments& segments, const planet::TileSource& tiles) {
    if (!show_.any()) return;
    const std::vector<OverlayVertex> list = expand(segments, show_.deviations ? &tiles : nullptr);
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

void OverlayPass::draw(const Camera& camera, const PicturePart& part, double pixel_scale) {
    if (count_ == 0) return;
    program_.use();
    set_grid_camera(program_, camera, part);
    const GLint fill = show_.deviations ? 3 : show_.segments ? 2 : show_.levels ? 1 : 0;
    program_.set("show", glm::ivec3(show_.mesh, fill, show_.curve));
    program_.set("eye", glm::vec3(camera.eye));
    program_.set("pixel_scale", static_cast<float>(pixel_scale));
    program_.set("graticule", show_.graticule ? static_cast<float>(graticule_step(camera, pixel_scale)) : 0.0f);
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
