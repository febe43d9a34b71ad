#include "planet/elevation/module.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "planet/error.h"

namespace planet {
namespace {

std::vector<std::filesystem::path> module_folders() {
    std::vector<std::filesystem::path> folders;
    std::error_code failed;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (!failed) folders.push_back(program.parent_path());
#ifdef OCTAGLOBE_MODULE_FOLDER
    folders.emplace_back(OCTAGLOBE_MODULE_FOLDER);
#endif
    if (const char* listed = std::getenv("OCTAGLOBE_MODULES")) {
        std::stringstream list(listed);
        for (std::string folder; std::getline(list, folder, ':');)
            if (!folder.empty()) folders.emplace_back(folder);
    }
    return folders;
}

void* open_module(const std::string& name, const char* what) {
    std::string reason = "not found";
    for (const auto& folder : module_folders()) {
        const std::filesystem::path file = folder / (name + ".so");
        std::error_code failed;
        if (!std::filesystem::exists(file, failed)) continue;
        if (void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return handle;
        reason = dlerror();
    }
    throw Error(Fault::bad_data, "module " + name,
                std::string("is needed for ").append(what).append(" and cannot be loaded: ").append(reason),
                name + ".so beside the program or in a folder named by OCTAGLOBE_MODULES");
}

}  // namespace

bool has_module(const char* name) {
    std::error_code failed;
    for (const auto& folder : module_folders())
        if (std::filesystem::exists(folder / (std::string(name) + ".so"), failed)) return true;
    return false;
}

void* module_symbol(const char* name, const char* symbol, const char* what) {
    static std::mutex mutex;
    static std::map<std::string, void*> open;
    const std::lock_guard lock(mutex);
    void*& handle = open[name];
    if (!handle) handle = open_module(name, what);
    void* found = dlsym(handle, symbol);
    if (!found) throw Error(Fault::bad_data, std::string("module ") + name, "is of another version");
    return found;
}

}  // namespace planet
