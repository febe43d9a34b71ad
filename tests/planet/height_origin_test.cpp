// Which source a height came from: in fields and in stores.

#include "planet/elevation/height_origin.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "planet/bake/bake.h"
#include "planet/elevation/constant_field.h"
#include "planet/elevation/elevation_sources.h"
#include "planet/elevation/fractal_field.h"
#include "planet/elevation/layered_field.h"
#include "planet/elevation/raster_field.h"
#include "planet/error.h"
#include "planet/mesh/deviation.h"
#include "planet/mesh/tile_layout.h"
#include "planet/store/store_field.h"
#include "raster_files.h"
#include "version3_store.h"

namespace planet {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

glm::dvec3 at_degrees(double latitude, double longitude) {
    return normal_from_geodetic(latitude * degrees, longitude * degrees);
}

WeighedOrigin origin_at(const ElevationField& field, double latitude, double longitude) {
    const glm::dvec3 n = at_degrees(latitude, longitude);
    float h = 0;
    WeighedOrigin origin;
    field.heights_with_origins({&n, 1}, {&h, 1}, {&origin, 1});
    EXPECT_EQ(h, field.height(n));
    return origin;
}

HeightOrigin only(std::uint32_t file) {
    return {file, file};
}

// ---- fields ---------------------------------------------------------------------------------------------------------

std::shared_ptr<const RasterField> raster_field(int width, int height, glm::dvec2 first, double step,
                                                const std::function<double(int, int)>& at) {
    Raster r;
    r.width = width;
    r.height = height;
    r.grid = {first, {step, 0}, {0, -step}};
    std::vector<float> samples;
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) samples.push_back(static_cast<float>(at(column, row)));
    r.samples = std::move(samples);
    r.crs = "EPSG:4326";
    r.name = std::to_string(width) + " columns";
    return std::make_shared<RasterField>(std::make_shared<const Raster>(std::move(r)), VerticalDatum::egm96);
}

/// A degree over the planet, 0.05 degrees in 8..12 with a hole around 10, 10, and 0.01 in 9..10, 11..12 above that.
struct ThreeLayers {
    std::shared_ptr<const RasterField> world =
        raster_field(360, 180, {-179.5, 89.5}, 1, [](int c, int) { return 300 + 0.1 * c; });
    std::shared_ptr<const RasterField> region = raster_field(80, 80, {8.025, 11.975}, 0.05, [](int c, int r) {
        return std::abs(c - 40) < 5 && std::abs(r - 40) < 5 ? nan : 900.0 + c;
    });
    std::shared_ptr<const RasterField> fine =
        raster_field(100, 100, {9.005, 11.995}, 0.01, [](int c, int) { return 1500.0 + c; });
};

TEST(LayeredOrigins, AreThoseOfTheHighestThatAnswers) {
    const ThreeLayers l;
    const LayeredField field({l.world, l.region, l.fine}, VerticalDatum::egm96);
    EXPECT_EQ(origin_at(field, 11.5, 9.5).origin, only(3));
    EXPECT_EQ(origin_at(field, 8.5, 8.5).origin, only(2));
    EXPECT_EQ(origin_at(field, -40, 100).origin, only(1));
    EXPECT_EQ(origin_at(field, 90, 0).origin, only(1));
    EXPECT_EQ(origin_at(field, -90, 77).origin, only(1));
    EXPECT_EQ(origin_at(field, 20, 180).origin, only(1));
    // The hole is less wide than two samples of the world: all of it is blended.
    const HeightOrigin in_hole = origin_at(LayeredField({l.world, l.region}, VerticalDatum::egm96), 10, 10).origin;
    EXPECT_TRUE((in_hole == HeightOrigin{1, 2} || in_hole == HeightOrigin{2, 1}));
}

// Going away from the border the finer one's weight falls from 1 to 0, and the first named changes once.
TEST(LayeredOrigins, ChangeOverWhereTheWeightsDo) {
    const ThreeLayers l;
    const LayeredField field({l.world, l.region}, VerticalDatum::egm96);
    double last = 1;
    std::set<std::uint32_t> seen;
    for (double longitude = 12.001; longitude < 15; longitude += 0.02) {
        const WeighedOrigin at = origin_at(field, 10, longitude);
        const double of_region = at.origin.file == 2   ? static_cast<double>(at.weight)
                                 : at.origin.blended() ? 1 - static_cast<double>(at.weight)
                                                       : 0;
        EXPECT_GE(at.weight, 0.5f);
        EXPECT_LE(of_region, last + 1e-6) << longitude;
        last = of_region;
        seen.insert(at.origin.file * 10 + at.origin.other);
        if (longitude > 14.1) {
            EXPECT_EQ(at.origin, only(1)) << longitude;
        }
    }
    EXPECT_TRUE(seen.contains(21) && seen.contains(12) && seen.contains(11));
}

// Heights are the same bits whether origins are asked for or not.
TEST(LayeredOrigins, LeaveHeightsAlone) {
    const ThreeLayers l;
    const LayeredField field({l.world, l.region, l.fine}, VerticalDatum::egm96);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> around(6, 14);
    std::vector<glm::dvec3> normals;
    for (int i = 0; i < 6000; ++i) normals.push_back(at_degrees(around(random), around(random)));
    normals[7] = glm::dvec3(nan);
    std::vector<float> alone(normals.size()), with(normals.size());
    std::vector<WeighedOrigin> origins(normals.size());
    field.heights(normals, alone);
    field.heights_with_origins(normals, with, origins);
    for (std::size_t i = 0; i < normals.size(); ++i) ASSERT_TRUE(i == 7 || alone[i] == with[i]) << i;
    EXPECT_TRUE(std::isnan(with[7]));
}

TEST(LayeredOrigins, AreNoSourceWhereNothingAnswers) {
    const ThreeLayers l;
    const LayeredField field({l.region}, VerticalDatum::egm96);
    EXPECT_EQ(origin_at(field, 9, 9).origin, only(1));
    EXPECT_EQ(origin_at(field, -40, 100).origin, only(0));
    EXPECT_EQ(origin_at(field, 9, 12.03).origin, (HeightOrigin{1, 0}));
    EXPECT_EQ(origin_at(field, 9, 12.09).origin, (HeightOrigin{0, 1}));
}

TEST(LayeredOrigins, CountThroughFieldsInFields) {
    const ThreeLayers l;
    const auto base = std::make_shared<LayeredField>(
        std::vector<std::shared_ptr<const ElevationField>>{std::make_shared<FractalField>(FractalParameters{}),
                                                           l.region},
        VerticalDatum::egm96);
    const LayeredField field({std::make_shared<ConstantField>(5.0), base, l.fine}, VerticalDatum::egm96);
    ASSERT_EQ(source_files(field.sources()).size(), 4u);
    EXPECT_EQ(origin_at(field, 11.5, 9.5).origin, only(4));
    EXPECT_EQ(origin_at(field, 8.5, 8.5).origin, only(3));
    EXPECT_EQ(origin_at(field, -8.5, 8.5).origin, only(2));
    EXPECT_EQ(origin_at(field, 10.995, 9.5).origin, (HeightOrigin{4, 3}));
}

// ---- mosaics --------------------------------------------------------------------------------------------------------

/// Three files of 61 x 61 samples of 0.01 degrees that share a row or column, one 8 columns; a.vrt is below all, c.vrt has
/// a void amid b.vrt's share.
struct Tiles {
    testing::TemporaryFolder folder;
    Tiles() {
        std::filesystem::create_directory(folder / "tiles");
        write("a", 20, 50, [](int, int) { return 100; });
        write("b", 20.6, 50, [](int, int) { return 200; });
        write("c", 21.12, 50, [](int c, int r) { return c < 4 && r > 20 && r < 40 ? -9999 : 300; });
    }
    void write(const std::string& name, double west, double north, const std::function<std::int16_t(int, int)>& at) {
        testing::write_raster<std::int16_t>(
            folder / "tiles/" + name + ".vrt",
            {61, 61, "EPSG:4326", {west - 0.005, 0.01, 0, north + 0.005, 0, -0.01}, "<NoDataValue>-9999</NoDataValue>"},
            at);
    }
    std::shared_ptr<const ElevationField> open(std::size_t memory_bytes = std::size_t{512} << 20) const {
        SourceOptions options;
        options.memory_bytes = memory_bytes;
        options.base = std::make_shared<ConstantField>(0.0);
        const SourceSpec source{folder / "tiles/*.vrt"};
        return open_elevation_sources({&source, 1}, options);
    }
};

TEST(MosaicOrigins, AreOfTheFileOfTheNearestSample) {
    const Tiles tiles;
    for (const std::size_t memory : {std::size_t{512} << 20, std::size_t{64} << 10}) {
        const auto field = tiles.open(memory);
        const auto files = source_files(field->sources());
        ASSERT_EQ(files.size(), 4u);
        EXPECT_EQ(files[1].name, "a.vrt");
        EXPECT_EQ(files[3].name, "c.vrt");
        EXPECT_EQ(files[3].source, 1u);
        EXPECT_EQ(origin_at(*field, 49.7, 20.3).origin, only(2));
        EXPECT_EQ(origin_at(*field, 49.7, 20.594).origin, only(2));
        EXPECT_EQ(origin_at(*field, 49.7, 20.596).origin, only(3));  // the shared column is the later one's
        EXPECT_EQ(origin_at(*field, 49.7, 20.8).origin, only(3));
        EXPECT_EQ(origin_at(*field, 49.9, 21.13).origin, only(4));
        EXPECT_EQ(origin_at(*field, 49.7, 21.13).origin, only(3));  // void in c
        EXPECT_EQ(origin_at(*field, 49.7, 21.156).origin, only(4));
        EXPECT_EQ(origin_at(*field, 49.7, 21.7205).origin.file, 4u);  // just inside the last half sample
        EXPECT_EQ(origin_at(*field, 10, 10).origin, only(1));
    }
}

TEST(MosaicOrigins, DoNotDependOnTheCompany) {
    const Tiles tiles;
    const auto field = tiles.open();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> latitude(49.3, 50.1), longitude(19.9, 21.9);
    std::vector<glm::dvec3> normals;
    for (int i = 0; i < 3000; ++i) normals.push_back(at_degrees(latitude(random), longitude(random)));
    for (int i = 0; i < 50; ++i) normals.push_back(at_degrees(-80 + 3 * i, 21));
    std::vector<float> h(normals.size());
    std::vector<WeighedOrigin> together(normals.size()), alone(1);
    field->heights_with_origins(normals, h, together);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        field->heights_with_origins({&normals[i], 1}, {h.data(), 1}, alone);
        ASSERT_EQ(alone[0].origin, together[i].origin) << i;
    }
}

// In a blend the file whose border is near is named, not the whole mosaic.
TEST(MosaicOrigins, AreNamedInBlendsToo) {
    const Tiles tiles;
    std::filesystem::remove(tiles.folder / "tiles/b.vrt");
    const auto spec = SourceSpec{tiles.folder / "tiles/*.vrt"};
    SourceOptions options;
    options.base = raster_field(360, 180, {-179.5, 89.5}, 1, [](int, int) { return 0; });
    const auto field = open_elevation_sources({&spec, 1}, options);
    EXPECT_EQ(origin_at(*field, 49.7, 20.62).origin, (HeightOrigin{2, 1}));
    EXPECT_EQ(origin_at(*field, 49.7, 21.10).origin, (HeightOrigin{3, 1}));
}

// Two files that meet at the antimeridian, on a grid that goes around: columns wrap.
TEST(MosaicOrigins, GoAroundThePlanet) {
    const testing::TemporaryFolder folder;
    for (const double west : {-180.0, 150.0})
        testing::write_raster<std::int16_t>(folder / (west < 0 ? "a.vrt" : "b.vrt"),
                                            {30, 60, "EPSG:4326", {west, 1, 0, 30, 0, -1}, ""},
                                            [&](int, int) { return static_cast<std::int16_t>(west); });
    const SourceSpec source{folder / "*.vrt"};
    const auto field = open_elevation_sources({&source, 1}, {});
    ASSERT_EQ(source_files(field->sources()).size(), 2u);
    EXPECT_EQ(origin_at(*field, 10, 179.9).origin, only(2));
    EXPECT_EQ(origin_at(*field, 10, -179.9).origin, only(1));
    EXPECT_EQ(origin_at(*field, 10, -150.6).origin, only(1));
    EXPECT_EQ(origin_at(*field, 10, 150.2).origin, only(2));
    EXPECT_EQ(origin_at(*field, 10, 180).origin.blended(), false);
    EXPECT_NE(origin_at(*field, 10, 180).origin, only(0));
    EXPECT_EQ(origin_at(*field, 10, 20).origin, only(0));
    // Both in one batch, which is wider than a window.
    const glm::dvec3 normals[2] = {at_degrees(0, 179.9), at_degrees(0, -179.9)};
    float h[2];
    WeighedOrigin origins[2];
    field->heights_with_origins(normals, h, origins);
    EXPECT_EQ(origins[0].origin, only(2));
    EXPECT_EQ(origins[1].origin, only(1));
}

TEST(MosaicOrigins, NamesSayTheFolderWhereFilesHaveSeveral) {
    const Tiles tiles;
    std::filesystem::create_directory(tiles.folder / "more");
    for (const char* file : {"a.vrt", "a.vrt.raw"})
        std::filesystem::rename(tiles.folder / ("tiles/" + std::string(file)),
                                tiles.folder / ("more/" + std::string(file)));
    const SourceSpec source{tiles.folder / "*/*.vrt"};
    const auto files = source_files(open_elevation_sources({&source, 1}, {})->sources());
    ASSERT_EQ(files.size(), 3u);
    EXPECT_EQ(files[0].name, "more/a.vrt");
    EXPECT_EQ(files[1].name, "tiles/b.vrt");
}

// ---- stores ---------------------------------------------------------------------------------------------------------

SurfaceOrigin surface_origin(const StoreField& field, double latitude, double longitude) {
    SurfaceCursor cursor = field.cursor();
    const glm::dvec3 n = at_degrees(latitude, longitude);
    cursor.seek(n);
    return cursor.origin(n);
}

std::vector<std::uint32_t> files_at(const StoreField& field, double latitude, double longitude) {
    const SurfaceOrigin origin = surface_origin(field, latitude, longitude);
    return {origin.files.begin(), origin.files.begin() + origin.count};
}

using Files = std::vector<std::uint32_t>;

class OriginStore : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new testing::TemporaryFolder;
        bake(*layers(), options(1), *folder_ / "store.octa");
    }
    static void TearDownTestSuite() { delete folder_; }

    /// The world, a raster across the antimeridian, one at the north pole, the region with its hole.
    static std::shared_ptr<const ElevationField> layers() {
        const ThreeLayers l;
        return std::make_shared<LayeredField>(
            std::vector<std::shared_ptr<const ElevationField>>{
                l.world, raster_field(40, 40, {178.05, 20.95}, 0.1, [](int c, int) { return 700.0 + c; }),
                raster_field(720, 10, {-179.75, 89.75}, 0.5, [](int, int r) { return 50.0 + r; }), l.region},
            VerticalDatum::egm96);
    }
    static BakeOptions options(int threads) {
        BakeOptions o;
        o.threads = threads;
        return o;
    }
    static StoreField open(const std::string& name = "store.octa") {
        return StoreField(std::make_shared<const ElevationStore>(ElevationStore::open(*folder_ / name)));
    }
    static inline testing::TemporaryFolder* folder_ = nullptr;
};

TEST_F(OriginStore, KnowsEverywhere) {
    const StoreField field = open();
    EXPECT_EQ(files_at(field, 9, 9), (Files{4}));
    EXPECT_EQ(files_at(field, 10, 10).size(), 2u);
    EXPECT_EQ(files_at(field, 19, 179.99), (Files{2}));
    EXPECT_EQ(files_at(field, 19, 180), (Files{2}));
    EXPECT_EQ(files_at(field, 19, -180), (Files{2}));
    EXPECT_EQ(files_at(field, 19, -179.5), (Files{2}));
    EXPECT_EQ(files_at(field, 90, 0), (Files{3}));
    EXPECT_EQ(files_at(field, 88, -120), (Files{3}));
    EXPECT_EQ(files_at(field, -90, 0), (Files{1}));
    EXPECT_EQ(files_at(field, 40, -100), (Files{1}));
    const StoreCheck check = field.store().verify();
    EXPECT_TRUE(check.ok()) << check.first_problems.front();
}

// At every finest vertex, those of sides and corners included: what the field says.
TEST_F(OriginStore, IsTheFieldAtEveryVertex) {
    const auto field = layers();
    const ElevationStore store = ElevationStore::open(*folder_ / "store.octa");
    std::size_t several = 0;
    for (const LocationCode root : store.tiles()) {
        const Tile tile = *store.read(root);
        TileLattice lattice;
        lattice.set_normals(corners(root), tile.depth);
        std::vector<glm::dvec3> normals;
        for (std::size_t v = 0; v < tile.height.size(); ++v) normals.push_back(lattice.normal(v));
        std::vector<float> heights(normals.size());
        std::vector<WeighedOrigin> origins(normals.size());
        field->heights_with_origins(normals, heights, origins);
        for (std::size_t v = 0; v < normals.size(); ++v)
            ASSERT_EQ(tile.origins[v], origins[v].origin) << to_string(root) << " " << v;
        several += tile.origins.kinds().size() > 1;
    }
    EXPECT_GT(several, 10u);
}

TEST_F(OriginStore, NamesTheNearestVertexFirst) {
    const StoreField field = open();
    const SurfaceCursor start = field.cursor();
    std::size_t mixed = 0;
    for (double longitude = 12; longitude < 15; longitude += 0.013) {
        const glm::dvec3 n = at_degrees(9.3, longitude);
        SurfaceCursor cursor = start;
        cursor.seek(n);
        const Corners c = corners(cursor.cell());
        const glm::dvec3 corner[3] = {c.left, c.right, c.apex};
        // Cells are small and nearly right: the corner with the greatest weight.
        glm::dvec3 weight;
        for (int k = 0; k < 3; ++k)
            weight[k] = glm::dot(n, glm::cross(corner[(k + 1) % 3], corner[(k + 2) % 3])) /
                        glm::dot(corner[k], glm::cross(corner[(k + 1) % 3], corner[(k + 2) % 3]));
        const int k = weight[0] >= weight[1] && weight[0] >= weight[2] ? 0 : weight[1] >= weight[2] ? 1 : 2;
        SurfaceCursor at_corner = start;
        at_corner.seek(corner[k]);
        const SurfaceOrigin here = cursor.origin(n), there = at_corner.origin(corner[k]);
        ASSERT_GT(there.count, 0u);
        EXPECT_EQ(here.files[0], there.files[0]) << longitude;
        EXPECT_GE(here.count, there.count);
        mixed += here.count > 1;
    }
    EXPECT_GT(mixed, 50u);
}

TEST_F(OriginStore, IsTheSameForAnyNumberOfThreads) {
    bake(*layers(), options(3), *folder_ / "three.octa");
    const auto bytes = [](const std::string& path) {
        std::ifstream in(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    EXPECT_TRUE(bytes(*folder_ / "store.octa") == bytes(*folder_ / "three.octa"));
}

TEST_F(OriginStore, OfVersion3IsReadWithoutThem) {
    std::filesystem::copy_file(*folder_ / "store.octa", *folder_ / "old.octa");
    testing::make_version_3(*folder_ / "old.octa");
    const StoreField old = open("old.octa"), field = open();
    EXPECT_EQ(old.store().metadata().format_version, 3);
    EXPECT_EQ(old.store().metadata().sources.size(), 4u);
    EXPECT_EQ(files_at(old, 9, 9), Files{});
    EXPECT_EQ(old.height(at_degrees(9.1, 9.2)), field.height(at_degrees(9.1, 9.2)));
    const StoreCheck check = old.store().verify();
    EXPECT_TRUE(check.ok()) << check.first_problems.front();
    BakeOptions again = options(1);
    again.resume = true;
    EXPECT_EQ(bake(*layers(), again, *folder_ / "old.octa").vertices_resumed, old.store().metadata().vertices);
}

TEST_F(OriginStore, VerifyFindsAVertexOfAnotherSource) {
    const std::filesystem::path path = *folder_ / "wrong.octa";
    std::filesystem::copy_file(*folder_ / "store.octa", path);
    {
        // All of one leaf tile from another file than the tiles around it.
        const ElevationStore store = ElevationStore::open(path);
        const auto tiles = store.tiles();
        const auto is_of_one = [&](LocationCode root) {
            const OriginPlane origins = store.read(root)->origins;
            return origins.kinds().size() == 1 && !origins[0].blended();
        };
        const LocationCode root = *std::find_if(tiles.rbegin(), tiles.rend(), is_of_one);
        const Tile tile = *store.read(root);
        SqliteFile file(path, SqliteFile::Access::recover);
        std::vector<std::uint8_t> payload(1 << 17);
        SqliteStatement select(file, "SELECT data FROM tiles WHERE code = ?");
        select.bind(1, static_cast<std::int64_t>(root.bits())).step();
        const auto frame = select.bytes(0);
        payload.resize(ZSTD_decompress(payload.data(), payload.size(), frame.data(), frame.size()));
        select.reset();
        ASSERT_EQ(payload.back(), 2 * tile.origins[0].file);
        payload.back() = static_cast<std::uint8_t>(2 * (tile.origins[0].file % 4 + 1));
        std::vector<std::uint8_t> bytes(ZSTD_compressBound(payload.size()));
        bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), payload.data(), payload.size(), 1));
        SqliteStatement update(file, "UPDATE tiles SET data = ? WHERE code = ?");
        update.bind(1, bytes).bind(2, static_cast<std::int64_t>(root.bits())).step();
    }
    EXPECT_FALSE(ElevationStore::open(path).verify().ok());
}

TEST_F(OriginStore, ResumesOnlyWithFilesOfTheSameNames) {
    const Tiles tiles;
    const std::string path = *folder_ / "tiles.octa";
    bake(*tiles.open(), options(1), path);
    BakeOptions again = options(1);
    again.resume = true;
    EXPECT_GT(bake(*tiles.open(), again, path).vertices_resumed, 0u);
    for (const char* ending : {".vrt", ".vrt.raw"}) {
        std::filesystem::rename(tiles.folder / ("tiles/a" + std::string(ending)),
                                tiles.folder / ("tiles/d" + std::string(ending)));
    }
    EXPECT_THROW(bake(*tiles.open(), again, path), Error);
}

}  // namespace
}  // namespace planet
