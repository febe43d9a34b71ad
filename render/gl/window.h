#pragma once
// A window to draw in, with widgets over the picture. GLFW and Dear ImGui are in a module of their own
// (planet/elevation/module.h), opened when a window is wanted: the program starts as fast, and runs, without them.
//
//     std::unique_ptr<Window> window = open_window({.title = "Octaglobe"});
//     Context context = Context::adopt(window->take_context(), debug);      // current on this thread
//     while (!window->closed()) {
//         for (const InputEvent& event : window->wait(0.1)) ...
//         gl()...                                                           // to framebuffer 0
//         window->draw_panels(panels);
//         window->swap();
//     }
//
// All of it on the main thread. A display that goes away ends the process with a line and exit status 4: Xlib allows no more.

#include <memory>
#include <string>
#include <vector>

#include "render/gl/native_context.h"

namespace render {

struct WindowOptions {
    std::string title;
    int width = 1280, height = 720;  ///< pixels
    bool full_screen = false;
    bool debug = false;  ///< ask the driver for its debug messages
};

/// Letters and digits are their capital ASCII code; the values are GLFW's.
enum class Key : int {
    space = 32,
    comma = 44,
    minus = 45,
    period = 46,
    slash = 47,
    equal = 61,
    left_bracket = 91,
    right_bracket = 93,
    escape = 256,
    enter = 257,
    tab = 258,
    backspace = 259,
    right = 262,
    left = 263,
    down = 264,
    up = 265,
    page_up = 266,
    page_down = 267,
    home = 268,
    f1 = 290,
    f2 = 291,
    f3 = 292,
    f11 = 300,
    keypad_minus = 333,
    keypad_plus = 334,
};
constexpr Key key_of(char letter_or_digit) {
    return static_cast<Key>(letter_or_digit);
}

enum class MouseButton { left, right, middle };

/// What the user did that no widget took. Places are pixels from the top left.
struct InputEvent {
    enum class Kind { press, repeat, release, button_down, button_up, motion, wheel };
    Kind kind;
    Key key{};
    MouseButton button{};
    bool shift = false, control = false;
    double x = 0, y = 0;  ///< of the cursor
    double wheel = 0;     ///< notches, positive away from the user
    double seconds = 0;   ///< on the window's clock
};

struct Panels;

class Window {
  public:
    Window() = default;
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    virtual ~Window() = default;

    /// The context of the window, for Context::adopt; once. The window must outlive it.
    virtual std::unique_ptr<NativeContext> take_context() = 0;
    /// How it was made: "GLX" or "EGL".
    virtual std::string context_way() const = 0;

    virtual bool closed() const = 0;
    /// Pixels; 0 x 0 while it is an icon.
    virtual int width() const = 0;
    virtual int height() const = 0;
    /// Pixels of the display in one of its units: 2 on a display of twice the usual density.
    virtual double scale() const = 0;
    /// Waits until something happens, at most so long (0: not at all).
    virtual std::vector<InputEvent> wait(double seconds) = 0;
    virtual double seconds() const = 0;
    /// Whether a key is down and no text is being typed.
    virtual bool held(Key key) const = 0;

    virtual void set_full_screen(bool full) = 0;
    virtual bool full_screen() const = 0;
    virtual void set_clipboard(const std::string& text) = 0;
    /// From the next swap() on: wait for the display, or do not.
    virtual void set_swap_interval(int frames) = 0;

    /// Draws the panels to framebuffer 0 and takes in what the user changed in them. Leaves other OpenGL state as it was.
    virtual void draw_panels(Panels& panels) = 0;
    virtual void swap() = 0;
};

/// Throws planet::Error(no_graphics) in one line: no such module or library, no display, no core 4.5 context.
std::unique_ptr<Window> open_window(const WindowOptions& options);

}  // namespace render
