#include "render/app/output_folder.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "planet/error.h"
#include "render/app/values.h"

namespace render {
namespace fs = std::filesystem;

namespace {

fs::path real_path(const fs::path& target) {
    fs::path path = target.lexically_normal();
    if (!path.has_filename()) path = path.parent_path();  // out/
    std::error_code failed;
    const fs::path real = fs::weakly_canonical(path, failed);
    return failed || real.empty() ? path : real;
}

/// Of a temporary name; 0: it is none.
pid_t process_of(const std::string& name, const std::string& target) {
    if (!name.starts_with(target + ".") || !name.ends_with(".part")) return 0;
    return static_cast<pid_t>(std::atol(name.c_str() + target.size() + 1));
}

}  // namespace

std::optional<fs::path> OutputFolder::left_behind(const fs::path& target) {
    const fs::path path = fs::absolute(real_path(target));
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(path.parent_path(), failed)) {
        const pid_t process = process_of(entry.path().filename(), path.filename());
        if (process > 0 && entry.is_directory() && ::kill(process, 0) != 0 && errno == ESRCH) return entry.path();
    }
    return {};
}

OutputFolder::OutputFolder(std::string where, fs::path target, const std::optional<fs::path>& begun)
    : where_(std::move(where)), target_(real_path(target)) {
    std::error_code ignored;
    const fs::file_status status = fs::status(target_, ignored);
    if (fs::exists(status) && (!fs::is_directory(status) || !fs::is_empty(target_, ignored)))
        fail(fs::is_directory(status) ? "is there, and not empty" : "is there, and no folder");
    for (int attempt = 0, made = -1; made != 0; ++attempt) {
        temporary_ = target_;
        temporary_ += "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        listed_ = TemporaryName(temporary_, [&] {
            made = begun ? ::rename(begun->c_str(), temporary_.c_str()) : ::mkdir(temporary_.c_str(), 0777);
            const int error = errno;
            if (made == 0 || (error == EEXIST && attempt < 100)) return;
            temporary_.clear();
            fail("cannot be made: " + std::generic_category().message(error));
        });
    }
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void OutputFolder::commit() {
    const SignalsWait wait;                                  // a signal would empty it while it gets its name
    if (::rename(temporary_.c_str(), target_.c_str()) != 0)  // an empty folder is replaced
        fail("cannot be made: " + std::generic_category().message(errno));
    temporary_.clear();
    listed_ = {};
}

void OutputFolder::fail(const std::string& why) const {
    throw planet::Error(planet::Fault::bad_usage, where_, shown(target_.native()) + " " + why,
                        "a new folder, or an empty one, in a folder that can be written to");
}

}  // namespace render
