#pragma once
// Little-endian bytes in and out; reading past the end is damage, not a crash.

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

namespace planet {

static_assert(std::endian::native == std::endian::little, "tiles are stored little-endian");

/// Thrown by ByteReader and tile decoding; callers turn it into an Error that names the tile.
struct MalformedBytes : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class ByteWriter {
  public:
    void u8(std::uint8_t v) { bytes_.push_back(v); }
    void f32(float v) {
        std::uint8_t b[4];
        std::memcpy(b, &v, 4);
        bytes_.insert(bytes_.end(), b, b + 4);
    }
    /// Seven bits a byte, low ones first.
    void varint(std::uint64_t v) {
        for (; v >= 128; v >>= 7) u8(static_cast<std::uint8_t>(v | 128));
        u8(static_cast<std::uint8_t>(v));
    }
    void raw(std::span<const std::uint8_t> b) { bytes_.insert(bytes_.end(), b.begin(), b.end()); }
    /// Room for `size` more bytes, zeros until they are written; shrink_to() gives back what was not needed of it.
    std::uint8_t* extend(std::size_t size) {
        bytes_.resize(bytes_.size() + size);
        return bytes_.data() + bytes_.size() - size;
    }
    /// @param end in or at the end of what extend() gave last
    void shrink_to(const std::uint8_t* end) { bytes_.resize(static_cast<std::size_t>(end - bytes_.data())); }
    void clear() { bytes_.clear(); }
    const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  private:
    std::vector<std::uint8_t> bytes_;
};

class ByteReader {
  public:
    explicit ByteReader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

    std::uint8_t u8() { return raw(1)[0]; }
    float f32() {
        float v;
        std::memcpy(&v, raw(4).data(), 4);
        return v;
    }
    std::uint64_t varint() {
        std::uint64_t v = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const std::uint8_t b = u8();
            v |= static_cast<std::uint64_t>(b & 127) << shift;
            if (b < 128) return v;
        }
        throw MalformedBytes("a number does not end");
    }
    std::span<const std::uint8_t> raw(std::size_t size) {
        if (left_.size() < size) throw MalformedBytes("it ends early");
        const auto taken = left_.first(size);
        left_ = left_.subspan(size);
        return taken;
    }
    std::span<const std::uint8_t> left() const { return left_; }
    /// @param size at most what is left
    void skip(std::size_t size) { left_ = left_.subspan(size); }
    bool at_end() const { return left_.empty(); }

  private:
    std::span<const std::uint8_t> left_;
};

/// Signed to unsigned with small magnitudes small: 0, -1, 1, -2 ... to 0, 1, 2, 3 ...
constexpr std::uint64_t zigzag(std::int64_t v) {
    return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t v) {
    return static_cast<std::int64_t>(v >> 1) ^ -static_cast<std::int64_t>(v & 1);
}

}  // namespace planet
