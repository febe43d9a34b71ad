// The window: GLFW. Built into the module octaglobe_window together with panel_drawing.cpp.

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "planet/error.h"
#include "render/gl/window.h"
#include "render/viewer/module/panel_drawing.h"

namespace render {
namespace {

static_assert(static_cast<int>(Key::escape) == GLFW_KEY_ESCAPE && static_cast<int>(Key::f11) == GLFW_KEY_F11 &&
              static_cast<int>(Key::home) == GLFW_KEY_HOME && static_cast<int>(Key::keypad_plus) == GLFW_KEY_KP_ADD &&
              static_cast<int>(Key::right_bracket) == GLFW_KEY_RIGHT_BRACKET);

[[noreturn]] void fail(const std::string& what, std::string_view accepted) {
    throw planet::Error(planet::Fault::no_graphics, "window", what, accepted);
}

std::string last_glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text != nullptr ? text : "no reason given";
}

/// Xlib ends the process when its display goes, whatever we do; but with one line and our exit status.
int display_gone(void*) {
    constexpr std::string_view line = "octaglobe: window: the display has gone away\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
    ::_exit(static_cast<int>(planet::Fault::no_graphics));
}

void watch_display() {
    void* xlib = dlopen("libX11.so.6", RTLD_NOW | RTLD_NOLOAD);
    if (xlib == nullptr) return;
    using SetHandler = void* (*)(int (*)(void*));
    if (const auto set = reinterpret_cast<SetHandler>(dlsym(xlib, "XSetIOErrorHandler"))) set(display_gone);
}

class WindowContext final : public NativeContext {
  public:
    explicit WindowContext(GLFWwindow* window) : window_(window) {}
    std::string make_current() override {
        glfwMakeContextCurrent(window_);
        return glfwGetCurrentContext() == window_ ? std::string() : last_glfw_error();
    }
    void release() override { glfwMakeContextCurrent(nullptr); }
    Resolver resolver() const override { return glfwGetProcAddress; }

  private:
    GLFWwindow* window_;
};

class GlfwWindow final : public Window {
  public:
    explicit GlfwWindow(const WindowOptions& options) {
        if (glfwInit() == GLFW_FALSE)
            fail(last_glfw_error(), "a display (DISPLAY); octaglobe render draws without one");
        try {
            open(options);
        } catch (...) {
            glfwTerminate();
            throw;
        }
    }
    ~GlfwWindow() override {
        glfwMakeContextCurrent(window_);  // for what the panels have on the GPU
        panels_.reset();
        glfwDestroyWindow(window_);
        glfwTerminate();
    }

    std::unique_ptr<NativeContext> take_context() override { return std::make_unique<WindowContext>(window_); }
    std::string context_way() const override { return way_; }

    bool closed() const override { return glfwWindowShouldClose(window_) != GLFW_FALSE; }
    int width() const override { return framebuffer_size().first; }
    int height() const override { return framebuffer_size().second; }
    double scale() const override {
        float x = 1, y = 1;
        glfwGetWindowContentScale(window_, &x, &y);
        return x >= 0.5f ? static_cast<double>(x) : 1;
    }
    std::vector<InputEvent> wait(double seconds) override {
        if (seconds > 0)
            glfwWaitEventsTimeout(seconds);
        else
            glfwPollEvents();
        return std::exchange(events_, {});
    }
    double seconds() const override { return glfwGetTime(); }
    bool held(Key key) const override {
        return !PanelDrawing::takes_keys() && glfwGetKey(window_, static_cast<int>(key)) == GLFW_PRESS;
    }

    void set_full_screen(bool full) override {
        if (full == full_screen()) return;
        if (full) {
            glfwGetWindowPos(window_, &place_[0], &place_[1]);
            glfwGetWindowSize(window_, &place_[2], &place_[3]);
            GLFWmonitor* monitor = glfwGetPrimaryMonitor();
            const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
            if (mode == nullptr) return;
            glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
        } else {
            glfwSetWindowMonitor(window_, nullptr, place_[0], place_[1], place_[2], place_[3], GLFW_DONT_CARE);
        }
    }
    bool full_screen() const override { return glfwGetWindowMonitor(window_) != nullptr; }
    void set_clipboard(const std::string& text) override { glfwSetClipboardString(window_, text.c_str()); }
    void set_swap_interval(int frames) override { glfwSwapInterval(frames); }

    void draw_panels(Panels& panels) override {
        if (panels_ == nullptr) panels_ = std::make_unique<PanelDrawing>(window_, scale());
        panels_->draw(panels);
    }
    void swap() override { glfwSwapBuffers(window_); }

  private:
    void open(const WindowOptions& options);
    bool create(const WindowOptions& options, int way);
    void listen();
    std::pair<int, int> framebuffer_size() const {
        std::pair size(0, 0);
        glfwGetFramebufferSize(window_, &size.first, &size.second);
        return size;
    }
    /// Window units are pixels on X11, and may be others elsewhere.
    InputEvent event(InputEvent::Kind kind, int modifiers) const {
        InputEvent e{.kind = kind};
        e.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
        e.control = (modifiers & GLFW_MOD_CONTROL) != 0;
        int w = 0, h = 0;
        glfwGetWindowSize(window_, &w, &h);
        std::tie(e.x, e.y) = cursor_ ? *cursor_ : cursor_now();
        const auto [pixels_w, pixels_h] = framebuffer_size();
        e.x *= static_cast<double>(pixels_w) / std::max(w, 1);
        e.y *= static_cast<double>(pixels_h) / std::max(h, 1);
        e.seconds = glfwGetTime();
        return e;
    }
    std::pair<double, double> cursor_now() const {
        std::pair place(0.0, 0.0);
        glfwGetCursorPos(window_, &place.first, &place.second);
        return place;
    }
    static GlfwWindow& of(GLFWwindow* window) { return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window)); }

    GLFWwindow* window_ = nullptr;
    std::string way_;
    std::array<int, 4> place_{100, 100, 1280, 720};  ///< before it filled the screen
    std::vector<InputEvent> events_;
    /// As the last event told it: the one that can be asked for may be further on than the button that is looked at.
    std::optional<std::pair<double, double>> cursor_;
    int modifiers_ = 0;
    std::unique_ptr<PanelDrawing> panels_;
};

bool GlfwWindow::create(const WindowOptions& options, int way) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, way);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, gl_major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, gl_minor);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, options.debug ? GLFW_TRUE : GLFW_FALSE);
    // The picture comes from a framebuffer of its own: the window needs neither depth nor samples.
    for (const int hint : {GLFW_DEPTH_BITS, GLFW_STENCIL_BITS, GLFW_SAMPLES}) glfwWindowHint(hint, 0);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "octaglobe");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "octaglobe");
    window_ = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
    return window_ != nullptr;
}

void GlfwWindow::open(const WindowOptions& options) {
    watch_display();
    std::string reasons;
    for (const auto& [way, name] :
         {std::pair(GLFW_NATIVE_CONTEXT_API, "GLX"), std::pair(GLFW_EGL_CONTEXT_API, "EGL")}) {
        way_ = name;
        if (create(options, way)) break;
        reasons += (reasons.empty() ? "" : "; ") + way_ + ": " + last_glfw_error();
    }
    if (window_ == nullptr)
        fail("no core 4.5 context (" + reasons + ")", "OpenGL by GLX or EGL; octaglobe render draws without a window");
    glfwSetWindowUserPointer(window_, this);
    glfwSetWindowSizeLimits(window_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
    listen();
    glfwMakeContextCurrent(window_);
    if (options.full_screen) set_full_screen(true);
}

void GlfwWindow::listen() {
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int modifiers) {
        GlfwWindow& self = of(w);
        self.modifiers_ = modifiers;
        const bool leaves = key == GLFW_KEY_Q && (modifiers & GLFW_MOD_CONTROL) != 0;
        if (PanelDrawing::takes_keys() && !leaves) return;
        using enum InputEvent::Kind;
        InputEvent e = self.event(action == GLFW_PRESS ? press : action == GLFW_REPEAT ? repeat : release, modifiers);
        e.key = static_cast<Key>(key);
        self.events_.push_back(e);
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int modifiers) {
        GlfwWindow& self = of(w);
        self.modifiers_ = modifiers;
        if (button > GLFW_MOUSE_BUTTON_MIDDLE || (action == GLFW_PRESS && PanelDrawing::takes_mouse())) return;
        InputEvent e =
            self.event(action == GLFW_PRESS ? InputEvent::Kind::button_down : InputEvent::Kind::button_up, modifiers);
        e.button = static_cast<MouseButton>(button);
        self.events_.push_back(e);
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
        of(w).cursor_ = {x, y};
        of(w).events_.push_back(of(w).event(InputEvent::Kind::motion, of(w).modifiers_));
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double notches) {
        if (PanelDrawing::takes_mouse()) return;
        InputEvent e = of(w).event(InputEvent::Kind::wheel, of(w).modifiers_);
        e.wheel = notches;
        of(w).events_.push_back(e);
    });
}

}  // namespace
}  // namespace render

extern "C" __attribute__((visibility("default"))) render::Window* octaglobe_window_1(
    const render::WindowOptions& options) {
    return new render::GlfwWindow(options);
}
