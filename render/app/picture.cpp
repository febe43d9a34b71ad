#include "render/app/picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "planet/elevation/image_io.h"
#include "planet/geodesy/earth_rotation.h"
#include "planet/geodesy/geodetic.h"
#include "planet/geodesy/sun.h"
#include "planet/mesh/segments.h"
#include "planet/octahedron/cell_metrics.h"
#include "planet/store/store_field.h"
#include "planet/store/store_tiles.h"
#include "render/app/data_path.h"
#include "render/app/earth_store.h"
#include "render/app/imagery.h"
#include "render/gl/framebuffer.h"
#include "render/passes/overlay.h"
#include "render/passes/sky.h"
#include "render/passes/terrain.h"
#include "render/picture/relief_patches.h"

namespace render {

namespace {

using planet::wgs84;

constexpr int part_side = 2048;

/// The most lattice steps of a patch are this many pixels: one normal a pixel or more, as far as there is data.
constexpr double patch_pixels = 96;
/// A patch of this many bisection levels above the finest has two texels between the vertices of the surface.
constexpr int finest_patch_above = 10;
constexpr std::size_t patch_limit = 1800;

/// Adds up the time of steps, in the order in which they first came.
class Steps {
  public:
    template <class Work>
    auto time(std::string_view name, Work&& work) {
        struct Stop {
            Steps& steps;
            std::string_view name;
            std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
            ~Stop() {
                steps.add(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
            }
        } const stop{*this, name};
        return work();
    }
    std::vector<std::pair<std::string, double>> list;

  private:
    void add(std::string_view name, double seconds) {
        const auto found = std::find_if(list.begin(), list.end(), [&](const auto& step) { return step.first == name; });
        if (found == list.end())
            list.emplace_back(name, seconds);
        else
            found->second += seconds;
    }
};

/// The surface that is drawn.
struct Surface {
    std::shared_ptr<const planet::ElevationStore> store;
    planet::StoreField field;
    planet::StoreTiles tiles;

    Surface(std::shared_ptr<const planet::ElevationStore> s, double exaggeration)
        : store(s), field(s), tiles(field.cache(), {store->metadata().ellipsoid, exaggeration}) {}

    PatchSurface for_patches() const {
        return {.heights = [this](auto normals, auto heights) { field.heights(normals, heights); },
                .spacing =
                    [this](const glm::dvec3& normal) {
                        planet::SurfaceCursor cursor = field.cursor();
                        cursor.seek(normal);
                        return planet::cell_metrics(cursor.cell().bisection_level()).vertex_spacing *
                               wgs84.mean_radius();
                    }};
    }

    /// A ball below all terrain, m.
    double occluder_radius(double exaggeration) const {
        double lowest = 0;
        for (int face = 0; face < planet::face_count; ++face)
            if (const auto tile = field.cache().tile(planet::LocationCode::face_root(face)))
                lowest = std::min(lowest, static_cast<double>(tile->min_height) * exaggeration);
        return store->metadata().ellipsoid.b + lowest - 120;  // the geoid goes down to -107 m
    }
};

/// Distance from the ground from which the planet and its air fill most of the picture's shorter side, m.
double whole_globe_range(double fov) {
    return (wgs84.a + 60e3) / std::sin(0.5 * 0.94 * fov) - wgs84.a;
}

Camera camera_for(const RenderOptions& o, const planet::StoreField& field) {
    const glm::dvec3 n = planet::normal_from_geodetic(o.at.latitude, o.at.longitude);
    const planet::Geoid geoid(data_file("egm96-15.pgm"));
    const auto ground_at = [&](const glm::dvec3& normal) {
        return static_cast<double>(field.height(normal)) * o.exaggeration + geoid.undulation(normal).m;
    };
    const double ground = ground_at(n);
    glm::dvec3 eye;
    if (o.height) {
        eye = planet::ecef_from_normal(wgs84, n, {ground + *o.height});
    } else {
        const double range = o.range.value_or(whole_globe_range(o.fov));
        eye = planet::ecef_from_normal(wgs84, n, {ground}) - range * look_direction(n, o.heading, o.pitch);
        // A shallow view can start inside a mountain: the eye then stands on it.
        const planet::NormalPosition p = planet::position_from_ecef(wgs84, eye);
        const double floor = ground_at(p.normal) + std::min(2.0, range);
        if (p.h.m < floor) eye = planet::ecef_from_normal(wgs84, p.normal, {floor});
    }
    return make_camera(eye, n, o.heading, o.pitch, focal_length_px(o.fov, o.size.width, o.size.height), o.size.width,
                       o.size.height);
}

/// All that is the same for every part of the picture.
class Painter {
  public:
    Painter(const RenderOptions& options, PictureReport& report)
        : options_(options),
          report_(report),
          threads_(options.threads > 0 ? static_cast<unsigned>(options.threads)
                                       : std::max(1u, std::thread::hardware_concurrency())),
          context_(steps_.time("context", [&] { return Context::create({.backend = options.backend}); })),
          earth_(options.earth),
          index_(user_checksum_index()),
          surface_(steps_.time("store", [&] { return open_store(); }), options.exaggeration),
          camera_(steps_.time("store", [&] { return camera_for(options, surface_.field); })),
          occluder_radius_(surface_.occluder_radius(options.exaggeration)) {
        open_looks();
    }

    void paint() {
        const int columns = (camera_.width + part_side - 1) / part_side,
                  rows = (camera_.height + part_side - 1) / part_side;
        planet::ImageWriter writer(options_.output.string(), camera_.width, camera_.height, 3,
                                   planet::SampleType::uint8);
        for (int row = 0; row < rows; ++row) {
            const int y = row * part_side, height = std::min(part_side, camera_.height - y);
            std::vector<std::uint8_t> band(static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(height) *
                                           3);
            for (int column = 0; column < columns; ++column) {
                const int x = column * part_side;
                paint_part({x, y, std::min(part_side, camera_.width - x), height}, band);
                options_.progress("drawing", static_cast<double>(row * columns + column + 1) / (rows * columns));
            }
            steps_.time("write", [&] { writer.write_rows(band.data(), height); });
        }
        steps_.time("write", [&] { writer.finish(); });
        index_.save();
        fill_report();
    }

  private:
    std::shared_ptr<const planet::ElevationStore> open_store() {
        if (options_.store)
            return std::make_shared<const planet::ElevationStore>(planet::ElevationStore::open(*options_.store, wgs84));
        return open_earth_store(options_.earth, earth_, index_, options_.progress);
    }

    void open_looks() {
        const Imagery imagery = steps_.time("imagery", [&] {
            return open_imagery(
                options_.imagery, options_.earth, index_, [&] { return earth_.get().heights; }, threads_,
                options_.progress);
        });
        steps_.time("textures", [&] {
            day_ = upload_cube(imagery.day, GL_SRGB8_ALPHA8);
            night_ = upload_cube(imagery.night, GL_SRGB8_ALPHA8);
            relief_ = upload_cube(imagery.relief, GL_RGBA8_SNORM);
        });
        const std::vector<Star> stars = steps_.time("stars", [] { return read_stars(data_file("stars.csv")); });
        steps_.time("shaders", [&] {
            terrain_.emplace();
            sky_.emplace(stars);
            overlay_.emplace(OverlayPass::Show{.mesh = options_.shows(Overlay::mesh),
                                               .levels = options_.shows(Overlay::levels),
                                               .curve = options_.shows(Overlay::curve)});
        });
        steps_.time("air", [&] {
            const AtmosphereTables tables = make_tables();
            ViewTable view = make_view_table(tables, camera_.eye, planet::sun_direction(options_.time), threads_);
            view.uniforms.sky_detail.w = static_cast<float>(imagery.texel_m(wgs84.mean_radius()));
            sky_->set_view(tables, view, glm::mat3(planet::ecef_from_j2000(options_.time)));
        });
        set_reversed_depth();
    }

    void build_mesh(const PicturePart& part) {
        planet::SegmentView view;
        view.test = {camera_.eye,
                     planet::split_reach(camera_.focal_px, camera_.tan_corner(), options_.max_pixel_deviation)};
        view.culling = camera_.culling(part, occluder_radius_);
        view.radius_m = wgs84.mean_radius();
        view.finest_patch_level = std::max(surface_.store->metadata().finest_level - finest_patch_above, 0);
        view.segment_angle = patch_pixels / camera_.focal_px;
        const auto detailed = [&] {
            return static_cast<std::size_t>(std::count_if(segments_.segments().begin(), segments_.segments().end(),
                                                          [](const planet::Segment& s) { return s.detailed; }));
        };
        do {
            steps_.time("mesh", [&] { segments_.build(surface_.tiles, view, static_cast<int>(threads_)); });
            view.segment_angle *= 1.5;
        } while (detailed() > patch_limit && view.segment_angle < 10);
        steps_.time("normals", [&] {
            patches_.build(segments_, surface_.for_patches(), wgs84.mean_radius(), static_cast<int>(threads_));
        });
        steps_.time("upload", [&] {
            terrain_->upload(segments_, patches_.layers());
            overlay_->upload(segments_);
            patch_texture_ = patches_.upload();
        });
        report_.triangles += segments_.leaf_levels().size();
        report_.vertices += segments_.vertices().size();
        report_.strip_indices += segments_.indices().size();
        report_.deviation_max_m = std::max(report_.deviation_max_m, segments_.deviation_max_m());
        report_.pixel_deviation_max =
            std::max(report_.pixel_deviation_max, segments_.ratio_max() * options_.max_pixel_deviation);
        report_.damaged = report_.damaged || segments_.damaged();
    }

    void paint_part(const PicturePart& part, std::vector<std::uint8_t>& band) {
        build_mesh(part);
        std::vector<std::uint8_t> pixels;
        steps_.time("draw", [&] {
            if (!target_ || target_.width() != part.width || target_.height() != part.height)
                target_ = Framebuffer(part.width, part.height, {.color_format = GL_RGBA8, .samples = options_.samples});
            target_.bind();
            target_.clear(0, 0, 0, 1);
            sky_->bind(camera_, part);
            day_.bind(4);
            night_.bind(5);
            relief_.bind(6);
            patch_texture_.bind(7);
            const double stretch = (wgs84.a / wgs84.b) * (wgs84.a / wgs84.b);
            terrain_->draw(camera_, part, {options_.exaggeration, stretch, patch_range});
            overlay_->draw(camera_, part);
            sky_->draw(camera_, part);
            pixels = target_.read_rgba8();
        });
        for (int y = 0; y < part.height; ++y) {
            const std::uint8_t* from =
                pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(part.width) * 4;
            std::uint8_t* to = band.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                                              static_cast<std::size_t>(part.x)) *
                                                 3;
            for (int x = 0; x < part.width; ++x, from += 4, to += 3) std::copy_n(from, 3, to);
        }
    }

    void fill_report() {
        report_.tiles = surface_.tiles.count();
        report_.eye_height_m = planet::height_from_ecef(wgs84, camera_.eye).m;
        report_.crs = "EPSG:4978";
        report_.vertical_datum = planet::name_of(surface_.store->metadata().datum);
        report_.sources = surface_.store->metadata().sources;
        report_.backend = backend_name(context_.backend());
        report_.gl_version = context_.gl_version();
        report_.gl_renderer = context_.gl_renderer();
        report_.seconds = steps_.list;
    }

    const RenderOptions& options_;
    PictureReport& report_;
    Steps steps_;
    unsigned threads_;
    Context context_;
    LazyEarth earth_;
    ChecksumIndex index_;
    Surface surface_;
    Camera camera_;
    double occluder_radius_;
    Texture day_, night_, relief_, patch_texture_;
    std::optional<TerrainPass> terrain_;
    std::optional<SkyPass> sky_;
    std::optional<OverlayPass> overlay_;
    planet::Segments segments_;
    ReliefPatches patches_;
    Framebuffer target_;
};

}  // namespace

PictureReport draw_picture(const RenderOptions& options) {
    PictureReport report;
    Painter(options, report).paint();
    return report;
}

}  // namespace render
