#pragma once
// Small pieces gathered into large blocks for a sink.

#include <cassert>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>
#include <type_traits>

#include "planet/exporters/mesh_file.h"

namespace planet {

/// flush() at the end is the caller's.
class BlockWriter {
  public:
    static constexpr std::size_t capacity = std::size_t{1} << 20;

    explicit BlockWriter(const ByteSink& sink)
        : sink_(sink), block_(std::make_unique_for_overwrite<char[]>(capacity)), end_(block_.get()) {}

    /// Where the next `size` bytes go, at most the capacity; taken() says where they end.
    char* room(std::size_t size) {
        assert(size <= capacity);
        if (static_cast<std::size_t>(block_.get() + capacity - end_) < size) flush();
        return end_;
    }
    void taken(char* end) { end_ = end; }

    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        std::memcpy(room(sizeof value), &value, sizeof value);
        end_ += sizeof value;
    }
    /// Of any length, and not copied if it is long.
    void put_bytes(std::string_view bytes) {
        if (bytes.size() > capacity) {
            flush();
            sink_(bytes);
            return;
        }
        std::memcpy(room(bytes.size()), bytes.data(), bytes.size());
        end_ += bytes.size();
    }
    void flush() {
        if (end_ != block_.get()) sink_({block_.get(), static_cast<std::size_t>(end_ - block_.get())});
        end_ = block_.get();
    }

  private:
    const ByteSink& sink_;
    std::unique_ptr<char[]> block_;
    char* end_;
};

/// The bytes of an array.
template <class Array>
std::string_view bytes_of(const Array& array) {
    return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof array[0]};
}

}  // namespace planet
