#pragma once
// A mesh from a file, in its place on the planet.

#include <array>
#include <optional>
#include <span>
#include <string>

#include "planet/elevation/image.h"
#include "planet/geodesy/geoid.h"
#include "planet/mesh/grid.h"
#include "planet/mesh/surface_mesh.h"

namespace render {

/// A picture on a mesh. Its colours are multiplied with those of the vertices.
struct MeshTexture {
    planet::Image picture;      ///< empty: none
    std::vector<glm::vec2> uv;  ///< by vertex, from the top left corner
};

class PlacedMesh {
  public:
    /// @param geoid for heights above it; those of a mesh that does not say are taken for such
    /// Throws planet::Error(bad_data), naming the file, if the reference does not say where on the Earth the mesh is.
    /// @param colors by vertex, linear, or empty
    /// @param texture with as many coordinates as vertices, or none
    PlacedMesh(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference,
               std::span<const glm::vec4> colors, const planet::Geoid& geoid, const std::string& file,
               MeshTexture texture = {});

    /// As the GPU takes them.
    struct Vertex {
        planet::GridPosition position;
        glm::vec3 normal;                    ///< of the ground, ecef, unit
        float height;                        ///< above the geoid, m, not exaggerated
        std::array<std::uint16_t, 4> color;  ///< linear, 65535 = 1
        glm::vec2 uv;                        ///< 0 without a texture
    };
    /// By vertex. @param exaggeration of heights above the geoid
    std::vector<Vertex> vertices(double exaggeration) const;
    const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
    bool has_colors() const { return has_colors_; }
    /// Empty: none.
    const planet::Image& picture() const { return texture_.picture; }
    /// Whether some of it lies beyond the picture, which is repeated there.
    bool repeats_picture() const;

  private:
    struct Place {
        glm::dvec3 normal{0, 0, 1};  ///< geodetic
        double height = 0;           ///< above the geoid, m
        double undulation = 0;
        std::array<std::uint16_t, 4> color{};
    };
    bool has_colors_;
    std::vector<Place> places_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    MeshTexture texture_;
};

}  // namespace render
