// octaglobe refine STREAM.oprog: a prefix of it, what a view needs of it, or all of it coming in as frames.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "planet/bisection/progressive_file.h"
#include "planet/bisection/shape.h"
#include "planet/error.h"
#include "planet/frames.h"
#include "render/app/figures.h"
#include "render/app/mesh/mesh_output.h"
#include "render/app/output_folder.h"
#include "render/app/progress.h"
#include "render/app/refine/refine_base.h"
#include "render/app/refine/refine_frame.h"
#include "render/app/refine/refine_output.h"
#include "render/app/refine/refine_view.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;
using planet::MeshFormat;
using planet::Progressive;
using planet::Selection;
using Index = Progressive::Index;

/// Each vertex is on its way for a quarter of the frames, the first ones first: no vertex is farther on its way than those
/// that it depends on.
double fraction_in_frame(double time, Index split, Index splits) {
    constexpr double way = 0.25;
    const double start = (1 - way) * static_cast<double>(split) / static_cast<double>(splits);
    const double t = std::clamp((time - start) / way, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

class StreamReader {
  public:
    StreamReader(const RefineCommand& command, Report& report)
        : command_(command),
          report_(report),
          output_(command, report),
          whole_(read()),
          meaning_(meaning_from(whole_.note(), whole_.base().attribute_width)),
          selection_(whole_) {
        if (command.rule && *command.rule != whole_.rule())
            throw Error(Fault::bad_usage, "--rule", "a progressive mesh keeps that by which it was made",
                        whole_.rule() == planet::BisectionRule::modified ? "modified" : "plain");
        change_frame();
    }

    void run() {
        select();
        if (command_.morph)
            write_frames();
        else
            write_mesh();
    }

  private:
    Progressive read() {
        const auto step = report_.step("read");
        return planet::read_progressive(command_.source, command_.at.value_or(1));
    }

    void select() {
        const auto step = report_.step("select");
        if (!command_.view) return selection_.set_prefix(whole_.split_count());
        const glm::dvec3 eye = eye_of(*command_.view, whole_, meaning_);
        selection_.select([&](Index vertex) { return seen_coarse(whole_, vertex, eye); });
    }

    MeshFormat format() const {
        return command_.morph ? command_.frame_format.value_or(MeshFormat::glb) : output_.format();
    }

    /// The same frame for all of its meshes.
    void change_frame() {
        const planet::MeshFrame wanted = frame_for(command_.frame, meaning_.reference, format());
        if (wanted != meaning_.reference.frame)
            change_.emplace(meaning_.reference, wanted, surface_of(whole_.base(), meaning_));
        planet::check_frame(written_reference(written_meaning(), format()), format());
    }
    RefineMeaning written_meaning() const {
        RefineMeaning meaning = meaning_;
        if (change_) {
            meaning.reference = change_->reference();
            meaning.metres_per_unit = {1, 1};
        }
        return meaning;
    }

    struct Written {
        planet::SurfaceMesh surface;
        planet::MeshLooks looks;
    };
    Written as_written(const planet::PlainMesh& plain) const {
        Written out{surface_of(plain, meaning_), looks_of(plain, meaning_)};
        if (change_) change_->apply(out.surface, out.looks);
        return out;
    }

    void write_mesh() {
        const planet::PlainMesh plain = selection_.mesh();
        Written written = as_written(plain);
        const planet::MeshRounding rounding = output_.round(written.surface, written_meaning());
        fill_report(plain);
        draw();
        output_.write(written.surface, written.looks, written_meaning(), rounding);
        output_.commit();
        tell(plain);
    }

    /// Levels are how deep a triangle lies below its base triangle: one of four counts two.
    void draw() {
        if (!command_.picture) return;
        std::vector<std::array<std::uint32_t, 3>> triangles;
        std::vector<std::uint8_t> levels;
        struct Visit {
            Progressive::Child triangle;
            int level;
        };
        std::vector<Visit> left;
        for (Index base = 0; base < whole_.base().triangles.size(); ++base) {
            left.push_back({{base, whole_.base_corners(base)}, 0});
            while (!left.empty()) {
                const Visit visit = left.back();
                left.pop_back();
                const Selection::Children below = selection_.children(visit.triangle.name);
                if (below.count == 0) {
                    triangles.push_back(visit.triangle.corners);
                    levels.push_back(static_cast<std::uint8_t>(std::min(visit.level, 255)));
                }
                for (std::size_t i = 0; i < static_cast<std::size_t>(below.count); ++i)
                    left.push_back({below.child[i], visit.level + below.count / 2});
            }
        }
        output_.draw(whole_.places(), triangles, levels, meaning_);
    }

    // Every frame has the triangles of the last one, so that nothing flips from C'C to A'B' on the way: vertices move, each
    // along its own line, and as little as one likes between frames.
    void write_frames() {
        OutputFolder folder("--output", *command_.output);
        std::size_t bytes = 0;
        planet::PlainMesh plain;
        for (int frame = 0; frame < *command_.morph; ++frame) {
            progress_.update("writing", static_cast<double>(frame) / *command_.morph);
            const double time = static_cast<double>(frame) / (*command_.morph - 1);
            plain = selection_.mesh([&](Index vertex) {
                return fraction_in_frame(time, vertex - whole_.base_vertex_count(), whole_.split_count());
            });
            bytes += write_frame(folder.path(), frame, plain);
        }
        fill_report(plain);
        draw();
        report_.set("frames", *command_.morph);
        report_.set("output", command_.output->string());
        report_.set("output_bytes", bytes);
        folder.commit();
        tell(plain);
    }

    /// @return bytes
    std::size_t write_frame(const std::filesystem::path& folder, int frame, const planet::PlainMesh& plain) const {
        constexpr std::string_view endings[] = {".glb", ".ply", ".obj", ".stl"};
        const planet::MeshReference reference = written_reference(written_meaning(), format());
        Written written = as_written(plain);
        const planet::MeshRounding rounding = planet::round_to_format(written.surface, reference, format());
        char name[32];
        std::snprintf(name, sizeof name, "frame_%05d", frame);
        std::ofstream out(folder / (name + std::string(endings[static_cast<std::size_t>(format())])), std::ios::binary);
        std::size_t bytes = 0;
        planet::write_mesh(
            [&](std::string_view block) {
                bytes += block.size();
                out.write(block.data(), static_cast<std::streamsize>(block.size()));
            },
            written.surface, reference, format(), rounding, written.looks);
        out.flush();
        if (!out) throw Error(Fault::bad_usage, "--output", "a frame cannot be written", "a disk with room");
        return bytes;
    }

    void fill_report(const planet::PlainMesh& plain) {
        report_.set("triangles", plain.triangles.size());
        report_.set("vertices", plain.vertices.size());
        report_.set("base_triangles", whole_.base().triangles.size());
        report_.set("base_vertices", whole_.base().vertices.size());
        report_.set("splits", plain.vertices.size() - whole_.base().vertices.size());
        report_.set("records_read", whole_.split_count());
        report_rule(whole_.rule(), whole_.sides(), report_);
        const bool plan = whole_.sides() == planet::SideGeometry::plan;
        angle_min_ = 4;
        for (const auto& t : plain.triangles) {
            std::array<glm::dvec3, 3> p{plain.vertices[t[0]], plain.vertices[t[1]], plain.vertices[t[2]]};
            if (plan)
                for (glm::dvec3& corner : p) corner.z = 0;
            angle_min_ = std::min(angle_min_, planet::smallest_angle(p[0], p[1], p[2]));
        }
        report_.set("angle_min_deg", angle_min_ / planet::degrees);
        report_reference(written_meaning().reference, report_);
    }

    void tell(const planet::PlainMesh& plain) {
        progress_.clear();
        std::cout << grouped(plain.triangles.size()) << " triangles of " << grouped(whole_.base().triangles.size())
                  << ", " << grouped(plain.vertices.size()) << " vertices; smallest angle "
                  << fixed(angle_min_ / planet::degrees, 2) << " degrees";
        if (command_.morph) std::cout << "; " << grouped(static_cast<std::size_t>(*command_.morph)) << " frames";
        std::cout << "\n";
    }

    const RefineCommand& command_;
    Report& report_;
    Progress progress_;
    RefineOutput output_;
    const Progressive whole_;
    const RefineMeaning meaning_;
    std::optional<FrameChange> change_;
    Selection selection_;
    double angle_min_ = 0;
};

}  // namespace

void refine_stream(const RefineCommand& command, Report& report) {
    StreamReader(command, report).run();
}

}  // namespace render
