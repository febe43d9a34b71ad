#pragma once
// The files of `octaglobe mesh`: the mesh and its picture, both whole or not at all.

#include <memory>
#include <optional>
#include <string>

#include "planet/exporters/mesh_file.h"
#include "render/app/figures.h"
#include "render/app/mesh/mesh_options.h"
#include "render/app/program.h"
#include "render/app/values.h"
#include "render/picture/mesh_picture.h"

namespace render {

/// Opened before any work is done, so that what cannot be written is refused at once.
class MeshOutput {
  public:
    /// Throws planet::Error(bad_usage) for an ending that is no format, or a place that cannot be written; for the picture
    /// too.
    explicit MeshOutput(const MeshOptions& options);

    /// .ply where none is written: nothing is rounded.
    planet::MeshFormat format() const { return format_; }
    /// What was asked for, or what suits the format. @param planet an ecef mesh by default
    planet::MeshFrame frame(bool planet) const;

    /// The mesh, if one was asked for: to a temporary file until commit().
    void write(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference,
               const planet::MeshRounding& rounding, Report& report, const planet::MeshLooks& looks = {});
    /// The picture, if one was asked for. Its size is set here: without --size as wide as ever, and as high as a plan of
    /// the whole mesh needs.
    void draw(MeshPicture picture, Report& report);
    /// Last: a picture that fails leaves no mesh behind.
    void commit();

  private:
    const MeshOptions& options_;
    planet::MeshFormat format_ = planet::MeshFormat::ply;
    std::unique_ptr<OutputFile> file_;
};

/// Adds --size of a picture of a mesh, which needs --picture. @param what is said of it
void add_mesh_picture_size(CLI::App& command, const std::string& what, std::optional<PictureSize>& size);

/// Throws planet::Error(bad_usage): a bound that a mesh of all samples does not keep in a file of a format.
/// @param asked, possible metres
[[noreturn]] void refuse_bound(double asked, double possible, planet::MeshFormat format);

/// frame, crs, vertical_datum.
void report_reference(const planet::MeshReference& reference, Report& report);

/// triangles, vertices, strip_indices, strips, and what report_reference() sets.
void report_mesh(const planet::SurfaceMesh& mesh, const planet::MeshReference& reference, Report& report);

}  // namespace render
