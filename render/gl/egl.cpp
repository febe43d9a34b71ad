#include "render/gl/egl.h"

#include <utility>

#include "planet/error.h"
#include "render/gl/egl_library.h"

namespace render {
namespace {

class EglNative : public NativeContext {
  public:
    EglNative(EglDisplay display, EGLContext context, EGLSurface surface)
        : display_(std::move(display)), context_(context), surface_(surface) {}
    ~EglNative() override {
        const Egl& egl = display_.egl();
        egl.destroy_context(display_.get(), context_);
        if (surface_ != EGL_NO_SURFACE) egl.destroy_surface(display_.get(), surface_);
    }

    std::string make_current() override {
        const Egl& egl = display_.egl();
        egl.bind_api(EGL_OPENGL_API);
        if (egl.make_current(display_.get(), surface_, surface_, context_) != EGL_FALSE) return {};
        return egl.failure("eglMakeCurrent");
    }
    void release() override {
        const Egl& egl = display_.egl();
        egl.bind_api(EGL_OPENGL_API);  // what is released is the context of the bound API, and the default is OpenGL ES
        egl.make_current(display_.get(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    Resolver resolver() const override { return display_.egl().get_proc_address; }

  private:
    EglDisplay display_;
    EGLContext context_;
    EGLSurface surface_;
};

/// A config for a context that draws to framebuffer objects only. A surface type of 0 accepts every config, yet on some
/// drivers matches none; then one with pbuffers is asked for, and then the context is made without a config.
bool choose_config(const EglDisplay& display, bool pbuffer_needed, EGLConfig& config, std::string& reason) {
    const Egl& egl = display.egl();
    for (const EGLint surface_type : {0, EGL_PBUFFER_BIT}) {
        if (surface_type == 0 && pbuffer_needed) continue;
        const EGLint attributes[] = {EGL_SURFACE_TYPE, surface_type, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLint count = 0;
        if (egl.choose_config(display.get(), attributes, &config, 1, &count) != EGL_FALSE && count > 0) return true;
    }
    config = EGL_NO_CONFIG_KHR;
    if (!pbuffer_needed && display.has("EGL_KHR_no_config_context")) return true;
    reason = "no EGL config for OpenGL";
    return false;
}

Attempt open_on(std::shared_ptr<const Egl> egl, EGLenum platform, EGLDeviceEXT device, bool debug) {
    Attempt attempt;
    auto display = EglDisplay::open(std::move(egl), platform, device, attempt.reason);
    if (!display) return attempt;
    const Egl& functions = display->egl();
    if (functions.bind_api(EGL_OPENGL_API) == EGL_FALSE) {
        attempt.reason = functions.failure("eglBindAPI(EGL_OPENGL_API)");
        return attempt;
    }
    const bool pbuffer_needed = !display->has("EGL_KHR_surfaceless_context");
    EGLConfig config = nullptr;
    if (!choose_config(*display, pbuffer_needed, config, attempt.reason)) return attempt;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 gl_major,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 gl_minor,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 debug ? EGL_TRUE : EGL_FALSE,
                                 EGL_NONE};
    const EGLContext context = functions.create_context(display->get(), config, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) {
        attempt.reason = functions.failure("eglCreateContext for core 4.5");
        return attempt;
    }
    EGLSurface surface = EGL_NO_SURFACE;
    if (pbuffer_needed) {
        const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
        surface = functions.create_pbuffer_surface(display->get(), config, size);
        if (surface == EGL_NO_SURFACE) attempt.reason = functions.failure("eglCreatePbufferSurface");
    }
    auto native = std::make_unique<EglNative>(*std::move(display), context, surface);
    if (attempt.reason.empty()) attempt.context = std::move(native);
    return attempt;
}

std::string device_name(const Egl& egl, EGLDeviceEXT device) {
    if (egl.query_device_string == nullptr) return "device";
    const char* extensions = egl.query_device_string(device, EGL_EXTENSIONS);
    const auto string = [&](std::string_view extension, EGLint name) -> std::string {
        if (!has_extension(extensions, extension)) return {};
        const char* text = egl.query_device_string(device, name);
        return text == nullptr ? std::string() : std::string(text);
    };
    std::string name = string("EGL_EXT_device_query_name", EGL_RENDERER_EXT);
    if (name.empty() && has_extension(extensions, "EGL_NV_device_cuda")) name = "NVIDIA GPU";
    if (name.empty() && has_extension(extensions, "EGL_MESA_device_software")) name = "Mesa software device";
    const std::string node = string("EGL_EXT_device_drm", EGL_DRM_DEVICE_FILE_EXT);
    if (!node.empty()) name += (name.empty() ? "" : " ") + node;
    return name.empty() ? "device" : name;
}

}  // namespace

Attempt open_egl_device(std::optional<int> device, bool debug) {
    Attempt attempt;
    const std::shared_ptr<const Egl> egl = Egl::load(attempt.reason);
    if (egl == nullptr) return attempt;
    if (egl->query_devices == nullptr || !has_extension(egl->client_extensions.c_str(), "EGL_EXT_platform_device")) {
        attempt.reason = "libEGL cannot enumerate devices (EGL_EXT_platform_device)";
        return attempt;
    }
    const std::vector<EGLDeviceEXT> devices = egl->devices();
    if (devices.empty()) {
        attempt.reason = "no EGL device: no driver is installed";
        return attempt;
    }
    if (device && (*device < 0 || static_cast<std::size_t>(*device) >= devices.size()))
        throw planet::Error(
            planet::Fault::bad_usage, "device", std::to_string(*device),
            devices.size() == 1 ? "0, the only EGL device" : "0 to " + std::to_string(devices.size() - 1));
    std::string reasons;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        if (device && static_cast<std::size_t>(*device) != i) continue;
        attempt = open_on(egl, EGL_PLATFORM_DEVICE_EXT, devices[i], debug);
        attempt.device = static_cast<int>(i);
        if (attempt.context != nullptr) return attempt;
        if (!reasons.empty()) reasons += ", ";
        reasons += "device " + std::to_string(i) + " (" + device_name(*egl, devices[i]) + ") " + attempt.reason;
    }
    attempt.reason = reasons;
    return attempt;
}

Attempt open_egl_surfaceless(bool debug) {
    Attempt attempt;
    const std::shared_ptr<const Egl> egl = Egl::load(attempt.reason);
    if (egl == nullptr) return attempt;
    if (!has_extension(egl->client_extensions.c_str(), "EGL_MESA_platform_surfaceless")) {
        attempt.reason = "libEGL lacks EGL_MESA_platform_surfaceless";
        return attempt;
    }
    return open_on(egl, EGL_PLATFORM_SURFACELESS_MESA, nullptr, debug);
}

std::vector<std::string> egl_device_names() {
    std::string reason;
    const std::shared_ptr<const Egl> egl = Egl::load(reason);
    if (egl == nullptr) return {};
    std::vector<std::string> names;
    for (const EGLDeviceEXT device : egl->devices()) names.push_back(device_name(*egl, device));
    return names;
}

}  // namespace render
