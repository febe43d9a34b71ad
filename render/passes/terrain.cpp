#include "render/passes/terrain.h"

#include <algorithm>
#include <cstddef>

namespace render {

namespace {

struct DrawCommand {  // DrawElementsIndirectCommand, OpenGL 4.5 core, 10.4
    GLuint count, instance_count, first_index;
    GLint base_vertex;
    GLuint base_instance;
};

}  // namespace

std::array<Attribute, 2> grid_attributes() {
    return {
        {{.location = 0, .components = 3, .type = GL_INT, .offset = 0, .conversion = Attribute::Conversion::integer},
         {.location = 1,
          .components = 1,
          .type = GL_UNSIGNED_INT,
          .offset = 12,
          .conversion = Attribute::Conversion::integer}}};
}

void set_grid_camera(Program& program, const Camera& camera, const PicturePart& part) {
    program.set("eye_hi", camera.grid_eye.hi);
    program.set("eye_lo", camera.grid_eye.lo);
    program.set("clip_from_ecef", camera.clip_from_ecef(part));
}

void set_terrain_uniforms(Program& program, const Camera& camera, const PicturePart& part, const TerrainLook& look) {
    set_grid_camera(program, camera, part);
    program.set("eye", glm::vec3(camera.eye));
    program.set("shape", glm::vec2(look.polar_stretch, look.exaggeration));
    program.set("pixel_angle", static_cast<float>(1.0 / camera.focal_px));
    program.set("patch_range", look.patch_range);
}

std::array<Attribute, 4> segment_attributes() {
    using planet::SegmentVertex;
    const auto grid = grid_attributes();
    return {{grid[0],
             grid[1],
             {.location = 2,
              .components = 2,
              .type = GL_UNSIGNED_SHORT,
              .offset = offsetof(SegmentVertex, u),
              .conversion = Attribute::Conversion::integer},
             {.location = 3, .components = 1, .offset = offsetof(SegmentVertex, height)}}};
}

Attribute layer_attribute() {
    return {.location = 4, .components = 1, .type = GL_INT, .conversion = Attribute::Conversion::integer};
}

Program& TerrainPass::program(bool from_afar) {
    Program& p = programs_[static_cast<std::size_t>(from_afar) + 2 * static_cast<std::size_t>(patched_)];
    if (!p) {
        ProgramOptions options;
        if (from_afar) options.defines.push_back("FROM_AFAR");
        if (patched_) options.defines.push_back("PATCHED");
        p = Program::link({"terrain.vert.glsl", "terrain.frag.glsl"}, options);
    }
    return p;
}

void TerrainPass::upload(const planet::Segments& segments, std::span<const std::int32_t> patch_layers) {
    std::vector<DrawCommand> commands;
    commands.reserve(segments.segments().size());
    for (const planet::Segment& s : segments.segments())
        commands.push_back({s.index_count, 1, s.first_index, static_cast<GLint>(s.first_vertex),
                            static_cast<GLuint>(commands.size())});
    patched_ = std::any_of(patch_layers.begin(), patch_layers.end(), [](std::int32_t layer) { return layer >= 0; });
    command_count_ = static_cast<GLsizei>(commands.size());
    vertices_ = Buffer(bytes_of(segments.vertices()));
    indices_ = Buffer(bytes_of(segments.indices()));
    layers_ = Buffer(bytes_of(patch_layers));
    commands_ = Buffer(bytes_of(commands));

    array_ = VertexArray::create();
    array_.set_vertices(0, vertices_, sizeof(planet::SegmentVertex), segment_attributes());
    array_.set_vertices(1, layers_, sizeof(std::int32_t), std::array{layer_attribute()}, 1);
    array_.set_indices(indices_);
}

void TerrainPass::draw(const Camera& camera, const PicturePart& part, const TerrainLook& look) {
    Program& p = program(look.from_afar);
    p.use();
    set_terrain_uniforms(p, camera, part, look);
    array_.bind();
    commands_.bind(GL_DRAW_INDIRECT_BUFFER);
    gl().Enable(GL_DEPTH_TEST);
    gl().Enable(GL_CULL_FACE);
    gl().DepthFunc(GL_GREATER);
    gl().MultiDrawElementsIndirect(GL_TRIANGLE_STRIP, GL_UNSIGNED_INT, nullptr, command_count_, 0);
    gl().Disable(GL_CULL_FACE);
}

}  // namespace render
