#include "render/app/output_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "planet/error.h"
#include "render/app/values.h"

namespace render {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(std::string where, fs::path target) : where_(std::move(where)), target_(std::move(target)) {
    target_ = target_.lexically_normal();
    if (!target_.has_filename()) target_ = target_.parent_path();  // out/
    std::error_code ignored;
    if (const fs::path real = fs::weakly_canonical(target_, ignored); !ignored && !real.empty()) target_ = real;
    const fs::file_status status = fs::status(target_, ignored);
    if (fs::exists(status) && (!fs::is_directory(status) || !fs::is_empty(target_, ignored)))
        fail(fs::is_directory(status) ? "is there, and not empty" : "is there, and no folder");
    for (int attempt = 0, made = -1; made != 0; ++attempt) {
        temporary_ = target_;
        temporary_ += "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        listed_ = TemporaryName(temporary_, [&] {
            made = ::mkdir(temporary_.c_str(), 0777);
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
