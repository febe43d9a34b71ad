#include <fstream>

#include "planet/elevation/sha256.h"
#include "planet/error.h"
#include "render/app/check/check_parts.h"
#include "render/app/data_path.h"

namespace render {
namespace {

namespace fs = std::filesystem;

/// One line of sha256sum's output, "DIGEST  NAME".
planet::CheckRow check_line(const fs::path& sums, const std::string& line, std::size_t number) {
    constexpr std::size_t digits = 64;
    if (line.size() < digits + 3 || line.find_first_not_of("0123456789abcdef") != digits || line[digits] != ' ')
        throw planet::Error(planet::Fault::bad_data, sums.native() + ":" + std::to_string(number), "is no checksum",
                            "64 hexadecimal digits, two blanks, a file name");
    const std::string name = line.substr(digits + 2);
    const fs::path file = sums.parent_path() / name;
    std::string fault;
    std::error_code failure;
    if (!fs::is_regular_file(file, failure))
        fault = ": missing";
    else if (planet::sha256_of_file(file.native()) != line.substr(0, digits))
        fault = ": not what was shipped";
    return planet::check_row("checksum of " + name + fault, fault.empty() ? 0 : 1, 0, "file");
}

}  // namespace

CheckPart check_data_files() {
    const fs::path sums = data_file("SHA256SUMS");
    std::ifstream in(sums);
    CheckPart part;
    auto& rows = part.rows;
    for (std::string line; std::getline(in, line);) rows.push_back(check_line(sums, line, rows.size() + 1));
    if (rows.empty())
        throw planet::Error(planet::Fault::bad_data, sums.native(), "names no file", "the output of sha256sum");
    return part;
}

}  // namespace render
