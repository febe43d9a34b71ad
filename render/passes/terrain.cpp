#include "render/passes/terrain.h"

#include <algorithm>
#include <cassert>
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
    program.set("morph_reach", static_cast<float>(look.morph_reach));
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

std::array<Attribute, 2> morph_attributes() {
    using planet::MorphVertex;
    return {{{.location = 5, .components = 3, .offset = offsetof(MorphVertex, x)},
             {.location = 6, .components = 3, .offset = offsetof(MorphVertex, deviation)}}};
}

bool FollowingBuffer::make_room(std::size_t bytes) {
    if (buffer_ && bytes <= buffer_.size()) return false;
    buffer_ = Buffer(bytes + bytes / 2);
    return true;
}

std::size_t FollowingBuffer::follow(std::span<const std::byte> contents, std::span<const planet::Range> changed,
                                    std::size_t stride) {
    if (make_room(contents.size())) {
        buffer_.upload(contents);
        return contents.size();
    }
    std::size_t sent = 0;
    for (const planet::Range& range : changed) {
        const std::size_t first = range.first * stride, bytes = range.count * stride;
        buffer_.upload(contents.subspan(first, bytes), first);
        sent += bytes;
    }
    return sent;
}

std::size_t FollowingBuffer::follow(std::span<const std::byte> contents) {
    if (buffer_ && std::ranges::equal(contents, last_)) return 0;
    make_room(contents.size());
    buffer_.upload(contents);
    last_.assign(contents.begin(), contents.end());
    return contents.size();
}

Program& TerrainPass::program(const TerrainLook& look) {
    const bool morphed = look.morph_reach > 0;
    assert(!morphed || morphs_.buffer());
    Program& p = programs_[static_cast<std::size_t>(look.from_afar) + 2 * static_cast<std::size_t>(patched_) +
                           4 * static_cast<std::size_t>(morphed) + 8 * static_cast<std::size_t>(look.relief)];
    if (!p) {
        ProgramOptions options;
        if (look.from_afar) options.defines.push_back("FROM_AFAR");
        if (look.relief) options.defines.push_back("RELIEF");
        if (patched_) options.defines.push_back("PATCHED");
        if (morphed) options.defines.push_back("MORPH");
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

    // Of segments that were not followed nothing is known: all of the array has changed.
    const auto follow = [&](FollowingBuffer& buffer, const auto& array, std::span<const planet::Range> changed) {
        const planet::Range all{0, static_cast<std::uint32_t>(array.size())};
        return buffer.follow(bytes_of(array), &segments == followed_ ? changed : std::span(&all, 1), sizeof(array[0]));
    };
    sent_ = follow(vertices_, segments.vertices(), segments.changed_vertices()) +
            follow(indices_, segments.indices(), segments.changed_indices()) + layers_.follow(bytes_of(patch_layers)) +
            commands_.follow(bytes_of(commands));
    if (!segments.morphs().empty()) sent_ += follow(morphs_, segments.morphs(), segments.changed_vertices());
    followed_ = &segments;
    make_array(!segments.morphs().empty());
}

void TerrainPass::make_array(bool morphs) {
    array_ = VertexArray::create();
    array_.set_vertices(0, vertices_.buffer(), sizeof(planet::SegmentVertex), segment_attributes());
    array_.set_vertices(1, layers_.buffer(), sizeof(std::int32_t), std::array{layer_attribute()}, 1);
    if (morphs) array_.set_vertices(2, morphs_.buffer(), sizeof(planet::MorphVertex), morph_attributes());
    array_.set_indices(indices_.buffer());
}

std::size_t TerrainPass::bytes() const {
    std::size_t sum = 0;
    for (const FollowingBuffer* b : {&vertices_, &morphs_, &indices_, &layers_, &commands_}) sum += b->buffer().size();
    return sum;
}

void TerrainPass::draw(const Camera& camera, const PicturePart& part, const TerrainLook& look) {
    Program& p = program(look);
    p.use();
    set_terrain_uniforms(p, camera, part, look);
    array_.bind();
    commands_.buffer().bind(GL_DRAW_INDIRECT_BUFFER);
    gl().Enable(GL_DEPTH_TEST);
    gl().Enable(GL_CULL_FACE);
    gl().DepthFunc(GL_GREATER);
    gl().MultiDrawElementsIndirect(GL_TRIANGLE_STRIP, GL_UNSIGNED_INT, nullptr, command_count_, 0);
    gl().Disable(GL_CULL_FACE);
}

}  // namespace render
