#pragma once
// OpenGL 4.5 core without a display or a window system.
//
//   auto context = render::Context::create({.backend = render::BackendChoice::automatic});
//   render::gl().Clear(...);                      // the context is current on this thread
//
// Three ways in, tried in this order: an EGL device (a GPU, else Mesa's software device), EGL on Mesa's surfaceless
// platform, and OSMesa. None is linked; each library is opened when it is wanted. Several contexts can live in one
// process, of one kind or of several, each current on at most one thread. There is no default framebuffer: bind a
// Framebuffer before drawing, also where nothing is rasterized (transform feedback).

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/checks.h"
#include "render/gl/debug_log.h"
#include "render/gl/loader.h"

namespace render {

class NativeContext;

enum class BackendChoice {
    automatic,        ///< the first that works of the three below
    egl,              ///< the first that works of the two below
    egl_device,       ///< EGL_EXT_platform_device
    egl_surfaceless,  ///< EGL_MESA_platform_surfaceless
    osmesa,           ///< libOSMesa
    window,           ///< of a Window, by adopt() only
};

/// The name at the command line: "auto", "egl", "egl-device", "egl-surfaceless", "osmesa".
std::string_view backend_name(BackendChoice backend);
std::optional<BackendChoice> backend_from_name(std::string_view name);

struct ContextOptions {
    BackendChoice backend = BackendChoice::automatic;
    /// Index into the EGL devices. With it, automatic and egl mean egl_device.
    std::optional<int> device{};
    /// Ask the driver for its debug messages (DebugLog) and full checks.
    bool debug = gl_checks;
};

class Context {
  public:
    /// Makes a context and makes it current on this thread. Pixel rows are tightly packed (alignment 1) and cube maps
    /// seamless in it; all other state is OpenGL's default.
    /// Throws planet::Error: no_graphics, one line that names every way that was tried and why each failed; bad_usage
    /// if a device is asked of a way that has none.
    static Context create(const ContextOptions& options = {});

    /// Takes over a context that was made elsewhere, such as a Window's, and makes it current on this thread as create()
    /// does. Its backend is BackendChoice::window. Throws planet::Error (no_graphics).
    static Context adopt(std::unique_ptr<NativeContext> native, bool debug = gl_checks);

    Context(Context&&) noexcept;
    Context& operator=(Context&&) noexcept;
    /// Objects that are still alive go with it; their handles may be destroyed later. If the context is current, it
    /// must be so on this thread.
    ~Context();

    /// Makes it current on this thread, where another context may be current. It must be current on no other thread.
    void make_current();
    /// Leaves this thread without a context. Nothing happens if it has none.
    static void release_current() noexcept;

    BackendChoice backend() const noexcept;           ///< never automatic or egl
    std::optional<int> device() const noexcept;       ///< the EGL device's index, for egl_device
    const std::string& gl_version() const noexcept;   ///< GL_VERSION, e.g. "4.5 (Core Profile) Mesa 22.3.6"
    const std::string& gl_renderer() const noexcept;  ///< GL_RENDERER, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"
    const Limits& limits() const noexcept;
    DebugLog& debug_log() noexcept;

  private:
    struct State;
    explicit Context(std::unique_ptr<State> state);
    static std::unique_ptr<State> open(BackendChoice way, const ContextOptions& options, std::string& reason);

    friend std::vector<struct BackendProbe> probe_backends();

    std::unique_ptr<State> state_;
};

/// What one way into OpenGL gives on this machine.
struct BackendProbe {
    std::string name;                  ///< "egl-device", "egl-surfaceless" or "osmesa"
    bool available = false;            ///< it gives a core 4.5 context
    std::string gl_version{};          ///< empty unless available
    std::string gl_renderer{};         ///< empty unless available
    std::vector<std::string> devices;  ///< egl-device: every device's name by index; else empty
    std::string reason{};              ///< one line why it is not available
    double milliseconds = 0;           ///< to make the context, load its functions and destroy it
};

/// Tries every way on its own, in the order of BackendChoice. The first pays for loading the driver's libraries. The
/// context that is current on this thread stays so.
std::vector<BackendProbe> probe_backends();

}  // namespace render
