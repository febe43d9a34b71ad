#pragma once
// SHA-256 of files, remembered.
//
// Names of caches are made of checksums of sources, so every start of the program needs those of all its sources.
// Reading 25 MB for that costs 17 ms, and 100 ms on a processor without SHA instructions; so a checksum that was
// computed once is kept with what stat() says of the file, as git does for its index. It is used while device, inode,
// size, time of modification and time of change (which a program cannot set) are all the same, and kept only if both
// times are over two seconds old when reading starts: a later change of the file then always shows.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace render {

/// Checksums that are kept in one file, 2 microseconds each once known. Several processes may use the same file: the
/// last to end wins, and what is lost is computed again.
class ChecksumIndex {
  public:
    /// @param file where the checksums are kept; nothing: every checksum is computed. A file that is missing or damaged
    ///             is taken as empty, and one that cannot be written is not an error.
    explicit ChecksumIndex(std::optional<std::filesystem::path> file);

    /// Of the file's content, 64 lower-case hexadecimal digits. Throws planet::Error(bad_data) if it cannot be read or
    /// is not a regular file.
    std::string sha256(const std::filesystem::path& path);

    /// Writes what is new. At most 1000 files are remembered, the latest ones.
    void save() noexcept;

    int computed() const noexcept { return computed_; }  ///< how many files had to be read so far

  private:
    std::optional<std::filesystem::path> file_;
    std::vector<std::pair<std::string, std::string>>
        known_;  ///< stamp (what stat says, and path) -> checksum; oldest first
    bool changed_ = false;
    int computed_ = 0;
};

/// The index in the user's cache folder.
ChecksumIndex user_checksum_index();

}  // namespace render
