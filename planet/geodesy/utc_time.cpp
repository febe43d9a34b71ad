#include "planet/geodesy/utc_time.h"

#include <array>
#include <cstdio>
#include <optional>

#include "planet/error.h"

namespace planet {
namespace {

using namespace std::chrono;

constexpr std::string_view accepted =
    "2026-06-21T15:00:00Z, 2026-06-21T15:00Z, 2026-06-21T17:00:00+02:00 or 2026-06-21, years 0001 to 9999";

constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Takes characters off the front of a text.
class Scanner {
  public:
    explicit Scanner(std::string_view text) : rest_(text) {}

    bool at_end() const { return rest_.empty(); }

    /// Takes one character out of `any_of`.
    std::optional<char> take(std::string_view any_of) {
        if (rest_.empty() || any_of.find(rest_[0]) == std::string_view::npos) return std::nullopt;
        const char c = rest_[0];
        rest_.remove_prefix(1);
        return c;
    }

    /// Takes exactly `count` digits, a number in [least, most].
    std::optional<int> number(std::size_t count, int least, int most) {
        if (rest_.size() < count) return std::nullopt;
        int value = 0;
        for (const char c : rest_.substr(0, count)) {
            if (!is_digit(c)) return std::nullopt;
            value = value * 10 + (c - '0');
        }
        rest_.remove_prefix(count);
        if (value < least || value > most) return std::nullopt;
        return value;
    }

    /// Takes 1 to 9 digits behind a decimal sign: whole milliseconds, cut off.
    std::optional<milliseconds> fraction() {
        int value = 0, count = 0;
        for (; count < 10 && !rest_.empty() && is_digit(rest_[0]); ++count, rest_.remove_prefix(1))
            if (count < 3) value = value * 10 + (rest_[0] - '0');
        if (count == 0 || count > 9) return std::nullopt;
        for (; count < 3; ++count) value *= 10;
        return milliseconds(value);
    }

  private:
    std::string_view rest_;
};

std::optional<sys_days> scan_date(Scanner& in) {
    const auto y = in.number(4, 1, 9999);
    if (!y || !in.take("-")) return std::nullopt;
    const auto m = in.number(2, 1, 12);
    if (!m || !in.take("-")) return std::nullopt;
    const auto d = in.number(2, 1, 31);
    if (!d) return std::nullopt;
    const year_month_day date{year(*y), month(static_cast<unsigned>(*m)), day(static_cast<unsigned>(*d))};
    if (!date.ok()) return std::nullopt;
    return sys_days(date);
}

struct TimeOfDay {
    milliseconds since_midnight{};
    bool leap_second = false;
};

std::optional<TimeOfDay> scan_time_of_day(Scanner& in) {
    const auto h = in.number(2, 0, 23);
    if (!h || !in.take(":")) return std::nullopt;
    const auto m = in.number(2, 0, 59);
    if (!m) return std::nullopt;
    TimeOfDay time{hours(*h) + minutes(*m), false};
    if (!in.take(":")) return time;
    const auto s = in.number(2, 0, 60);
    if (!s) return std::nullopt;
    time.since_midnight += seconds(*s);
    time.leap_second = *s == 60;
    if (!in.take(".,")) return time;
    const auto fraction = in.fraction();
    if (!fraction) return std::nullopt;
    time.since_midnight += *fraction;
    return time;
}

/// How far local time is ahead of UTC.
std::optional<minutes> scan_offset(Scanner& in) {
    if (in.take("Zz")) return minutes(0);
    const auto sign = in.take("+-");
    if (!sign) return std::nullopt;
    const auto h = in.number(2, 0, 23);
    if (!h || !in.take(":")) return std::nullopt;
    const auto m = in.number(2, 0, 59);
    if (!m) return std::nullopt;
    const minutes ahead = hours(*h) + minutes(*m);
    return *sign == '-' ? -ahead : ahead;
}

/// Whether a second numbered 60 that carries over to `next` is one where leap seconds are put.
bool may_be_leap_second(UtcTime next) {
    const sys_days today = floor<days>(next);
    if (next - today >= seconds(1)) return false;
    const year_month_day date(today);
    return date.day() == day(1) && (date.month() == January || date.month() == July);
}

std::optional<UtcTime> scan(Scanner in) {
    const auto date = scan_date(in);
    if (!date) return std::nullopt;
    if (in.at_end()) return UtcTime(*date);
    if (!in.take("Tt ")) return std::nullopt;
    const auto time = scan_time_of_day(in);
    if (!time) return std::nullopt;
    const auto offset = scan_offset(in);
    if (!offset || !in.at_end()) return std::nullopt;
    const UtcTime t = UtcTime(*date) + time->since_midnight - *offset;
    if (time->leap_second && !may_be_leap_second(t)) return std::nullopt;
    return t;
}

}  // namespace

UtcTime utc_from_iso8601(std::string_view text, std::string_view where) {
    if (const auto t = scan(Scanner(text))) return *t;
    constexpr std::size_t longest_echo = 64;
    const std::string echo(text.substr(0, longest_echo));
    throw Error(Fault::bad_usage, where, "\"" + echo + "\" is not a time", accepted);
}

std::string iso8601_from_utc(UtcTime t) {
    const sys_days today = floor<days>(t);
    const year_month_day date(today);
    const hh_mm_ss time(t - today);
    std::array<char, 64> text{};
    const auto count = [](auto duration) { return static_cast<int>(duration.count()); };
    int n = std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d", static_cast<int>(date.year()),
                          static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), count(time.hours()),
                          count(time.minutes()), count(time.seconds()));
    std::string result(text.data(), static_cast<std::size_t>(n));
    if (time.subseconds().count() != 0) {
        n = std::snprintf(text.data(), text.size(), ".%03d", count(time.subseconds()));
        result.append(text.data(), static_cast<std::size_t>(n));
    }
    return result + "Z";
}

double days_since_j2000(UtcTime t) {
    constexpr UtcTime j2000 = sys_days(year(2000) / January / 1) + hours(12);
    return duration<double, days::period>(t - j2000).count();
}

double julian_date(UtcTime t) {
    return 2451545.0 + days_since_j2000(t);
}

}  // namespace planet
