#pragma once
// Golomb-Rice coding of groups of small numbers: what residuals of heights are, level by level.
//
//   group   5 bits: k, then the numbers
//   number  v >> k ones, a zero, and the k low bits of v; or 24 ones and v in 40 bits
//
// Bits are filled from the low end of each byte. k is the one that makes the group shortest. For residuals, which are
// near to Laplacian with a width that halves or so from level to level, this is within a tenth of a bit of their
// entropy (Golomb, "Run-length encodings", 1966; Rice, "Some practical universal noiseless coding techniques", 1979),
// and a number is read in about 2 ns.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/store/byte_stream.h"

namespace planet {

inline constexpr std::uint64_t largest_rice_number = (std::uint64_t{1} << 40) - 1;

/// Appends groups, then fills the last byte with zeros.
class RiceWriter {
  public:
    explicit RiceWriter(ByteWriter& out) : out_(out) {}
    ~RiceWriter();
    RiceWriter(const RiceWriter&) = delete;
    RiceWriter& operator=(const RiceWriter&) = delete;

    /// @param values each at most largest_rice_number
    void group(std::span<const std::uint64_t> values);

  private:
    void bits(std::uint64_t value, int count);

    ByteWriter& out_;
    std::uint64_t held_ = 0;
    int held_bits_ = 0;
};

/// Reads what a RiceWriter wrote; the reader goes on behind it. Throws MalformedBytes at the end of the bytes.
class RiceReader {
  public:
    explicit RiceReader(ByteReader& in);
    ~RiceReader();
    RiceReader(const RiceReader&) = delete;
    RiceReader& operator=(const RiceReader&) = delete;

    void group(std::span<std::uint64_t> values);

  private:
    void refill();
    std::uint64_t bits(int count);

    ByteReader& in_;
    std::span<const std::uint8_t> bytes_;
    std::size_t next_ = 0;
    std::uint64_t held_ = 0;
    int held_bits_ = 0;
};

}  // namespace planet
