#pragma once
// Golomb-Rice coding of groups of small numbers: what residuals of heights are, level by level.
//
//   group   5 bits: k, then the numbers
//   number  v >> k ones, a zero, and the k low bits of v; or 24 ones and v in 32 bits
//
// Bits are filled from the low end of each byte. k is the one that makes the group shortest. For residuals, which are
// near to Laplacian with a width that halves or so from level to level, this is within a tenth of a bit of their
// entropy (Golomb, "Run-length encodings", 1966; Rice, "Some practical universal noiseless coding techniques", 1979),
// and a number is written and read in about 2 ns: no number takes more than 56 bits, so each is one store or load of
// eight bytes.

#include <cstdint>
#include <span>
#include <vector>

#include "planet/store/byte_stream.h"

namespace planet {

/// Appends groups, then fills the last byte with zeros.
class RiceWriter {
  public:
    explicit RiceWriter(ByteWriter& out) : out_(out) {}
    ~RiceWriter();
    RiceWriter(const RiceWriter&) = delete;
    RiceWriter& operator=(const RiceWriter&) = delete;

    void group(std::span<const std::uint32_t> values);

  private:
    ByteWriter& out_;
    std::uint64_t held_ = 0;  // fewer than 8 bits between groups
    int held_bits_ = 0;
};

/// Reads what a RiceWriter wrote; the reader goes on behind it. Throws MalformedBytes at the end of the bytes.
class RiceReader {
  public:
    explicit RiceReader(ByteReader& in);
    ~RiceReader();
    RiceReader(const RiceReader&) = delete;
    RiceReader& operator=(const RiceReader&) = delete;

    void group(std::span<std::uint32_t> values);

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
