#pragma once
// The program run as a user runs it: a process of its own.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/render/app/scratch_folder.h"

namespace render {

struct Outcome {
    int status = -1;  ///< 128 + the signal if it was killed
    std::string out, err;
};

/// Runs the program with these arguments in a folder; its streams go to files outside that folder.
inline Outcome run(const std::filesystem::path& folder, const std::vector<std::string>& arguments) {
    const ScratchFolder streams;
    const std::string out = streams / "out", err = streams / "err";
    std::vector<char*> argv{const_cast<char*>(OCTAGLOBE_PROGRAM)};
    for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child == 0) {
        const auto redirect = [](const std::string& path, int stream) {
            const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
            return file >= 0 && ::dup2(file, stream) == stream;
        };
        if (::chdir(folder.c_str()) != 0 || !redirect(out, STDOUT_FILENO) || !redirect(err, STDERR_FILENO)) ::_exit(99);
        ::execv(OCTAGLOBE_PROGRAM, argv.data());
        ::_exit(98);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content(out), content(err)};
}

/// Arguments separated by blanks; '' is an empty one.
inline std::vector<std::string> words(const std::string& line) {
    std::vector<std::string> words;
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word == "''" ? "" : word);
    return words;
}

}  // namespace render
