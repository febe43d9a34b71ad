#include "render/app/checksum.h"

#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <system_error>

#include "planet/elevation/sha256.h"
#include "planet/error.h"
#include "render/app/data_path.h"
#include "render/app/output_file.h"

namespace render {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t digits = 64;  // of a SHA-256 in hexadecimal
constexpr std::size_t remembered = 1000;

std::int64_t nanoseconds(const timespec& t) {
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

/// What tells one state of a file from another.
std::string stamp_of(const struct stat& s, const fs::path& path) {
    std::string text;
    for (const auto number : {static_cast<std::int64_t>(s.st_dev), static_cast<std::int64_t>(s.st_ino),
                              static_cast<std::int64_t>(s.st_size), nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)})
        text.append(std::to_string(number)).append(" ");
    return text.append(path.native());
}

bool settled(const struct stat& s) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return nanoseconds(now) - std::max(nanoseconds(s.st_mtim), nanoseconds(s.st_ctim)) > 2'000'000'000;
}

}  // namespace

ChecksumIndex::ChecksumIndex(std::optional<fs::path> file) : file_(std::move(file)) {
    if (!file_) return;
    std::ifstream in(*file_, std::ios::binary);
    for (std::string line; known_.size() < remembered && std::getline(in, line);) {
        const bool valid =
            line.size() > digits + 1 && line[digits] == ' ' && line.find_first_not_of("0123456789abcdef") == digits;
        if (valid) known_.emplace_back(line.substr(digits + 1), line.substr(0, digits));
    }
}

std::string ChecksumIndex::sha256(const fs::path& path) {
    std::error_code failure;
    const fs::path real = fs::canonical(path, failure);
    struct stat before {};
    const bool seen = !failure && ::stat(real.c_str(), &before) == 0;
    const std::string stamp = seen ? stamp_of(before, real) : std::string();
    const auto found =
        std::find_if(known_.begin(), known_.end(), [&](const auto& k) { return seen && k.first == stamp; });
    if (found != known_.end()) return found->second;

    if (!fs::is_regular_file(path, failure))
        throw planet::Error(planet::Fault::bad_data, path.native(), seen ? "is not a file" : "cannot be found",
                            "a file");
    ++computed_;
    std::string sum = planet::sha256_of_file(path.native());
    struct stat after {};
    const bool keep = seen && settled(before) && ::stat(real.c_str(), &after) == 0 && stamp_of(after, real) == stamp &&
                      stamp.find('\n') == std::string::npos;
    if (keep) {
        const auto same_path = [&](const auto& k) { return k.first.ends_with(" " + real.native()); };
        std::erase_if(known_, same_path);
        known_.emplace_back(stamp, sum);
        changed_ = true;
    }
    return sum;
}

void ChecksumIndex::save() noexcept {
    if (!file_ || !changed_) return;
    changed_ = false;
    try {
        std::string text;
        const std::size_t first = known_.size() > remembered ? known_.size() - remembered : 0;
        for (std::size_t i = first; i < known_.size(); ++i)
            text.append(known_[i].second).append(" ").append(known_[i].first).append("\n");
        OutputFile("checksums", *file_).commit(text);
    } catch (const std::exception&) {
        // It is only a cache: the next run reads the files again.
    }
}

ChecksumIndex user_checksum_index() {
    const auto folder = cache_folder();
    return ChecksumIndex(folder ? std::optional(*folder / "checksums") : std::nullopt);
}

}  // namespace render
