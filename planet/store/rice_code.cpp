#include "planet/store/rice_code.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace planet {

namespace {

constexpr int most_ones = 24, long_bits = 40, most_low_bits = 31;

// The length of a group in bits, header not counted.
std::uint64_t length(std::span<const std::uint64_t> values, int k) {
    std::uint64_t sum = 0;
    for (const std::uint64_t v : values) {
        const std::uint64_t ones = v >> k;
        sum += ones < most_ones ? ones + 1 + static_cast<std::uint64_t>(k) : most_ones + long_bits;
    }
    return sum;
}

constexpr std::uint64_t low_mask(int count) {
    return (std::uint64_t{1} << count) - 1;
}

}  // namespace

void RiceWriter::bits(std::uint64_t value, int count) {
    assert(count <= long_bits && value <= low_mask(count));
    held_ |= value << held_bits_;
    held_bits_ += count;
    while (held_bits_ >= 8) {
        out_.u8(static_cast<std::uint8_t>(held_));
        held_ >>= 8;
        held_bits_ -= 8;
    }
}

RiceWriter::~RiceWriter() {
    if (held_bits_ > 0) out_.u8(static_cast<std::uint8_t>(held_));
}

void RiceWriter::group(std::span<const std::uint64_t> values) {
    int best = 0;
    for (int k = 1; k <= most_low_bits; ++k)
        if (length(values, k) < length(values, best)) best = k;
    bits(static_cast<std::uint64_t>(best), 5);
    for (const std::uint64_t v : values) {
        assert(v <= largest_rice_number);
        const std::uint64_t ones = v >> best;
        if (ones < most_ones) {
            bits(low_mask(static_cast<int>(ones)), static_cast<int>(ones) + 1);
            bits(v & low_mask(best), best);
        } else {
            bits(low_mask(most_ones), most_ones);
            bits(v, long_bits);
        }
    }
}

RiceReader::RiceReader(ByteReader& in) : in_(in), bytes_(in.left()) {}

RiceReader::~RiceReader() {
    // Whole bytes that were held but not used go back.
    in_.skip(next_ - static_cast<std::size_t>(held_bits_ / 8));
}

void RiceReader::refill() {
    if (bytes_.size() - next_ >= 8) {
        std::uint64_t word;
        std::memcpy(&word, bytes_.data() + next_, 8);
        held_ |= word << held_bits_;
        next_ += static_cast<std::size_t>((63 - held_bits_) >> 3);
        held_bits_ |= 56;
        return;
    }
    for (; held_bits_ <= 56 && next_ < bytes_.size(); held_bits_ += 8)
        held_ |= static_cast<std::uint64_t>(bytes_[next_++]) << held_bits_;
}

std::uint64_t RiceReader::bits(int count) {
    if (held_bits_ < count) refill();
    if (held_bits_ < count) throw MalformedBytes("it ends early");
    const std::uint64_t value = held_ & low_mask(count);
    held_ >>= count;
    held_bits_ -= count;
    return value;
}

void RiceReader::group(std::span<std::uint64_t> values) {
    const auto k = static_cast<int>(bits(5));
    for (std::uint64_t& v : values) {
        if (held_bits_ < 56) refill();
        const int ones = std::min(std::countr_one(held_), most_ones);
        const int used = ones + (ones < most_ones ? 1 : 0);
        if (held_bits_ < used) throw MalformedBytes("it ends early");
        held_ >>= used;
        held_bits_ -= used;
        v = ones < most_ones ? static_cast<std::uint64_t>(ones) << k | bits(k) : bits(long_bits);
    }
}

}  // namespace planet
