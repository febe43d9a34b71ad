// OpenGL for Dear ImGui where there is EGL and no GLX. Its backend knows one library, libGL.so.1, and one way to ask it for
// functions; a machine without it would have a window and no panels. The module is linked so that what its static
// libraries ask of dlopen and dlsym comes here first (--wrap in CMakeLists.txt).

#include <string_view>

extern "C" {

void* __real_dlopen(const char* name, int flags);
void* __real_dlsym(void* library, const char* name);

void* __wrap_dlopen(const char* name, int flags) {
    void* library = __real_dlopen(name, flags);
    const bool is_gl = name != nullptr && std::string_view(name) == "libGL.so.1";
    return library == nullptr && is_gl ? __real_dlopen("libEGL.so.1", flags) : library;
}

void* __wrap_dlsym(void* library, const char* name) {
    void* symbol = __real_dlsym(library, name);
    const bool asks_for_functions = std::string_view(name) == "glXGetProcAddressARB";
    return symbol == nullptr && asks_for_functions ? __real_dlsym(library, "eglGetProcAddress") : symbol;
}

}  // extern "C"
