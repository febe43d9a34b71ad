#pragma once
// octaglobe query: what its subcommands share. Each is a file query_NAME.cpp that defines add_query_NAME.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planet/geodesy/geoid.h"
#include "planet/terrain/ground.h"
#include "render/app/picture/earth.h"
#include "render/app/report.h"
#include "render/app/values.h"

namespace render {

/// The ground that a query is about.
struct GroundOptions {
    EarthSources sources;
    std::optional<std::filesystem::path> store;
};
void add_ground_options(CLI::App& command, GroundOptions& options);

/// What queries for heights at places take.
struct HeightOptions {
    std::vector<planet::Geodetic> places;
    planet::VerticalDatum datum = planet::VerticalDatum::egm96;  ///< that is asked for
    GroundOptions ground;
    std::string json;
};
/// --datum and the options of the ground; not the places. @param datum_use  what the datum is for
void add_height_options(CLI::App& command, HeightOptions& options, const std::string& datum_use);

/// Heights come from the store that pictures are drawn from, because only there is it known how far the surface can be
/// from the samples it was made of. Times itself as a step of the report.
planet::StoreField open_ground(const GroundOptions& options, Report& report);

/// A line on standard error for each tile that could not be read; whether there was one. Sets "damaged".
bool report_damage(const planet::StoreField& field, Report& report);

/// Heights above both datums, by the datum of a store.
class HeightReference {
  public:
    /// Reads the geoid.
    explicit HeightReference(const planet::StoreField& field);

    struct Heights {
        planet::OrthometricHeight H;
        planet::EllipsoidalHeight h;
        planet::GeoidUndulation N;

        double above(planet::VerticalDatum datum) const { return datum == planet::VerticalDatum::egm96 ? H.m : h.m; }
    };
    Heights heights(const planet::Ground& ground, const glm::dvec3& normal) const;

  private:
    planet::Geoid geoid_;
    planet::VerticalDatum datum_;
};

/// LAT,LON several times, by position. @param least how many it takes
CLI::Option* add_places(CLI::App& command, const std::string& name, const std::string& what,
                        std::vector<planet::Geodetic>& places, int least, int most = 1 << 20);

/// 0..360 degrees, clockwise from north, of an azimuth in radians.
double bearing(double azimuth);
/// "37.576700,-105.485800": a place as it can be given again.
std::string place_text(const planet::Geodetic& place);
/// {"latitude_deg", "longitude_deg"}
nlohmann::ordered_json place_json(const planet::Geodetic& place);
/// A height bound as JSON: null where there is none.
nlohmann::ordered_json bound_json(const planet::Ground& ground, bool damaged);

void add_query_height(CLI::App& query);
void add_query_profile(CLI::App& query);
void add_query_distance(CLI::App& query);
void add_query_area(CLI::App& query);
void add_query_sight(CLI::App& query);
void add_query_viewshed(CLI::App& query);

}  // namespace render
