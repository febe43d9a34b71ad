#include "render/gl/loader.h"

namespace render {

std::string load_functions(Functions& functions, Resolver resolver) {
    const char* missing = "";
    const auto resolve = [&](const char* name) {
        const ProcAddress address = resolver(name);
        if (address == nullptr && *missing == '\0') missing = name;
        return address;
    };
#define OCTAGLOBE_GL(name) functions.name = reinterpret_cast<decltype(functions.name)>(resolve("gl" #name));
#include "gl_functions.inc"
#undef OCTAGLOBE_GL
    return missing;
}

}  // namespace render
