#include "render/passes/sky.h"

#include <cstddef>
#include <glm/gtc/packing.hpp>

namespace render {

namespace {

std::vector<std::uint64_t> half_texels(const TableImage& table) {
    std::vector<std::uint64_t> half(table.texels.size());
    for (std::size_t i = 0; i < half.size(); ++i) half[i] = glm::packHalf4x16(table.texels[i]);
    return half;
}

Texture table_2d(const TableImage& table) {
    Texture t = Texture::make_2d(GL_RGBA16F, table.width, table.height);
    t.upload(0, bytes_of(half_texels(table)));
    return t;
}

Texture noise_texture(std::span<const std::vector<std::uint8_t>> levels) {
    const int side = 1 << (levels.size() - 1);
    Texture t = Texture::make_3d(GL_RGBA8, side, side, side, static_cast<int>(levels.size()));
    for (int level = 0; level < t.levels(); ++level) t.upload(level, bytes_of(levels[static_cast<std::size_t>(level)]));
    t.set_sampling({.wrap_s = GL_REPEAT, .wrap_t = GL_REPEAT, .wrap_r = GL_REPEAT});
    return t;
}

}  // namespace

SkyPass::SkyPass(std::span<const Star> stars, std::span<const std::vector<std::uint8_t>> noise)
    : sky_(Program::link({"sky.vert.glsl", "sky.frag.glsl"})),
      nothing_(VertexArray::create()),
      uniforms_(sizeof(SkyUniforms)),
      star_count_(static_cast<GLsizei>(stars.size())),
      noise_(noise_texture(noise)) {
    if (stars.empty()) return;
    stars_ = Program::link({"stars.vert.glsl", "stars.frag.glsl"});
    star_buffer_ = Buffer(bytes_of(stars));
    star_array_ = VertexArray::create();
    const Attribute attributes[] = {{.location = 0, .components = 3, .offset = offsetof(Star, direction)},
                                    {.location = 1, .components = 3, .offset = offsetof(Star, light)}};
    star_array_.set_vertices(0, star_buffer_, sizeof(Star), attributes);
}

void SkyPass::set_view(const AtmosphereTables& tables, const ViewTable& view, const glm::mat3& ecef_from_inertial) {
    air_ = Texture::make_3d(GL_RGBA16F, view.air.width, view.air.height, view.air.depth);
    air_.upload(0, bytes_of(half_texels(view.air)));
    sun_light_ = table_2d(tables.sun_light);
    sky_light_ = table_2d(tables.sky_light);
    block_ = view.uniforms;
    ecef_from_inertial_ = ecef_from_inertial;
}

void SkyPass::bind(const Camera& camera, const PicturePart& part) {
    // gl_FragCoord counts from the part's bottom left; dithering counts from the picture's top left.
    block_.sky_picture.x = static_cast<float>(part.x);
    block_.sky_picture.y = static_cast<float>(camera.height - part.y - part.height);
    block_.sky_picture.w = static_cast<float>(1.0 / camera.focal_px);
    uniforms_.upload(std::as_bytes(std::span(&block_, 1)));
    uniforms_.bind_base(GL_UNIFORM_BUFFER, 1);
    air_.bind(0);
    sun_light_.bind(1);
    sky_light_.bind(2);
    noise_.bind(3);
}

void SkyPass::draw_air(const Camera& camera, const PicturePart& part) {
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_GEQUAL);
    gl().DepthMask(GL_FALSE);
    sky_.use();
    gl().UniformMatrix4fv(0, 1, GL_FALSE, &camera.ecef_direction_from_clip(part)[0][0]);
    nothing_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    gl().DepthMask(GL_TRUE);
}

void SkyPass::draw_stars(const Camera& camera, const PicturePart& part) {
    if (star_count_ == 0) return;
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthFunc(GL_GEQUAL);
    gl().DepthMask(GL_FALSE);
    stars_.use();
    gl().UniformMatrix4fv(0, 1, GL_FALSE, &camera.clip_from_ecef(part)[0][0]);
    gl().UniformMatrix3fv(1, 1, GL_FALSE, &ecef_from_inertial_[0][0]);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_ONE, GL_ONE);
    gl().Enable(GL_PROGRAM_POINT_SIZE);
    star_array_.bind();
    gl().DrawArrays(GL_POINTS, 0, star_count_);
    gl().Disable(GL_PROGRAM_POINT_SIZE);
    gl().Disable(GL_BLEND);
    gl().DepthMask(GL_TRUE);
}

}  // namespace render
