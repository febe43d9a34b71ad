#include "render/layers/font_file.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace render {

namespace {

namespace fs = std::filesystem;

/// What Dear ImGui can read, too: it ends the process on anything else.
bool is_font(const fs::path& file) {
    std::array<unsigned char, 4> magic{};
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(magic.data()), 4)) return false;
    std::error_code failed;
    return magic == std::array<unsigned char, 4>{0, 1, 0, 0} && fs::file_size(file, failed) > 10'000;
}

}  // namespace

std::string find_font() {
    if (const char* named = std::getenv("OCTAGLOBE_FONT"); named != nullptr) return is_font(named) ? named : "";
    for (const char* file :
         {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"})
        if (is_font(file)) return file;
    return {};
}

}  // namespace render
