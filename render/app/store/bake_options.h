#pragma once
// What `octaglobe bake` is told.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planet/bake/bake.h"
#include "planet/elevation/elevation_field.h"

namespace render {

struct BakeCommand {
    std::vector<std::string> sources;          ///< files and patterns, later ones on top
    std::vector<planet::VerticalDatum> datum;  ///< none: what files say; one for all, or one for each of `sources`
    bool over_earth = false;                   ///< the shipped Earth lies below them; else H = 0
    std::filesystem::path output;
    std::size_t memory_bytes = std::size_t{1} << 30;  ///< of the whole process
    planet::BakeOptions bake;
    /// Where there is no source the sea is drawn by the least cells: at level 18 their middle is some 20 m low. Nothing:
    /// that, or the finest level if it is coarser.
    std::optional<int> least_level;
    std::string json;
};

}  // namespace render
