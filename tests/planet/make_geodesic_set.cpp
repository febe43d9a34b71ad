// Makes geodesic_set.txt: geodesics of WGS84 by GeographicLib's GeodesicExact, elliptic integrals instead of the series
// that planet/geodesy/geodesic.h uses.
//
//     g++ -O2 -std=c++20 make_geodesic_set.cpp -lGeographicLib -o make_geodesic_set && ./make_geodesic_set >geodesic_set.txt
//
// One geodesic a line: latitude, longitude and azimuth at the start, the same at the end (degrees), distance (m), and the
// area between it and the equator (m^2), in the order of Karney's GeodTest.dat. Every line is the shortest.

#include <GeographicLib/GeodesicExact.hpp>
#include <cstdint>
#include <cstdio>

namespace {

// The same numbers everywhere: Vigna's splitmix64.
class Random {
  public:
    double between(double low, double high) {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return low + (high - low) * static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }

  private:
    std::uint64_t state_ = 7;
};

const GeographicLib::GeodesicExact& lines = GeographicLib::GeodesicExact::WGS84();

void write(double lat1, double lon1, double lat2, double lon2) {
    double s12 = 0, azi1 = 0, azi2 = 0, m12 = 0, M12 = 0, M21 = 0, S12 = 0;
    lines.Inverse(lat1, lon1, lat2, lon2, s12, azi1, azi2, m12, M12, M21, S12);
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g %.9f %.3f\n", lat1, lon1, azi1, lat2, lon2, azi2, s12, S12);
}

}  // namespace

int main() {
    Random random;
    const auto latitude = [&] { return random.between(-90, 90); };
    const auto longitude = [&] { return random.between(-180, 180); };
    std::puts("# lat1 lon1 azi1 lat2 lon2 azi2 s12 S12, degrees, m and m^2: make_geodesic_set.cpp");
    std::puts("# anywhere");
    for (int i = 0; i < 150; ++i) write(latitude(), longitude(), latitude(), longitude());
    std::puts("# nearly antipodal: within half a degree");
    for (int i = 0; i < 100; ++i) {
        const double lat = latitude() * 0.99, lon = longitude();
        write(lat, lon, -lat + random.between(-0.5, 0.5), lon + 180 + random.between(-0.5, 0.5));
    }
    std::puts("# short: 1 m to 10 km");
    for (int i = 0; i < 60; ++i) {
        const double lat = latitude() * 0.99, lon = longitude(), d = std::pow(10, random.between(-5, -1));
        write(lat, lon, lat + d * random.between(-1, 1), lon + d * random.between(-1, 1));
    }
    std::puts("# along meridians and the equator");
    for (int i = 0; i < 30; ++i) {
        const double lon = longitude();
        write(latitude(), lon, latitude(), lon);
        write(0, lon, 0, lon + random.between(-179, 179));
    }
    std::puts("# an end at a pole or near one");
    for (int i = 0; i < 30; ++i) {
        write(i % 2 ? 90 : -90, longitude(), latitude(), longitude());
        write(i % 2 ? 89.999 : -89.999, longitude(), i % 3 ? 89.99 : -89.99, longitude());
    }
    return 0;
}
