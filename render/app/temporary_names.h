#pragma once
// What must not be left behind if a signal ends the program: Ctrl-C, a closed terminal, kill.

#include <sys/types.h>

#include <filesystem>
#include <utility>

namespace render {

/// The name of a temporary file, or of a folder without folders in it, listed until this goes. A signal that ends the
/// program first removes what is listed. There is room for 16; what is beyond, and names of 4096 bytes and more, are
/// not removed.
class TemporaryName {
  public:
    TemporaryName() = default;
    explicit TemporaryName(const std::filesystem::path& path);
    TemporaryName(TemporaryName&& other) noexcept : slot_(std::exchange(other.slot_, -1)) {}
    TemporaryName& operator=(TemporaryName&& other) noexcept {
        std::swap(slot_, other.slot_);
        return *this;
    }
    ~TemporaryName();

  private:
    int slot_ = -1;
};

/// The same for one process that writes such a file: it is killed before. 0: none.
void set_temporary_process(pid_t id);

}  // namespace render
