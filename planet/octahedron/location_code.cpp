#include "planet/octahedron/location_code.h"

namespace planet {

std::string to_string(LocationCode cell) {
    const int f = cell.face();
    std::string text = f < 4 ? "N" : "S";
    text += static_cast<char>('0' + (f & 3));
    const int d = cell.bisection_level();
    if (d > 0) text += '.';
    for (int i = d - 1; i >= 0; --i) text += static_cast<char>('0' + (cell.bits() >> i & 1));
    return text;
}

std::optional<LocationCode> parse_code(std::string_view text) {
    if (text.size() < 2 || (text[0] != 'N' && text[0] != 'S') || text[1] < '0' || text[1] > '3') return std::nullopt;
    LocationCode cell = LocationCode::face_root((text[0] == 'S' ? 4 : 0) + (text[1] - '0'));
    if (text.size() == 2) return cell;
    if (text[2] != '.' || text.size() == 3 || text.size() > 3 + max_bisection_level) return std::nullopt;
    for (const char c : text.substr(3)) {
        if (c != '0' && c != '1') return std::nullopt;
        cell = cell.child(c - '0');
    }
    return cell;
}

}  // namespace planet
