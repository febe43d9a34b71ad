#include "render/viewer/module/fonts.h"

#include <imgui.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace render {
namespace {

namespace fs = std::filesystem;

/// What Dear ImGui can read: it ends the process on anything else.
bool is_font(const fs::path& file) {
    std::array<unsigned char, 4> magic{};
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(magic.data()), 4)) return false;
    std::error_code failed;
    return magic == std::array<unsigned char, 4>{0, 1, 0, 0} && fs::file_size(file, failed) > 10'000;
}

std::string find_font() {
    if (const char* named = std::getenv("OCTAGLOBE_FONT"); named != nullptr) return is_font(named) ? named : "";
    for (const char* file :
         {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"})
        if (is_font(file)) return file;
    return {};
}

}  // namespace

Fonts load_fonts(float scale) {
    // Latin with degrees; dashes and primes; arrows.
    static const ImWchar ranges[] = {0x20, 0xff, 0x2010, 0x2033, 0x2190, 0x2193, 0};
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const std::string file = find_font();
    Fonts fonts;
    if (!file.empty()) {
        fonts.text = atlas.AddFontFromFileTTF(file.c_str(), 14 * scale, nullptr, ranges);
        fonts.title = atlas.AddFontFromFileTTF(file.c_str(), 17 * scale, nullptr, ranges);
    }
    if (fonts.text == nullptr || fonts.title == nullptr) {
        ImFontConfig config;
        config.SizePixels = 13 * scale;
        fonts.text = fonts.title = atlas.AddFontDefault(&config);
    }
    return fonts;
}

}  // namespace render
