// octaglobe mesh --planet.

#include "planet/error.h"
#include "render/app/mesh_output.h"

namespace render {

void mesh_planet(const MeshOptions&, Report&) {
    throw planet::Error(planet::Fault::bad_usage, "--planet", "is not there yet");
}

}  // namespace render
