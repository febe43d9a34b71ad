#include "render/gl/library.h"

#include <dlfcn.h>

#include <cstdlib>
#include <vector>

namespace render {

ProcAddress Library::symbol(const char* symbol_name) const {
    return handle == nullptr ? nullptr : reinterpret_cast<ProcAddress>(dlsym(handle, symbol_name));
}

Library open_library(const char* variable, std::initializer_list<const char*> names) {
    std::vector<const char*> candidates(names);
    if (const char* value = std::getenv(variable); value != nullptr && *value != '\0') candidates.assign(1, value);
    Library library;
    for (const char* name : candidates) {
        library.handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (library.handle != nullptr) {
            library.name = name;
            library.reason.clear();
            return library;
        }
        // The first failure is the one to tell: the further names are older or newer versions.
        if (const char* message = dlerror(); library.reason.empty())
            library.reason = message != nullptr ? message : std::string(name) + " cannot be opened";
    }
    return library;
}

}  // namespace render
