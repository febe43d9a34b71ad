#include "render/app/picture/part_painter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace render {

namespace {

int line_reach(const RenderOptions& options) {
    return options.has_layers() ? static_cast<int>(std::ceil(LayerPass::reach_px * options.drawn_scale())) : 0;
}

/// Rows of RGBA of one part into those of RGB of another. @param kept what is copied, in both
void copy_rgb(const std::vector<std::uint8_t>& rgba, const PicturePart& drawn, const PicturePart& kept,
              const PicturePart& band, std::vector<std::uint8_t>& rgb) {
    const auto index = [](const PicturePart& of, int x, int y) {
        return static_cast<std::size_t>(y - of.y) * static_cast<std::size_t>(of.width) +
               static_cast<std::size_t>(x - of.x);
    };
    for (int y = kept.y; y < kept.y + kept.height; ++y) {
        const std::uint8_t* from = rgba.data() + index(drawn, kept.x, y) * 4;
        std::uint8_t* to = rgb.data() + index(band, kept.x, y) * 3;
        for (int x = 0; x < kept.width; ++x, from += 4, to += 3) std::copy_n(from, 3, to);
    }
}

}  // namespace

PartPainter::PartPainter(const RenderOptions& options, const DrawnSurface& surface, const Camera& camera, Steps& steps)
    : options_(options),
      surface_(surface),
      camera_(camera),
      steps_(steps),
      threads_(options.thread_count()),
      line_reach_(line_reach(options)),
      mesher_(options, surface, camera, steps),
      parts_(camera, options.drawn(), {.side = options.part_side, .margin = std::max(least_part_margin, line_reach_)}) {
    begin_mesh();
}

/// Starts making the mesh of the next part. Two are in use at a time: that one, and the one that is drawn.
void PartPainter::begin_mesh() {
    made_ = 1 - made_;
    mesh_ = beside(threads_, [this]() -> std::optional<PicturePart> {
        while (!parts_.empty()) {
            const PicturePart part = parts_.take();
            const auto crowd = parts_.can_be_split(part) ? PartMesher::Crowd::refused : PartMesher::Crowd::coarser;
            if (mesher_.build(parts_.drawn(part), crowd, meshes_[made_])) return part;
            parts_.put_back_split(part);
        }
        return {};
    });
}

/// Uploads a mesh and begins another. @return the part it is of; nothing behind the last one
std::optional<PicturePart> PartPainter::next_mesh(GlobeLooks& looks) {
    const std::optional<PicturePart> part = mesh_.get();
    if (!part) return part;
    const PartMesh& mesh = meshes_[made_];
    const planet::Segments& segments = mesh.segments;
    steps_.time("upload", [&] {
        looks.terrain().upload(segments, mesh.patches.layers());
        looks.overlay().upload(segments, mesher_.tiles());
        patch_texture_ = mesh.patches.upload();
    });
    painted_.triangles += segments.leaf_count();
    painted_.vertices += segments.vertex_count();
    painted_.strip_indices += segments.index_count();
    painted_.sent_bytes += looks.terrain().sent_bytes();
    painted_.deviation_max_m = std::max(painted_.deviation_max_m, mesh.deviation_max_m);
    painted_.pixel_deviation_max = std::max(painted_.pixel_deviation_max, mesh.pixel_deviation_max);
    last_ = made_;
    begin_mesh();
    return part;
}

void PartPainter::paint(GlobeLooks& looks, int most_samples, const Output& output) {
    std::vector<std::uint8_t> pixels;
    PicturePart band;  // of these pixels
    double done = 0;
    const double all = static_cast<double>(options_.drawn().width) * options_.drawn().height;
    const auto write_band = [&] {
        if (band.height > 0) output.write(std::exchange(pixels, {}), band.height);
    };
    while (const auto part = next_mesh(looks)) {
        if (const PicturePart next = parts_.band(*part); next.y != band.y || band.height == 0) {
            write_band();
            band = next;
            pixels.resize(static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.height) * 3);
        }
        const PicturePart drawn = parts_.drawn(*part), kept = parts_.kept(*part);
        const int samples = looks.samples(options_, camera_, most_samples);
        const auto rgba = steps_.time("draw", [&] { return draw(looks, samples, drawn, kept); });
        copy_rgb(rgba, drawn, kept, band, pixels);
        done += static_cast<double>(kept.width) * kept.height;
        output.progress(done / all);
    }
    write_band();
}

/// @param part that is drawn @param kept of it @return RGBA of the part
std::vector<std::uint8_t> PartPainter::draw(GlobeLooks& looks, int samples, const PicturePart& part,
                                            const PicturePart& kept) {
    if (!target_ || target_.width() != part.width || target_.height() != part.height) {
        target_ = Framebuffer();  // before another takes memory
        target_ = Framebuffer(part.width, part.height, looks.target_options(samples));
    }
    target_.bind();
    // What is not wanted need not be drawn, but for where the depth of what layers lie on is looked up. OpenGL
    // counts rows from below.
    const PicturePart needed = grown(kept, line_reach_);
    gl().Enable(GL_SCISSOR_TEST);
    gl().Scissor(needed.x - part.x, part.y + part.height - needed.y - needed.height, needed.width, needed.height);
    target_.clear(0, 0, 0, 1);
    DrapeGround ground = surface_.for_layers(last_mesh().segments, camera_, part, options_.drawn_scale());
    looks.draw({.camera = camera_,
                .part = part,
                .exaggeration = options_.exaggeration,
                .patches = patch_texture_,
                .ground = ground,
                .relief = options_.shows(Overlay::relief),
                .pixel_scale = options_.drawn_scale()},
               target_);
    std::vector<std::uint8_t> rgba = target_.read_rgba8();
    gl().Disable(GL_SCISSOR_TEST);
    return rgba;
}

}  // namespace render
