#pragma once
// Everything that is not the ground: the sky, the sun and the stars, and the tables that the ground's shader shares.

#include <span>

#include "render/gl/buffer.h"
#include "render/gl/shader.h"
#include "render/gl/texture.h"
#include "render/picture/camera.h"
#include "render/sky/atmosphere.h"
#include "render/sky/stars.h"

namespace render {

class SkyPass {
  public:
    /// @param stars may be empty @param noise of make_noise_levels()
    SkyPass(std::span<const Star> stars, std::span<const std::vector<std::uint8_t>> noise);

    /// Uploads the tables of a view. @param ecef_from_inertial the Earth's rotation, for the stars
    void set_view(const AtmosphereTables& tables, const ViewTable& view, const glm::mat3& ecef_from_inertial);

    /// Binds textures 0..3 and the uniform block, which terrain shaders use too, for a part of a picture.
    void bind(const Camera& camera, const PicturePart& part);

    /// Draws sky and stars where nothing nearer was drawn: after the terrain.
    void draw(const Camera& camera, const PicturePart& part) {
        draw_air(camera, part);
        draw_stars(camera, part);
    }
    /// One after the other: stars add to what is there.
    void draw_air(const Camera& camera, const PicturePart& part);
    void draw_stars(const Camera& camera, const PicturePart& part);

  private:
    Program sky_, stars_;
    VertexArray nothing_, star_array_;
    Buffer star_buffer_, uniforms_;
    GLsizei star_count_ = 0;
    Texture air_, sun_light_, sky_light_, noise_;
    SkyUniforms block_{};
    glm::mat3 ecef_from_inertial_{1};
};

}  // namespace render
