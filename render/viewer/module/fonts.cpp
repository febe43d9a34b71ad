#include "render/viewer/module/fonts.h"

#include <imgui.h>

#include <string>

#include "render/layers/font_file.h"

namespace render {
Fonts load_fonts(float scale) {
    // Latin with degrees; dashes and primes; arrows.
    static const ImWchar ranges[] = {0x20, 0xff, 0x2010, 0x2033, 0x2190, 0x2193, 0};
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const std::string file = find_font();
    Fonts fonts;
    if (!file.empty()) {
        fonts.text = atlas.AddFontFromFileTTF(file.c_str(), 14 * scale, nullptr, ranges);
        fonts.small = atlas.AddFontFromFileTTF(file.c_str(), 12 * scale, nullptr, ranges);
        fonts.title = atlas.AddFontFromFileTTF(file.c_str(), 17 * scale, nullptr, ranges);
    }
    if (fonts.text == nullptr || fonts.small == nullptr || fonts.title == nullptr) {
        ImFontConfig config;
        config.SizePixels = 13 * scale;
        fonts.text = fonts.small = fonts.title = atlas.AddFontDefault(&config);
    }
    return fonts;
}

}  // namespace render
