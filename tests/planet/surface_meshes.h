#pragma once
// Meshes for the tests of mesh files, and the files' bytes.

#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include "planet/exporters/mesh_file.h"
#include "planet/geodesy/local_frame.h"
#include "raster_files.h"

namespace planet::testing {

/// Waves over a square of `side`, (n + 1)^2 vertices from `low` on, none of them round.
inline SurfaceMesh wavy_mesh(std::uint32_t n, double side, const glm::dvec3& low = {}) {
    SurfaceMesh mesh;
    for (std::uint32_t y = 0; y <= n; ++y)
        for (std::uint32_t x = 0; x <= n; ++x)
            mesh.vertices.push_back(low + glm::dvec3(side * x / n, side * y / n, 500.1 + 300 * std::sin(x + 2.0 * y)));
    for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) {
            const std::uint32_t a = y * (n + 1) + x, c = a + n + 1;
            mesh.triangles.push_back({a, a + 1, c});
            mesh.triangles.push_back({a + 1, c + 1, c});
        }
    return mesh;
}

inline MeshReference enu_reference() {
    MeshReference r;
    r.frame = MeshFrame::enu;
    r.crs = "EPSG:4979";
    r.vertical_datum = "EGM96";
    const LocalFrame frame(wgs84, Geodetic{37.58 * degrees, -105.49 * degrees, {}});
    r.origin = frame.origin();
    r.ecef_from_enu = frame.ecef_from_enu_rotation();
    return r;
}

inline MeshReference reference_of(MeshFrame frame) {
    MeshReference r;
    r.frame = frame;
    return r;
}

inline std::string bytes_of_mesh(const SurfaceMesh& mesh, const MeshReference& reference, MeshFormat format,
                                 const std::optional<MeshRounding>& rounding = std::nullopt) {
    std::string bytes;
    write_mesh([&](std::string_view block) { bytes += block; }, mesh, reference, format, rounding);
    return bytes;
}

/// Reads bytes as a file whose name ends so.
inline SurfaceMesh mesh_from_bytes(const std::string& bytes, const std::string& ending,
                                   MeshReference* reference = nullptr) {
    const TemporaryFolder folder;
    write_bytes(folder / ("mesh" + ending), bytes);
    return read_mesh(folder / ("mesh" + ending), reference);
}

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
    T value;
    if (offset + sizeof value > bytes.size()) throw std::out_of_range("beyond the end of the file");
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// The JSON and the binary chunk of a .glb.
struct Glb {
    std::string json, binary;

    explicit Glb(const std::string& file) {
        const auto json_size = number_at<std::uint32_t>(file, 12);
        json = file.substr(20, json_size);
        binary = file.substr(28 + json_size);
    }
    /// The numbers of the first list with this key; none if there is no such key.
    std::vector<double> list(const std::string& key) const {
        std::vector<double> numbers;
        const std::size_t found = json.find("\"" + key + "\":[");
        if (found == std::string::npos) return numbers;
        const char* at = json.c_str() + found + key.size() + 3;
        do {
            char* end;
            numbers.push_back(std::strtod(at + 1, &end));
            at = end;
        } while (*at == ',');
        return numbers;
    }
    /// Vertex i as the float offset plus the root node's translation, turned back from y-up.
    glm::dvec3 vertex(std::size_t i) const {
        const auto p = number_at<std::array<float, 3>>(binary, 12 * i);
        std::vector<double> t = list("translation");
        t.resize(3);
        return {t[0] + p[0], -(t[2] + p[2]), t[1] + p[1]};
    }
};

}  // namespace planet::testing
