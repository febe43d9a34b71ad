// Our TIN of a raw raster, as a PLY like those of the peers.
// tin_compare RASTER SIZE MAX_DEVIATION fast|standard|best THREADS OUTPUT
//     prints JSON: seconds and processor seconds that the TIN took, without reading and writing, and its peak memory in
//     bytes, the heights included

#include <sys/resource.h>

#include <bit>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

#include "planet/tin/tiled_tin.h"

namespace {

using namespace planet;

HeightGrid read_heights(const char* path, int size) {
    static_assert(std::endian::native == std::endian::little);
    Raster raster;
    raster.width = raster.height = size;
    std::vector<std::int16_t> samples(raster.count());
    std::ifstream(path, std::ios::binary)
        .read(reinterpret_cast<char*>(samples.data()), static_cast<std::streamsize>(2 * samples.size()));
    raster.samples = std::move(samples);
    return HeightGrid(raster);
}

// A line of /proc/self/status: VmRSS, or VmHWM, the most since it was last set back.
double resident_bytes(const char* which) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind(which, 0) == 0) return 1024 * std::stod(line.substr(std::strlen(which) + 1));
    return 0;
}
void set_peak_back() {
    std::ofstream("/proc/self/clear_refs") << 5;
}

double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void write_ply(const TinMesh& mesh, const char* path) {
    std::ofstream out(path, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const double place[] = {static_cast<double>(mesh.vertices[v].x), static_cast<double>(-mesh.vertices[v].y),
                                static_cast<double>(mesh.height[v])};
        out.write(reinterpret_cast<const char*>(place), sizeof place);
    }
    for (const auto& t : mesh.triangles) out.put(3).write(reinterpret_cast<const char*>(t.data()), sizeof t);
}

TinQuality quality_of(const std::string& name) {
    return name == "fast" ? TinQuality::fast : name == "standard" ? TinQuality::standard : TinQuality::best;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 7) return 2;
    const double before = resident_bytes("VmRSS:");
    const HeightGrid grid = read_heights(arguments[1], std::stoi(arguments[2]));
    const TiledTinOptions options{std::stod(arguments[3]), quality_of(arguments[4]),
                                  static_cast<unsigned>(std::stoi(arguments[5]))};
    set_peak_back();
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    const TinMesh mesh = tiled_tin(grid, options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("{\"seconds\": %.6f, \"processor\": %.6f, \"peak_bytes\": %.0f}\n", seconds,
                processor_seconds() - processor, resident_bytes("VmHWM:") - before);
    write_ply(mesh, arguments[6]);
}
