#pragma once
// What must not be left behind if a signal ends the program: Ctrl-C, a closed terminal, kill.

#include <signal.h>
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

namespace render {

/// While one lives, a signal that would end the program waits, at most 2 s; after such a signal none begins. So what is
/// made and listed by it is either removed or not made. For moments.
class SignalsWait {
  public:
    SignalsWait();
    SignalsWait(const SignalsWait&) = delete;
    SignalsWait& operator=(const SignalsWait&) = delete;
    ~SignalsWait();

  private:
    sigset_t before_;
};

/// The name of a temporary file, or of a folder without folders in it, listed until this goes. A signal that ends the
/// program first removes what is listed. There is room for 16; what is beyond, and names of 4096 bytes and more, are
/// not removed.
class TemporaryName {
  public:
    TemporaryName() = default;
    /// @param make makes what has that name, while signals wait; what it throws comes out, and nothing is listed
    TemporaryName(const std::filesystem::path& path, const std::function<void()>& make);
    TemporaryName(TemporaryName&& other) noexcept : slot_(std::exchange(other.slot_, -1)) {}
    TemporaryName& operator=(TemporaryName&& other) noexcept {
        std::swap(slot_, other.slot_);
        return *this;
    }
    ~TemporaryName();

  private:
    int slot_ = -1;
};

/// The same for what makes files itself and keeps what it is handed until they are whole: planet::MakeFile.
std::shared_ptr<void> make_listed(const std::filesystem::path& path, const std::function<void()>& make);

/// The same for one process that writes such a file: it is ended before. 0: none. While signals wait.
void set_temporary_process(pid_t id);

}  // namespace render
