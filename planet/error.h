#pragma once
// The one exception type of the project. Misuse by the programmer is an assert; "no answer" is std::optional.

#include <stdexcept>
#include <string>
#include <string_view>

namespace planet {

/// What was at fault. The values are the exit status of the program.
enum class Fault {
    check_failed = 1,  ///< a bound or a check did not hold
    bad_usage = 2,     ///< a parameter outside its range
    bad_data = 3,      ///< a file that is missing, damaged or not what it should be
    no_graphics = 4,   ///< no usable OpenGL
};

/// Bad data or a bad parameter. what() is one line: "WHERE: WHAT; accepted: ACCEPTED".
class Error : public std::runtime_error {
  public:
    /// @param where    the file, line, byte or parameter, e.g. "dem.tif" or "--size"
    /// @param what     what is wrong, with the value, e.g. "70000x70000 is too large"
    /// @param accepted what would be accepted, e.g. "1x1 to 65535x65535"; may be empty
    Error(Fault fault, std::string_view where, std::string_view what, std::string_view accepted = {})
        : std::runtime_error(line(where, what, accepted)), fault_(fault) {}

    Fault fault() const noexcept { return fault_; }

  private:
    static std::string line(std::string_view where, std::string_view what, std::string_view accepted) {
        std::string text;
        text.append(where).append(": ").append(what);
        if (!accepted.empty()) text.append("; accepted: ").append(accepted);
        for (char& c : text)
            if (c == '\n' || c == '\r') c = ' ';
        return text;
    }

    Fault fault_;
};

}  // namespace planet
