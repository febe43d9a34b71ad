#pragma once
// The files of `octaglobe refine`: mesh, progressive mesh, picture; each whole or not at all.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "planet/bisection/progressive.h"
#include "render/app/output_file.h"
#include "render/app/refine/refine_base.h"
#include "render/app/refine/refine_options.h"

namespace render {

/// rule, sides: of a mesh, and of a progressive one.
void report_rule(planet::BisectionRule rule, planet::SideGeometry sides, Report& report);

/// What a file says of its coordinates. An .stl holds any that are not degrees and nowhere known.
planet::MeshReference written_reference(const RefineMeaning& meaning, planet::MeshFormat format);

/// Opened before any work is done, so that what cannot be written is refused at once. With --morph no mesh file is.
class RefineOutput {
  public:
    /// Throws planet::Error(bad_usage) for an ending that is no format, or a place that cannot be written.
    RefineOutput(const RefineCommand& command, Report& report);

    /// .ply where none is written: nothing is rounded.
    planet::MeshFormat format() const { return format_; }

    /// Rounds in place as the format does. Throws planet::Error(bad_usage) if the format cannot hold the mesh.
    planet::MeshRounding round(planet::SurfaceMesh& surface, const RefineMeaning& meaning) const;
    /// The mesh as rounded, if a file was asked for; it is read again and compared.
    void write(const planet::SurfaceMesh& surface, const planet::MeshLooks& looks, const RefineMeaning& meaning,
               const planet::MeshRounding& rounding);
    /// @param step of which places are multiples from midpoints, metres; 0: of none
    void write_progressive(planet::Progressive&& mesh, double step, const RefineMeaning& meaning);
    /// Terrain and planets as `octaglobe mesh` draws them, free surfaces from an angle.
    /// @param vertices as in a RefineBase @param level by triangle
    void draw(std::span<const glm::dvec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
              std::span<const std::uint8_t> level, const RefineMeaning& meaning);
    /// Last: what fails before leaves nothing behind.
    void commit();

  private:
    const RefineCommand& command_;
    Report& report_;
    planet::MeshFormat format_ = planet::MeshFormat::ply;
    std::unique_ptr<OutputFile> file_, progressive_;
};

}  // namespace render
