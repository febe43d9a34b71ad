#pragma once
// Small stores, baked by the program from small rasters.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "planet/elevation/sha256.h"
#include "planet/store/sqlite_file.h"
#include "planet/store/store_field.h"
#include "tests/render/app/program_process.h"
#include "tests/render/app/terrain_files.h"

namespace render {

/// Bakes in a folder and returns the report. @param arguments without --json, -o is store.octa unless given, and the
/// planet without sources as coarse as can be, which is quick.
inline nlohmann::json bake(const ScratchFolder& folder, std::string arguments) {
    if (arguments.find("--least-level") == std::string::npos) arguments += " --least-level 12";
    if (arguments.find("-o ") == std::string::npos) arguments += " -o store.octa";
    const Outcome outcome = run(folder.path(), words("bake " + arguments + " --json bake.json"));
    EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return outcome.status == 0 ? nlohmann::json::parse(content(folder / "bake.json")) : nlohmann::json();
}

inline planet::StoreField open_field(const std::filesystem::path& file) {
    return planet::StoreField(std::make_shared<const planet::ElevationStore>(planet::ElevationStore::open(file)));
}

/// @param latitude, longitude degrees
inline double height_at(const planet::StoreField& field, double latitude, double longitude) {
    using planet::degrees;
    return static_cast<double>(field.height(planet::normal_from_geodetic(latitude * degrees, longitude * degrees)));
}

/// The checksum of all rows of all tables, to compare contents.
inline std::string rows_of(const std::filesystem::path& file) {
    planet::SqliteFile database(file, planet::SqliteFile::Access::read);
    std::string rows;
    planet::SqliteStatement tables(database, "SELECT sql FROM sqlite_schema WHERE sql NOT NULL ORDER BY name");
    while (tables.step()) rows += tables.text(0) + "\n";
    const auto add = [&](const char* select, int columns) {
        planet::SqliteStatement row(database, select);
        while (row.step())
            for (int i = 0; i < columns; ++i) rows += row.text(i) + (i + 1 < columns ? "|" : "\n");
    };
    add("SELECT key, value FROM metadata ORDER BY key", 2);
    add("SELECT rank, name, checksum, crs, datum, hex(spacing_m), files FROM sources ORDER BY rank", 7);
    add("SELECT code, hex(data) FROM tiles ORDER BY code", 2);
    planet::Sha256 sum;
    sum.add(rows.data(), rows.size());
    return sum.hex();
}

}  // namespace render
