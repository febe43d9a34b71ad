#include "render/app/refine/refine_output.h"
#include "render/app/mesh/mesh_output.h"

#include <algorithm>

#include "planet/bisection/progressive_file.h"
#include "planet/elevation/image_io.h"
#include "planet/error.h"
#include "planet/exporters/reference_text.h"
#include "planet/frames.h"
#include "render/app/temporary_names.h"
#include "render/gl/context.h"
#include "render/picture/mesh_picture.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFormat;
using planet::MeshFrame;
using Triangles = std::span<const std::array<std::uint32_t, 3>>;

constexpr double whole_planet_m = 3e6;  ///< the middle of one lies this near to the Earth's
const glm::dvec3 towards_viewer = glm::normalize(glm::dvec3(0.5, -0.75, 0.6));  ///< in the south-east, 33 degrees above
constexpr int least_fitting_height = 400, most_fitting_height = 3200;           ///< pixels

/// All triangles turn alike in plan: no overhangs, at least nearby.
bool is_terrain(std::span<const glm::dvec3> vertices, Triangles triangles) {
    bool left = false, right = false;
    for (const auto& t : triangles) {
        const glm::dvec3 u = vertices[t[1]] - vertices[t[0]], v = vertices[t[2]] - vertices[t[0]];
        const double area = u.x * v.y - u.y * v.x;
        left = left || area >= 0;
        right = right || area <= 0;
    }
    return left != right;
}

/// A free surface as a planet is drawn, with both of its sides: what is behind is hidden.
struct SeenFromAngle {
    std::vector<glm::dvec3> vertices;  ///< from a point so far behind the surface that it is lit as if slightly round
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::uint8_t> level;

    SeenFromAngle(std::span<const glm::dvec3> places, Triangles front, std::span<const std::uint8_t> levels)
        : vertices(places.begin(), places.end()),
          triangles(front.begin(), front.end()),
          level(levels.begin(), levels.end()) {
        glm::dvec3 low = places[0], high = low;
        for (const glm::dvec3& v : places) {
            low = glm::min(low, v);
            high = glm::max(high, v);
        }
        const glm::dvec3 origin = (low + high) * 0.5 - glm::length(high - low) * towards_viewer;
        for (glm::dvec3& v : vertices) v -= origin;
        for (const auto& [i, j, k] : front) triangles.push_back({i, k, j});
        level.insert(level.end(), levels.begin(), levels.end());
    }

    /// Of a picture as wide as others that shows it all.
    int fitting_height(MeshPicture picture) const {
        const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 0, 1), towards_viewer));
        const glm::dvec3 up = glm::cross(towards_viewer, right);
        std::vector<glm::dvec3> plan;
        for (const glm::dvec3& v : vertices) plan.emplace_back(glm::dot(right, v), glm::dot(up, v), 0);
        picture.vertices = plan;
        return render::fitting_height(picture, least_fitting_height, most_fitting_height);
    }
};

glm::dvec3 middle_of(std::span<const glm::dvec3> vertices) {
    glm::dvec3 sum(0);
    for (const glm::dvec3& v : vertices) sum += v;
    return sum / static_cast<double>(vertices.size());
}

}  // namespace

void report_rule(planet::BisectionRule rule, planet::SideGeometry sides, Report& report) {
    report.set("rule", rule == planet::BisectionRule::modified ? "modified" : "plain");
    report.set("sides", sides == planet::SideGeometry::plan ? "plan" : "space");
}

planet::MeshReference written_reference(const RefineMeaning& meaning, MeshFormat format) {
    planet::MeshReference reference = meaning.reference;
    if (format == MeshFormat::stl && reference.frame == MeshFrame::source && reference.crs.empty() &&
        !reference.geographic)
        reference.frame = MeshFrame::enu;
    return reference;
}

RefineOutput::RefineOutput(const RefineCommand& command, Report& report) : command_(command), report_(report) {
    if (command.picture) const OutputFile writable("--picture", *command.picture);
    if (command.progressive) {
        if (command.progressive->extension() != ".oprog")
            throw Error(Fault::bad_usage, "--progressive", shown(command.progressive->native()) + " has another ending",
                        ".oprog");
        progressive_ = std::make_unique<OutputFile>("--progressive", *command.progressive);
    }
    if (!command.output || command.morph) return;
    format_ = planet::mesh_format(command.output->native());
    file_ = std::make_unique<OutputFile>("--output", *command.output);
}

planet::MeshRounding RefineOutput::round(planet::SurfaceMesh& surface, const RefineMeaning& meaning) const {
    const planet::MeshRounding rounding =
        planet::round_to_format(surface, written_reference(meaning, format_), format_);
    if (format_ == MeshFormat::ply || format_ == MeshFormat::obj) return rounding;
    for (const auto& t : surface.triangles) {
        const glm::dvec3 &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
        if (a == b || b == c || c == a)
            throw Error(Fault::bad_usage, "--output",
                        "triangles are too small for a " + command_.output->extension().string() + ", which rounds",
                        "a .ply or .obj, or larger triangles");
    }
    return rounding;
}

void RefineOutput::write(const planet::SurfaceMesh& surface, const planet::MeshLooks& looks,
                         const RefineMeaning& meaning, const planet::MeshRounding& rounding) {
    if (!file_) return;
    const auto step = report_.step("write");
    std::size_t bytes = 0;
    planet::write_mesh(
        [&](std::string_view block) {
            bytes += block.size();
            file_->append(block);
        },
        surface, written_reference(meaning, format_), format_, rounding, looks);
    const std::string written = file_->temporary().string();
    if (!written.empty() && !planet::file_holds(written, format_, surface))
        throw Error(Fault::check_failed, written, "does not hold the mesh as it is");
    report_.set("rounding_xy", rounding.xy);
    report_.set("rounding_z_m", rounding.z);
    report_.set("output", command_.output->string());
    report_.set("output_bytes", bytes);
}

void RefineOutput::write_progressive(planet::Progressive&& mesh, double step, const RefineMeaning& meaning) {
    if (!progressive_) return;
    const auto timed = report_.step("progressive");
    std::string note = note_from(meaning);
    if (note.size() > planet::Progressive::max_note) note.clear();  // a CRS of that length is damaged
    mesh.set_note(std::move(note));
    const std::vector<std::uint8_t> bytes = planet::encode_progressive(mesh, {step});
    progressive_->append({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const planet::PlainMesh& base = mesh.base();
    const std::size_t of_base =
        sizeof(glm::dvec3) * base.vertices.size() + 12 * base.triangles.size() + 4 * base.attributes.size();
    report_.set("progressive", command_.progressive->string());
    report_.set("progressive_bytes", bytes.size());
    if (mesh.split_count() > 0)
        report_.set("progressive_bytes_per_split",
                    static_cast<double>(bytes.size() - of_base) / static_cast<double>(mesh.split_count()));
}

void RefineOutput::draw(std::span<const glm::dvec3> vertices, Triangles triangles, std::span<const std::uint8_t> level,
                        const RefineMeaning& meaning) {
    if (!command_.picture) return;
    const auto step = report_.step("picture");
    MeshPicture picture{.vertices = vertices, .triangles = triangles, .level = level};
    picture.curve = false;
    std::optional<SeenFromAngle> seen;
    if (meaning.reference.frame == MeshFrame::ecef) {
        picture.planet = true;
        picture.look_from = middle_of(vertices);
        if (!(glm::length(picture.look_from) > whole_planet_m))
            picture.look_from = planet::normal_from_geodetic(20 * planet::degrees, 15 * planet::degrees);
    } else if (is_terrain(vertices, triangles)) {
        picture.relief = true;
    } else {
        seen.emplace(vertices, triangles, level);
        picture.vertices = seen->vertices;
        picture.triangles = seen->triangles;
        picture.level = seen->level;
        picture.planet = true;
        picture.look_from = towards_viewer;
        picture.height = seen->fitting_height(picture);
    }
    if (command_.picture_size) {
        picture.width = command_.picture_size->width;
        picture.height = command_.picture_size->height;
    } else if (!picture.planet) {
        picture.height = fitting_height(picture, least_fitting_height, most_fitting_height);
    }
    const Context context = Context::create();
    planet::write_image(command_.picture->string(), draw_mesh_picture(picture), {.make_file = make_listed});
    report_.set("picture", command_.picture->string());
}

void RefineOutput::commit() {
    if (file_) file_->commit();
    if (progressive_) progressive_->commit();
}

}  // namespace render
