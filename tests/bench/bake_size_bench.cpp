// Bytes for the same heights: tiles of a store, and a GeoTIFF with DEFLATE and predictor 2 by gdal_translate. Two cells
// that share their split side are a square, and the lattice in it is a raster: 513 x 513 vertices amid the shipped DEM.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "bake_scene.h"
#include "planet/bake/bake.h"
#include "planet/store/tile_sides.h"

namespace {

using namespace planet;
using bench::bake_scene;

constexpr int square_level = 17, lattice_level = 35;
constexpr int steps = 1 << ((lattice_level - square_level) / 2);

struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("octaglobe bake_bench " + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
};

class LatticeSquare {
  public:
    LatticeSquare() {
        for (const BakedTile& t : bake_scene().tiles) tiles_.emplace(t.tile.root.bits(), &t);
        for (const BakedTile* t : bake_scene().leaves) {
            const LocationCode cell = t->tile.root.ancestor(square_level);
            if (fill(cell) && fill(neighbor(cell))) return;
            height.assign(height.size(), 0);
            leaf_bytes = leaf_tiles = 0;
        }
        throw std::runtime_error("no square of the lattice is whole");
    }

    std::vector<std::int16_t> height = std::vector<std::int16_t>((steps + 1) * (steps + 1));  ///< in quanta, row-major
    std::size_t leaf_bytes = 0, leaf_tiles = 0;
    /// Bytes of the inner tile above, by tile below it.
    double inner_bytes_a_tile = 0;

  private:
    struct Corner {
        int x, y;
    };

    bool fill(LocationCode cell) {
        // The lesser of the two has its apex at the origin; the other one's left is its right.
        const bool first = cell < neighbor(cell);
        const Corner left = first ? Corner{steps, 0} : Corner{0, steps},
                     right = first ? Corner{0, steps} : Corner{steps, 0},
                     apex = first ? Corner{0, 0} : Corner{steps, steps};
        const auto [root, local] = cell_in_tile(cell, bake_scene().scale.layers);
        const auto holder = tiles_.find(root.bits());
        if (holder == tiles_.end()) return false;
        const auto& vertex = tile_layout().corners[local];
        const Corner at[3] = {left, right, apex};
        for (std::size_t k = 0; k < 3; ++k) put(at[k], *holder->second, vertex[k]);
        const BakedTile& above = *holder->second;
        inner_bytes_a_tile = static_cast<double>(encode_tile(above, bake_scene().scale).size()) /
                             static_cast<double>(above.tile.child_exists.count());
        return fill(cell, left, right, apex);
    }

    bool fill(LocationCode cell, Corner left, Corner right, Corner apex) {
        const auto [root, local] = cell_in_tile(cell, bake_scene().scale.layers);
        const auto holder = tiles_.find(root.bits());
        if (holder == tiles_.end() || local >> holder->second->tile.depth || !holder->second->exists[local])
            return false;
        if (local == 1) {
            ++leaf_tiles;
            leaf_bytes += encode_tile(*holder->second, bake_scene().scale).size();
        }
        const Corner middle{(left.x + right.x) / 2, (left.y + right.y) / 2};
        put(middle, *holder->second, tile_layout().split_vertex[local]);
        return cell.bisection_level() + 1 == lattice_level ||
               (fill(cell.child(0), left, apex, middle) && fill(cell.child(1), apex, right, middle));
    }

    void put(Corner at, const BakedTile& tile, std::size_t vertex) {
        height[static_cast<std::size_t>(at.y * (steps + 1) + at.x)] =
            static_cast<std::int16_t>(tile.tile.height[vertex] / static_cast<float>(bake_scene().scale.quantum_m));
    }

    std::map<std::uint64_t, const BakedTile*> tiles_;
};

const LatticeSquare& square() {
    static const LatticeSquare s;
    return s;
}

double a_vertex(double bytes) {
    return bytes / static_cast<double>(square().height.size());
}

// Bytes of the store's file for every byte of its tiles.
double sqlite_factor() {
    static const double factor = [] {
        const Folder folder;
        const auto file = folder.path / "dem.octa";
        const BakeReport report = bake(*bake_scene().field, {}, file);
        return static_cast<double>(std::filesystem::file_size(file)) / static_cast<double>(report.tile_bytes);
    }();
    return factor;
}

void size_as_tiles(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(square().leaf_bytes);
    const auto leaves = static_cast<double>(square().leaf_bytes);
    const double inner = square().inner_bytes_a_tile * static_cast<double>(square().leaf_tiles);
    state.counters["leaves"] = a_vertex(leaves);
    state.counters["inner"] = a_vertex(inner);
    state.counters["sqlite"] = a_vertex((leaves + inner) * (sqlite_factor() - 1));
    state.counters["bytes_a_vertex"] = a_vertex((leaves + inner) * sqlite_factor());
}
BENCHMARK(size_as_tiles)->Iterations(1);

// @param options of the creation of a GeoTIFF, or none for the raster as it is
double geotiff_bytes(const std::string& options) {
    const Folder folder;
    const std::string raw = (folder.path / "lattice.raw").string(), tiff = (folder.path / "lattice.tif").string();
    const auto& height = square().height;
    std::ofstream(raw, std::ios::binary)
        .write(reinterpret_cast<const char*>(height.data()), static_cast<std::streamsize>(2 * height.size()));
    std::ofstream(folder.path / "lattice.hdr") << "ENVI\nsamples = " << steps + 1 << "\nlines = " << steps + 1
                                               << "\nbands = 1\ndata type = 2\ninterleave = bsq\nbyte order = 0\n";
    const std::string command = "gdal_translate -q " + options + " '" + raw + "' '" + tiff + "'";
    return std::system(command.c_str()) == 0 ? static_cast<double>(std::filesystem::file_size(tiff)) : 0;
}

void size_as_geotiff(benchmark::State& state, const std::string& options) {
    double bytes = 0;
    for (auto _ : state) bytes = geotiff_bytes(options);
    if (bytes == 0) state.SkipWithError("gdal_translate is needed");
    state.counters["bytes_a_vertex"] = a_vertex(bytes);
}
BENCHMARK_CAPTURE(size_as_geotiff, plain, "")->Iterations(1);
BENCHMARK_CAPTURE(size_as_geotiff, deflate, "-co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR=2")->Iterations(1);
BENCHMARK_CAPTURE(size_as_geotiff, deflate_9, "-co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR=2 -co ZLEVEL=9")
    ->Iterations(1);

}  // namespace
