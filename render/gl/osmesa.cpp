#include "render/gl/osmesa.h"

#include <array>
#include <optional>

#include "render/gl/library.h"

namespace render {
namespace {

// GL/osmesa.h belongs to a development package that is gone where Mesa is new; these few values never changed.
using OSMesaContext = struct osmesa_context*;
constexpr int osmesa_format = 0x22, osmesa_depth_bits = 0x30, osmesa_stencil_bits = 0x31, osmesa_accum_bits = 0x32;
constexpr int osmesa_profile = 0x33, osmesa_core_profile = 0x34;
constexpr int osmesa_major_version = 0x36, osmesa_minor_version = 0x37;
constexpr int gl_rgba = 0x1908, gl_unsigned_byte = 0x1401;

struct OSMesa {
    OSMesaContext (*create_context_attribs)(const int* attributes, OSMesaContext share) = nullptr;
    void (*destroy_context)(OSMesaContext) = nullptr;
    GLboolean (*make_current)(OSMesaContext, void* buffer, GLenum type, GLsizei width, GLsizei height) = nullptr;
    Resolver get_proc_address = nullptr;
};

std::optional<OSMesa> load_osmesa(std::string& reason) {
    const Library library =
        open_library("OCTAGLOBE_OSMESA_LIBRARY", {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"});
    if (!library) {
        reason = library.reason;
        return std::nullopt;
    }
    OSMesa osmesa;
    const bool complete = library.load(osmesa.create_context_attribs, "OSMesaCreateContextAttribs") &&
                          library.load(osmesa.destroy_context, "OSMesaDestroyContext") &&
                          library.load(osmesa.make_current, "OSMesaMakeCurrent") &&
                          library.load(osmesa.get_proc_address, "OSMesaGetProcAddress");
    if (complete) return osmesa;
    reason = library.name + " is not OSMesa 11.2 or later: it lacks OSMesaCreateContextAttribs or a companion";
    return std::nullopt;
}

class OSMesaNative : public NativeContext {
  public:
    OSMesaNative(const OSMesa& osmesa, OSMesaContext context) : osmesa_(osmesa), context_(context) {}
    ~OSMesaNative() override { osmesa_.destroy_context(context_); }

    std::string make_current() override {
        if (osmesa_.make_current(context_, pixel_.data(), gl_unsigned_byte, 1, 1) != GL_FALSE) return {};
        return "OSMesaMakeCurrent failed";
    }
    void release() override { osmesa_.make_current(nullptr, nullptr, 0, 0, 0); }
    Resolver resolver() const override { return osmesa_.get_proc_address; }

  private:
    OSMesa osmesa_;
    OSMesaContext context_;
    std::array<unsigned char, 4> pixel_{};  // the default framebuffer, which must exist and is never drawn to
};

}  // namespace

Attempt open_osmesa() {
    Attempt attempt;
    const std::optional<OSMesa> osmesa = load_osmesa(attempt.reason);
    if (!osmesa) return attempt;
    const int attributes[] = {osmesa_format,
                              gl_rgba,
                              osmesa_depth_bits,
                              0,
                              osmesa_stencil_bits,
                              0,
                              osmesa_accum_bits,
                              0,
                              osmesa_profile,
                              osmesa_core_profile,
                              osmesa_major_version,
                              gl_major,
                              osmesa_minor_version,
                              gl_minor,
                              0,
                              0};
    if (const OSMesaContext context = osmesa->create_context_attribs(attributes, nullptr); context != nullptr)
        attempt.context = std::make_unique<OSMesaNative>(*osmesa, context);
    else
        attempt.reason = "OSMesaCreateContextAttribs gives no core 4.5 context";
    return attempt;
}

}  // namespace render
