#pragma once
// Numbers for people.

#include <cstddef>
#include <string>

namespace render {

/// "12 345"
std::string grouped(std::size_t number);
/// "19.84": a number >= 0, at most four digits that count, the last one rounded up: "at most" stays true.
std::string four_digits(double number);
/// The shortest text that reads back to the same bits.
std::string exact(double value);
/// With so many decimals; no "-0.0".
std::string fixed(double value, int decimals);
/// "812 bytes", "4.8 MB", "1.2 GB": of 1000.
std::string bytes_text(std::size_t bytes);

}  // namespace render
