#pragma once
// libEGL's functions and displays.

#define EGL_NO_PLATFORM_SPECIFIC_TYPES 1  // no X11 headers
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace render {

/// The functions of libEGL.so.1 (EGL 1.5 client API and the extensions that are used).
struct Egl {
    PFNEGLGETPROCADDRESSPROC get_proc_address = nullptr;
    PFNEGLQUERYSTRINGPROC query_string = nullptr;
    PFNEGLINITIALIZEPROC initialize = nullptr;
    PFNEGLBINDAPIPROC bind_api = nullptr;
    PFNEGLCHOOSECONFIGPROC choose_config = nullptr;
    PFNEGLCREATECONTEXTPROC create_context = nullptr;
    PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
    PFNEGLCREATEPBUFFERSURFACEPROC create_pbuffer_surface = nullptr;
    PFNEGLDESTROYSURFACEPROC destroy_surface = nullptr;
    PFNEGLMAKECURRENTPROC make_current = nullptr;
    PFNEGLGETERRORPROC get_error = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;             ///< null without EGL_EXT_device_enumeration
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;  ///< null without EGL_EXT_device_query
    std::string client_extensions;

    /// Opens libEGL. Null with the reason if it is missing, too old or has no way to a display without a window system.
    static std::shared_ptr<const Egl> load(std::string& reason);

    std::vector<EGLDeviceEXT> devices() const;
    /// "eglInitialize: EGL_NOT_INITIALIZED" and the like, of the last call on this thread.
    std::string failure(std::string_view function) const;
};

/// Does a list of extensions, separated by blanks, hold this one?
bool has_extension(const char* list, std::string_view extension);

/// An initialized display of libEGL. It is never terminated: every request for the same platform and device gives the
/// same EGLDisplay to the whole process, so ending it would end the contexts of others, and Mesa would unload the
/// driver, leak a little and load it again for the next context (5 to 20 ms).
class EglDisplay {
  public:
    /// Nothing, and the reason, if there is no such display. `device` is null for the surfaceless platform.
    /// Thread-safe.
    static std::optional<EglDisplay> open(std::shared_ptr<const Egl> egl, EGLenum platform, EGLDeviceEXT device,
                                          std::string& reason);

    const Egl& egl() const noexcept { return *egl_; }
    EGLDisplay get() const noexcept { return display_; }
    bool has(std::string_view extension) const;

  private:
    EglDisplay(std::shared_ptr<const Egl> egl, EGLDisplay display) : egl_(std::move(egl)), display_(display) {}

    std::shared_ptr<const Egl> egl_;
    EGLDisplay display_;
};

}  // namespace render
