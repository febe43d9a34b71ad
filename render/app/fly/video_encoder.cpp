#include "render/app/fly/video_encoder.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "planet/error.h"
#include "render/app/figures.h"

namespace render {
namespace fs = std::filesystem;

namespace {

std::optional<std::string> program_in_path(const char* name) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path file = fs::path(folder.empty() ? "." : folder) / name;
        std::error_code ignored;
        if (fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0) return file.native();
    }
    return {};
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

/// What stands in a file, in its last line that is not empty.
std::string last_line(int file) {
    std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(file, 0, SEEK_END), 0)), ' ');
    if (::pread(file, text.data(), text.size(), 0) < 0) return {};
    std::istringstream lines(text);
    std::string last;
    for (std::string line; std::getline(lines, line);)
        if (line.find_first_not_of(" \r") != std::string::npos) last = line;
    return last;
}

}  // namespace

VideoEncoder::VideoEncoder(fs::path target, PictureSize size, double fps) : target_(std::move(target)) {
    if (size.width % 2 != 0 || size.height % 2 != 0)
        throw planet::Error(planet::Fault::bad_usage, "--size",
                            std::to_string(size.width) + "x" + std::to_string(size.height) + " is odd",
                            "even sides for a video");
    const auto program = program_in_path("ffmpeg");
    if (!program)
        throw planet::Error(planet::Fault::bad_usage, "--output",
                            shown(target_.native()) + " takes the program ffmpeg, which is not in PATH",
                            "a video once ffmpeg is installed (apt-get install ffmpeg), or a folder's name for PNGs");
    open_temporary();
    try {
        start(*program, size, fps);
    } catch (...) {
        abandon();
        throw;
    }
}

VideoEncoder::~VideoEncoder() {
    abandon();
}

void VideoEncoder::abandon() noexcept {
    if (process_ > 0) {
        ::kill(process_, SIGKILL);
        wait();
    }
    if (frames_ >= 0) ::close(frames_);
    if (messages_ >= 0) ::close(messages_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

/// Beside the target, with its ending, by which ffmpeg chooses.
void VideoEncoder::open_temporary() {
    std::error_code ignored;
    if (const fs::path real = fs::weakly_canonical(target_, ignored); !ignored && !real.empty()) target_ = real;
    if (const auto status = fs::status(target_, ignored); fs::exists(status) && !fs::is_regular_file(status))
        fail("cannot be written: it is there, and no file");
    for (int attempt = 0; temporary_.empty(); ++attempt) {
        fs::path name = target_.stem();
        name += "." + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part";
        name += target_.extension();
        const fs::path path = target_.parent_path() / name;
        listed_ = TemporaryName(path, [&] {
            const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (file < 0 && errno == EEXIST && attempt < 100) return;
            if (file < 0) fail("cannot be written: " + reason(errno));
            ::close(file);
            temporary_ = path;
        });
    }
}

void VideoEncoder::start(const std::string& program, PictureSize size, double fps) {
    // A failed write says so; the signal would end the program without a word.
    ::signal(SIGPIPE, SIG_IGN);
    int ends[2];
    messages_ = ::memfd_create("ffmpeg", MFD_CLOEXEC);
    if (messages_ < 0 || ::pipe2(ends, O_CLOEXEC) != 0) fail("cannot be written: " + reason(errno));
    frames_ = ends[1];
    ::fcntl(frames_, F_SETPIPE_SZ, 1 << 20);

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, messages_, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);  // here they wait
    // Of another group: Ctrl-C is for this program, which then ends ffmpeg.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);

    std::vector<std::string> words{program, "-hide_banner", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
                                   "-video_size", std::to_string(size.width) + "x" + std::to_string(size.height),
                                   "-framerate", fixed(fps, 6), "-i", "pipe:0", "-an",
                                   // What players take colours for that are not said to be others.
                                   "-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-colorspace",
                                   "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv",
                                   "-fflags", "+bitexact", "-y", temporary_.native()};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const SignalsWait wait;
    const int failed = ::posix_spawn(&process_, program.c_str(), &files, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[0]);
    if (failed != 0) {
        process_ = 0;
        fail("cannot be written: ffmpeg cannot be started: " + reason(failed));
    }
    set_temporary_process(process_);
}

int VideoEncoder::wait() {
    int status = -1;  // it stays so if a signal has come, whose handler ends the process
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    set_temporary_process(0);
    process_ = 0;
    return status;
}

void VideoEncoder::write(long, std::span<const std::uint8_t> rgb) {
    while (!rgb.empty()) {
        const auto written = ::write(frames_, rgb.data(), rgb.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_as_ffmpeg_says();
        rgb = rgb.subspan(static_cast<std::size_t>(written));
    }
}

void VideoEncoder::finish() {
    ::close(std::exchange(frames_, -1));
    if (wait() != 0) fail_as_ffmpeg_says();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written: " + reason(errno));
    temporary_.clear();
    listed_ = {};
}

void VideoEncoder::fail_as_ffmpeg_says() {
    if (frames_ >= 0) ::close(std::exchange(frames_, -1));
    if (process_ > 0) wait();
    const std::string line = last_line(messages_);
    fail("cannot be written: ffmpeg ended with " + (line.empty() ? "no message" : shown(line)));
}

void VideoEncoder::fail(const std::string& why) const {
    throw planet::Error(planet::Fault::bad_usage, "--output", shown(target_.native()) + " " + why,
                        "a video that ffmpeg can write, or a folder's name for PNGs");
}

}  // namespace render
