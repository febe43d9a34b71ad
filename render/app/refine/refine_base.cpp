#include "render/app/refine/refine_base.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planet/error.h"
#include "planet/exporters/conforming.h"
#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"
#include "planet/frames.h"
#include "render/app/refine/refine_frame.h"

namespace render {
namespace {

using planet::MeshFrame;

constexpr std::size_t normal_width = 3, uv_width = 2, color_width = 4;

std::size_t width_of(const RefineMeaning& m) {
    return m.normals * normal_width + m.uv * uv_width + m.colors * color_width;
}

RefineMeaning meaning_of(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference,
                         const planet::MeshLooks& looks) {
    RefineMeaning m;
    m.reference = reference;
    m.somewhere_local = reference.frame == MeshFrame::enu && reference.origin == glm::dvec3(0);
    if (m.somewhere_local) m.reference = {};
    m.metres_per_unit = metres_per_unit(m.reference, mesh.vertices);
    m.normals = !looks.normals.empty();
    m.uv = !looks.uv.empty();
    m.colors = !looks.colors.empty();
    return m;
}

template <class Vector>
void append(std::vector<float>& out, const Vector& v) {
    for (int i = 0; i < Vector::length(); ++i) out.push_back(v[i]);
}

/// Takes the next numbers.
template <class Vector>
Vector take(const float*& from) {
    Vector v;
    for (int i = 0; i < Vector::length(); ++i) v[i] = *from++;
    return v;
}

}  // namespace

glm::dvec2 metres_per_unit(const planet::MeshReference& reference, const std::vector<glm::dvec3>& vertices) {
    if (!reference.geographic) return {1, 1};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const glm::dvec3& v : vertices) {
        low = std::min(low, v.y);
        high = std::max(high, v.y);
    }
    const double latitude = std::clamp((low + high) / 2, -90.0, 90.0) * planet::degrees;
    return {111320 * std::max(0.01, std::cos(latitude)), 110574};
}

RefineBase read_refine_base(const std::string& path, bool weld, const std::optional<MeshFrame>& frame,
                            planet::MeshFormat format) {
    planet::MeshReference reference;
    planet::MeshLooks looks;
    planet::SurfaceMesh mesh = planet::read_mesh(path, &reference, &looks);
    RefineBase base;
    if (weld) base.welded = planet::weld(mesh, looks);
    if (const auto fault = planet::conforming_fault(mesh))
        throw planet::Error(planet::Fault::bad_data, path, *fault,
                            weld ? "a conforming triangle mesh" : "a conforming triangle mesh; --weld joins vertices");
    base.meaning = meaning_of(mesh, reference, looks);
    const MeshFrame wanted = frame_for(frame, base.meaning.reference, format);
    if (wanted != base.meaning.reference.frame) {
        const FrameChange change(base.meaning.reference, wanted, mesh);
        change.apply(mesh, looks);
        base.meaning = meaning_of(mesh, change.reference(), looks);
    }
    base.meaning.round = wanted == MeshFrame::ecef || (wanted == MeshFrame::enu && reference.frame == MeshFrame::ecef);
    base.picture = std::move(looks.picture);
    base.mesh.attribute_width = width_of(base.meaning);
    base.mesh.attributes.reserve(base.mesh.attribute_width * mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (base.meaning.normals) append(base.mesh.attributes, looks.normals[v]);
        if (base.meaning.uv) append(base.mesh.attributes, looks.uv[v]);
        if (base.meaning.colors) append(base.mesh.attributes, looks.colors[v]);
    }
    for (glm::dvec3& p : mesh.vertices) p = base.meaning.in_metres(p);
    base.mesh.vertices = std::move(mesh.vertices);
    base.mesh.triangles = std::move(mesh.triangles);
    return base;
}

planet::SurfaceMesh surface_of(const planet::PlainMesh& mesh, const RefineMeaning& meaning) {
    planet::SurfaceMesh surface;
    surface.triangles = mesh.triangles;
    surface.vertices.reserve(mesh.vertices.size());
    for (const glm::dvec3& p : mesh.vertices) surface.vertices.push_back(meaning.in_file(p));
    return surface;
}

planet::MeshLooks looks_of(const planet::PlainMesh& mesh, const RefineMeaning& meaning) {
    planet::MeshLooks looks;
    if (mesh.attribute_width == 0 || mesh.attribute_width != width_of(meaning)) return looks;
    const float* from = mesh.attributes.data();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (meaning.normals) {
            const auto n = take<glm::vec3>(from);
            const float length = glm::length(n);
            looks.normals.push_back(length > 0 ? n / length : n);
        }
        if (meaning.uv) looks.uv.push_back(take<glm::vec2>(from));
        if (meaning.colors) looks.colors.push_back(take<glm::vec4>(from));
    }
    return looks;
}

std::string note_from(const RefineMeaning& meaning) {
    std::string note;
    for (const std::string& line : planet::reference_lines(meaning.reference)) note += line + "\n";
    if (meaning.reference.geographic)
        note += "metres_per_unit " + planet::text_of(meaning.metres_per_unit.x) + " " +
                planet::text_of(meaning.metres_per_unit.y) + "\n";
    if (meaning.somewhere_local) note += "somewhere_local\n";
    note += "attributes";
    if (meaning.normals) note += " normals";
    if (meaning.uv) note += " uv";
    if (meaning.colors) note += " colors";
    return note + "\n";
}

RefineMeaning meaning_from(const std::string& note, std::size_t attribute_width) {
    RefineMeaning m;
    std::string_view left = note;
    while (!left.empty()) {
        std::string_view line = planet::take_line(left);
        planet::read_reference_line(line, m.reference);
        const std::string_view key = planet::take_word(line);
        if (key == "somewhere_local") m.somewhere_local = true;
        if (key == "metres_per_unit") {
            const auto x = planet::number_from<double>(planet::take_word(line));
            const auto y = planet::number_from<double>(planet::take_word(line));
            if (x && y && *x > 0 && *y > 0 && std::isfinite(*x) && std::isfinite(*y)) m.metres_per_unit = {*x, *y};
        }
        if (key != "attributes") continue;
        m.normals = line.find("normals") != line.npos;
        m.uv = line.find("uv") != line.npos;
        m.colors = line.find("colors") != line.npos;
    }
    if (width_of(m) != attribute_width) m.normals = m.uv = m.colors = false;
    return m;
}

}  // namespace render
