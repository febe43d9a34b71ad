#pragma once
// An output file that appears whole or not at all.

#include <filesystem>
#include <string>
#include <string_view>

#include "render/app/temporary_names.h"

namespace render {

/// Opens a temporary file beside the target at once, so that an unwritable target is refused before any work is done;
/// commit() renames it over the target. A link is followed: what it points to is replaced. A target that is no regular
/// file (a pipe, /dev/stdout) cannot be replaced and is written in place. Without commit() nothing is left behind.
class OutputFile {
  public:
    /// Throws planet::Error(bad_usage) naming `where` (the option) if the file cannot be written.
    /// @param known_as what messages call it, if not the target: where it will be in the end
    OutputFile(std::string where, std::filesystem::path target, std::filesystem::path known_as = {});
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();

    /// Writes bytes behind those before. Throws planet::Error(bad_usage), leaving the old file untouched, if they cannot
    /// all be written.
    void append(std::string_view bytes);
    /// Once, with the last bytes. Throws as append() does.
    void commit(std::string_view bytes = {});

    /// Where the bytes are until commit(), to be read again; empty where the target is written in place.
    const std::filesystem::path& temporary() const { return temporary_; }

  private:
    [[noreturn]] void fail(int error) const;
    void abandon() noexcept;

    std::string where_;
    std::filesystem::path target_, known_as_;
    std::filesystem::path temporary_;  ///< empty when the target is written in place
    TemporaryName listed_;
    int descriptor_ = -1;
};

}  // namespace render
