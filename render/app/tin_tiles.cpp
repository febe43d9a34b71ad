// octaglobe tin --tile
#include "planet/error.h"
#include "render/app/tin_options.h"
namespace render {
void tin_tiles(const TinCommand&, Report&) {
    throw planet::Error(planet::Fault::bad_usage, "--tile", "to come");
}
}  // namespace render
