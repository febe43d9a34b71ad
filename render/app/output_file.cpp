#include "render/app/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "planet/error.h"
#include "render/app/values.h"

namespace render {
namespace fs = std::filesystem;

OutputFile::OutputFile(std::string where, fs::path target, fs::path known_as)
    : where_(std::move(where)), target_(std::move(target)), known_as_(std::move(known_as)) {
    if (target_.empty()) throw planet::Error(planet::Fault::bad_usage, where_, "empty file name", "a path");
    std::error_code ignored;
    const fs::file_status status = fs::status(target_, ignored);
    if (fs::is_directory(status)) fail(EISDIR);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) fail(errno);
        return;
    }
    if (const fs::path real = fs::weakly_canonical(target_, ignored); !ignored && !real.empty()) target_ = real;
    // Made with the rights that the user's umask grants, which mkstemp would not do. The name holds the process, and
    // O_EXCL sees to the rest.
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
        temporary_ = target_;
        temporary_ += "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        listed_ = TemporaryName(temporary_, [&] {
            descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            const int error = errno;
            if (descriptor_ >= 0 || (error == EEXIST && attempt < 100)) return;
            temporary_.clear();
            fail(error);
        });
    }
}

OutputFile::~OutputFile() {
    abandon();
}

void OutputFile::append(std::string_view bytes) {
    while (!bytes.empty()) {
        const auto written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void OutputFile::commit(std::string_view bytes) {
    append(bytes);
    const int closed = ::close(descriptor_);  // a full disk or a network file system may tell only now
    descriptor_ = -1;
    if (closed != 0) fail(errno);
    if (temporary_.empty()) return;  // a device
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
    temporary_.clear();
    listed_ = {};
}

void OutputFile::fail(int error) const {
    throw planet::Error(planet::Fault::bad_usage, where_,
                        shown((known_as_.empty() ? target_ : known_as_).native()) +
                            " cannot be written: " + std::generic_category().message(error),
                        "a file in a folder that exists and can be written");
}

void OutputFile::abandon() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (temporary_.empty()) return;
    ::unlink(temporary_.c_str());
}

}  // namespace render
