#pragma once
// Stars of a catalogue as points for stars.vert.glsl.

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

namespace render {

/// A vertex: attribute 0 is direction, attribute 1 light; stride sizeof(Star).
struct Star {
    glm::vec3 direction{0};  ///< unit, inertial: x to right ascension 0, z to the celestial pole, J2000
    glm::vec3 light{0};      ///< radiance of the middle of its picture, 1 about for Vega
};

/// @param right_ascension, declination J2000, rad   @param magnitude V   @param b_v colour index, -0.4..2 (clamped)
/// Light falls with 10^(-0.3 V), not the true -0.4: eight bits hold then what the eye sees, to magnitude 6.
/// Colour: temperature after F. Ballesteros 2012, EPL 97 34008, then Planck's law at the bands of the air.
Star make_star(double right_ascension, double declination, double magnitude, double b_v);

/// Reads a text table: right ascension and declination J2000 in degrees, V, B-V, four numbers a line parted by commas
/// or blanks; further fields are ignored. Blank lines, lines that begin with '#' and one header line are skipped.
/// Throws planet::Error (bad_data) for a missing file, more than 16 MiB, or a bad line (named by its number).
std::vector<Star> read_stars(const std::filesystem::path& file);

}  // namespace render
