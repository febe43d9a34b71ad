#pragma once
// A file as memory, read-only.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

namespace render {

class MappedFile {
  public:
    /// Nothing if the file is not there or cannot be mapped.
    static std::optional<MappedFile> open(const std::filesystem::path& path);
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&&) = delete;
    ~MappedFile();

    std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

  private:
    MappedFile(void* data, std::size_t size) : data_(data), size_(size) {}
    void* data_;
    std::size_t size_;
};

}  // namespace render
