#include "render/layers/glyphs.h"

#include "planet/elevation/module.h"
#include "planet/error.h"
#include "render/layers/font_file.h"

namespace render {

std::unique_ptr<GlyphSource> open_glyphs() {
    const std::string file = find_font();
    if (file.empty())
        throw planet::Error(planet::Fault::bad_data, "labels", "there is no font",
                            "fonts-dejavu-core, or a TrueType file named by OCTAGLOBE_FONT");
    using Factory = GlyphSource* (*)(const char*);
    void* const symbol = planet::module_symbol("octaglobe_text", "octaglobe_text_1", "drawing labels");
    return std::unique_ptr<GlyphSource>(reinterpret_cast<Factory>(symbol)(file.c_str()));
}

std::u32string characters_of(const std::string& utf8) {
    std::u32string text;
    constexpr char32_t unknown = 0xfffd;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i++]);
        const int more = lead < 0x80 ? 0 : lead >= 0xf0 && lead < 0xf5 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc2 ? 1 : -1;
        if (more < 0 || lead >= 0xf5) {
            text += unknown;
            continue;
        }
        char32_t c = more == 0 ? lead : lead & (0x3fu >> more);
        int read = 0;
        for (; read < more && i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80; ++read)
            c = c << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3f);
        text += read == more ? c : unknown;
    }
    return text;
}

}  // namespace render
