#include "render/app/refine_terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/elevation/raster_io.h"
#include "planet/error.h"
#include "planet/patches/raster_frame.h"
#include "render/app/data_path.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFrame;

/// 24 bytes each.
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

planet::RasterFrame frame_of(const std::shared_ptr<const planet::Raster>& raster, MeshFrame frame,
                             planet::VerticalDatum datum) {
    std::shared_ptr<const planet::Geoid> geoid;
    if (frame == MeshFrame::enu && !raster->plain && datum == planet::VerticalDatum::egm96)
        geoid = std::make_shared<const planet::Geoid>(data_file("egm96-15.pgm"));
    return {raster, frame, datum, geoid};
}

void check_crs(const std::string& of_mesh, const std::string& of_raster, const std::string& raster) {
    if (of_mesh.empty() || of_raster.empty() || of_mesh == of_raster) return;
    throw Error(Fault::bad_usage, "--elevation", raster + " is in " + of_raster.substr(0, 60),
                "a raster in the mesh's CRS, " + of_mesh.substr(0, 60));
}

}  // namespace

RefineTerrain::RefineTerrain(const std::string& path, std::optional<planet::VerticalDatum> datum,
                             const RefineMeaning& meaning) {
    const planet::MeshReference& reference = meaning.reference;
    if (reference.frame == MeshFrame::ecef)
        throw Error(Fault::bad_usage, "--elevation", "goes with no Earth-centred mesh",
                    "a mesh of frame source, utm or enu");
    const auto raster = read(path);
    name_ = raster->name;
    width_ = raster->width;
    height_ = raster->height;
    const bool enu = reference.frame == MeshFrame::enu || meaning.somewhere_local;
    const planet::RasterFrame frame =
        frame_of(raster, enu ? MeshFrame::enu : reference.frame, datum.value_or(planet::VerticalDatum::egm96));
    if (!enu) check_crs(reference.crs, frame.reference().crs, name_);

    // The same local frame wherever the raster's middle is. A raster that is nowhere has its own coordinates.
    const bool moved = reference.frame == MeshFrame::enu && !raster->plain;
    const glm::dmat3 mesh_from_ecef = glm::transpose(reference.ecef_from_enu);
    const glm::dmat3 ecef_from_raster = frame.reference().ecef_from_enu;
    const glm::dvec3 between = frame.reference().origin - reference.origin;
    double sum = 0;
    std::size_t valid = 0;
    for (int row = 0; row < height_; ++row)
        for (int column = 0; column < width_; ++column)
            if (const double h = raster->at(column, row); !std::isnan(h)) {
                sum += h;
                ++valid;
            }
    if (valid == 0) throw Error(Fault::bad_data, name_, "holds no heights", "one band of heights");
    samples_.resize(raster->count());
    const auto columns = static_cast<std::size_t>(width_);
    std::vector<glm::dvec2> at(columns);
    std::vector<double> heights(columns);
    for (int row = 0; row < height_; ++row) {
        const std::span<glm::dvec3> places(samples_.data() + static_cast<std::size_t>(row) * columns, columns);
        for (int column = 0; column < width_; ++column) {
            const double h = raster->at(column, row);
            at[static_cast<std::size_t>(column)] = {column, row};
            heights[static_cast<std::size_t>(column)] = std::isnan(h) ? sum / static_cast<double>(valid) : h;
        }
        frame.place(at, heights, places, {});
        for (int column = 0; column < width_; ++column) {
            glm::dvec3& p = places[static_cast<std::size_t>(column)];
            if (moved) p = mesh_from_ecef * (between + ecef_from_raster * p);
            p = meaning.in_metres(p);
            if (std::isnan(p.x + p.y))
                throw Error(Fault::bad_usage, "--elevation", "the mesh's frame does not reach all of " + name_,
                            "a smaller raster, or a mesh in the raster's CRS");
            if (std::isnan(raster->at(column, row))) p.z = std::numeric_limits<double>::quiet_NaN();
        }
    }
}

// Newton's method on the cells between samples; at once where the grid is affine. Beyond the grid it goes on straight.
glm::dvec2 RefineTerrain::column_row(glm::dvec2 p) const {
    glm::dvec2 at(0.5 * (width_ - 1), 0.5 * (height_ - 1));
    for (int i = 0; i < 12; ++i) {
        const int c = static_cast<int>(std::clamp(std::floor(at.x), 0.0, width_ - 2.0));
        const int r = static_cast<int>(std::clamp(std::floor(at.y), 0.0, height_ - 2.0));
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

glm::dvec3 RefineTerrain::on_ground(const glm::dvec3& p) const {
    constexpr double beyond = 1;  // samples: a border that is crossed is followed outwards
    glm::dvec2 at = column_row(glm::dvec2(p));
    const glm::dvec2 last(width_ - 1, height_ - 1);
    if (!(at.x >= -beyond && at.y >= -beyond && at.x <= last.x + beyond && at.y <= last.y + beyond)) return p;
    at = glm::clamp(at, glm::dvec2(0), last);
    const int c = std::min(static_cast<int>(at.x), width_ - 2), r = std::min(static_cast<int>(at.y), height_ - 2);
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
    return weights > 0 ? glm::dvec3(p.x, p.y, sum / weights) : p;
}

RefineTerrain::Box RefineTerrain::box_around(const planet::TrianglePlaces& t) const {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (std::size_t k = 0; k < 3; ++k)
        for (const glm::dvec3& p : {t[k], (t[k] + t[(k + 1) % 3]) * 0.5}) {  // sides curve in the grid
            const glm::dvec2 at = column_row(glm::dvec2(p));
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
    const glm::dvec2 margin = 1.5 + (high - low) / 16.0;
    low = glm::clamp(low - margin, glm::dvec2(0), glm::dvec2(width_, height_));
    high = glm::clamp(high + margin, glm::dvec2(-1), glm::dvec2(width_ - 1, height_ - 1));
    return {static_cast<int>(std::ceil(low.x)), static_cast<int>(std::floor(high.x)),
            static_cast<int>(std::ceil(low.y)), static_cast<int>(std::floor(high.y))};
}

// visit(index of the sample, distance from the plane)
template <class Visit>
void RefineTerrain::for_each_sample(const planet::TrianglePlaces& t, Visit&& visit) const {
    const glm::dvec2 a(t[0]), u = glm::dvec2(t[1]) - a, v = glm::dvec2(t[2]) - a;
    const double area = u.x * v.y - u.y * v.x;
    if (area == 0) return;
    constexpr double rounding = -1e-9;
    const Box box = box_around(t);
    for (int row = box.low; row <= box.high; ++row)
        for (int column = box.left; column <= box.right; ++column) {
            const glm::dvec3& s = sample(column, row);
            const glm::dvec2 w = glm::dvec2(s) - a;
            const double beta = (w.x * v.y - w.y * v.x) / area, gamma = (u.x * w.y - u.y * w.x) / area;
            if (beta < rounding || gamma < rounding || 1 - beta - gamma < rounding || std::isnan(s.z)) continue;
            visit(static_cast<std::size_t>(&s - samples_.data()),
                  std::abs(t[0].z + beta * (t[1].z - t[0].z) + gamma * (t[2].z - t[0].z) - s.z));
        }
}

double RefineTerrain::deviation(const planet::TrianglePlaces& triangle) const {
    double largest = 0;
    for_each_sample(triangle, [&](std::size_t, double d) { largest = std::max(largest, d); });
    return largest;
}

RefineTerrain::Measured RefineTerrain::measure(const planet::PlainMesh& mesh,
                                               const std::function<bool(const planet::TrianglePlaces&)>& region) const {
    Measured out;
    std::vector<bool> met(samples_.size());
    double squares = 0;
    for (const auto& t : mesh.triangles) {
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
        if (largest > out.max_in_region && (!region || region(places))) out.max_in_region = largest;
    }
    const auto valid =
        std::count_if(samples_.begin(), samples_.end(), [](const glm::dvec3& s) { return !std::isnan(s.z); });
    out.uncovered = static_cast<std::size_t>(valid) - out.samples;
    out.rms = out.samples > 0 ? std::sqrt(squares / static_cast<double>(out.samples)) : 0;
    return out;
}

}  // namespace render
