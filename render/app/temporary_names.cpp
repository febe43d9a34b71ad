#include "render/app/temporary_names.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>

namespace render {

namespace {

// A slot is taken, then filled: the handler sees a whole name or none.
struct Slot {
    std::atomic<bool> taken = false, listed = false;
    std::array<char, 4096> path{};
};
std::array<Slot, 16> slots;
std::atomic<pid_t> process = 0;
std::atomic<int> being_made = 0;  // SignalsWait
std::atomic<bool> ending = false;
constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};

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

void wait_for_what_is_being_made() {
    constexpr timespec moment{0, 1'000'000};
    for (int i = 0; being_made > 0 && i < 2000; ++i) ::nanosleep(&moment, nullptr);
}

extern "C" void remove_temporaries(int signal_number) {
    ending = true;
    wait_for_what_is_being_made();
    if (const pid_t id = process; id > 0) {
        ::kill(id, SIGKILL);
        ::waitpid(id, nullptr, 0);  // or it could still make its file
    }
    for (Slot& each : slots)
        if (each.listed) remove_path(each.path.data());
    ::signal(signal_number, SIG_DFL);
    ::raise(signal_number);
}

sigset_t set_of_ending_signals() {
    sigset_t set;
    ::sigemptyset(&set);
    for (const int number : ending_signals) ::sigaddset(&set, number);
    return set;
}

void catch_signals() {
    for (const int number : ending_signals) {
        struct sigaction action {};
        if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;  // nohup
        action.sa_handler = remove_temporaries;
        action.sa_mask = set_of_ending_signals();
        ::sigaction(number, &action, nullptr);
    }
}

}  // namespace

SignalsWait::SignalsWait() {
    // The handler must not run in this thread, which it would wait for.
    const sigset_t blocked = set_of_ending_signals();
    ::pthread_sigmask(SIG_BLOCK, &blocked, &before_);
    ++being_made;
    if (!ending) return;
    --being_made;
    for (;;) ::pause();  // the program ends
}

SignalsWait::~SignalsWait() {
    --being_made;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

TemporaryName::TemporaryName(const std::filesystem::path& path, const std::function<void()>& make) {
    static const bool caught = (catch_signals(), true);
    static_cast<void>(caught);
    const std::string name = std::filesystem::absolute(path).native();
    const SignalsWait wait;
    make();
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

std::shared_ptr<void> make_listed(const std::filesystem::path& path, const std::function<void()>& make) {
    return std::make_shared<TemporaryName>(path, make);
}

void set_temporary_process(pid_t id) {
    process = id;
}

}  // namespace render
