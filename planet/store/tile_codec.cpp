#include "planet/store/tile_codec.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <tuple>

#include "planet/mesh/saturation.h"
#include "planet/store/byte_stream.h"
#include "planet/store/ladder.h"
#include "planet/store/lattice_code.h"
#include "planet/store/origin_code.h"
#include "planet/store/rice_code.h"

namespace planet {

namespace {

constexpr std::size_t most_payload_bytes = 1 << 16;
constexpr int compression_level = -1;  // the quickest: after the Rice code the slow ones gain 0.2 %
constexpr std::uint8_t flag_inner = 1, flag_undulation = 2, flag_whole = 4, flag_origins = 8, flag_kinds = 16;

// ---- heights and undulations ----------------------------------------------------------------------------------------

float finite(float v, float largest = std::numeric_limits<float>::max()) {
    if (!(std::abs(v) <= largest)) throw MalformedBytes("a number is out of range");
    return v;
}

// Heights are whole multiples of the quantum, a power of two, below 2^24 of them: exact in float both ways.
void write_heights(ByteWriter& out, std::span<const float> height, double quantum) {
    std::array<std::int32_t, tile_vertices> q;
    const auto quanta = static_cast<float>(1 / quantum);
    for (std::size_t v = 0; v < height.size(); ++v) q[v] = static_cast<std::int32_t>(height[v] * quanta);
    write_lattice(out, std::span(q).first(height.size()));
}

void read_heights(ByteReader& in, std::span<float> height, double quantum) {
    std::array<std::int32_t, tile_vertices> q;
    read_lattice(in, std::span(q).first(height.size()));
    for (std::size_t v = 0; v < height.size(); ++v) height[v] = static_cast<float>(q[v]) * static_cast<float>(quantum);
}

void write_undulations(ByteWriter& out, const Tile& tile) {
    const std::size_t own = own_undulations(tile.root, tile.depth);
    if (own == 0) {
        for (std::size_t v = 0; v < 3; ++v) out.f32(static_cast<float>(tile.undulation[v].m));
        return;
    }
    std::vector<std::int32_t> q;
    for (std::size_t v = 0; v < own; ++v)
        q.push_back(static_cast<std::int32_t>(std::lround(tile.undulation[v].m / undulation_quantum_m)));
    write_lattice(out, q);
}

void read_undulations(ByteReader& in, Tile& tile) {
    tile.undulation.resize(tile.height.size());
    const std::size_t own = own_undulations(tile.root, tile.depth);
    if (own == 0) {
        for (std::size_t v = 0; v < 3; ++v) tile.undulation[v].m = static_cast<double>(finite(in.f32(), 1e4f));
    } else {
        std::vector<std::int32_t> q(own);
        read_lattice(in, q);
        for (std::size_t v = 0; v < own; ++v) tile.undulation[v].m = static_cast<double>(q[v]) * undulation_quantum_m;
    }
    interpolate_undulations(tile.root, tile.depth, tile.undulation);
}

// ---- leaf tiles: only what the neighbours add to the records of side cells ------------------------------------------

void write_bits(ByteWriter& out, std::span<const std::uint8_t> flags) {
    for (std::size_t i = 0; i < flags.size(); i += 8) {
        unsigned byte = 0;
        for (std::size_t k = 0; k < 8 && i + k < flags.size(); ++k) byte |= (flags[i + k] ? 1u : 0u) << k;
        out.u8(static_cast<std::uint8_t>(byte));
    }
}

std::vector<std::uint8_t> read_bits(ByteReader& in, std::size_t count) {
    const auto bytes = in.raw((count + 7) / 8);
    std::vector<std::uint8_t> flags(count);
    for (std::size_t i = 0; i < count; ++i) flags[i] = bytes[i / 8] >> (i % 8) & 1;
    return flags;
}

void write_leaf(ByteWriter& out, const BakedTile& baked, bool whole) {
    const auto sides = side_cells(baked.tile.depth);
    std::vector<std::uint8_t> exists;
    std::vector<std::uint32_t> deviation, radius;
    for (std::size_t k = 0; k < sides.size(); ++k) {
        exists.push_back(baked.exists[sides[k].cell]);
        if (!exists.back()) continue;
        deviation.push_back(baked.gain[k].deviation);
        radius.push_back(baked.gain[k].radius);
    }
    if (!whole) write_bits(out, exists);
    RiceWriter rice(out);
    rice.group(deviation);
    rice.group(radius);
}

struct SideGains {
    std::vector<std::uint32_t> deviation, radius;
};

// What the bake did, from the gains of the sides: own deviations, then saturation from the finest level up.
void settle_leaf(Tile& tile, std::span<const std::uint8_t> exists, const SideGains& gains, const TileLattice& lattice) {
    measure_leaf(lattice, exists, tile.deviation, tile.radius);
    static thread_local TileSaturation saturation;
    saturation.start(tile.depth, lattice.rounded());
    const auto sides = side_cells(tile.depth);
    std::size_t k = sides.size(), g = gains.deviation.size();
    for (int level = tile.depth - 1; level >= 0; --level) {
        saturation.level(level, exists, tile.deviation, tile.radius);
        for (; k > 0 && sides[k - 1].cell >= 1u << level; --k) {
            const unsigned i = sides[k - 1].cell;
            if (!exists[i]) continue;
            --g;
            const std::uint64_t d = std::uint64_t{deviation_code(tile.deviation[i])} + gains.deviation[g];
            const std::uint64_t r = std::uint64_t{radius_code(tile.radius[i])} + gains.radius[g];
            if (d >= deviation_codes || r >= radius_codes) throw MalformedBytes("a record is out of range");
            tile.deviation[i] = deviation_from_code(static_cast<unsigned>(d));
            tile.radius[i] = radius_from_code(static_cast<unsigned>(r));
        }
    }
    tile.deviation[0] = tile.radius[0] = 0;
}

void read_leaf(ByteReader& in, bool whole, const TileScale& scale, Tile& tile) {
    static thread_local TileLattice lattice;
    const std::size_t records = std::size_t{1} << tile.depth, sides = side_cells(tile.depth).size();
    std::size_t side_count = sides;
    std::vector<std::uint8_t> exists(records, 1);
    if (!whole) {
        const std::vector<std::uint8_t> on_side = read_bits(in, sides);
        side_count = static_cast<std::size_t>(std::count(on_side.begin(), on_side.end(), 1));
        existence_inside(tile.depth, on_side, exists);
    }
    SideGains gains{std::vector<std::uint32_t>(side_count), std::vector<std::uint32_t>(side_count)};
    {
        RiceReader rice(in);
        rice.group(gains.deviation);
        rice.group(gains.radius);
    }
    own_height_range(tile, exists);
    lattice.set_normals(corners(tile.root), tile.depth);
    lattice.set_positions(scale.placement, tile.height, tile.undulation,
                          whole ? std::span<const std::uint8_t>() : std::span<const std::uint8_t>(exists));
    settle_leaf(tile, exists, gains, lattice);
}

// ---- inner tiles: all deviations; radii of the finest diamonds and of the sides -------------------------------------

bool stores_deviation(unsigned i) {
    return i > tile_layout().split_neighbor[i];
}

// Of the last level, and on the sides.
bool stores_radius(unsigned i, int depth) {
    const unsigned beyond = tile_layout().split_neighbor[i];
    return beyond == 0 || (i >> (depth - 1) && i < beyond);
}

void write_inner(ByteWriter& out, const BakedTile& baked) {
    const Tile& tile = baked.tile;
    const unsigned cells = 1u << tile.depth;
    out.f32(tile.min_height);
    out.f32(tile.max_height);
    std::vector<std::uint8_t> child(cells);
    for (std::size_t k = 0; k < child.size(); ++k) child[k] = tile.child_exists[k];
    write_bits(out, child);
    // Records of one level are alike: as a level's least one and what the others have above it.
    RiceWriter rice(out);
    const auto write_codes = [&rice](std::vector<std::uint32_t>& codes) {
        const std::uint32_t least = codes.empty() ? 0 : *std::min_element(codes.begin(), codes.end());
        for (std::uint32_t& c : codes) c -= least;
        rice.group({&least, 1});
        rice.group(codes);
    };
    for (unsigned first = 1; first < cells; first *= 2) {
        std::vector<std::uint32_t> deviation, radius;
        for (unsigned i = first; i < 2 * first; ++i) {
            if (stores_deviation(i)) deviation.push_back(deviation_code(tile.deviation[i]));
            if (stores_radius(i, tile.depth)) radius.push_back(radius_code(tile.radius[i]));
        }
        write_codes(deviation);
        write_codes(radius);
    }
    // Those of the roots below lie on the ladders, like all records on sides: exact.
    std::vector<std::uint32_t> deviation, radius;
    for (std::size_t k = 0; k < cells; ++k) {
        if (!tile.child_exists[k]) continue;
        deviation.push_back(deviation_code(tile.child_deviation[k]));
        radius.push_back(radius_code(tile.child_radius[k]));
    }
    write_codes(deviation);
    write_codes(radius);
}

std::vector<std::uint32_t> read_codes(RiceReader& rice, std::size_t count, std::uint32_t end) {
    std::uint32_t least = 0;
    std::vector<std::uint32_t> codes(count);
    rice.group({&least, 1});
    rice.group(codes);
    for (std::uint32_t& c : codes) {
        if (c >= end || least >= end - c) throw MalformedBytes("a record is out of range");
        c += least;
    }
    return codes;
}

// Both cells of a diamond inside the tile get its record.
void read_inner_level(RiceReader& rice, unsigned first, Tile& tile) {
    const TileLayout& layout = tile_layout();
    std::size_t deviations = 0, radii = 0;
    for (unsigned i = first; i < 2 * first; ++i) {
        deviations += stores_deviation(i);
        radii += stores_radius(i, tile.depth);
    }
    const auto deviation = read_codes(rice, deviations, deviation_codes);
    const auto radius = read_codes(rice, radii, radius_codes);
    std::size_t d = 0, r = 0;
    for (unsigned i = first; i < 2 * first; ++i) {
        const unsigned beyond = layout.split_neighbor[i];
        if (stores_deviation(i)) {
            tile.deviation[i] = deviation_from_code(deviation[d++]);
            if (beyond != 0) tile.deviation[beyond] = tile.deviation[i];
        }
        if (stores_radius(i, tile.depth)) {
            tile.radius[i] = radius_from_code(radius[r++]);
            if (beyond != 0) tile.radius[beyond] = tile.radius[i];
        }
    }
}

void read_children(RiceReader& rice, Tile& tile) {
    const std::size_t children = tile.child_exists.count();
    const auto deviation = read_codes(rice, children, deviation_codes);
    const auto radius = read_codes(rice, children, radius_codes);
    const std::size_t cells = std::size_t{1} << tile.depth;
    tile.child_deviation.assign(cells, 0);
    tile.child_radius.assign(cells, 0);
    for (std::size_t k = 0, c = 0; k < cells; ++k) {
        if (!tile.child_exists[k]) continue;
        tile.child_deviation[k] = deviation_from_code(deviation[c]);
        tile.child_radius[k] = radius_from_code(radius[c++]);
    }
}

void read_inner(ByteReader& in, const TileScale& scale, Tile& tile) {
    static thread_local TileLattice lattice;
    const unsigned cells = 1u << tile.depth;
    tile.min_height = finite(in.f32());
    tile.max_height = finite(in.f32());
    const auto child = read_bits(in, cells);
    for (std::size_t k = 0; k < child.size(); ++k) tile.child_exists[k] = child[k];
    {
        RiceReader rice(in);
        for (unsigned first = 1; first < cells; first *= 2) read_inner_level(rice, first, tile);
        read_children(rice, tile);
    }
    std::vector<std::uint8_t> exists(cells);
    for (std::size_t i = 1; i < cells; ++i) exists[i] = tile.deviation[i] > 0;
    lattice.set_normals(corners(tile.root), tile.depth);
    lattice.set_positions(scale.placement, tile.height, tile.undulation, {});
    // The radii in between, as the bake had them. Deviations are saturated already, so raising leaves them alone.
    std::vector<float> start(cells);
    corner_radii(lattice, exists, true, std::vector<std::uint8_t>(cells / 2, 0), start);
    const TileLayout& layout = tile_layout();
    static thread_local TileSaturation saturation;
    saturation.start(tile.depth, lattice.rounded());
    for (int level = tile.depth - 2; level >= 0; --level) {
        for (unsigned i = 1u << level; i < 2u << level; ++i)
            if (layout.split_neighbor[i] != 0) tile.radius[i] = start[i];
        saturation.level(level, exists, tile.deviation, tile.radius);
    }
}

// ---- the frame around it: zstd with its content checksum ------------------------------------------------------------

struct FreeContext {
    void operator()(ZSTD_CCtx* c) const { ZSTD_freeCCtx(c); }
    void operator()(ZSTD_DCtx* c) const { ZSTD_freeDCtx(c); }
};

std::vector<std::uint8_t> compress(std::span<const std::uint8_t> payload) {
    static thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, compression_level);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
    std::vector<std::uint8_t> frame(ZSTD_compressBound(payload.size()));
    const std::size_t size = ZSTD_compress2(context.get(), frame.data(), frame.size(), payload.data(), payload.size());
    assert(!ZSTD_isError(size));
    frame.resize(size);
    return frame;
}

std::span<const std::uint8_t> decompress(std::span<const std::uint8_t> frame) {
    static thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
    static thread_local std::vector<std::uint8_t> payload(most_payload_bytes);
    const std::size_t size =
        ZSTD_decompressDCtx(context.get(), payload.data(), payload.size(), frame.data(), frame.size());
    if (ZSTD_isError(size)) throw MalformedBytes(ZSTD_getErrorName(size));
    return {payload.data(), size};
}

}  // namespace

std::size_t own_undulations(LocationCode root, int depth) {
    const int levels = undulation_level - root.bisection_level();
    return levels <= 0 ? 0 : tile_layout().vertex_count[static_cast<std::size_t>(std::min(levels, depth))];
}

void interpolate_undulations(LocationCode root, int depth, std::span<GeoidUndulation> undulation) {
    const TileLayout& layout = tile_layout();
    const std::size_t all = layout.vertex_count[static_cast<std::size_t>(depth)];
    for (std::size_t v = std::max<std::size_t>(3, own_undulations(root, depth)); v < all; ++v) {
        const auto [a, b] = layout.ends[v];
        undulation[v].m = static_cast<double>(static_cast<float>(0.5 * (undulation[a].m + undulation[b].m)));
    }
}

namespace {

bool is_whole(std::span<const std::uint8_t> exists) {
    return std::memchr(exists.data() + 1, 0, exists.size() - 1) == nullptr;
}

// Many at a time, so that the compiler can: the least and largest do not depend on the order.
std::pair<float, float> range(std::span<const float> values) {
    std::array<float, 16> low, high;
    low.fill(values[0]);
    high.fill(values[0]);
    std::size_t v = 0;
    for (; v + low.size() <= values.size(); v += low.size())
        for (std::size_t w = 0; w < low.size(); ++w) {
            low[w] = values[v + w] < low[w] ? values[v + w] : low[w];
            high[w] = values[v + w] > high[w] ? values[v + w] : high[w];
        }
    for (; v < values.size(); ++v) {
        low[0] = std::min(low[0], values[v]);
        high[0] = std::max(high[0], values[v]);
    }
    return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

}  // namespace

void own_height_range(Tile& tile, std::span<const std::uint8_t> exists) {
    if (is_whole(exists)) {
        std::tie(tile.min_height, tile.max_height) = range(tile.height);
        return;
    }
    const TileLayout& layout = tile_layout();
    const auto [least, most] = std::minmax_element(tile.height.begin(), tile.height.begin() + 3);
    float low = *least, high = *most;
    for (std::size_t i = 1; i < exists.size(); ++i) {
        const float h = exists[i] ? tile.height[layout.split_vertex[i]] : low;
        low = std::min(low, h);
        high = std::max(high, h);
    }
    tile.min_height = low;
    tile.max_height = high;
}

std::vector<std::uint8_t> encode_tile(const BakedTile& baked, const TileScale& scale) {
    const Tile& tile = baked.tile;
    const bool whole = is_whole(baked.exists);
    ByteWriter out;
    out.varint(tile.root.bits());
    out.u8(static_cast<std::uint8_t>(tile.depth));
    out.u8(static_cast<std::uint8_t>((baked.inner() ? flag_inner : 0) | (scale.has_undulation ? flag_undulation : 0) |
                                     (whole ? flag_whole : 0) | (tile.origins.known() ? flag_origins : 0) |
                                     (tile.origins.kinds().size() > 1 ? flag_kinds : 0)));
    out.f32(tile.resampling);
    write_heights(out, tile.height, scale.quantum_m);
    if (scale.has_undulation) write_undulations(out, tile);
    if (baked.inner())
        write_inner(out, baked);
    else
        write_leaf(out, baked, whole);
    write_origins(out, tile.origins);
    return compress(out.bytes());
}

Tile decode_tile(LocationCode root, std::span<const std::uint8_t> bytes, const TileScale& scale) {
    ByteReader in(decompress(bytes));
    Tile tile;
    if (in.varint() != root.bits()) throw MalformedBytes("it is another tile");
    tile.root = root;
    tile.depth = in.u8();
    const std::uint8_t flags = in.u8();
    const bool inner = flags & flag_inner;
    if (((flags & flag_undulation) != 0) != scale.has_undulation)
        throw MalformedBytes("its undulations are not the store's");
    const int level = root.bisection_level(), deepest = scale.layers.depth(level);
    if (tile.depth < 1 || tile.depth > deepest || (inner && tile.depth != deepest) || !scale.layers.begin_at(level) ||
        level + tile.depth > max_bisection_level)
        throw MalformedBytes("its depth is not possible");
    tile.resampling = finite(in.f32());
    tile.height.resize(tile_layout().vertex_count[static_cast<std::size_t>(tile.depth)]);
    tile.deviation.resize(std::size_t{1} << tile.depth);
    tile.radius.resize(std::size_t{1} << tile.depth);
    read_heights(in, tile.height, scale.quantum_m);
    if (scale.has_undulation) read_undulations(in, tile);
    if (inner)
        read_inner(in, scale, tile);
    else
        read_leaf(in, flags & flag_whole, scale, tile);
    if (flags & flag_origins) tile.origins = read_origins(in, flags & flag_kinds, tile.height.size(), scale.files);
    if (!in.at_end()) throw MalformedBytes("bytes follow its end");
    return tile;
}

}  // namespace planet
