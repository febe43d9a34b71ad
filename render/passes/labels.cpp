#include "render/passes/labels.h"

#include <algorithm>

namespace render {

namespace {

constexpr int atlas_side = 1024;
constexpr float rim_px = 2.2f;

}  // namespace

LabelPass::LabelPass()
    : glyphs_(open_glyphs()),
      program_(Program::link({"label.vert.glsl", "label.frag.glsl"})),
      atlas_(Texture::make_2d(GL_R8, atlas_side, atlas_side)) {}

/// Letters come into the atlas when they are first asked for; when it is full, others stay blank.
const LabelPass::Place& LabelPass::place_of(char32_t character) {
    const auto found = places_.find(character);
    if (found != places_.end()) return found->second;
    Place place{glyphs_->glyph(character)};
    const int width = place.glyph.width + 1, height = place.glyph.height + 1;
    if (pen_x_ + width > atlas_side) {
        pen_x_ = 0;
        pen_y_ += std::exchange(row_height_, 0);
    }
    if (width > atlas_side || pen_y_ + height > atlas_side) place.glyph.width = place.glyph.height = 0;
    if (place.glyph.width > 0) {
        place.x = pen_x_, place.y = pen_y_;
        atlas_.upload_box(0, place.x, place.y, 0, place.glyph.width, place.glyph.height, 1,
                          bytes_of(place.glyph.distances));
        pen_x_ += width;
        row_height_ = std::max(row_height_, height);
    }
    place.glyph.distances = {};
    return places_.emplace(character, std::move(place)).first->second;
}

double LabelPass::width_of(const std::string& text, double size) {
    double width = 0;
    for (const char32_t c : characters_of(text)) width += static_cast<double>(place_of(c).glyph.advance);
    return width * size / glyph_size;
}

void LabelPass::add(const PlacedLabel& label, double size, std::vector<Quad>& quads) {
    const float scale = static_cast<float>(size / glyph_size);
    // Capitals are 0.73 em high: their middle is the line's.
    const float baseline = label.at.y + 0.365f * static_cast<float>(size);
    float pen = label.at.x;
    for (const char32_t c : characters_of(*label.text)) {
        const Place& p = place_of(c);
        const float left = pen + scale * p.glyph.left, top = baseline - scale * p.glyph.top;
        const auto width = static_cast<float>(p.glyph.width), height = static_cast<float>(p.glyph.height);
        if (p.glyph.width > 0)
            quads.push_back({{left, top, left + scale * width, top + scale * height},
                             glm::vec4(p.x, p.y, static_cast<float>(p.x) + width, static_cast<float>(p.y) + height) /
                                 static_cast<float>(atlas_side)});
        pen += scale * p.glyph.advance;
    }
}

void LabelPass::draw(std::span<const Layer* const> layers, const Camera& camera, const PicturePart& part,
                     const DrapeGround& ground, double pixel_scale) {
    const double size = label_size_px * pixel_scale;
    const auto labels =
        place_labels(layers, camera, ground, size, [&](const std::string& text) { return width_of(text, size); });
    std::vector<Quad> quads;
    for (const PlacedLabel& label : labels) add(label, size, quads);
    if (quads.empty()) return;
    const Buffer buffer(bytes_of(quads));
    VertexArray array = VertexArray::create();
    const Attribute attributes[] = {{.location = 0, .components = 4, .offset = 0},
                                    {.location = 1, .components = 4, .offset = sizeof(glm::vec4)}};
    array.set_vertices(0, buffer, sizeof(Quad), attributes, 1);
    atlas_.bind(0);
    program_.use();
    program_.set("part", glm::vec4(part.x, part.y, part.width, part.height));
    program_.set("pixels_of_texel", static_cast<float>(255 / glyph_step * size / glyph_size));
    gl().Disable(GL_DEPTH_TEST);
    gl().Enable(GL_BLEND);
    gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    array.bind();
    // All rims before all letters: none lies over a letter of its neighbour.
    for (const bool rim : {true, false}) {
        program_.set("rim", rim ? rim_px * static_cast<float>(pixel_scale) : 0.0f);
        program_.set("paint", rim ? glm::vec4(0.03f, 0.04f, 0.06f, 0.72f) : glm::vec4(1, 1, 1, 1));
        gl().DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(quads.size()));
    }
    gl().Disable(GL_BLEND);
    gl().Enable(GL_DEPTH_TEST);
}

}  // namespace render
