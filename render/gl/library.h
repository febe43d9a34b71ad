#pragma once
// A shared library opened at run time. It stays open until the process ends: drivers leave thread-local destructors and
// exit handlers behind that must not be unmapped.

#include <initializer_list>
#include <string>

#include "render/gl/loader.h"

namespace render {

struct Library {
    void* handle = nullptr;  ///< of dlopen; null if none of the names can be opened
    std::string name;        ///< the name that was opened
    std::string reason;      ///< one line why none could be opened

    explicit operator bool() const noexcept { return handle != nullptr; }
    /// The address of a symbol, or null.
    ProcAddress symbol(const char* symbol_name) const;
    /// Sets `function` to the symbol; false if it is missing.
    template <class Function>
    bool load(Function& function, const char* symbol_name) const {
        function = reinterpret_cast<Function>(symbol(symbol_name));
        return function != nullptr;
    }
};

/// Opens the first of `names` that exists. If the environment variable `variable` is set and not empty, its value (a
/// name or a path) is the only candidate: for a library that lies elsewhere, and to try out a machine without it.
Library open_library(const char* variable, std::initializer_list<const char*> names);

}  // namespace render
