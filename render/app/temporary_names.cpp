#include "render/app/temporary_names.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

namespace render {

namespace {

// A slot is taken, then filled: the handler sees a whole name or none.
struct Slot {
    std::atomic<bool> taken = false, listed = false;
    std::array<char, 4096> path{};
};
std::array<Slot, 16> slots;
std::atomic<pid_t> process = 0;

// From here to catch_signals() only what a signal handler may call: readdir is not.

/// As the kernel writes it: man 2 getdents64.
struct DirectoryEntry {
    std::uint64_t inode;
    std::int64_t offset;
    unsigned short length;
    unsigned char type;
    char name[1];
};

void empty_folder(int folder) {
    alignas(DirectoryEntry) char buffer[4096];
    for (long bytes; (bytes = ::syscall(SYS_getdents64, folder, buffer, sizeof buffer)) > 0;)
        for (long at = 0; at < bytes;) {
            const auto* entry = reinterpret_cast<const DirectoryEntry*>(buffer + at);
            ::unlinkat(folder, entry->name, 0);  // fails for . and ..
            at += entry->length;
        }
}

void remove_path(const char* path) {
    // Another thread may put a file into the folder meanwhile.
    for (int attempt = 0; attempt < 100; ++attempt) {
        if (::unlink(path) == 0) return;
        const int folder = ::open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (folder < 0) return;
        empty_folder(folder);
        ::close(folder);
        if (::rmdir(path) == 0) return;
    }
}

extern "C" void remove_temporaries(int signal_number) {
    if (const pid_t id = process; id > 0) ::kill(id, SIGKILL);
    for (Slot& each : slots)
        if (each.listed) remove_path(each.path.data());
    ::signal(signal_number, SIG_DFL);
    ::raise(signal_number);
}

void catch_signals() {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action {};
        if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;  // nohup
        action.sa_handler = remove_temporaries;
        ::sigaction(number, &action, nullptr);
    }
}

}  // namespace

TemporaryName::TemporaryName(const std::filesystem::path& path) {
    static const bool caught = (catch_signals(), true);
    static_cast<void>(caught);
    const std::string name = std::filesystem::absolute(path).native();
    for (std::size_t i = 0; i < slots.size(); ++i) {
        Slot& slot = slots[i];
        if (name.size() >= slot.path.size() || slot.taken.exchange(true)) continue;
        name.copy(slot.path.data(), name.size());
        slot.path[name.size()] = 0;
        slot.listed = true;
        slot_ = static_cast<int>(i);
        return;
    }
}

TemporaryName::~TemporaryName() {
    if (slot_ < 0) return;
    Slot& slot = slots[static_cast<std::size_t>(slot_)];
    slot.listed = false;
    slot.taken = false;
}

void set_temporary_process(pid_t id) {
    process = id;
}

}  // namespace render
