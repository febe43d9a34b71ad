#pragma once
// The program run as a user runs it: a process of its own.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/render/app/scratch_folder.h"

namespace render {

struct Outcome {
    int status = -1;  ///< 128 + the signal if it was killed
    std::string out, err;
};

/// Starts the program with these arguments in a folder; its streams go to files outside that folder.
class Process {
  public:
    /// @param prepare runs in the new process before the program: limits, timers, another user
    Process(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
            const std::function<void()>& prepare = {}) {
        std::vector<char*> argv{const_cast<char*>(OCTAGLOBE_PROGRAM)};
        for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        id_ = ::fork();
        if (id_ != 0) return;
        const auto redirect = [](const std::string& path, int stream) {
            const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
            return file >= 0 && ::dup2(file, stream) == stream;
        };
        if (::chdir(folder.c_str()) != 0 || !redirect(out_, STDOUT_FILENO) || !redirect(err_, STDERR_FILENO))
            ::_exit(99);
        if (prepare) prepare();
        ::execv(OCTAGLOBE_PROGRAM, argv.data());
        ::_exit(98);
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;
    ~Process() {
        if (id_ <= 0) return;
        ::kill(id_, SIGKILL);
        wait();
    }

    pid_t id() const { return id_; }
    /// What it has written to standard output until now.
    std::string out_so_far() const { return content(out_); }
    /// Once. The use of resources is that of this process alone.
    Outcome wait(rusage* usage = nullptr) {
        int status = 0;
        ::wait4(std::exchange(id_, 0), &status, 0, usage);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content(out_), content(err_)};
    }

  private:
    ScratchFolder streams_;
    std::string out_ = streams_ / "out", err_ = streams_ / "err";
    pid_t id_ = 0;
};

inline Outcome run(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                   const std::function<void()>& prepare = {}) {
    return Process(folder, arguments, prepare).wait();
}

/// Arguments separated by blanks; '' is an empty one.
inline std::vector<std::string> words(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word == "''" ? "" : word);
    return words;
}

}  // namespace render
