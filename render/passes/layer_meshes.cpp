#include "render/passes/layer_meshes.h"

#include <array>

namespace render {

namespace {

constexpr GLuint picture_unit = 8;  // beyond those of the terrain, which stay bound

Texture texture_of(const PlacedMesh& mesh) {
    const planet::Image& picture = mesh.picture();
    if (picture.pixels.empty()) return {};
    const GLenum format = picture.channels == 4 ? GL_SRGB8_ALPHA8 : GL_SRGB8;
    Texture texture =
        Texture::make_2d(format, picture.width, picture.height, mip_levels(picture.width, picture.height));
    texture.upload(0, std::as_bytes(std::span(picture.pixels)));
    texture.generate_mipmaps();
    const GLenum wrap = mesh.repeats_picture() ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    texture.set_sampling({.wrap_s = wrap, .wrap_t = wrap});
    return texture;
}

}  // namespace

LayerMeshPass::LayerMeshPass()
    : program_(Program::link({"layer_mesh.vert.glsl", "layer_mesh.frag.glsl"}, {.defines = {"FROM_AFAR"}})),
      nothing_(Program::link({"full_screen.vert.glsl", "layer_paint.frag.glsl"})),
      no_vertices_(VertexArray::create()) {}

const LayerMeshPass::OnGpu& LayerMeshPass::on_gpu(const PlacedMesh& mesh, double exaggeration) {
    OnGpu& kept = meshes_[&mesh];
    if (kept.array && kept.exaggeration == exaggeration) return kept;
    kept.exaggeration = exaggeration;
    kept.vertices = Buffer(bytes_of(mesh.vertices(exaggeration)));
    kept.indices = Buffer(bytes_of(mesh.triangles()));
    kept.count = static_cast<GLsizei>(3 * mesh.triangles().size());
    if (!kept.picture) kept.picture = texture_of(mesh);
    kept.array = VertexArray::create();
    const auto grid = grid_attributes();
    const Attribute attributes[] = {grid[0],
                                    grid[1],
                                    {.location = 2, .components = 3, .offset = offsetof(PlacedMesh::Vertex, normal)},
                                    {.location = 3, .components = 1, .offset = offsetof(PlacedMesh::Vertex, height)},
                                    {.location = 4,
                                     .components = 4,
                                     .type = GL_UNSIGNED_SHORT,
                                     .offset = offsetof(PlacedMesh::Vertex, color),
                                     .conversion = Attribute::Conversion::normalized},
                                    {.location = 5, .components = 2, .offset = offsetof(PlacedMesh::Vertex, uv)}};
    kept.array.set_vertices(0, kept.vertices, sizeof(PlacedMesh::Vertex), attributes);
    kept.array.set_indices(kept.indices);
    return kept;
}

// Where the mesh is what is seen, depth becomes that of its place, for what is draped over it.
void LayerMeshPass::write_own_depth(const std::function<void()>& triangles) {
    gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl().StencilFunc(GL_EQUAL, 1, 0xff);
    gl().StencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    gl().DepthFunc(GL_ALWAYS);
    nothing_.use();
    no_vertices_.bind();
    gl().DrawArrays(GL_TRIANGLES, 0, 3);
    gl().DepthFunc(GL_GREATER);
    program_.use();
    program_.set("lift", 0.0f);
    triangles();
    gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void LayerMeshPass::draw(std::span<const Layer* const> layers, const Camera& camera, const PicturePart& part,
                         const TerrainLook& look) {
    program_.use();
    set_terrain_uniforms(program_, camera, part, look);
    const auto lift = static_cast<float>(mesh_lift_m(look.exaggeration));
    for (const Layer* layer : layers) {
        if (!layer->mesh) continue;
        const OnGpu& mesh = on_gpu(*layer->mesh, look.exaggeration);
        program_.set("own_colors", static_cast<GLint>(layer->style.own_colors && layer->mesh->has_colors()));
        program_.set("textured", static_cast<GLint>(layer->style.own_colors && mesh.picture));
        if (mesh.picture) mesh.picture.bind(picture_unit);
        program_.set("paint", glm::vec4(linear_from_srgb(layer->style.color), layer->style.opacity));
        const auto triangles = [&] {
            mesh.array.bind();
            gl().DrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr);
        };
        gl().Enable(GL_STENCIL_TEST);
        constexpr GLint none = 0;
        gl().ClearBufferiv(GL_STENCIL, 0, &none);
        // Its depth first, so that what is seen through is the terrain and not the mesh itself.
        program_.set("lift", lift);
        gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        gl().StencilFunc(GL_ALWAYS, 1, 0xff);
        gl().StencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
        triangles();
        gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
        gl().DepthFunc(GL_EQUAL);
        gl().Enable(GL_BLEND);
        gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        triangles();
        gl().Disable(GL_BLEND);
        write_own_depth(triangles);
        gl().Disable(GL_STENCIL_TEST);
    }
}

}  // namespace render
