#pragma once
// Lines, words and numbers of a text in memory.

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace planet {

constexpr bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// Takes the next word off the front; empty at the end.
inline std::string_view take_word(std::string_view& text) {
    std::size_t begin = 0;
    while (begin < text.size() && is_blank(text[begin])) ++begin;
    std::size_t end = begin;
    while (end < text.size() && !is_blank(text[end])) ++end;
    const std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    return word;
}

/// Takes the next line off the front, without its end, which may be \n or \r\n.
inline std::string_view take_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

/// Without blanks at either end.
inline std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// At most 40 characters of what a file holds, for a message.
inline std::string shown_word(std::string_view word) {
    std::string shown(word.substr(0, 40));
    for (char& c : shown)
        if (c < ' ' || c > '~') c = '?';
    return shown;
}

/// The whole word as a number; a plus sign may precede it.
template <class Number>
std::optional<Number> number_from(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    Number value{};
    const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failed != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

/// The shortest digits that read back to the same bits, at most 24 characters. Returns their end.
inline char* put_number(char* at, double value) {
    return std::to_chars(at, at + 24, value).ptr;
}

inline std::string text_of(double value) {
    char digits[24];
    return {digits, put_number(digits, value)};
}

}  // namespace planet
