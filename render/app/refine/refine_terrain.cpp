#include "render/app/refine/refine_terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/geodesy/geodetic.h"
#include "render/app/data_path.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFrame;

/// 24 bytes each, 36 with verticals.
constexpr std::int64_t most_samples = std::int64_t{1} << 27;

std::shared_ptr<const planet::Raster> read(const std::string& path) {
    planet::RasterOptions how;
    how.plain = true;
    how.max_samples = most_samples;
    auto raster = std::make_shared<const planet::Raster>(planet::read_raster(path, how));
    if (raster->width < 2 || raster->height < 2)
        throw Error(Fault::bad_data, raster->name,
                    std::to_string(raster->width) + "x" + std::to_string(raster->height) + " samples have no area",
                    "2x2 samples or more");
    return raster;
}

void check_crs(const std::string& of_mesh, const std::string& of_raster, const std::string& raster) {
    if (of_mesh.empty() || of_raster.empty() || of_mesh == of_raster) return;
    throw Error(Fault::bad_usage, "--elevation", raster + " is in " + of_raster.substr(0, 60),
                "a raster in the mesh's CRS, " + of_mesh.substr(0, 60));
}

/// NaN if there is none.
double mean_height(const planet::Raster& raster) {
    double sum = 0, valid = 0;
    for (int row = 0; row < raster.height; ++row)
        for (int column = 0; column < raster.width; ++column)
            if (const double h = raster.at(column, row); !std::isnan(h)) {
                sum += h;
                ++valid;
            }
    return sum / valid;
}

}  // namespace

RefineTerrain::RefineTerrain(const std::string& path, std::optional<planet::VerticalDatum> datum,
                             const RefineMeaning& meaning)
    : raster_(read(path)) {
    const planet::MeshReference& reference = meaning.reference;
    const MeshFrame kind = meaning.somewhere_local ? MeshFrame::enu : reference.frame;
    const bool curved = (kind == MeshFrame::enu || kind == MeshFrame::ecef) && !raster_->plain;
    const planet::VerticalDatum above = datum.value_or(planet::VerticalDatum::egm96);
    if (curved && above == planet::VerticalDatum::egm96)
        geoid_ = std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm"));
    const planet::RasterFrame frame(raster_, kind, above, geoid_);
    if (!curved) check_crs(reference.crs, frame.reference().crs, name());
    if (curved) {
        const planet::MeshReference& of_samples = reference.frame == MeshFrame::enu ? reference : frame.reference();
        origin_ = of_samples.origin;
        ecef_from_mesh_ = of_samples.ecef_from_enu;
        verticals_.resize(raster_->count());
    }
    if (meaning.round) field_ = std::make_unique<const planet::RasterField>(raster_, above);
    place_samples(frame, meaning);
    plant_tree();
}

// In the mesh's own local frame, wherever the raster's middle is.
void RefineTerrain::place_samples(const planet::RasterFrame& frame, const RefineMeaning& meaning) {
    const glm::dmat3 mesh_from_samples = glm::transpose(ecef_from_mesh_) * frame.reference().ecef_from_enu;
    const glm::dvec3 between = glm::transpose(ecef_from_mesh_) * (frame.reference().origin - origin_);
    const bool curved = !verticals_.empty();
    const double mean = mean_height(*raster_);  // of voids, for their x and y
    if (std::isnan(mean)) throw Error(Fault::bad_data, name(), "holds no heights", "one band of heights");
    const auto columns = static_cast<std::size_t>(raster_->width);
    std::vector<glm::dvec2> at(columns);
    std::vector<double> heights(columns);
    samples_.resize(raster_->count());
    for (int row = 0; row < raster_->height; ++row) {
        const std::span<glm::dvec3> places(&samples_[index(0, row)], columns);
        const std::span<glm::vec3> ups =
            curved ? std::span(&verticals_[index(0, row)], columns) : std::span<glm::vec3>();
        for (std::size_t c = 0; c < columns; ++c) {
            at[c] = {c, row};
            const double h = raster_->at(static_cast<int>(c), row);
            heights[c] = std::isnan(h) ? mean : h;
        }
        frame.place(at, heights, places, ups);
        for (std::size_t c = 0; c < columns; ++c) {
            glm::dvec3& p = places[c];
            if (curved) {
                p = between + mesh_from_samples * p;
                ups[c] = glm::vec3(mesh_from_samples * glm::dvec3(ups[c]));
            }
            p = meaning.in_metres(p);
            if (std::isnan(p.x + p.y))
                throw Error(Fault::bad_usage, "--elevation", "the mesh's frame does not reach all of " + name(),
                            "a smaller raster, or a mesh in the raster's CRS");
            if (std::isnan(raster_->at(static_cast<int>(c), row))) p.z = std::numeric_limits<double>::quiet_NaN();
        }
    }
}

void RefineTerrain::plant_tree() {
    tree_ = SampleTree(raster_->width, raster_->height, [this](int column, int row) {
        const std::size_t i = index(column, row);
        return verticals_.empty() ? glm::dvec3(glm::dvec2(samples_[i]), 0)
                                  : ecef_from_mesh_ * glm::dvec3(verticals_[i]);
    });
}

glm::dvec3 RefineTerrain::ecef_normal(const glm::dvec3& p) const {
    return planet::normal_from_ecef(planet::wgs84, origin_ + ecef_from_mesh_ * p);
}

// Newton's method on the cells between samples; at once where the grid is affine. Beyond the grid it goes on straight.
glm::dvec2 RefineTerrain::column_row(glm::dvec2 p) const {
    glm::dvec2 at(0.5 * (raster_->width - 1), 0.5 * (raster_->height - 1));
    for (int i = 0; i < 12; ++i) {
        const int c = static_cast<int>(std::clamp(std::floor(at.x), 0.0, raster_->width - 2.0));
        const int r = static_cast<int>(std::clamp(std::floor(at.y), 0.0, raster_->height - 2.0));
        const glm::dvec2 a(sample(c, r)), b(sample(c + 1, r)), d(sample(c, r + 1)), e(sample(c + 1, r + 1));
        // Within the cell bilinear; outside of it straight on, as it leaves there.
        const double x = std::clamp(at.x - c, 0.0, 1.0), y = std::clamp(at.y - r, 0.0, 1.0);
        const glm::dvec2 twist = e - b - d + a, u = b - a + y * twist, v = d - a + x * twist;
        const glm::dvec2 miss =
            p - (a + x * (b - a) + y * (d - a) + x * y * twist) - (at.x - c - x) * u - (at.y - r - y) * v;
        const double area = u.x * v.y - u.y * v.x;
        if (area == 0) break;
        const glm::dvec2 step((miss.x * v.y - miss.y * v.x) / area, (u.x * miss.y - u.y * miss.x) / area);
        at = glm::clamp(at + step, glm::dvec2(-1e6), glm::dvec2(1e8));
        if (std::abs(step.x) + std::abs(step.y) < 1e-9) break;
    }
    return at;
}

std::optional<glm::dvec3> RefineTerrain::ground(const glm::dvec3& p) const {
    if (field_) {
        const glm::dvec3 normal = ecef_normal(p);
        const double h = static_cast<double>(field_->height(normal));
        if (std::isnan(h)) return std::nullopt;
        const double N = geoid_ ? geoid_->undulation(normal).m : 0;
        return glm::transpose(ecef_from_mesh_) * (planet::ecef_from_normal(planet::wgs84, normal, {h + N}) - origin_);
    }
    constexpr double beyond = 1;  // samples: a border that is crossed is followed outwards
    glm::dvec2 at = column_row(glm::dvec2(p));
    const glm::dvec2 last(raster_->width - 1, raster_->height - 1);
    if (!(at.x >= -beyond && at.y >= -beyond && at.x <= last.x + beyond && at.y <= last.y + beyond))
        return std::nullopt;
    at = glm::clamp(at, glm::dvec2(0), last);
    const int c = std::min(static_cast<int>(at.x), raster_->width - 2);
    const int r = std::min(static_cast<int>(at.y), raster_->height - 2);
    const double x = at.x - c, y = at.y - r;
    double sum = 0, weights = 0;
    const auto add = [&](int column, int row, double weight) {
        const double z = sample(column, row).z;
        if (std::isnan(z)) return;  // beside a void, what is left of the cell counts
        sum += weight * z;
        weights += weight;
    };
    add(c, r, (1 - x) * (1 - y));
    add(c + 1, r, x * (1 - y));
    add(c, r + 1, (1 - x) * y);
    add(c + 1, r + 1, x * y);
    if (!(weights > 0)) return std::nullopt;
    return glm::dvec3(p.x, p.y, sum / weights);
}

SampleBox RefineTerrain::box_around(const planet::TrianglePlaces& t) const {
    if (verticals_.empty()) {
        const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
        return {{low.x, low.y, 0}, {high.x, high.y, 0}};
    }
    // The normals of a triangle's points are those of its corners put together, made as long as 1 again: by L^2 / 3 at most, if
    // corners are up to L apart. To that comes what flattening bends, and verticals are floats.
    constexpr double bent = 0.01, rounding = 2e-7;
    const std::array<glm::dvec3, 3> n{ecef_normal(t[0]), ecef_normal(t[1]), ecef_normal(t[2])};
    const double apart = std::max({glm::distance(n[0], n[1]), glm::distance(n[1], n[2]), glm::distance(n[2], n[0])});
    const double margin = apart * apart / 3 + bent * apart + rounding;
    return {glm::min(glm::min(n[0], n[1]), n[2]) - margin, glm::max(glm::max(n[0], n[1]), n[2]) + margin};
}

// visit(index of the sample, distance from the plane). Where the vertical meets the plane: Moeller and Trumbore, "Fast,
// Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2 (1997).
template <class Visit>
void RefineTerrain::for_each_sample(const planet::TrianglePlaces& t, Visit&& visit) const {
    constexpr double rounding = -1e-9;
    const glm::dvec3 u = t[1] - t[0], v = t[2] - t[0];
    const auto look_at = [&](std::size_t i) {
        const glm::dvec3 up = vertical(i), across = glm::cross(up, v), w = samples_[i] - t[0];
        const double area = glm::dot(u, across);
        if (area == 0) return;
        const double beta = glm::dot(w, across) / area;
        if (!(beta >= rounding)) return;  // or void
        const glm::dvec3 q = glm::cross(w, u);
        const double gamma = glm::dot(up, q) / area;
        if (gamma >= rounding && 1 - beta - gamma >= rounding) visit(i, std::abs(glm::dot(v, q) / area));
    };
    tree_.visit(box_around(t), [&](const SampleTree::Block& b) {
        for (int row = b.low; row <= b.high; ++row)
            for (int column = b.left; column <= b.right; ++column) look_at(index(column, row));
    });
}

double RefineTerrain::deviation(const planet::TrianglePlaces& triangle) const {
    double largest = 0;
    for_each_sample(triangle, [&](std::size_t, double d) { largest = std::max(largest, d); });
    return largest;
}

RefineTerrain::Measured RefineTerrain::measure(const planet::PlainMesh& mesh,
                                               const std::function<bool(std::size_t triangle)>& region) const {
    Measured out;
    std::vector<bool> met(samples_.size());
    double squares = 0;
    for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
        const auto& t = mesh.triangles[triangle];
        const planet::TrianglePlaces places{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
        double largest = 0;
        for_each_sample(places, [&](std::size_t i, double d) {
            largest = std::max(largest, d);
            if (met[i]) return;
            met[i] = true;
            squares += d * d;
            ++out.samples;
        });
        out.max = std::max(out.max, largest);
        if (largest > out.max_in_region && (!region || region(triangle))) out.max_in_region = largest;
    }
    const auto valid =
        std::count_if(samples_.begin(), samples_.end(), [](const glm::dvec3& s) { return !std::isnan(s.z); });
    out.uncovered = static_cast<std::size_t>(valid) - out.samples;
    out.rms = out.samples > 0 ? std::sqrt(squares / static_cast<double>(out.samples)) : 0;
    return out;
}

}  // namespace render
