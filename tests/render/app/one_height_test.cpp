// One height: what a query answers, what an exported mesh has and what a ray meets in a picture agree within what is
// stated of each, at 10,000 places over land, sea, poles and seams.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "planet/exporters/mesh_file.h"
#include "planet/mesh/pick.h"
#include "planet/octahedron/octahedron_map.h"
#include "planet/terrain/ground.h"
#include "tests/render/app/earth_views.h"
#include "tests/render/app/program_process.h"

namespace render {
namespace {

using planet::degrees;
using planet::wgs84;

/// Latitude and longitude in radians: a quarter each in the finest data, anywhere, near the poles, and at seams of faces.
std::vector<planet::Geodetic> places() {
    std::mt19937_64 engine(11);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    };
    std::vector<planet::Geodetic> list;
    for (int i = 0; i < 2500; ++i) {
        list.push_back({between(37.05, 37.95) * degrees, between(-105.95, -104.05) * degrees, {}});
        list.push_back({std::asin(between(-1, 1)), between(-180, 180) * degrees, {}});
        list.push_back(
            {(i % 2 ? 1 : -1) * (90 - std::pow(between(0, 2), 3)) * degrees, between(-180, 180) * degrees, {}});
        const double along = between(-180, 180), off = between(-1, 1) * (i % 3 ? 1e-9 : 0.1);
        const bool meridian = i % 2 == 0;
        list.push_back({(meridian ? along / 2 : off) * degrees,
                        (meridian ? std::remainder(90 * (i / 2 % 4) + off, 360) : along) * degrees,
                        {}});
    }
    list[1] = {90 * degrees, 0, {}};
    list[2] = {-90 * degrees, 0, {}};
    list[3] = {0, 180 * degrees, {}};
    return list;
}

struct Heights {
    double height, bound;
};

/// What the program says, from a table it reads.
std::vector<Heights> queried(const ScratchFolder& folder, const std::vector<planet::Geodetic>& list) {
    {
        std::ofstream out(folder / "places.csv");
        out.precision(17);
        out << "latitude,longitude\n";
        for (const auto& p : list) out << p.latitude / degrees << ',' << p.longitude / degrees << '\n';
    }
    const Outcome outcome = run(folder.path(), words("query height --points places.csv -o heights.csv"));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::ifstream in(folder / "heights.csv");
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "latitude_deg,longitude_deg,height_m,ellipsoidal_height_m,height_bound_m,source,blended_with");
    std::vector<Heights> heights;
    while (std::getline(in, line)) {
        std::istringstream fields(line);
        std::string field[5];
        for (auto& f : field) std::getline(fields, f, ',');
        heights.push_back({std::strtod(field[2].c_str(), nullptr), std::strtod(field[4].c_str(), nullptr)});
    }
    return heights;
}

/// The triangles of an ecef mesh by direction.
class MeshSurface {
  public:
    explicit MeshSurface(planet::SurfaceMesh mesh) : mesh_(std::move(mesh)), bins_(6 * side * side) {
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            glm::dvec3 low(2), high(-2);
            for (const auto v : mesh_.triangles[t]) {
                const glm::dvec3 n = glm::normalize(mesh_.vertices[v]);
                low = glm::min(low, n);
                high = glm::max(high, n);
            }
            add(t, low - 0.02, high + 0.02);
        }
    }

    /// Metres above the ellipsoid where the normal's line meets a triangle.
    std::optional<double> height(const glm::dvec3& n) const {
        const glm::dvec3 foot = planet::ecef_from_normal(wgs84, n);
        std::optional<double> best;
        double least = -1e9;
        for (const auto t : bins_[bin_of(glm::normalize(foot))]) {
            const auto& [i, j, k] = mesh_.triangles[t];
            const glm::dvec3 a = mesh_.vertices[i] - foot, b = mesh_.vertices[j] - foot, c = mesh_.vertices[k] - foot;
            const glm::dvec3 plane = glm::cross(b - a, c - a);
            if (glm::dot(plane, n) <= 0) continue;
            // The triangle in which the line is farthest inside: on sides and corners one of those that meet there.
            const double inside = std::min({glm::dot(glm::cross(a, b), n), glm::dot(glm::cross(b, c), n),
                                            glm::dot(glm::cross(c, a), n)}) /
                                  glm::dot(plane, n);
            if (inside > least) least = inside, best = glm::dot(a, plane) / glm::dot(n, plane);
        }
        return least > -1e-6 ? best : std::nullopt;
    }

  private:
    static constexpr int side = 40;
    static std::size_t bin(int face, int x, int y) { return static_cast<std::size_t>((face * side + y) * side + x); }
    static int cell(double v) { return std::clamp(static_cast<int>((v + 1) / 2 * side), 0, side - 1); }
    static std::size_t bin_of(const glm::dvec3& n) {
        const glm::dvec3 a = glm::abs(n);
        const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
        return bin(2 * axis + (n[axis] < 0), cell(n[(axis + 1) % 3]), cell(n[(axis + 2) % 3]));
    }
    void add(std::uint32_t t, const glm::dvec3& low, const glm::dvec3& high) {
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2;
            if (face % 2 ? low[axis] > -0.5 : high[axis] < 0.5) continue;
            for (int y = cell(low[(axis + 2) % 3]); y <= cell(high[(axis + 2) % 3]); ++y)
                for (int x = cell(low[(axis + 1) % 3]); x <= cell(high[(axis + 1) % 3]); ++x)
                    bins_[bin(face, x, y)].push_back(t);
        }
    }

    planet::SurfaceMesh mesh_;
    std::vector<std::vector<std::uint32_t>> bins_;
};

class OneHeight : public ::testing::Test {
  protected:
    OneHeight() {
        const EarthSources sources;
        LazyEarth earth(sources);
        ChecksumIndex index = user_checksum_index();
        store_ = open_earth_store(sources, earth, index, [](std::string_view, double) {});
    }
    std::shared_ptr<const planet::ElevationStore> store_;
};

TEST_F(OneHeight, QueryMeshAndPickAgree) {
    const ScratchFolder folder;
    const std::vector<planet::Geodetic> list = places();
    const std::vector<Heights> answers = queried(folder, list);
    ASSERT_EQ(answers.size(), 10000u);

    const Outcome exported =
        run(folder.path(), words("mesh --planet --max-deviation 500 -o earth.ply --json earth.json"));
    ASSERT_EQ(exported.status, 0) << exported.err;
    const double mesh_deviation =
        nlohmann::json::parse(content(folder / "earth.json")).at("deviation_max_m").get<double>();
    ASSERT_LE(mesh_deviation, 500);
    const MeshSurface mesh(planet::read_mesh(folder / "earth.ply"));

    const testing::ExaggeratedEarth earth(store_, 1);
    planet::SurfaceCursor cursor = earth.field().cursor();
    double worst_mesh = 0, worst_pick = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const glm::dvec3 n = planet::normal_from_geodetic(list[i].latitude, list[i].longitude);
        const planet::Ground ground = planet::ground_at(cursor, n);
        // The program: to the decimals that it prints, and what degrees lose.
        ASSERT_NEAR(answers[i].height, ground.height, 0.0006) << i;
        ASSERT_NEAR(answers[i].bound, ground.bound, 0.0006 + 1e-6 * ground.bound) << i;

        // The exported mesh is within its deviation of the planes that the answer is above by its sag.
        const auto of_mesh = mesh.height(n);
        ASSERT_TRUE(of_mesh) << i;
        const double off_mesh = std::abs(*of_mesh - (ground.drawn + ground.undulation));
        ASSERT_LE(off_mesh, mesh_deviation + 0.001) << i;
        worst_mesh = std::max(worst_mesh, off_mesh);

        // A ray at a place from somewhere, in a picture of half a pixel: every zoom from 100 m to 20,000 km.
        const double away = 100 * std::exp2(17.6 * static_cast<double>(i % 97) / 96);
        const planet::EllipsoidalHeight eye_height{ground.h().m + away};
        const glm::dvec3 eye = planet::ecef_from_normal(wgs84, n, eye_height);
        const auto picked = planet::pick(earth.tiles(), {eye, planet::split_reach(1000, 0.5, 0.5)}, eye, -n);
        ASSERT_TRUE(picked) << i;
        const double off_pick =
            std::abs(planet::height_from_ecef(wgs84, picked->position).m - (ground.drawn + ground.undulation));
        ASSERT_LE(off_pick, picked->deviation + 0.001) << i << " from " << away;
        ASSERT_LE(picked->deviation, (away + 1000) * 0.5 / 1000 + 20) << i;  // that is half a pixel there
        worst_pick = std::max(worst_pick, off_pick);
    }
    EXPECT_GT(worst_mesh, 100);  // the bounds are not merely large
    EXPECT_GT(worst_pick, 10);
}

// What a picture's report says of its middle is the query's answer there, whatever the exaggeration.
TEST_F(OneHeight, ReportsOfPicturesAgree) {
    for (const char* exaggeration : {"1", "4"}) {
        const ScratchFolder folder;
        const Outcome drawn =
            run(folder.path(), words("render --at 37.58,-105.49 --range 20km --pitch -50 --size 64x64 -o x.png --json "
                                     "x.json --exaggeration " +
                                     std::string(exaggeration)));
        if (drawn.status == 4) GTEST_SKIP() << drawn.err;
        ASSERT_EQ(drawn.status, 0) << drawn.err;
        const auto picture = nlohmann::json::parse(content(folder / "x.json"));
        std::ostringstream place;
        place.precision(17);
        place << picture.at("centre_latitude_deg").get<double>() << ','
              << picture.at("centre_longitude_deg").get<double>();
        EXPECT_NEAR(picture.at("centre_latitude_deg").get<double>(), 37.58, 0.01);
        const Outcome asked = run(folder.path(), words("query height " + place.str() + " --json q.json"));
        ASSERT_EQ(asked.status, 0) << asked.err;
        const auto answer = nlohmann::json::parse(content(folder / "q.json"));
        EXPECT_NEAR(picture.at("centre_height_m").get<double>(), answer.at("height_m").get<double>(), 1e-4);
        EXPECT_NEAR(picture.at("centre_height_bound_m").get<double>(), answer.at("height_bound_m").get<double>(), 1e-4);
        // Half a pixel of 64 across 40 degrees.
        EXPECT_LT(picture.at("centre_deviation_m").get<double>(), 0.5 * 1.1 * 20000 / 88);
    }
}

}  // namespace
}  // namespace render
