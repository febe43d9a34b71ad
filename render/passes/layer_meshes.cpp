#include "render/passes/layer_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace render {

namespace {

/// What a mesh and the terrain may be off along the view: nearer than that it is the mesh that is seen.
constexpr double lift_m = 150;

glm::vec3 linear_from_srgb(const glm::vec3& c) {
    const auto linear = [](float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); };
    return {linear(c.r), linear(c.g), linear(c.b)};
}

}  // namespace

LayerMeshPass::LayerMeshPass()
    : program_(Program::link({"layer_mesh.vert.glsl", "layer_mesh.frag.glsl"}, {.defines = {"FROM_AFAR"}})) {}

const LayerMeshPass::OnGpu& LayerMeshPass::on_gpu(const PlacedMesh& mesh, double exaggeration) {
    OnGpu& kept = meshes_[&mesh];
    if (kept.array && kept.exaggeration == exaggeration) return kept;
    kept.exaggeration = exaggeration;
    kept.vertices = Buffer(bytes_of(mesh.vertices(exaggeration)));
    kept.indices = Buffer(bytes_of(mesh.triangles()));
    kept.count = static_cast<GLsizei>(3 * mesh.triangles().size());
    kept.array = VertexArray::create();
    const auto grid = grid_attributes();
    const Attribute attributes[] = {grid[0],
                                    grid[1],
                                    {.location = 2, .components = 3, .offset = offsetof(PlacedMesh::Vertex, normal)},
                                    {.location = 3, .components = 1, .offset = offsetof(PlacedMesh::Vertex, height)}};
    kept.array.set_vertices(0, kept.vertices, sizeof(PlacedMesh::Vertex), attributes);
    kept.array.set_indices(kept.indices);
    return kept;
}

void LayerMeshPass::draw(std::span<const Layer* const> layers, const Camera& camera, const PicturePart& part,
                         const TerrainLook& look) {
    program_.use();
    set_terrain_uniforms(program_, camera, part, look);
    program_.set("lift", static_cast<float>(lift_m * std::max(look.exaggeration, 1.0)));
    for (const Layer* layer : layers) {
        if (!layer->mesh) continue;
        const OnGpu& mesh = on_gpu(*layer->mesh, look.exaggeration);
        program_.set("paint", glm::vec4(linear_from_srgb(layer->style.color), layer->style.opacity));
        mesh.array.bind();
        const auto triangles = [&] { gl().DrawElements(GL_TRIANGLES, mesh.count, GL_UNSIGNED_INT, nullptr); };
        // Its depth first, so that what is seen through is the terrain and not the mesh itself.
        gl().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        gl().DepthFunc(GL_GREATER);
        triangles();
        gl().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        gl().DepthFunc(GL_EQUAL);
        gl().Enable(GL_BLEND);
        gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        triangles();
        gl().Disable(GL_BLEND);
        gl().DepthFunc(GL_GREATER);
    }
}

}  // namespace render
