#include "planet/bisection/progressive_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "planet/error.h"
#include "planet/store/byte_stream.h"

namespace planet {

namespace {

using Index = Progressive::Index;

constexpr std::uint8_t magic[8] = {'O', 'P', 'R', 'O', 'G', 1, 13, 10};
constexpr Index block_records = 16384;
enum class Places : std::uint8_t { midpoints, multiples, doubles };

struct Header {
    std::uint8_t magic[8];
    BisectionRule rule;
    SideGeometry sides;
    Places places;
    std::uint8_t zero;
    std::uint32_t attribute_width, vertices, triangles, records, note_bytes;
    double quantum;
};
static_assert(sizeof(Header) == 40);

std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
    std::uint64_t sum = 0xcbf29ce484222325u, word = 0;
    const auto take = [&] { sum = (sum ^ word) * 0x100000001b3u; };
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        std::memcpy(&word, bytes.data() + i, 8);
        take();
    }
    word = 0;
    std::memcpy(&word, bytes.data() + i, bytes.size() - i);
    take();
    return sum;
}

// Bits of a side in a block that ends with so many records.
int side_bits(std::size_t base_triangles, Index records) {
    return static_cast<int>(std::bit_width(3 * (std::uint64_t{base_triangles} + 4 * std::uint64_t{records})));
}

template <class T>
void append_raw(ByteWriter& out, const T& value) {
    std::uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.raw(bytes);
}

template <class T>
void append_array(ByteWriter& out, const std::vector<T>& values) {
    out.raw({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)});
}

template <class T>
void read_array(ByteReader& in, std::vector<T>& values, std::size_t count) {
    const auto bytes = in.raw(count * sizeof(T));
    values.resize(count);
    if (count != 0) std::memcpy(values.data(), bytes.data(), bytes.size());
}

template <class T>
T read_raw(ByteReader& in) {
    T value;
    std::memcpy(&value, in.raw(sizeof(T)).data(), sizeof(T));
    return value;
}

class BitWriter {
  public:
    explicit BitWriter(ByteWriter& out) : out_(out) {}
    void put(std::uint64_t value, int bits) {  // at most 32
        held_ |= value << count_;
        for (count_ += bits; count_ >= 8; count_ -= 8, held_ >>= 8) out_.u8(static_cast<std::uint8_t>(held_));
    }
    void finish() {
        if (count_ > 0) out_.u8(static_cast<std::uint8_t>(held_));
    }

  private:
    ByteWriter& out_;
    std::uint64_t held_ = 0;
    int count_ = 0;
};

// Eight bytes from the one in which a number begins may be read: the checksum follows.
class BitReader {
  public:
    explicit BitReader(const std::uint8_t* bytes) : bytes_(bytes) {}
    std::uint64_t take(int bits) {  // at most 57
        std::uint64_t word;
        std::memcpy(&word, bytes_ + (at_ >> 3), 8);
        word = word >> (at_ & 7) & ((std::uint64_t{1} << bits) - 1);
        at_ += static_cast<std::size_t>(bits);
        return word;
    }
    std::size_t bits_taken() const { return at_; }

  private:
    const std::uint8_t* bytes_;
    std::size_t at_ = 0;
};

Places kind_of_places(const Progressive& mesh, double quantum) {
    if (quantum != 0) return Places::multiples;
    for (Index v = mesh.base_vertex_count(); v < mesh.vertex_count(); ++v) {
        const auto [a, b] = mesh.ends(v);
        if (mesh.place(v) != mesh.midpoint(a, b)) return Places::doubles;
    }
    return Places::midpoints;
}

void check_quantum(double quantum) {
    int exponent;
    if (quantum != 0 && !(quantum > 0 && std::isfinite(quantum) && std::frexp(quantum, &exponent) == 0.5))
        throw Error(Fault::bad_usage, "the quantum", std::to_string(quantum), "0 or a power of two");
}

class Encoder {
  public:
    Encoder(const Progressive& mesh, double quantum)
        : mesh_(mesh), quantum_(quantum), places_(kind_of_places(mesh, quantum)) {
        if (places_ == Places::multiples) read_back_.assign(mesh.places().begin(), mesh.places().end());
    }

    std::vector<std::uint8_t> run() {
        base();
        for (Index begin = 0; begin < mesh_.split_count(); begin += block_records)
            block(begin, std::min(begin + block_records, mesh_.split_count()));
        return out_.bytes();
    }

  private:
    void base() {
        const PlainMesh& base = mesh_.base();
        Header header{{},
                      mesh_.rule(),
                      mesh_.sides(),
                      places_,
                      0,
                      static_cast<std::uint32_t>(base.attribute_width),
                      static_cast<std::uint32_t>(base.vertices.size()),
                      static_cast<std::uint32_t>(base.triangles.size()),
                      mesh_.split_count(),
                      static_cast<std::uint32_t>(mesh_.note().size()),
                      quantum_};
        std::memcpy(header.magic, magic, sizeof magic);
        append_raw(out_, header);
        out_.raw({reinterpret_cast<const std::uint8_t*>(mesh_.note().data()), mesh_.note().size()});
        append_array(out_, base.vertices);
        append_array(out_, base.triangles);
        append_array(out_, base.attributes);
        append_raw(out_, checksum(out_.bytes()));
    }
    void block(Index begin, Index end) {
        ByteWriter payload;
        BitWriter bits(payload);
        const int width = side_bits(mesh_.base().triangles.size(), end);
        for (Index i = begin; i < end; ++i) {
            const SplitRecord r = mesh_.record(i);
            const bool border = r.second == SplitRecord::no_side;
            bits.put(r.flags, 3);
            bits.put(border, 1);
            bits.put(r.first, width);
            if (!border) bits.put(r.second, width);
        }
        bits.finish();
        for (Index i = begin; i < end; ++i) place(mesh_.base_vertex_count() + i, payload);
        append_raw(out_, static_cast<std::uint32_t>(payload.bytes().size()));
        out_.raw(payload.bytes());
        append_raw(out_, checksum(payload.bytes()));
    }
    void place(Index v, ByteWriter& payload) {
        if (places_ == Places::midpoints) return;
        const auto [a, b] = mesh_.ends(v);
        const glm::dvec3 p = mesh_.place(v);
        for (int axis = mesh_.sides() == SideGeometry::plan ? 2 : 0; axis < 3; ++axis)
            if (places_ == Places::doubles) append_raw(payload, p[axis]);
        if (places_ != Places::multiples) return;
        glm::dvec3& rounded = read_back_[v];
        rounded = (read_back_[a] + read_back_[b]) * 0.5;
        for (int axis = mesh_.sides() == SideGeometry::plan ? 2 : 0; axis < 3; ++axis) {
            const double steps = std::round((p[axis] - rounded[axis]) / quantum_);
            if (!(std::abs(steps) < 0x1p52))
                throw Error(Fault::bad_usage, "the quantum", std::to_string(quantum_), "a larger one");
            payload.varint(zigzag(static_cast<std::int64_t>(steps)));
            rounded[axis] += steps * quantum_;
        }
    }

    const Progressive& mesh_;
    double quantum_;
    Places places_;
    std::vector<glm::dvec3> read_back_;  ///< places as a reader has them
    ByteWriter out_;
};

std::uint64_t word_at(ByteReader& in) {
    return read_raw<std::uint64_t>(in);
}

class Decoder {
  public:
    explicit Decoder(std::span<const std::uint8_t> bytes) : bytes_(bytes), in_(bytes) {}

    Progressive run(double fraction) {
        Progressive mesh = base();
        const auto wanted = static_cast<Index>(std::llround(fraction * header_.records));
        // Records are not more than their bits allow.
        if (std::uint64_t{header_.records} * static_cast<unsigned>(4 + side_bits(header_.triangles, 0)) >
            8 * std::uint64_t{in_.left().size()})
            throw MalformedBytes("it ends early");
        mesh.reserve(wanted);
        for (Index begin = 0; begin < wanted; begin += block_records)
            block(mesh, begin, std::min(begin + block_records, header_.records), wanted);
        if (wanted == header_.records && !in_.at_end()) throw MalformedBytes("something follows its end");
        return mesh;
    }

  private:
    void check_header() const {
        if (std::memcmp(header_.magic, magic, 5) != 0) throw MalformedBytes("it is no progressive mesh");
        if (std::memcmp(header_.magic, magic, sizeof magic) != 0)
            throw MalformedBytes("version " + std::to_string(header_.magic[5]) + " of the format");
        const bool sensible =
            header_.rule <= BisectionRule::plain && header_.sides <= SideGeometry::plan &&
            header_.places <= Places::doubles && header_.zero == 0 && header_.triangles > 0 &&
            header_.note_bytes <= Progressive::max_note &&
            3 * (std::uint64_t{header_.triangles} + 4 * std::uint64_t{header_.records}) < 0xffffffffu &&
            std::uint64_t{header_.vertices} + header_.records < 0xffffffffu && header_.quantum >= 0 &&
            std::isfinite(header_.quantum);
        if (!sensible) throw MalformedBytes("its header says what cannot be");
    }
    Progressive base() {
        header_ = read_raw<Header>(in_);
        check_header();
        const auto& h = header_;
        // In 64 bits none of these sums overflows but that of attributes.
        const std::uint64_t fixed = h.note_bytes + 24 * std::uint64_t{h.vertices} + 12 * std::uint64_t{h.triangles};
        if (fixed > in_.left().size() ||
            (h.attribute_width != 0 && h.vertices > (in_.left().size() - fixed) / 4 / h.attribute_width))
            throw MalformedBytes("it ends early");
        const auto note = in_.raw(h.note_bytes);
        PlainMesh base;
        read_array(in_, base.vertices, h.vertices);
        read_array(in_, base.triangles, h.triangles);
        base.attribute_width = h.attribute_width;
        read_array(in_, base.attributes, std::size_t{h.vertices} * h.attribute_width);
        const std::size_t size = bytes_.size() - in_.left().size();
        if (word_at(in_) != checksum(bytes_.first(size))) throw MalformedBytes("its base mesh is damaged");
        for (const glm::dvec3& p : base.vertices)
            if (!std::isfinite(p.x + p.y + p.z)) throw MalformedBytes("a vertex is at no place");
        for (const auto& t : base.triangles)
            for (const Index v : t)
                if (v >= h.vertices) throw MalformedBytes("a triangle has a vertex that is not there");
        Progressive mesh(std::move(base), h.rule, h.sides);
        mesh.set_note(std::string(note.begin(), note.end()));
        return mesh;
    }
    void block(Progressive& mesh, Index begin, Index end, Index wanted) {
        const auto size = read_raw<std::uint32_t>(in_);
        const auto payload = in_.raw(size);
        const auto damaged = [&](const char* what) {
            throw MalformedBytes("records " + std::to_string(begin) + " to " + std::to_string(end - 1) + what);
        };
        if (word_at(in_) != checksum(payload)) damaged(" are damaged");
        const int width = side_bits(header_.triangles, end);
        const Index count = end - begin;
        // Records first: places begin where their bits end.
        std::vector<SplitRecord> records(count);
        BitReader bits(payload.data());
        const auto take = [&](int n) {
            if (bits.bits_taken() + static_cast<std::size_t>(n) > 8 * payload.size()) damaged(" are incomplete");
            return bits.take(n);
        };
        for (SplitRecord& r : records) {
            const std::uint64_t head = take(4 + width);
            r.flags = head & 7;
            r.first = static_cast<Index>(head >> 4);
            r.second = (head & 8) != 0 ? SplitRecord::no_side : static_cast<Index>(take(width));
        }
        ByteReader places(payload.subspan((bits.bits_taken() + 7) / 8));
        const Index stop = std::min(count, wanted - begin);
        const auto placed = [&](const glm::dvec3& midpoint) {
            return header_.places == Places::midpoints ? midpoint : place(midpoint, places);
        };
        constexpr Index step = 1024;  // whose splits stay in the cache until they are placed
        for (Index i = 0; i < stop; i += step)
            if (!mesh.append(std::span(records).subspan(i, std::min(step, stop - i)), placed))
                damaged(" do not fit each other");
        if (stop == count && !places.at_end()) damaged(" are too long");
    }
    glm::dvec3 place(glm::dvec3 p, ByteReader& in) const {
        for (int axis = header_.sides == SideGeometry::plan ? 2 : 0; axis < 3; ++axis) {
            if (header_.places == Places::doubles)
                p[axis] = read_raw<double>(in);
            else
                p[axis] += static_cast<double>(unzigzag(in.varint())) * header_.quantum;
        }
        if (!std::isfinite(p.x + p.y + p.z)) throw MalformedBytes("a vertex is at no place");
        return p;
    }

    std::span<const std::uint8_t> bytes_;
    ByteReader in_;
    Header header_{};
};

}  // namespace

std::vector<std::uint8_t> encode_progressive(const Progressive& mesh, const ProgressiveFormat& format) {
    check_quantum(format.quantum);
    return Encoder(mesh, format.quantum).run();
}

Progressive decode_progressive(std::span<const std::uint8_t> bytes, const std::string& where, double fraction) {
    if (!(fraction >= 0 && fraction <= 1))
        throw Error(Fault::bad_usage, "the fraction of the records", std::to_string(fraction), "0 to 1");
    try {
        return Decoder(bytes).run(fraction);
    } catch (const MalformedBytes& e) {
        throw Error(Fault::bad_data, where, e.what(), "a whole progressive mesh (.oprog)");
    }
}

Progressive read_progressive(const std::string& path, double fraction) {
    constexpr const char* accepted = "a progressive mesh (.oprog)";
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) throw Error(Fault::bad_data, path, "no such file", accepted);
    if (!std::filesystem::is_regular_file(status)) throw Error(Fault::bad_data, path, "is not a file", accepted);
    std::vector<std::uint8_t> bytes(std::filesystem::file_size(path, failed));
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) throw Error(Fault::bad_data, path, "cannot be read", accepted);
    return decode_progressive(bytes, path, fraction);
}

}  // namespace planet
