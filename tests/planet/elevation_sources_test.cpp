#include "planet/elevation/elevation_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <tuple>

#include "planet/elevation/blocked_raster.h"
#include "planet/elevation/constant_field.h"
#include "planet/elevation/raster_field.h"
#include "planet/error.h"
#include "planet/parallel.h"
#include "raster_files.h"

namespace planet {
namespace {

using testing::RasterFile;
using testing::TemporaryFolder;
using testing::write_bytes;
using testing::write_raster;

constexpr std::int16_t none = -9999;

glm::dvec3 at_degrees(double latitude, double longitude) {
    return normal_from_geodetic(latitude * degrees, longitude * degrees);
}

std::int16_t relief(int c, int r) {
    return static_cast<std::int16_t>(
        std::lround(1500 + 700 * std::sin(c * 0.11) + 500 * std::cos(r * 0.13 + c * 0.02)));
}

RasterFile sheet(int width, int height, glm::dvec2 top_left, double step) {
    return {
        width, height, "EPSG:4326", {top_left.x, step, 0, top_left.y, 0, -step}, "<NoDataValue>-9999</NoDataValue>"};
}

std::shared_ptr<const RasterField> blocked_field(const std::string& path, std::size_t cache_bytes) {
    const auto mosaic = std::make_shared<const RasterMosaic>(std::vector{mosaic_part(path)},
                                                             std::filesystem::path(path).filename().string());
    const auto raster = std::make_shared<const BlockedRaster>(mosaic, std::make_shared<BlockCache>(cache_bytes));
    return std::make_shared<RasterField>(raster, raster->survey(), VerticalDatum::egm96);
}

// Directions all over a raster, on its edges, beyond them and along a line that crosses every block.
std::vector<glm::dvec3> places_on(const RasterField& field) {
    const RasterHeader& r = field.raster();
    std::mt19937 random(4);
    std::uniform_real_distribution<double> x(-2, r.width + 1), y(-2, r.height + 1);
    std::vector<glm::dvec2> at;
    for (int i = 0; i < 500; ++i) at.emplace_back(x(random), y(random));
    for (int i = 0; i < 4000; ++i) at.emplace_back(i * r.width / 4000.0, i * r.height / 4000.0);
    for (int i = 0; i < 2000; ++i) at.emplace_back(255.5 + 0.001 * i, i * 0.2);
    for (int i = 0; i < 2000; ++i) at.emplace_back(i * r.width / 2000.0, 256);
    for (glm::dvec2& p : at) p = r.grid.crs_from_sample(p);
    if (r.transform) r.transform->geodetic_from_crs(at);
    std::vector<glm::dvec3> normals;
    for (const glm::dvec2 p : at)
        if (!std::isnan(p.x) && std::abs(p.y) <= 90) normals.push_back(at_degrees(p.y, p.x));
    return normals;
}

void expect_same_bits(std::span<const float> a, std::span<const float> b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i]))
            << i << " " << a[i] << " " << b[i];
}

void expect_same_field(const std::string& path, std::size_t cache_bytes) {
    const auto whole = open_raster_field(path, VerticalDatum::egm96);
    const auto blocked = blocked_field(path, cache_bytes);
    const std::vector<glm::dvec3> normals = places_on(*whole);
    std::vector<float> a(normals.size()), b(normals.size());
    whole->heights(normals, a);
    blocked->heights(normals, b);
    expect_same_bits(a, b);
    EXPECT_GT(std::count_if(a.begin(), a.end(), [](float h) { return std::isfinite(h); }), 3000);
    for (std::size_t i = 0; i < normals.size(); i += 1171)
        for (const double angle : {0.0, 0.01, 0.1, 4.0}) {
            const Cap cap{normals[i], angle};
            ASSERT_EQ(whole->spacing(cap), blocked->spacing(cap));
            if (i % 2 != 0) continue;
            std::vector<glm::dvec3> n, m;
            std::vector<float> g, h;
            whole->samples(cap, n, g);
            blocked->samples(cap, m, h);
            ASSERT_EQ(n, m);
            expect_same_bits(g, h);
        }
    EXPECT_EQ(whole->border_size(), blocked->border_size());
    std::vector<glm::dvec3> n, m;
    whole->border({{0, 0, 1}, 4}, 1, n);
    blocked->border({{0, 0, 1}, 4}, 1, m);
    EXPECT_EQ(n, m);
    EXPECT_EQ(n.size(), whole->border_size());
    const SourceInfo s = whole->sources().at(0), t = blocked->sources().at(0);
    EXPECT_EQ(s.checksum, t.checksum);
    EXPECT_EQ(s.checksum.size(), 64u);
    EXPECT_EQ(s.name, t.name);
    EXPECT_EQ(s.crs, t.crs);
    EXPECT_EQ(s.spacing_m, t.spacing_m);
}

TEST(BlockedRaster, HasTheBitsOfTheWholeOne) {
    const TemporaryFolder folder;
    const auto with_voids = [](int c, int r) {
        return (c * 7 + r * 13) % 101 < 2 || (c > 300 && c < 330 && r > 250) ? none : relief(c, r);
    };
    write_raster<std::int16_t>(folder / "shorts", sheet(701, 523, {10, 47}, 0.01), with_voids);
    RasterFile scaled = sheet(300, 600, {178, 10}, 0.01);  // across the antimeridian
    scaled.band += "<Scale>0.25</Scale><Offset>-3</Offset>";
    write_raster<float>(folder / "floats", scaled,
                        [&](int c, int r) { return static_cast<float>(with_voids(c, r)) + 0.25f; });
    RasterFile utm{530, 410, "EPSG:32633", {400000, 90, 0, 5300000, 0, -90}, "<NoDataValue>-9999</NoDataValue>"};
    write_raster<std::int16_t>(folder / "utm", utm, with_voids);
    write_raster<std::uint16_t>(folder / "late", sheet(300, 600, {0, 0}, 0.01), [](int c, int r) {
        return static_cast<std::uint16_t>(c == 299 && r == 599 ? 40000 : relief(c, r));  // no 16-bit sample after all
    });
    write_bytes(folder / "strips.tif", testing::tiff_bytes(400, 300, true, relief));
    for (const char* name : {"shorts", "floats", "utm", "late", "strips.tif"})
        for (const std::size_t bytes : {std::size_t{300} << 10, std::size_t{64} << 20}) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(bytes));
            expect_same_field(folder / name, bytes);
        }
}

TEST(BlockedRaster, HasTheBitsOfTheWholeOneAroundThePlanet) {
    const TemporaryFolder folder;
    const auto value = [](int c, int r) {
        return static_cast<std::int16_t>(900 * std::sin(c * 2 * std::numbers::pi / 720) + r);
    };
    write_raster<std::int16_t>(folder / "pixels", sheet(720, 360, {-180, 90}, 0.5), value);
    write_raster<std::int16_t>(folder / "nodes", sheet(721, 361, {-180.25, 90.25}, 0.5), value);
    for (const char* name : {"pixels", "nodes"}) {
        SCOPED_TRACE(name);
        expect_same_field(folder / name, std::size_t{200} << 10);
        expect_same_field(folder / name, std::size_t{64} << 20);
    }
}

TEST(BlockedRaster, SeveralThreadsGetWhatOneGets) {
    const TemporaryFolder folder;
    write_raster<std::int16_t>(folder / "a", sheet(1500, 1100, {10, 47}, 0.01), relief);
    const auto whole = open_raster_field(folder / "a", VerticalDatum::egm96);
    const auto blocked = blocked_field(folder / "a", std::size_t{600} << 10);  // four blocks of thirty
    const std::vector<glm::dvec3> normals = places_on(*whole);
    std::vector<float> expected(normals.size());
    whole->heights(normals, expected);
    std::vector<std::vector<float>> found(4, std::vector<float>(normals.size()));
    parallel_for(found.size(), 4, [&](std::size_t i) { blocked->heights(normals, found[i]); });
    for (const auto& f : found) expect_same_bits(f, expected);
}

// The first thread opens, hands on and opens again: what it opened may share a position in the file.
TEST(BlockedRaster, AThreadReadsWhatItOpenedItself) {
    const TemporaryFolder folder;
    write_raster<std::int16_t>(folder / "a", sheet(900, 700, {10, 47}, 0.01), relief);
    std::atomic<int> wrong = 0;
    const auto read_some = [&](const RasterMosaic& mosaic, unsigned seed, int times) {
        std::mt19937 random(seed);
        std::vector<std::int16_t> samples(64 * 8);
        for (int n = 0; n < times; ++n) {
            const SampleWindow w{static_cast<int>(random() % 800), static_cast<int>(random() % 600), 64, 8};
            if (!mosaic.read(w, samples)) ++wrong;
            for (int k = 0; k < 64 * 8; ++k)
                if (samples[static_cast<std::size_t>(k)] != relief(w.column + k % 64, w.row + k / 64)) ++wrong;
        }
    };
    for (unsigned round = 0; round < 20; ++round) {
        const RasterMosaic mosaic({mosaic_part(folder / "a")}, "a");
        read_some(mosaic, round, 1);
        parallel_for(4, 4, [&](std::size_t i) { read_some(mosaic, round + static_cast<unsigned>(i), 200); });
    }
    EXPECT_EQ(wrong, 0);
}

TEST(BlockedRaster, KeepsToItsMemory) {
    const TemporaryFolder folder;
    write_raster<std::int16_t>(folder / "a", sheet(2000, 1500, {10, 47}, 0.01), relief);
    const auto cache = std::make_shared<BlockCache>(std::size_t{1} << 20);
    const auto mosaic = std::make_shared<const RasterMosaic>(std::vector{mosaic_part(folder / "a")}, "a");
    const BlockedRaster raster(mosaic, cache);
    EXPECT_LE(cache->bytes(), std::size_t{1} << 20);
    const std::uint64_t before = cache->made();
    SampleCursor cursor(raster);
    for (int c = 0; c < 2000; ++c) EXPECT_EQ(cursor.at(c, 700).raw(c, 700), relief(c, 700));
    EXPECT_LE(cache->bytes(), std::size_t{1} << 20);
    EXPECT_LE(cache->made() - before, 8u);  // once each
}

TEST(BlockedRaster, AFileThatChangesOrVanishesOrIsCutIsOneLine) {
    const TemporaryFolder folder;
    const auto error_after = [&](const std::function<void(const std::string&)>& change) -> std::string {
        const std::string path = folder / "a.tif";
        write_bytes(path, testing::tiff_bytes(900, 900, true, relief));
        const auto field = blocked_field(path, 1);
        change(path);
        try {
            for (double y = 41.1; y < 50; y += 0.5) field->height(at_degrees(y, 14));
        } catch (const Error& e) {
            EXPECT_EQ(e.fault(), Fault::bad_data);
            EXPECT_EQ(std::string(e.what()).rfind(path, 0), 0u) << e.what();
            return e.what();
        }
        return "";
    };
    EXPECT_EQ(error_after([](const std::string&) {}), "");
    EXPECT_NE(error_after([](const std::string& p) { std::filesystem::remove(p); }).find("has vanished"),
              std::string::npos);
    EXPECT_NE(error_after([](const std::string& p) {
                  write_bytes(p, testing::tiff_bytes(900, 901, true, relief));
              }).find("has changed"),
              std::string::npos);
    // Cut in the middle before it is opened: the block that cannot be read is named.
    const std::string whole = testing::tiff_bytes(900, 900, true, relief);
    write_bytes(folder / "cut.tif", whole.substr(0, whole.size() * 2 / 3));
    try {
        blocked_field(folder / "cut.tif", std::size_t{1} << 20);
        FAIL() << "a file that is cut short was read";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("in row 598, columns 0 to 899"), std::string::npos) << e.what();
    }
}

// Opened with memory for all samples, or for hardly any of them.
std::shared_ptr<const ElevationField> open_sources(const std::vector<SourceSpec>& sources, SourceOptions options = {},
                                                   bool in_blocks = false) {
    options.memory_bytes = in_blocks ? std::size_t{2} << 20 : std::size_t{256} << 20;
    return open_elevation_sources(sources, options);
}

// Tiles of 1 degree with 101 x 101 samples that share their borders, as SRTM has them, cut from one relief.
void write_tiles(const TemporaryFolder& folder, int columns, int rows, const std::function<bool(int, int)>& is_there) {
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            if (!is_there(i, j)) continue;
            const RasterFile file = sheet(101, 101, {10 + i - 0.005, 50 - j + 0.005}, 0.01);
            write_raster<std::int16_t>(folder / ("tile" + std::to_string(rows - j) + std::to_string(i) + ".vrt"), file,
                                       [&](int c, int r) { return relief(100 * i + c, 100 * j + r); });
        }
}

TEST(ElevationSources, TilesOfAPatternAreOneMosaicWithoutSeams) {
    const TemporaryFolder folder;
    write_tiles(folder, 4, 3, [](int i, int j) { return !(i == 2 && j == 1); });
    write_raster<std::int16_t>(folder / "all", sheet(401, 301, {9.995, 50.005}, 0.01), [](int c, int r) {
        const bool missing = c > 200 && c < 300 && r > 100 && r < 200;
        return missing ? none : relief(c, r);
    });
    const auto one = open_sources({{folder / "all"}});
    for (const bool in_blocks : {false, true}) {
        const auto tiles = open_sources({{folder / "*.vrt"}}, {}, in_blocks);
        ASSERT_EQ(tiles->sources().size(), 1u);
        EXPECT_EQ(tiles->sources()[0].name, "*.vrt (11 files)");
        std::vector<glm::dvec3> normals;
        for (double y = 46.9; y < 50.1; y += 0.0137)
            for (double x = 9.9; x < 14.1; x += 0.0171) normals.push_back(at_degrees(y, x));
        std::vector<float> a(normals.size()), b(normals.size());
        one->heights(normals, a);
        tiles->heights(normals, b);
        for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 2e-3) << i;  // origins differ by roundings
        std::vector<glm::dvec3> n;
        std::vector<float> h;
        tiles->samples({{0, 0, 1}, 4}, n, h);
        EXPECT_EQ(n.size(), 401u * 301 - 99 * 99);  // none twice
    }
    EXPECT_EQ(open_sources({{folder / "*.vrt"}})->sources()[0].checksum,
              open_sources({{folder / "*.vrt"}}, {}, true)->sources()[0].checksum);
}

// As they are distributed: 1201 x 1201 big-endian shorts, the place in the name, borders shared, -32768 for voids.
TEST(ElevationSources, TilesOfSrtmAreSeamless) {
    const TemporaryFolder folder;
    const auto H = [](int c, int r) { return relief(c / 3, r / 3) + c % 3; };  // counted from 10 E, 49 N
    for (const auto& [name, column, row] :
         {std::tuple{"N48E010.hgt", 0, 0}, {"N48E011.hgt", 1200, 0}, {"N47E011.hgt", 1200, 1200}}) {
        std::string bytes;
        for (int r = 0; r <= 1200; ++r)
            for (int c = 0; c <= 1200; ++c) {
                const int v = c == 600 && r == 700 ? -32768 : H(column + c, row + r);
                bytes += static_cast<char>(v >> 8 & 255);
                bytes += static_cast<char>(v & 255);
            }
        write_bytes(folder / name, bytes);
    }
    for (const bool in_blocks : {false, true}) {
        const auto field = open_sources({{folder / "*.hgt"}}, {}, in_blocks);
        ASSERT_EQ(field->sources().size(), 1u);
        EXPECT_EQ(field->sources()[0].crs, "EPSG:4326");
        const auto at = [&](double c, double r) { return field->height(at_degrees(49 - r / 1200, 10 + c / 1200)); };
        for (int r = 3; r < 1200; r += 13)
            for (const double c : {0.0, 3.0, 1197.0, 1199.0, 1200.0, 1201.0, 1203.0, 2400.0})
                ASSERT_NEAR(at(c, r), H(static_cast<int>(c), r), 0.01) << c << " " << r;
        for (int c = 1210; c < 2390; c += 7) ASSERT_NEAR(at(c, 1200), H(c, 1200), 0.01) << c;
        // Across the border of two tiles the surface is the bicubic one, with samples of both.
        const double t = 0.5, expected = -0.0625 * (H(1198, 50) + H(1201, 50)) + 0.5625 * (H(1199, 50) + H(1200, 50));
        EXPECT_NEAR(at(1199 + t, 50), expected, 0.05);
        std::vector<glm::dvec3> n;
        std::vector<float> h;
        field->samples({{0, 0, 1}, 4}, n, h);
        EXPECT_EQ(n.size(), 3u * 1201 * 1201 - 2 * 1201 - 3);  // shared rows and columns once; the voids not
    }
}

TEST(ElevationSources, FilesThatDifferAreLayersAndLaterOnesLieOnTop) {
    const TemporaryFolder folder;
    const auto level = [](int metres) { return [metres](int, int) { return static_cast<std::int16_t>(metres); }; };
    write_raster<std::int16_t>(folder / "a1.dem", sheet(100, 100, {10, 50}, 0.01), level(100));
    write_raster<std::int16_t>(folder / "a2.dem", sheet(100, 100, {10.5, 50}, 0.01), level(200));    // same grid
    write_raster<std::int16_t>(folder / "a3.dem", sheet(100, 100, {10.203, 50}, 0.01), level(300));  // another phase
    write_raster<std::int16_t>(folder / "a4.dem", sheet(30, 30, {10.6, 49.9}, 0.02), level(400));    // another spacing
    write_raster<std::int16_t>(folder / "b.dem", sheet(20, 20, {10.1, 49.9}, 0.01), level(500));
    const auto field = open_sources({{folder / "a?.dem"}, {folder / "b.dem"}});
    ASSERT_EQ(field->sources().size(), 4u);
    EXPECT_EQ(field->sources()[0].name, "a?.dem (2 files)");
    EXPECT_EQ(field->sources()[3].name, "b.dem");
    EXPECT_EQ(field->height(at_degrees(49.5, 10.1)), 100);
    EXPECT_EQ(field->height(at_degrees(49.5, 11.4)), 200);
    EXPECT_EQ(field->height(at_degrees(49.95, 10.7)), 300);
    EXPECT_EQ(field->height(at_degrees(49.5, 10.8)), 400);
    EXPECT_EQ(field->height(at_degrees(49.8, 10.2)), 500);
    EXPECT_EQ(field->height(at_degrees(20, 10)), 0);
    SourceOptions options;
    options.base = std::make_shared<const ConstantField>(70);
    EXPECT_EQ(open_sources({{folder / "b.dem"}}, options)->height(at_degrees(-50, -100)), 70);
}

// One hill of 800 m: degrees above EGM96 by the CRS, metres of UTM above the ellipsoid, feet; N = 40 m + 10 m x.
double hill_m(double latitude, double longitude) {
    const double x = (longitude - 15) / 0.3, y = (latitude - 47) / 0.2;
    return 500 + 800 * std::exp(-x * x - y * y);
}
GeoidUndulation undulation(const glm::dvec3& n) {
    return {40 + 10 * n.x};
}

TEST(ElevationSources, OneHillInThreeDatumsAndSystemsIsOneHill) {
    const TemporaryFolder folder;
    const auto degrees_of = [](int c, int r) { return glm::dvec2(14.5 + 0.002 * (c + 0.5), 47.3 - 0.002 * (r + 0.5)); };
    const auto H = [&](int c, int r) { return hill_m(degrees_of(c, r).y, degrees_of(c, r).x); };
    RasterFile file{500, 300, "EPSG:4326+5773", {14.5, 0.002, 0, 47.3, 0, -0.002}, ""};
    write_raster<double>(folder / "egm96", file, H);
    file.crs = "EPSG:4326";
    file.band = "<UnitType>ft</UnitType>";
    write_raster<double>(folder / "feet", file, [&](int c, int r) { return H(c, r) / 0.3048; });
    file.band = "";
    file.crs = "EPSG:4979";
    const auto h = [&](double latitude, double longitude) {
        return hill_m(latitude, longitude) + undulation(at_degrees(latitude, longitude)).m;
    };
    write_raster<double>(folder / "three_axes", file,
                         [&](int c, int r) { return h(degrees_of(c, r).y, degrees_of(c, r).x); });
    RasterFile utm{400, 300, "EPSG:32633", {462000, 200, 0, 5238000, 0, -200}, ""};
    write_raster<double>(folder / "plan", utm, [](int, int) { return 0.0; });
    const Raster plan = read_raster(folder / "plan");
    write_raster<double>(folder / "utm", utm, [&](int c, int r) {
        glm::dvec2 p = plan.grid.crs_from_sample({c, r});
        plan.transform->geodetic_from_crs({&p, 1});
        return h(p.y, p.x);
    });
    SourceOptions options;
    options.geoid = [](std::span<const glm::dvec3> n, std::span<GeoidUndulation> out) {
        std::transform(n.begin(), n.end(), out.begin(), undulation);
    };
    const auto ellipsoid = VerticalDatum::ellipsoid;
    const std::vector<SourceSpec> specs = {
        {folder / "egm96"}, {folder / "feet"}, {folder / "three_axes"}, {folder / "utm", ellipsoid}};
    for (const VerticalDatum datum : {VerticalDatum::egm96, ellipsoid}) {
        options.datum = datum;
        for (const SourceSpec& spec : specs) {
            const auto field = open_sources({spec}, options);
            EXPECT_EQ(field->datum(), datum);
            const SourceInfo info = field->sources().at(0);
            EXPECT_EQ(info.datum_assumed, info.name == "feet") << info.name;
            EXPECT_EQ(info.datum == ellipsoid, info.name == "utm" || info.name == "three_axes") << info.name;
            for (double y = 46.85; y < 47.15; y += 0.0173)
                for (double x = 14.7; x < 15.3; x += 0.0191) {
                    const double N = datum == ellipsoid ? undulation(at_degrees(y, x)).m : 0;
                    // 1/256 of a sample of 200 m, on slopes of up to 3 %, and the interpolation.
                    ASSERT_NEAR(field->height(at_degrees(y, x)), hill_m(y, x) + N, 0.06) << info.name << y << " " << x;
                }
        }
    }
    options.geoid = {};
    EXPECT_THROW(open_sources({specs[0]}, options), Error);
}

TEST(ElevationSources, EachMistakeGetsItsOwnLine) {
    const TemporaryFolder folder;
    const auto error_of = [&](const std::vector<SourceSpec>& specs) -> std::string {
        try {
            open_sources(specs);
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        return "";
    };
    const auto expect = [&](const std::string& file, const std::string& part) {
        const std::string text = error_of({{folder / file}});
        EXPECT_NE(text.find(part), std::string::npos) << file << ": " << text;
        EXPECT_EQ(text.rfind(folder / file, 0), 0u) << text;
    };
    EXPECT_NE(error_of({}).find("no source"), std::string::npos);
    expect("missing.tif", "no such file");
    expect("*.hgt", "matches no file; accepted: a pattern");
    expect("", "cannot be read");  // the folder itself
    RasterFile file = sheet(4, 3, {10, 50}, 0.5);
    write_raster<std::uint8_t>(
        folder / "rgb", file, [](int, int) { return std::uint8_t{1}; }, 3);
    expect("rgb", "colour picture");
    const auto zero = [](int, int) { return std::int16_t{0}; };
    file.crs = "EPSG:4326+3855";
    write_raster<std::int16_t>(folder / "egm2008", file, zero);
    expect("egm2008", "EPSG:3855, which cannot be converted; accepted: EGM96 (EPSG:5773) or the ellipsoid; --datum");
    EXPECT_EQ(error_of({{folder / "egm2008", VerticalDatum::egm96}}), "");
    file.crs = "";
    file.geotransform[0] = 500000;
    write_raster<std::int16_t>(folder / "nowhere", file, zero);
    expect("nowhere", "does not name its CRS");
    file = sheet(400, 300, {10, 50}, 0.01);
    write_raster<std::int16_t>(folder / "void", file, [](int, int) { return none; });
    EXPECT_NE(error_of({{folder / "void"}}).find("every sample is nodata"), std::string::npos);
    EXPECT_THROW(open_sources({{folder / "void"}}, {}, true), Error);
}

TEST(ElevationSources, PatternsAreExpandedInTheOrderOfNames) {
    const TemporaryFolder folder;
    for (const char* name : {"b", "a10", "a9", "odd[1]*"}) write_bytes(folder / name, "x");
    std::filesystem::create_directory(folder / "a_folder");
    const auto names = [&](const std::string& pattern) {
        std::vector<std::string> found;
        for (const std::string& f : files_of_pattern(folder / pattern))
            found.push_back(std::filesystem::path(f).filename());
        return found;
    };
    EXPECT_EQ(names("a*"), (std::vector<std::string>{"a10", "a9"}));
    EXPECT_EQ(names("[!ao]"), (std::vector<std::string>{"b"}));
    EXPECT_EQ(names("odd[1]*"), (std::vector<std::string>{"odd[1]*"}));  // a name that looks like a pattern
    EXPECT_EQ(names("missing"), (std::vector<std::string>{"missing"}));  // for whoever opens it
}

}  // namespace
}  // namespace planet
