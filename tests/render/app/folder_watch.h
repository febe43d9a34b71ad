#pragma once
// Moments of a process by what it does in a folder.

#include <poll.h>
#include <sys/inotify.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>

#include "tests/render/app/program_process.h"

namespace render {

/// What happens in a folder.
class FolderWatch {
  public:
    explicit FolderWatch(const std::filesystem::path& folder) : watch_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
        ::inotify_add_watch(watch_, folder.c_str(),
                            IN_CREATE | IN_MODIFY | IN_DELETE | IN_MOVED_TO | IN_CLOSE_WRITE | IN_CLOSE_NOWRITE);
    }
    ~FolderWatch() { ::close(watch_); }
    FolderWatch(const FolderWatch&) = delete;
    FolderWatch& operator=(const FolderWatch&) = delete;

    /// Waits for the n-th event of a process, or its end. @return how many there were
    int wait_for(int n, const Process& process) {
        const int ended = static_cast<int>(::syscall(SYS_pidfd_open, process.id(), 0));
        int events = 0;
        for (bool running = true; running && events < n;) {
            std::array<pollfd, 2> ready{{{watch_, POLLIN, 0}, {ended, POLLIN, 0}}};
            ::poll(ready.data(), ready.size(), -1);
            running = ready[1].revents == 0;
            alignas(inotify_event) std::array<char, 4096> bytes{};
            for (ssize_t length; events < n && (length = ::read(watch_, bytes.data(), bytes.size())) > 0;)
                for (ssize_t at = 0; at < length; ++events)
                    at += static_cast<ssize_t>(sizeof(inotify_event) +
                                               reinterpret_cast<const inotify_event*>(bytes.data() + at)->len);
        }
        ::close(ended);
        return events;
    }

  private:
    int watch_;
};

}  // namespace render
