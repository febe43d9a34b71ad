#include "render/gl/context.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <utility>

#include "planet/error.h"
#include "render/gl/egl.h"
#include "render/gl/osmesa.h"

namespace render {

struct Context::State {
    // Declared first, destroyed last: the driver may still speak while its context goes.
    DebugLog debug_log;
    std::unique_ptr<NativeContext> native;
    Functions functions;
    BackendChoice backend = BackendChoice::automatic;
    std::optional<int> device;
    std::string gl_version, gl_renderer;

    static State*& current() noexcept {
        static constinit thread_local State* state = nullptr;
        return state;
    }

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (current() == this) release_current();
    }

    /// Returns what went wrong; empty if nothing did.
    std::string make_current() {
        if (current() == this) return {};
        // Two libraries of one process do not know of each other's current context: release before a change.
        release_current();
        std::string reason = native->make_current();
        if (!reason.empty()) return reason;
        current() = this;
        detail::current_functions = &functions;
        return {};
    }
    static void release_current() noexcept {
        if (State* state = std::exchange(current(), nullptr)) state->native->release();
        detail::current_functions = nullptr;
    }

    std::string load();
    void set_up(bool debug);
};

namespace {

constexpr std::array ways{BackendChoice::egl_device, BackendChoice::egl_surfaceless, BackendChoice::osmesa};

Limits read_limits() {
    const auto get = [](GLenum name) {
        GLint value = 0;
        gl().GetIntegerv(name, &value);
        return value;
    };
    GLint viewport[2] = {0, 0};
    gl().GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    Limits limits;
    limits.texture_size = get(GL_MAX_TEXTURE_SIZE);
    limits.cube_size = get(GL_MAX_CUBE_MAP_TEXTURE_SIZE);
    limits.volume_size = get(GL_MAX_3D_TEXTURE_SIZE);
    limits.array_layers = get(GL_MAX_ARRAY_TEXTURE_LAYERS);
    limits.target_size = std::min({limits.texture_size, viewport[0], viewport[1]});
    limits.samples = std::min(get(GL_MAX_COLOR_TEXTURE_SAMPLES), get(GL_MAX_DEPTH_TEXTURE_SAMPLES));
    return limits;
}

std::string gl_string(GLenum name) {
    const GLubyte* text = gl().GetString(name);
    return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

}  // namespace

/// Loads the functions and checks the version. Returns what is missing; empty if nothing is.
std::string Context::State::load() {
    static std::atomic<std::uint32_t> contexts{0};
    const std::string missing = load_functions(functions, native->resolver());
    if (functions.GetIntegerv == nullptr || functions.GetString == nullptr) return "no " + missing;
    GLint major = 0, minor = 0;
    functions.GetIntegerv(GL_MAJOR_VERSION, &major);
    functions.GetIntegerv(GL_MINOR_VERSION, &minor);
    gl_version = gl_string(GL_VERSION);
    gl_renderer = gl_string(GL_RENDERER);
    if (std::pair(major, minor) < std::pair(gl_major, gl_minor)) return "gives only OpenGL " + gl_version;
    if (!missing.empty()) return gl_version + " lacks " + missing;
    functions.context_id = ++contexts;
    functions.debug_log = &debug_log;
    return {};
}

void Context::State::set_up(bool debug) {
    functions.limits = read_limits();
    functions.PixelStorei(GL_PACK_ALIGNMENT, 1);
    functions.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    functions.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    if (debug) debug_log.attach();
}

std::unique_ptr<Context::State> Context::open(BackendChoice way, const ContextOptions& options, std::string& reason) {
    Attempt attempt;
    switch (way) {
        case BackendChoice::egl_device:
            attempt = open_egl_device(options.device, options.debug);
            break;
        case BackendChoice::egl_surfaceless:
            attempt = open_egl_surfaceless(options.debug);
            break;
        default:
            attempt = open_osmesa();
            break;
    }
    reason = std::move(attempt.reason);
    if (attempt.context == nullptr) return nullptr;
    auto state = std::make_unique<State>();
    state->native = std::move(attempt.context);
    state->backend = way;
    if (attempt.device >= 0) state->device = attempt.device;
    State* const previous = State::current();
    reason = state->make_current();
    if (reason.empty()) reason = state->load();
    if (reason.empty()) {
        state->set_up(options.debug);
        return state;
    }
    state.reset();
    if (previous != nullptr) previous->make_current();
    return nullptr;
}

Context Context::create(const ContextOptions& options) {
    using enum BackendChoice;
    const bool only_device = options.device && (options.backend == automatic || options.backend == egl);
    const BackendChoice choice = only_device ? egl_device : options.backend;
    if (options.device && choice != egl_device)
        throw planet::Error(planet::Fault::bad_usage, "device",
                            std::to_string(*options.device) + " with " + std::string(backend_name(choice)),
                            "a device with auto, egl or egl-device only");
    std::string tried, last_reason;
    for (const BackendChoice way : ways) {
        if (choice != automatic && choice != way && !(choice == egl && way != osmesa)) continue;
        std::string reason;
        if (auto state = open(way, options, reason)) return Context(std::move(state));
        // Both ways through EGL usually fail for one reason: say it once.
        const bool same = reason == last_reason;
        const std::string name(backend_name(way));
        if (same)
            tried.insert(tried.size() - reason.size() - 2, " and " + name);
        else
            tried += (tried.empty() ? "" : "; ") + name + ": " + reason;
        last_reason = reason;
    }
    throw planet::Error(planet::Fault::no_graphics, "OpenGL", "no core 4.5 context (" + tried + ")",
                        "EGL with a driver (libegl1 and libgl1-mesa-dri, or a GPU's own) or OSMesa (libosmesa6)");
}

Context Context::adopt(std::unique_ptr<NativeContext> native, bool debug) {
    auto state = std::make_unique<State>();
    state->native = std::move(native);
    state->backend = BackendChoice::window;
    std::string reason = state->make_current();
    if (reason.empty()) reason = state->load();
    if (!reason.empty()) throw planet::Error(planet::Fault::no_graphics, "window", reason, "OpenGL 4.5 core");
    state->set_up(debug);
    return Context(std::move(state));
}

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;
Context::~Context() = default;

void Context::make_current() {
    assert(state_ != nullptr);
    if (const std::string reason = state_->make_current(); !reason.empty())
        throw planet::Error(planet::Fault::no_graphics, backend_name(state_->backend), reason);
}

void Context::release_current() noexcept {
    State::release_current();
}

BackendChoice Context::backend() const noexcept {
    return state_->backend;
}
std::optional<int> Context::device() const noexcept {
    return state_->device;
}
const std::string& Context::gl_version() const noexcept {
    return state_->gl_version;
}
const std::string& Context::gl_renderer() const noexcept {
    return state_->gl_renderer;
}
const Limits& Context::limits() const noexcept {
    return state_->functions.limits;
}
DebugLog& Context::debug_log() noexcept {
    return state_->debug_log;
}

std::string_view backend_name(BackendChoice backend) {
    switch (backend) {
        case BackendChoice::automatic:
            return "auto";
        case BackendChoice::egl:
            return "egl";
        case BackendChoice::egl_device:
            return "egl-device";
        case BackendChoice::egl_surfaceless:
            return "egl-surfaceless";
        case BackendChoice::osmesa:
            return "osmesa";
        case BackendChoice::window:
            return "window";
    }
    assert(false);
    return {};
}

std::optional<BackendChoice> backend_from_name(std::string_view name) {
    using enum BackendChoice;
    for (const BackendChoice backend : {automatic, egl, egl_device, egl_surfaceless, osmesa})
        if (name == backend_name(backend)) return backend;
    return std::nullopt;
}

std::vector<BackendProbe> probe_backends() {
    Context::State* const previous = Context::State::current();
    std::vector<BackendProbe> probes;
    for (const BackendChoice way : ways) {
        const auto start = std::chrono::steady_clock::now();
        BackendProbe probe{.name = std::string(backend_name(way)), .devices = {}};
        if (const auto state = Context::open(way, {.backend = way, .debug = false}, probe.reason)) {
            probe.available = true;
            probe.gl_version = state->gl_version;
            probe.gl_renderer = state->gl_renderer;
        }
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
        probe.milliseconds = time.count();
        if (way == BackendChoice::egl_device) probe.devices = egl_device_names();
        probes.push_back(std::move(probe));
    }
    if (previous != nullptr) previous->make_current();
    return probes;
}

}  // namespace render
