#include "planet/store/origin_code.h"

#include <algorithm>

#include "planet/mesh/tile_layout.h"

namespace planet {

namespace {

std::uint16_t expected(std::span<const std::uint16_t> before, std::size_t vertex) {
    return vertex < 3 ? 0 : before[tile_layout().ends[vertex][0]];
}

// Twice the file, and 1 if another one follows.
void write_kind(ByteWriter& out, const HeightOrigin& kind) {
    out.varint(std::uint64_t{2} * kind.file + (kind.blended() ? 1 : 0));
    if (kind.blended()) out.varint(kind.other);
}

HeightOrigin read_kind(ByteReader& in, std::uint32_t files) {
    const std::uint64_t code = in.varint(), file = code / 2, other = code % 2 != 0 ? in.varint() : file;
    if (file > files || other > files || (code % 2 != 0 && other == file))
        throw MalformedBytes("a height is of no source");
    return {static_cast<std::uint32_t>(file), static_cast<std::uint32_t>(other)};
}

}  // namespace

void write_origins(ByteWriter& out, const OriginPlane& origins) {
    const auto kind = origins.kind();
    if (!kind.empty()) out.varint(origins.kinds().size());
    for (const HeightOrigin& each : origins.kinds()) write_kind(out, each);
    std::size_t as_expected = 0;
    for (std::size_t v = 0; v < kind.size(); ++v) {
        if (kind[v] == expected(kind, v)) {
            ++as_expected;
            continue;
        }
        out.varint(as_expected);
        out.varint(kind[v]);
        as_expected = 0;
    }
    if (as_expected > 0) out.varint(as_expected);
}

OriginPlane read_origins(ByteReader& in, bool several, std::size_t vertices, std::uint32_t files) {
    const std::uint64_t count = several ? in.varint() : 1;
    if (count > vertices || (several && count < 2)) throw MalformedBytes("its heights are of too many sources");
    std::vector<HeightOrigin> kinds;
    for (std::uint64_t k = 0; k < count; ++k) kinds.push_back(read_kind(in, files));
    std::vector<std::uint16_t> kind(several ? vertices : 0);
    for (std::size_t v = 0; v < kind.size();) {
        const std::uint64_t as_expected = in.varint();
        if (as_expected > kind.size() - v) throw MalformedBytes("its sources go on beyond its end");
        for (const std::size_t end = v + as_expected; v < end; ++v) kind[v] = expected(kind, v);
        if (v == kind.size()) break;
        const std::uint64_t other = in.varint();
        if (other >= count) throw MalformedBytes("a height is of no source");
        kind[v++] = static_cast<std::uint16_t>(other);
    }
    return {std::move(kinds), std::move(kind)};
}

}  // namespace planet
