#include "planet/exporters/ply_header.h"

#include <algorithm>
#include <array>

#include "planet/exporters/reference_text.h"
#include "planet/exporters/text_words.h"
#include "planet/store/byte_stream.h"

namespace planet {
namespace {

struct TypeName {
    std::string_view name, other_name;
    std::size_t size;
};
constexpr std::array<TypeName, 8> types{{{"char", "int8", 1},
                                         {"uchar", "uint8", 1},
                                         {"short", "int16", 2},
                                         {"ushort", "uint16", 2},
                                         {"int", "int32", 4},
                                         {"uint", "uint32", 4},
                                         {"float", "float32", 4},
                                         {"double", "float64", 8}}};  // as in PlyType

PlyType type_from(std::string_view name) {
    const auto found = std::find_if(types.begin(), types.end(),
                                    [&](const TypeName& t) { return name == t.name || name == t.other_name; });
    if (found == types.end()) throw MalformedBytes("its header has an unknown type, " + shown_word(name));
    return static_cast<PlyType>(found - types.begin());
}

PlyEncoding encoding_from(std::string_view name) {
    if (name == "ascii") return PlyEncoding::ascii;
    if (name == "binary_little_endian") return PlyEncoding::little_endian;
    if (name == "binary_big_endian") return PlyEncoding::big_endian;
    throw MalformedBytes("its header has an unknown format, " + shown_word(name));
}

PlyProperty property_from(std::string_view words) {
    PlyProperty property;
    std::string_view type = take_word(words);
    if (type == "list") {
        property.is_list = true;
        property.count_type = type_from(take_word(words));
        type = take_word(words);
    }
    property.type = type_from(type);
    property.name = take_word(words);
    return property;
}

PlyElement element_from(std::string_view words) {
    PlyElement element;
    element.name = take_word(words);
    const auto count = number_from<std::uint64_t>(take_word(words));
    if (!count) throw MalformedBytes("its header has an element without a number");
    element.count = *count;
    return element;
}

}  // namespace

std::size_t size_of(PlyType type) {
    return types[static_cast<std::size_t>(type)].size;
}

std::size_t PlyElement::least_size(bool ascii) const {
    std::size_t size = 0;
    for (const PlyProperty& p : properties) size += ascii ? 1 : size_of(p.is_list ? p.count_type : p.type);
    return size;
}

PlyHeader take_ply_header(std::string_view& file) {
    PlyHeader header;
    if (take_line(file) != "ply") throw MalformedBytes("is not a PLY file");
    bool has_format = false;
    while (!file.empty()) {
        std::string_view line = take_line(file);
        const std::string_view key = take_word(line);
        if (key == "end_header") {
            if (!has_format) throw MalformedBytes("its header names no format");
            return header;
        }
        if (key == "format") {
            header.encoding = encoding_from(take_word(line));
            has_format = true;
        }
        if (key == "comment") read_reference_line(line, header.reference);
        if (key == "element") header.elements.push_back(element_from(line));
        if (key == "property") {
            if (header.elements.empty()) throw MalformedBytes("its header has a property of no element");
            header.elements.back().properties.push_back(property_from(line));
        }
    }
    throw MalformedBytes("its header does not end");
}

}  // namespace planet
