#include "render/gl/egl_library.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "render/gl/library.h"

namespace render {
namespace {

bool load_core(Egl& egl, const Library& library) {
    return library.load(egl.get_proc_address, "eglGetProcAddress") &&
           library.load(egl.query_string, "eglQueryString") && library.load(egl.initialize, "eglInitialize") &&
           library.load(egl.bind_api, "eglBindAPI") && library.load(egl.choose_config, "eglChooseConfig") &&
           library.load(egl.create_context, "eglCreateContext") &&
           library.load(egl.destroy_context, "eglDestroyContext") &&
           library.load(egl.create_pbuffer_surface, "eglCreatePbufferSurface") &&
           library.load(egl.destroy_surface, "eglDestroySurface") && library.load(egl.make_current, "eglMakeCurrent") &&
           library.load(egl.get_error, "eglGetError");
}

template <class Function>
void load_extension(Function& function, const Egl& egl, const char* name) {
    function = reinterpret_cast<Function>(egl.get_proc_address(name));
}

}  // namespace

std::shared_ptr<const Egl> Egl::load(std::string& reason) {
    // Mesa warns on standard error about every device that it may not open; the reasons are ours to report.
    static const int quiet = setenv("EGL_LOG_LEVEL", "fatal", 0);
    static_cast<void>(quiet);
    const Library library = open_library("OCTAGLOBE_EGL_LIBRARY", {"libEGL.so.1", "libEGL.so"});
    auto egl = std::make_shared<Egl>();
    if (!library) {
        reason = library.reason;
    } else if (!load_core(*egl, library)) {
        reason = library.name + " is not EGL: it lacks eglGetProcAddress or a companion";
    } else if (const char* list = egl->query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS); list == nullptr) {
        reason = library.name + " has no client extensions (EGL_EXT_client_extensions)";
    } else {
        egl->client_extensions = list;
        load_extension(egl->get_platform_display, *egl, "eglGetPlatformDisplayEXT");
        const bool enumerates =
            has_extension(list, "EGL_EXT_device_enumeration") || has_extension(list, "EGL_EXT_device_base");
        if (enumerates) load_extension(egl->query_devices, *egl, "eglQueryDevicesEXT");
        if (has_extension(list, "EGL_EXT_device_query") || has_extension(list, "EGL_EXT_device_base"))
            load_extension(egl->query_device_string, *egl, "eglQueryDeviceStringEXT");
        if (has_extension(list, "EGL_EXT_platform_base") && egl->get_platform_display != nullptr) return egl;
        reason = library.name + " lacks EGL_EXT_platform_base: it is too old, or no driver is installed";
    }
    return nullptr;
}

std::vector<EGLDeviceEXT> Egl::devices() const {
    EGLint count = 0;
    if (query_devices == nullptr || query_devices(0, nullptr, &count) == EGL_FALSE || count <= 0) return {};
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (query_devices(count, devices.data(), &count) == EGL_FALSE || count < 0) return {};
    devices.resize(static_cast<std::size_t>(count));
    return devices;
}

std::string Egl::failure(std::string_view function) const {
    static constexpr std::array names{"EGL_SUCCESS",       "EGL_NOT_INITIALIZED",     "EGL_BAD_ACCESS",
                                      "EGL_BAD_ALLOC",     "EGL_BAD_ATTRIBUTE",       "EGL_BAD_CONFIG",
                                      "EGL_BAD_CONTEXT",   "EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY",
                                      "EGL_BAD_MATCH",     "EGL_BAD_NATIVE_PIXMAP",   "EGL_BAD_NATIVE_WINDOW",
                                      "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",         "EGL_CONTEXT_LOST"};
    const EGLint code = get_error();
    const auto index = static_cast<std::size_t>(code - EGL_SUCCESS);
    std::string text(function);
    text += ": ";
    if (index < names.size()) return text + names[index];
    char number[16];
    std::snprintf(number, sizeof number, "0x%04x", static_cast<unsigned>(code));
    return text + "error " + number;
}

bool has_extension(const char* list, std::string_view extension) {
    if (list == nullptr) return false;
    for (std::string_view rest(list); !rest.empty();) {
        const std::size_t end = rest.find(' ');
        if (rest.substr(0, end) == extension) return true;
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    }
    return false;
}

std::optional<EglDisplay> EglDisplay::open(std::shared_ptr<const Egl> egl, EGLenum platform, EGLDeviceEXT device,
                                           std::string& reason) {
    const EGLDisplay display = egl->get_platform_display(platform, device, nullptr);
    if (display == EGL_NO_DISPLAY) {
        reason = egl->failure("eglGetPlatformDisplayEXT");
        if (reason.ends_with("EGL_SUCCESS")) reason = "no EGL driver serves this platform";
        return std::nullopt;
    }
    if (egl->initialize(display, nullptr, nullptr) == EGL_FALSE) {
        reason = egl->failure("eglInitialize");
        return std::nullopt;
    }
    return EglDisplay(std::move(egl), display);
}

bool EglDisplay::has(std::string_view extension) const {
    return has_extension(egl_->query_string(display_, EGL_EXTENSIONS), extension);
}

}  // namespace render
