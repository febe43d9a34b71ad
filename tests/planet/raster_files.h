#pragma once
// Small elevation files for tests: raw samples described by a GDAL virtual raster, and hand-made TIFFs.

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace planet::testing {

/// A folder that is removed with everything in it.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "octaglobe_XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

struct RasterFile {
    int width, height;
    std::string crs;         ///< what <SRS> takes; empty: none
    double geotransform[6];  ///< of pixel corners, as GDAL has it
    std::string band;        ///< further elements of the band, e.g. <NoDataValue>
};

template <class T>
constexpr const char* gdal_type() {
    if constexpr (std::is_same_v<T, std::uint8_t>)
        return "Byte";
    else if constexpr (std::is_same_v<T, std::int16_t>)
        return "Int16";
    else if constexpr (std::is_same_v<T, std::uint16_t>)
        return "UInt16";
    else if constexpr (std::is_same_v<T, std::int32_t>)
        return "Int32";
    else if constexpr (std::is_same_v<T, float>)
        return "Float32";
    else
        return "Float64";
}

/// Writes path (a .vrt) and path + ".raw". @param value of (column, row)
template <class T>
void write_raster(const std::string& path, const RasterFile& file, const std::function<T(int, int)>& value,
                  int bands = 1) {
    std::string raw;
    for (int b = 0; b < bands; ++b)
        for (int row = 0; row < file.height; ++row)
            for (int column = 0; column < file.width; ++column) {
                const T v = value(column, row);
                raw.append(reinterpret_cast<const char*>(&v), sizeof v);
            }
    write_bytes(path + ".raw", raw);
    const char* const colours[] = {"Red", "Green", "Blue", "Alpha"};
    std::string text = "<VRTDataset rasterXSize=\"" + std::to_string(file.width) + "\" rasterYSize=\"" +
                       std::to_string(file.height) + "\">";
    if (!file.crs.empty()) text += "<SRS>" + file.crs + "</SRS>";
    text += "<GeoTransform>";
    for (int i = 0; i < 6; ++i) {
        char number[40];
        std::snprintf(number, sizeof number, "%s%.17g", i > 0 ? "," : "", file.geotransform[i]);
        text += number;
    }
    text += "</GeoTransform>";
    for (int b = 0; b < bands; ++b) {
        text += "<VRTRasterBand dataType=\"" + std::string(gdal_type<T>()) + "\" band=\"" + std::to_string(b + 1) +
                "\" subClass=\"VRTRawRasterBand\"><SourceFilename relativetoVRT=\"1\">" +
                std::filesystem::path(path).filename().string() +
                ".raw</SourceFilename><ByteOrder>LSB</ByteOrder><ImageOffset>" +
                std::to_string(static_cast<std::size_t>(b * file.width * file.height) * sizeof(T)) + "</ImageOffset>" +
                file.band;
        if (bands > 1) text += "<ColorInterp>" + std::string(colours[b % 4]) + "</ColorInterp>";
        text += "</VRTRasterBand>";
    }
    write_bytes(path, text + "</VRTDataset>");
}

/// A minimal uncompressed little-endian TIFF of 16-bit samples with one strip a row; with `geo`, a GeoTIFF in WGS84
/// whose top left corner is (longitude 10, latitude 50), 0.01 degrees a pixel.
inline std::string tiff_bytes(int width, int height, bool geo, const std::function<std::int16_t(int, int)>& value) {
    std::string out;
    const auto u16 = [&](unsigned v) { out += static_cast<char>(v & 255), out += static_cast<char>(v >> 8 & 255); };
    const auto u32 = [&](std::size_t v) {
        u16(static_cast<unsigned>(v & 0xffff)), u16(static_cast<unsigned>(v >> 16));
    };
    const auto f64 = [&](double v) { out.append(reinterpret_cast<const char*>(&v), 8); };
    const auto tag = [&](unsigned id, unsigned type, std::size_t count, std::size_t v) {
        u16(id), u16(type), u32(count), u32(v);
    };
    const unsigned tags = geo ? 12 : 9;
    const std::size_t rows = static_cast<std::size_t>(height), row_bytes = static_cast<std::size_t>(width) * 2;
    const std::size_t offsets = 8 + 2 + tags * 12 + 4, counts = offsets + 4 * rows, scale = counts + 4 * rows;
    const std::size_t data = scale + (geo ? 24 + 48 + 32 : 0);
    out = "II";
    u16(42), u32(8), u16(tags);
    tag(256, 4, 1, static_cast<std::size_t>(width)), tag(257, 4, 1, rows), tag(258, 3, 1, 16), tag(259, 3, 1, 1);
    tag(262, 3, 1, 1), tag(273, 4, rows, height > 1 ? offsets : data), tag(278, 4, 1, 1);
    tag(279, 4, rows, height > 1 ? counts : row_bytes), tag(339, 3, 1, 2);
    if (geo) tag(33550, 12, 3, scale), tag(33922, 12, 6, scale + 24), tag(34735, 3, 16, scale + 72);
    u32(0);
    for (std::size_t r = 0; r < rows; ++r) u32(data + r * row_bytes);
    for (std::size_t r = 0; r < rows; ++r) u32(row_bytes);
    if (geo) {
        f64(0.01), f64(0.01), f64(0), f64(0), f64(0), f64(0), f64(10), f64(50), f64(0);
        for (const unsigned v : {1u, 1u, 0u, 3u, 1024u, 0u, 1u, 2u, 1025u, 0u, 1u, 1u, 2048u, 0u, 1u, 4326u}) u16(v);
    }
    for (int r = 0; r < height; ++r)
        for (int c = 0; c < width; ++c) u16(static_cast<unsigned>(value(c, r)) & 0xffff);
    return out;
}

/// A grey PNG of 8 or 16 bits a sample, not compressed; at most 65,535 bytes of samples.
inline std::string png_bytes(int width, int height, int bits, const std::function<unsigned(int, int)>& value) {
    const auto big = [](std::uint32_t v) {
        std::string bytes;
        for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(v >> shift & 255);
        return bytes;
    };
    const auto chunk = [&](const std::string& type_and_data) {
        std::uint32_t crc = 0xffffffff;
        for (const char c : type_and_data) {
            crc ^= static_cast<unsigned char>(c);
            for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
        }
        return big(static_cast<std::uint32_t>(type_and_data.size() - 4)) + type_and_data + big(~crc);
    };
    std::string rows;
    for (int r = 0; r < height; ++r) {
        rows += '\0';  // no filter
        for (int c = 0; c < width; ++c) rows += big(value(c, r)).substr(static_cast<std::size_t>(4 - bits / 8));
    }
    std::uint32_t a = 1, b = 0;  // Adler-32
    for (const char c : rows) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
    const auto n = static_cast<std::uint32_t>(rows.size());
    const auto little = [](std::uint32_t v) {
        return std::string{static_cast<char>(v & 255), static_cast<char>(v >> 8 & 255)};
    };
    const std::string header = big(static_cast<std::uint32_t>(width)) + big(static_cast<std::uint32_t>(height)) +
                               static_cast<char>(bits) + std::string(4, '\0');
    const std::string stored = "\x78\x01\x01" + little(n) + little(~n & 0xffff) + rows + big(b << 16 | a);
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + header) + chunk("IDAT" + stored) + chunk("IEND");
}

}  // namespace planet::testing
