#include "planet/store/rice_code.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace planet {

namespace {

constexpr int most_ones = 24, long_bits = 32, most_low_bits = 31;

constexpr std::uint64_t low_mask(int count) {
    return (std::uint64_t{1} << count) - 1;
}

// The length of a group in bits, header not counted.
std::uint64_t length(std::span<const std::uint32_t> values, int k) {
    std::uint64_t sum = 0;
    const auto low = static_cast<std::uint32_t>(k + 1);
    for (const std::uint32_t v : values) {
        const std::uint32_t ones = v >> k;
        sum += ones < most_ones ? ones + low : most_ones + long_bits;
    }
    return sum;
}

// Lengths fall towards the best k and rise beyond it: the search goes downhill from near the mean's logarithm.
int best_low_bits(std::span<const std::uint32_t> values, std::uint64_t& least) {
    std::uint64_t sum = 0;
    for (const std::uint32_t v : values) sum += v;
    const std::uint64_t mean = values.empty() ? 0 : sum / values.size();
    int k = std::clamp(static_cast<int>(std::bit_width(mean)) - 1, 0, most_low_bits);
    least = length(values, k);
    for (const int step : {-1, 1})
        for (int next = k + step; next >= 0 && next <= most_low_bits; next += step) {
            const std::uint64_t there = length(values, next);
            if (there >= least) break;
            least = there;
            k = next;
        }
    return k;
}

}  // namespace

RiceWriter::~RiceWriter() {
    if (held_bits_ > 0) out_.u8(static_cast<std::uint8_t>(held_));
}

void RiceWriter::group(std::span<const std::uint32_t> values) {
    std::uint64_t length = 0;
    const int k = best_low_bits(values, length);
    std::uint64_t held = held_;
    int held_bits = held_bits_;
    // A store writes eight bytes of which the first ones count.
    std::uint8_t* const begin = out_.extend((static_cast<std::uint64_t>(held_bits) + 5 + length) / 8 + 8);
    std::uint8_t* to = begin;
    const auto put = [&](std::uint64_t word, int count) {
        held |= word << held_bits;
        held_bits += count;
        std::memcpy(to, &held, 8);
        to += held_bits >> 3;
        held >>= held_bits & ~7;
        held_bits &= 7;
    };
    put(static_cast<std::uint64_t>(k), 5);
    for (const std::uint32_t v : values) {
        const auto ones = static_cast<int>(std::min<std::uint32_t>(v >> k, most_ones));
        if (ones < most_ones)
            put(low_mask(ones) | (v & low_mask(k)) << (ones + 1), ones + 1 + k);
        else
            put(low_mask(most_ones) | static_cast<std::uint64_t>(v) << most_ones, most_ones + long_bits);
    }
    out_.shrink_to(to);
    held_ = held;
    held_bits_ = held_bits;
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

void RiceReader::group(std::span<std::uint32_t> values) {
    const auto k = static_cast<int>(bits(5));
    std::uint32_t* out = values.data();
    std::uint32_t* const end = out + values.size();
    // Far from the end of the bytes no number needs a check: it is in the 56 bits that are there after a refill.
    while (out != end && bytes_.size() - next_ >= 8) {
        std::uint64_t word;
        std::memcpy(&word, bytes_.data() + next_, 8);
        std::uint64_t held = held_ | word << held_bits_;
        next_ += static_cast<std::size_t>((63 - held_bits_) >> 3);
        int left = held_bits_ | 56;
        for (; out != end; ++out) {
            const int ones = std::countr_one(held);
            const int used = ones < most_ones ? ones + 1 + k : most_ones + long_bits;
            if (used > left) break;
            *out = ones < most_ones ? static_cast<std::uint32_t>(ones) << k |
                                          static_cast<std::uint32_t>(held >> (ones + 1) & low_mask(k))
                                    : static_cast<std::uint32_t>(held >> most_ones);
            held >>= used;
            left -= used;
        }
        held_ = held;
        held_bits_ = left;
    }
    for (; out != end; ++out) {
        if (held_bits_ < 56) refill();
        const int ones = std::min(std::countr_one(held_), most_ones);
        const int used = ones + (ones < most_ones ? 1 : 0);
        if (held_bits_ < used) throw MalformedBytes("it ends early");
        held_ >>= used;
        held_bits_ -= used;
        *out = ones < most_ones ? static_cast<std::uint32_t>(ones) << k | static_cast<std::uint32_t>(bits(k))
                                : static_cast<std::uint32_t>(bits(long_bits));
    }
}

}  // namespace planet
