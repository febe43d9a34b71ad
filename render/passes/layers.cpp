#include "render/passes/layers.h"

namespace render {

namespace {

constexpr double casing_px = 1.2, casing_opacity = 0.45;
constexpr glm::vec3 casing_color(0.03f, 0.04f, 0.06f);
constexpr int outside = 128;  // the stencil's middle: places may lie in fewer walls than the eye

}  // namespace

LayerPass::LayerPass()
    : line_(Program::link({"layer_line.vert.glsl", "layer_line.frag.glsl"})),
      wall_(Program::link({"layer_wall.vert.glsl", "layer_paint.frag.glsl"})),
      paint_(Program::link({"full_screen.vert.glsl", "layer_paint.frag.glsl"})),
      nothing_(VertexArray::create()) {}

void LayerPass::draw(std::span<const Layer* const> layers, const View& view) {
    if (layers.empty()) return;
    view.target.resolve_depth();
    gl().DepthMask(GL_FALSE);
    gl().Disable(GL_DEPTH_TEST);
    gl().Enable(GL_BLEND);
    for (const Layer* layer : layers) draw(*layer, view);
    begin_alpha(1);
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl().Disable(GL_BLEND);
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthMask(GL_TRUE);
    view.target.bind();
}

// What overlaps counts once: a layer's alpha is gathered in that of the picture, and then its colour blended with it.
void LayerPass::draw(const Layer& layer, const View& view) {
    const LayerStyle& style = layer.style;
    const double line = 0.5 * style.width * view.pixel_scale,
                 point = point_radius_widths * style.width * view.pixel_scale;
    const Pieces lines = drape(layer.lines, view), points = drape(layer.points, view);
    if (style.casing) {
        begin_alpha(0);
        const double rim = casing_px * view.pixel_scale, opacity = casing_opacity * style.opacity;
        cover(lines, line + rim, opacity, view);
        cover(points, point + rim, opacity, view);
        blend(casing_color);
    }
    begin_alpha(0);
    if (!layer.polygons.empty()) fill(layer.polygons, style.fill * style.opacity, view);
    cover(lines, line, style.opacity, view);
    cover(points, point, style.opacity, view);
    blend(style.color);
}

LayerPass::Pieces LayerPass::drape(const GeodesicLines& lines, const View& view) {
    std::vector<ScreenPiece> list;
    render::drape(lines, view.camera, view.ground, list);
    Pieces pieces{Buffer(bytes_of(list)), VertexArray::create(), static_cast<GLsizei>(list.size())};
    const Attribute ends[] = {{.location = 0, .components = 3, .offset = 0},
                              {.location = 1, .components = 3, .offset = sizeof(glm::vec3)}};
    pieces.array.set_vertices(0, pieces.buffer, sizeof(ScreenPiece), ends, 1);
    return pieces;
}

void LayerPass::cover(const Pieces& pieces, double half_width, double opacity, const View& view) {
    if (pieces.count == 0) return;
    view.target.bind_color();
    (view.terrain_depth != nullptr ? *view.terrain_depth : view.target.depth()).bind(0);
    view.target.depth().bind(1);
    line_.use();
    line_.set("part", glm::vec4(view.part.x, view.part.y, view.part.width, view.part.height));
    line_.set("half_width", static_cast<float>(half_width));
    line_.set("opacity", static_cast<float>(opacity));
    line_.set("pixel_slack", static_cast<float>(1 - (1.5 + half_width) / view.camera.focal_px));
    line_.set("lift", view.terrain_depth != nullptr ? static_cast<float>(view.mesh_lift_m) : 0.0f);
    line_.set("near", static_cast<float>(view.camera.near_m));
    gl().BlendEquation(GL_MAX);
    pieces.array.bind();
    gl().DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, pieces.count);
    gl().BlendEquation(GL_FUNC_ADD);
    view.target.bind();
}

void LayerPass::fill(const FilledPolygons& polygons, double opacity, const View& view) {
    const PolygonWalls walls = polygons.walls(view.camera, view.ground.relief_m);
    const Buffer buffer(bytes_of(walls.triangles));
    VertexArray array = VertexArray::create();
    const Attribute place[] = {{.location = 0, .components = 4}};
    array.set_vertices(0, buffer, sizeof(glm::vec4), place);
    const GLint eye_count = outside + walls.around_eye;
    gl().ClearBufferiv(GL_STENCIL, 0, &eye_count);
    gl().Enable(GL_STENCIL_TEST);
    gl().Enable(GL_DEPTH_TEST);

    gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl().DepthFunc(GL_GREATER);
    gl().StencilFunc(GL_ALWAYS, 0, 0xff);
    gl().StencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    gl().StencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    wall_.use();
    wall_.set("clip_from_ecef", view.camera.clip_from_ecef(view.part));
    array.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(walls.triangles.size()));

    gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
    gl().DepthFunc(GL_LESS);  // on the ground, not on the sky
    gl().StencilFunc(GL_NOTEQUAL, outside, 0xff);
    gl().StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl().BlendFunc(GL_ONE, GL_ZERO);
    paint(glm::vec4(0, 0, 0, opacity));
    gl().DepthFunc(GL_GREATER);
    gl().Disable(GL_DEPTH_TEST);
    gl().Disable(GL_STENCIL_TEST);
}

void LayerPass::begin_alpha(float alpha) {
    gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
    const GLfloat value[] = {0, 0, 0, alpha};
    gl().ClearBufferfv(GL_COLOR, 0, value);
}

void LayerPass::blend(const glm::vec3& color) {
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    gl().BlendFunc(GL_DST_ALPHA, GL_ONE_MINUS_DST_ALPHA);
    paint(glm::vec4(color, 1));
}

void LayerPass::paint(const glm::vec4& color) {
    paint_.use();
    paint_.set("paint", color);
    nothing_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace render
