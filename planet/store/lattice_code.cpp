#include "planet/store/lattice_code.h"

#include <array>
#include <cstring>

#include "planet/mesh/tile_layout.h"
#include "planet/store/rice_code.h"

namespace planet {

namespace {

// What a vertex is predicted from; on the tile's sides the two ends twice.
struct Predictors {
    std::array<std::array<std::uint16_t, tile_vertices>, 4> vertex{};
};

Predictors make_predictors() {
    const TileLayout& layout = tile_layout();
    Predictors p;
    for (unsigned i = 1; i < tile_cells; ++i) {
        const std::size_t v = layout.split_vertex[i];
        const unsigned beyond = layout.split_neighbor[i];
        p.vertex[0][v] = layout.ends[v][0];
        p.vertex[1][v] = layout.ends[v][1];
        p.vertex[2][v] = beyond == 0 ? layout.ends[v][0] : layout.corners[i][2];
        p.vertex[3][v] = beyond == 0 ? layout.ends[v][1] : layout.corners[beyond][2];
    }
    return p;
}

const Predictors& predictors() {
    static const Predictors table = make_predictors();
    return table;
}

// Unsigned sums: what damage makes of them may wrap, but is defined.
void predict(const std::uint32_t* q, std::size_t begin, std::size_t end, std::uint32_t* predicted) {
    const auto& [a, b, c, d] = predictors().vertex;
    for (std::size_t v = begin; v < end; ++v) {
        const std::uint32_t sum = q[a[v]] + q[b[v]] + q[c[v]] + q[d[v]] + 2;
        predicted[v - begin] = static_cast<std::uint32_t>(static_cast<std::int32_t>(sum) >> 2);
    }
}

constexpr std::uint32_t zigzag32(std::uint32_t v) {
    return v << 1 ^ (0 - (v >> 31));
}
constexpr std::uint32_t unzigzag32(std::uint32_t v) {
    return v >> 1 ^ (0 - (v & 1));
}

constexpr std::uint32_t most = largest_height_quanta;

// Whether all are within -most .. most.
bool in_range(const std::uint32_t* q, std::size_t count) {
    std::uint32_t beyond = 0;
    for (std::size_t v = 0; v < count; ++v) beyond |= q[v] + most > 2 * most ? 1u : 0u;
    return beyond == 0;
}

// Calls level(first, end) for the vertices that split cells of each level.
template <class Level>
void by_level(std::size_t vertices, Level level) {
    const auto& count = tile_layout().vertex_count;
    for (std::size_t l = 1; l < count.size() && count[l] <= vertices; ++l) level(count[l - 1], count[l]);
}

constexpr std::size_t most_in_a_level = 1024 + 32;

}  // namespace

void write_lattice(ByteWriter& out, std::span<const std::int32_t> q) {
    for (std::size_t v = 0; v < 3; ++v) out.varint(zigzag(q[v]));
    std::array<std::uint32_t, tile_vertices> known;
    std::memcpy(known.data(), q.data(), q.size_bytes());
    std::array<std::uint32_t, most_in_a_level> residual;
    RiceWriter rice(out);
    by_level(q.size(), [&](std::size_t begin, std::size_t end) {
        predict(known.data(), begin, end, residual.data());
        for (std::size_t v = begin; v < end; ++v) residual[v - begin] = zigzag32(known[v] - residual[v - begin]);
        rice.group(std::span(residual).first(end - begin));
    });
}

void read_lattice(ByteReader& in, std::span<std::int32_t> q) {
    std::array<std::uint32_t, tile_vertices> known;
    for (std::size_t v = 0; v < 3; ++v) {
        const std::int64_t corner = unzigzag(in.varint());
        if (corner < -std::int64_t{most} || corner > std::int64_t{most})
            throw MalformedBytes("a height is out of range");
        known[v] = static_cast<std::uint32_t>(corner);
    }
    std::array<std::uint32_t, most_in_a_level> residual, predicted;
    RiceReader rice(in);
    by_level(q.size(), [&](std::size_t begin, std::size_t end) {
        rice.group(std::span(residual).first(end - begin));
        predict(known.data(), begin, end, predicted.data());
        for (std::size_t v = begin; v < end; ++v) known[v] = predicted[v - begin] + unzigzag32(residual[v - begin]);
        if (!in_range(known.data() + begin, end - begin)) throw MalformedBytes("a height is out of range");
    });
    std::memcpy(q.data(), known.data(), q.size_bytes());
}

}  // namespace planet
