#include "render/gl/window.h"

#include "planet/elevation/module.h"
#include "planet/error.h"

namespace render {

std::unique_ptr<Window> open_window(const WindowOptions& options) {
    using Factory = Window* (*)(const WindowOptions&);
    void* symbol = nullptr;
    try {
        symbol = planet::module_symbol("octaglobe_window", "octaglobe_window_1", "opening a window");
    } catch (const planet::Error& error) {
        throw planet::Error(planet::Fault::no_graphics, "window", error.what());
    }
    return std::unique_ptr<Window>(reinterpret_cast<Factory>(symbol)(options));
}

}  // namespace render
