#pragma once
// A folder of output files that appears whole or not at all.

#include <filesystem>
#include <optional>
#include <string>

#include "render/app/temporary_names.h"

namespace render {

/// Makes a temporary folder beside the target at once, so that an unwritable place is refused before any work is done;
/// commit() renames it. Without commit() nothing is left behind.
class OutputFolder {
  public:
    /// Throws planet::Error(bad_usage) naming `where` (the option) if the target is there, and not an empty folder, or if
    /// it cannot be made.
    /// @param begun if given, a folder of one that was killed, which is taken instead of a new one
    OutputFolder(std::string where, std::filesystem::path target,
                 const std::optional<std::filesystem::path>& begun = {});
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;
    ~OutputFolder();

    /// The temporary folder of a process that is gone, if one is there.
    static std::optional<std::filesystem::path> left_behind(const std::filesystem::path& target);

    /// Where the files go until commit().
    const std::filesystem::path& path() const { return temporary_; }
    /// Once. Throws as the constructor does.
    void commit();

  private:
    [[noreturn]] void fail(const std::string& why) const;

    std::string where_;
    std::filesystem::path target_, temporary_;
    TemporaryName listed_;
};

}  // namespace render
