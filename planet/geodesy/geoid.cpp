#include "planet/geodesy/geoid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <system_error>
#include <vector>

#include "planet/error.h"
#include "planet/geodesy/angles.h"

namespace planet {
namespace {

constexpr int stencil_size = 12;
constexpr int terms = 10;
constexpr std::string_view accepted = "a geoid grid in the PGM form of GeographicLib, such as egm96-15.pgm";

/// The terms x^p y^q of a cubic in two variables.
constexpr std::array<std::array<int, 2>, terms> powers{
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};

struct StencilPoint {
    int x, y;  // cells east and south of the cell's north-west corner
    double weight;
};
constexpr std::array<StencilPoint, stencil_size> stencil{{{0, -1, 1},
                                                          {1, -1, 1},
                                                          {-1, 0, 1},
                                                          {0, 0, 2},
                                                          {1, 0, 2},
                                                          {2, 0, 1},
                                                          {-1, 1, 1},
                                                          {0, 1, 2},
                                                          {1, 1, 2},
                                                          {2, 1, 1},
                                                          {0, 2, 1},
                                                          {1, 2, 1}}};

using Terms = std::array<double, terms>;
/// By stencil point: what a unit value there adds to the coefficient of each term.
using Fit = std::array<Terms, stencil_size>;

double power(double x, int n) {
    double p = 1;
    while (n-- > 0) p *= x;
    return p;
}

/// Solves the symmetric positive definite `m` c = `rhs` by elimination; m has at most ten rows, the numbers are small.
void solve(std::array<Terms, terms>& m, Fit& rhs) {
    for (int i = 0; i < terms; ++i)
        for (int r = 0; r < terms; ++r) {
            if (r == i) continue;
            const double q = m[r][i] / m[i][i];
            for (int c = i; c < terms; ++c) m[r][c] -= q * m[i][c];
            for (Terms& column : rhs) column[r] -= q * column[i];
        }
    for (Terms& column : rhs)
        for (int i = 0; i < terms; ++i) column[i] /= m[i][i];
}

/// The weighted least squares fit of a cubic in x and (y - y0) to the stencil. With `constant_at_y0` its terms in x
/// alone are zero: on the line y = y0, a pole, there is one value.
Fit least_squares_fit(double y0, bool constant_at_y0) {
    std::array<Terms, terms> normal{};
    Fit fit{};
    for (int k = 0; k < stencil_size; ++k) {
        Terms row{};
        for (int t = 0; t < terms; ++t) {
            const bool held_at_zero = constant_at_y0 && powers[t][1] == 0 && powers[t][0] > 0;
            if (!held_at_zero) row[t] = power(stencil[k].x, powers[t][0]) * power(stencil[k].y - y0, powers[t][1]);
        }
        for (int i = 0; i < terms; ++i) {
            fit[k][i] = stencil[k].weight * row[i];
            for (int j = 0; j < terms; ++j) normal[i][j] += stencil[k].weight * row[i] * row[j];
        }
    }
    for (int t = 0; t < terms; ++t)
        if (normal[t][t] == 0) normal[t][t] = 1;
    solve(normal, fit);
    return fit;
}

struct Header {
    int width = 0, height = 0;
    double offset = 0, scale = 0;
    std::string description = "NONE";
    std::uintmax_t data_start = 0;
};

/// Reads the header line by line. Every line is bounded: a binary file without line ends is no header.
class HeaderReader {
  public:
    HeaderReader(std::istream& in, std::string where) : in_(in), where_(std::move(where)) {}

    Header read() {
        if (line() != "P5") fail("does not begin with P5");
        Header header;
        std::string text = line();
        for (; !text.empty() && text[0] == '#'; text = line()) comment(text, header);
        std::istringstream(text) >> header.width >> header.height;
        if (line() != "65535") fail("is not a 16-bit map (the largest grey is not 65535)");
        if (!offset_ || !scale_ || !(*scale_ > 0)) fail("has no usable Offset and Scale");
        header.offset = *offset_;
        header.scale = *scale_;
        if (header.width < 4 || header.width % 2 != 0 || header.height < 5 || header.height % 2 == 0)
            fail("has " + std::to_string(header.width) + "x" + std::to_string(header.height) +
                 " samples, not an even number of columns and an odd number of rows");
        header.data_start = static_cast<std::uintmax_t>(in_.tellg());
        return header;
    }

  private:
    static constexpr std::size_t longest_line = 1024;

    std::string line() {
        std::array<char, longest_line> buffer{};
        if (!in_.getline(buffer.data(), buffer.size()) || in_.eof())
            fail("ends within its header, at line " + std::to_string(line_ + 1));
        ++line_;
        return buffer.data();
    }

    void comment(const std::string& text, Header& header) {
        std::istringstream words(text.substr(1));
        std::string key;
        words >> key >> std::ws;
        if (key == "Description") std::getline(words, header.description);
        if (key == "Offset") offset_ = number(words, key);
        if (key == "Scale") scale_ = number(words, key);
    }

    double number(std::istream& words, const std::string& key) {
        double value = 0;
        if (!(words >> value) || !std::isfinite(value))
            fail("line " + std::to_string(line_) + ": " + key + " is not a number");
        return value;
    }

    [[noreturn]] void fail(const std::string& what) const { throw Error(Fault::bad_data, where_, what, accepted); }

    std::istream& in_;
    std::string where_;
    int line_ = 0;
    std::optional<double> offset_, scale_;
};

}  // namespace

// The samples with a border of one row beyond each pole and of columns 1 west and 2 east, so that a stencil is read
// without a test. Beyond a pole the next row is the same parallel on the other side of the planet.
struct Geoid::Grid {
    std::filesystem::path path;
    Header header;
    int stride = 0;
    std::vector<std::uint16_t> samples;
    Fit inner = least_squares_fit(0, false);
    Fit north = least_squares_fit(0, true);
    Fit south = least_squares_fit(1, true);

    void fill(std::istream& in);
    double at(double latitude, double longitude) const;
    /// Many, faster: neighbours mostly lie in the same cell.
    void at(std::span<const double> latitude, std::span<const double> longitude, GeoidUndulation* out) const;
    /// Where the last bit of an angle decides between two cells, whose cubics differ by some mm: there the angles are
    /// always those of the standard library, so that what is stored of the geoid does not depend on how it was asked.
    bool is_beside_side(double latitude, double longitude) const;

  private:
    /// A cell by its north-west corner, none for a place that is not one, and where a place lies in it: in cells east
    /// and south.
    struct CellPlace {
        int left = -1, top = -1;
        double x = 0, y = 0;
    };
    CellPlace cell_place(double latitude, double longitude) const;
    /// The cubic of a cell.
    Terms cubic(int left, int top) const;
    double in_cell(const Terms& t, double x, double y) const;

    std::uint16_t* row(int y) { return samples.data() + static_cast<std::ptrdiff_t>(y + 1) * stride + 1; }
    const std::uint16_t* row(int y) const { return samples.data() + static_cast<std::ptrdiff_t>(y + 1) * stride + 1; }
    void extend_columns(int y);
};

void Geoid::Grid::extend_columns(int y) {
    std::uint16_t* r = row(y);
    r[-1] = r[header.width - 1];
    r[header.width] = r[0];
    r[header.width + 1] = r[1];
}

void Geoid::Grid::fill(std::istream& in) {
    const int w = header.width, last = header.height - 1;
    stride = w + 3;
    samples.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(header.height + 2));
    std::vector<char> bytes(static_cast<std::size_t>(w) * 2);
    for (int y = 0; y <= last; ++y) {
        if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
            throw Error(Fault::bad_data, path.string(), "cannot be read at row " + std::to_string(y), accepted);
        for (int x = 0; x < w; ++x) {
            const auto high = static_cast<unsigned char>(bytes[static_cast<std::size_t>(x) * 2]);
            const auto low = static_cast<unsigned char>(bytes[static_cast<std::size_t>(x) * 2 + 1]);
            row(y)[x] = static_cast<std::uint16_t>(high << 8 | low);
        }
        extend_columns(y);
    }
    for (int x = 0; x < w; ++x) {
        const int opposite = x < w / 2 ? x + w / 2 : x - w / 2;
        row(-1)[x] = row(1)[opposite];
        row(last + 1)[x] = row(last - 1)[opposite];
    }
    extend_columns(-1);
    extend_columns(last + 1);
}

Terms Geoid::Grid::cubic(int left, int top) const {
    const Fit& fit = top == 0 ? north : top == header.height - 2 ? south : inner;
    Terms made{};
    for (int k = 0; k < stencil_size; ++k) {
        const double v = row(top + stencil[k].y)[left + stencil[k].x];
        for (int i = 0; i < terms; ++i) made[i] += fit[k][i] * v;
    }
    return made;
}

Geoid::Grid::CellPlace Geoid::Grid::cell_place(double latitude, double longitude) const {
    constexpr double pi = std::numbers::pi;
    if (!(std::abs(latitude) <= pi / 2) || !std::isfinite(longitude)) return {};
    if (std::abs(longitude) > pi) longitude = std::remainder(longitude, 2 * pi);
    const int half_rows = (header.height - 1) / 2;
    double x = longitude * (header.width / (2 * pi)), y = half_rows - latitude * (half_rows / (pi / 2));
    const int column = static_cast<int>(std::floor(x));
    const int top = std::min(static_cast<int>(std::floor(std::max(y, 0.0))), header.height - 2);
    x -= column;
    y -= top;
    const int left = column < 0 ? column + header.width : column >= header.width ? column - header.width : column;
    if (top == header.height - 2) y -= 1;  // that fit is about the pole
    return {left, top, x, y};
}

double Geoid::Grid::in_cell(const Terms& t, double x, double y) const {
    const double grey = t[0] + x * (t[1] + x * (t[3] + x * t[6])) +
                        y * (t[2] + x * (t[4] + x * t[7]) + y * (t[5] + x * t[8] + y * t[9]));
    return header.offset + header.scale * grey;
}

bool Geoid::Grid::is_beside_side(double latitude, double longitude) const {
    const auto is_whole = [](double cells) { return std::abs(cells - std::nearbyint(cells)) < 1e-9; };
    return is_whole(longitude * (header.width / (2 * std::numbers::pi))) ||
           is_whole(latitude * ((header.height - 1) / std::numbers::pi));
}

double Geoid::Grid::at(double latitude, double longitude) const {
    const CellPlace p = cell_place(latitude, longitude);
    return p.left < 0 ? std::numeric_limits<double>::quiet_NaN() : in_cell(cubic(p.left, p.top), p.x, p.y);
}

void Geoid::Grid::at(std::span<const double> latitude, std::span<const double> longitude, GeoidUndulation* out) const {
    Terms t{};
    CellPlace last;
    for (std::size_t i = 0; i < latitude.size(); ++i) {
        const CellPlace p = cell_place(latitude[i], longitude[i]);
        if (p.left != last.left || p.top != last.top) {
            if (p.left >= 0) t = cubic(p.left, p.top);
            last = p;
        }
        out[i].m = p.left < 0 ? std::numeric_limits<double>::quiet_NaN() : in_cell(t, p.x, p.y);
    }
}

Geoid::Geoid(const std::filesystem::path& pgm) {
    const std::string where = pgm.string();
    std::error_code fault;
    if (!std::filesystem::exists(pgm, fault)) throw Error(Fault::bad_data, where, "no such file", accepted);
    if (!std::filesystem::is_regular_file(pgm, fault)) throw Error(Fault::bad_data, where, "is not a file", accepted);
    const std::uintmax_t size = std::filesystem::file_size(pgm, fault);
    std::ifstream in(pgm, std::ios::binary);
    if (fault || !in) throw Error(Fault::bad_data, where, "cannot be opened", "a readable file");
    auto grid = std::make_shared<Grid>();
    grid->path = pgm;
    grid->header = HeaderReader(in, where).read();
    const Header& header = grid->header;
    // Checked before anything is allocated: a header cannot ask for more than the file holds.
    const std::uintmax_t wanted = header.data_start + std::uintmax_t{2} * static_cast<unsigned>(header.width) *
                                                          static_cast<unsigned>(header.height);
    if (size != wanted)
        throw Error(Fault::bad_data, where, "is " + std::to_string(size) + " bytes long",
                    std::to_string(wanted) + " bytes");
    grid->fill(in);
    grid_ = std::move(grid);
}

GeoidUndulation Geoid::undulation(double latitude, double longitude) const {
    return {grid_->at(latitude, longitude)};
}

void Geoid::undulations(std::span<const double> latitudes, std::span<const double> longitudes,
                        std::span<GeoidUndulation> out) const {
    assert(latitudes.size() == out.size() && longitudes.size() == out.size());
    grid_->at(latitudes, longitudes, out.data());
}

GeoidUndulation Geoid::undulation(const glm::dvec3& normal) const {
    GeoidUndulation out;
    undulations({&normal, 1}, {&out, 1});
    return out;
}

void Geoid::undulations(std::span<const glm::dvec3> normals, std::span<GeoidUndulation> out) const {
    assert(normals.size() == out.size());
    constexpr std::size_t piece = 256;  // their angles stay in the first-level cache
    double latitude[piece], longitude[piece];
    for (std::size_t first = 0; first < normals.size(); first += piece) {
        const std::size_t n = std::min(piece, normals.size() - first);
        angles_from_normals(normals.subspan(first, n), {longitude, n}, {latitude, n});
        for (std::size_t i = 0; i < n; ++i) {
            if (!grid_->is_beside_side(latitude[i], longitude[i])) continue;
            const glm::dvec3& normal = normals[first + i];
            latitude[i] = std::atan2(normal.z, std::sqrt(normal.x * normal.x + normal.y * normal.y));
            longitude[i] = std::atan2(normal.y, normal.x);
        }
        grid_->at({latitude, n}, {longitude, n}, out.data() + first);
    }
}

const std::string& Geoid::description() const {
    return grid_->header.description;
}

const std::filesystem::path& Geoid::path() const {
    return grid_->path;
}

}  // namespace planet
